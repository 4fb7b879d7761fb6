//! Scene files for [Viscera](viscera): TOML in, a world out.
//!
//! A scene is read ([`Scene::load`]), changed by overrides ([`Scene::set`]), checked against the schema that [`mod@file`] gives
//! ([`Scene::check`]), and built. What is wrong is shown in its line ([`SceneError`]).

mod build;
mod check;
mod document;
mod error;
pub mod file;
mod files;
pub mod quantity;
mod scene;
mod schema;
mod summary;
mod tissue;
pub mod unit;

pub use build::{BodyResponses, BuiltScene, Meshes};
pub use check::closest;
pub use error::{Place, SceneError, SceneErrors};
pub use files::Files;
pub use scene::Scene;
pub use schema::{schema, schema_text};
pub use summary::{BodySummary, InstrumentSummary, SceneSummary};

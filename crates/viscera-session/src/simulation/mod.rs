//! A scene being played: its world, the ghost beside it, its surfaces and instruments.

mod build;
pub(crate) mod colour;
mod entry;
mod ghost;
mod play;
mod surface;
pub(crate) mod tools;
mod way_out;
mod world;

pub(crate) use build::Change;
pub(crate) use play::{Kept, Play};
pub(crate) use surface::Surface;
pub(crate) use world::AnyWorld;

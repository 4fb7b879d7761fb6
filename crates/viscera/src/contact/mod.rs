//! Contact between rigid tools and the deforming surface of a body.
//!
//! Tools are capsules whose motion over a step is known. Every triangle of the surface that meets one on the way makes a contact: a
//! material point of the triangle, one of the tool's axis, and the direction between them when they meet. Along it the two must be the
//! tool's radius apart at the end of the step; across it friction holds them together, up to Coulomb's cone.
//!
//! * Explicit sub-steps satisfy that by impulses on lumped masses (`impulses`): exact, and no stiffer than
//!   the tissue, so the stable step stays what it is.
//! * Implicit steps take stiff springs that push and never pull (`springs`), as stiff as some twenty times the diagonal of the
//!   matrix at the nodes that touch.
//! * Bodies that answer statically feel pushes, found through their responses (`pushes`): exact, and without friction.

mod capsule;
mod closest;
mod contacts;
mod impulses;
mod pushes;
mod springs;
mod sweep;
mod tool_frame;

pub use capsule::Capsule;
pub(crate) use closest::distance_to_triangle;
pub use contacts::{Contact, Contacts, ToolLoad};
pub(crate) use impulses::Nodes;
pub(crate) use pushes::PushMemory;
pub use springs::Traction;
pub use sweep::MovingCapsule;
pub use tool_frame::ToolFrame;

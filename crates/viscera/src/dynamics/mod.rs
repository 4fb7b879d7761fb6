//! How bodies move in time.

pub mod answer;
mod drive;
pub mod explicit;
mod hold;
pub mod implicit;
pub mod quasi_static;
pub(crate) mod tied;

pub use drive::Drive;

//! How bodies move in time.

pub mod answer;
mod drive;
pub mod explicit;
mod hold;
pub mod implicit;
pub mod quasi_static;

pub use drive::Drive;

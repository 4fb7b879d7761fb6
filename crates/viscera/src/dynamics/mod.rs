//! How bodies move in time.

mod drive;
pub mod explicit;
pub mod implicit;

pub use drive::Drive;

//! How bodies move in time.

pub mod explicit;
pub mod quasi_static;

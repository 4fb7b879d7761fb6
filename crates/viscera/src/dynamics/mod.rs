//! How bodies move in time.

pub mod explicit;

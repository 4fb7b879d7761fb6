//! The `viscera` program.

fn main() {}

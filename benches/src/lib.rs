//! What the benches set their numbers against: the machine's own multiply-adds and bytes, measured in the same run.

mod bars;
mod machine;

pub use bars::Results;
pub use machine::{Machine, instruction_set};

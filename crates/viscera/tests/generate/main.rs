//! What the generators promise: volumes, closed surfaces, matching faces, bounded angles, readable refusals.

mod proof;
mod simple_shapes;

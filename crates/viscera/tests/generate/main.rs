//! What the generators promise: volumes, closed surfaces, matching faces, bounded angles, readable refusals.

mod proof;
mod quality;
mod simple_shapes;
mod solids;
mod stuffing;
mod surfaces;

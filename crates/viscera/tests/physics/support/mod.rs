//! What the tests measure with: random numbers, every model of a tissue, comparisons, reference files.

mod compare;
mod models;
mod random;
mod reference;

pub(crate) use compare::{assert_close, assert_near, largest, near};
pub(crate) use models::{
    Evaluate, KEEP_VOLUME, Named, amplification, deformed, examples, hex_mesh, inner_nodes, models, models_and_penalty,
    models_of_the_law, of_values, plain, tet_mesh, uneven,
};
pub(crate) use random::Random;
pub(crate) use reference::{Reference, matrix, number, vector, vectors};

use viscera::math::{Mat3, Vec3};

pub(crate) type Vector = Vec3<f64>;
pub(crate) type Matrix = Mat3<f64>;

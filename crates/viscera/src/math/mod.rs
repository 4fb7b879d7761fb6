//! Numbers, lanes, small vectors and matrices: one text for `f32`, `f64` and SIMD lanes.

mod dual;
mod instruction_set;
mod lanes;
pub(crate) mod large_pages;
mod mat3;
mod prefetch;
mod real;
pub mod rotation;
mod rows;
mod sym3;
mod vec3;

pub use dual::Dual;
pub(crate) use instruction_set::baseline;
pub use instruction_set::{Level, dispatch, dispatch_level, vectorize, with_level};
pub use lanes::{Lanes, MAX_LANES, Part, Scalar, Simd};
pub use mat3::Mat3;
pub(crate) use prefetch::prefetch;
pub use real::Real;
pub use sym3::Sym3;
pub use vec3::Vec3;

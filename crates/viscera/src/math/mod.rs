//! Numbers, lanes, small vectors and matrices: one text for `f32`, `f64` and SIMD lanes.

mod dual;
mod lanes;
mod mat3;
mod prefetch;
mod real;
pub mod rotation;
mod rows;
mod sym3;
mod vec3;

pub use dual::Dual;
pub(crate) use lanes::baseline;
pub use lanes::{Lanes, MAX_LANES, Scalar, dispatch_level, with_level};
pub use mat3::Mat3;
pub(crate) use prefetch::prefetch;
pub use real::Real;
pub use sym3::Sym3;
pub use vec3::Vec3;

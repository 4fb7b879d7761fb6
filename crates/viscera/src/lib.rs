//! Soft tissue in real time, physically.
//!
//! Viscera unites two lines of work, the non-linear anisotropic tensor-mass models for surgery (Picinbono, Delingette,
//! Ayache 2000/2001) and the physically realistic interactive models (Nesme et al. 2005). All quantities are SI
//! (m, kg, s, N, Pa) unless an item says otherwise. The crate touches no file, socket or clock, and no thread
//! but those of the executor that a step is given.

pub mod body;
pub mod constraint;
pub mod contact;
pub mod curve;
mod cutting;
pub mod dynamics;
pub mod executor;
pub mod instrument;
pub mod material;
pub mod math;
pub mod mesh;
pub mod model;
pub mod solver;
pub mod stage;
pub mod world;

/// The guide's chapter on the library, so that its examples are compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/guide/library.md")]
pub struct Guide;

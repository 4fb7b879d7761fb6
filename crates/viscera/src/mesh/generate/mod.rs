//! Meshes of simple shapes, made from their measures. One shape is one file.

mod boundary_regions;
mod box_grid;
mod cylinder;
mod error;
mod extrusion;
mod liver;
mod trunk;
mod tube;

pub use box_grid::CubeCut;
pub use error::GenerateError;
pub use liver::Liver;
pub use tube::TubeDivisions;

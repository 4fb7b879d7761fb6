//! Meshes of tetrahedra and hexahedra: storage, topology, surface, regions, quality, generators.
//!
//! Nodes are numbered from 0 and measured in metres. Corners follow the Gmsh/VTK order: a tetrahedron (a, b, c, d) has
//! det[b−a, c−a, d−a] > 0; a hexahedron lists its bottom face counter-clockwise seen from inside, then its top face.

mod check;
mod error;
mod gauss;
mod generate;
mod groups;
mod isosurface_stuffing;
mod measure;
mod mesh_report;
mod partition;
mod quality;
mod region;
mod reordering;
mod select;
mod signed_distance;
mod surface_check;
mod surface_filling;
mod surface_mesh;
mod thickening;
mod topology;
mod triangle_tree;
mod volume_mesh;

pub use error::MeshError;
pub use gauss::{GaussPoint, GaussRule, hexahedron_volume};
pub use generate::{CubeCut, GenerateError, Liver, TubeDivisions};
pub use mesh_report::MeshReport;
pub(crate) use partition::partition;
pub use quality::{QualityReport, Spread, TetQuality, radius_ratio, scaled_jacobian};
pub use region::NamedRegion;
pub use reordering::Reordered;
pub use select::{LoadTriangle, Region, RegionError};
pub use signed_distance::SignedDistance;
pub use surface_check::{Hole, NonManifoldEdge, SurfaceError, SurfaceReport};
pub use surface_filling::FillingReport;
pub use surface_mesh::SurfaceMesh;
pub use topology::{Face, TetTopology, cells_of_nodes};
pub use triangle_tree::TriangleTree;
pub use volume_mesh::{HEX_EDGES, HEX_FACES, HexMesh, Mesh, TET_EDGES, TET_FACES, TetMesh, VolumeMesh};

use crate::math::Vec3;

/// A place in space [m], in double precision: what meshes are made of.
pub type Point = Vec3<f64>;

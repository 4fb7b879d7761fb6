//! Meshes in, results and pictures out, for [Viscera](viscera).
//!
//! [`read_mesh`] reads Gmsh, VTK, STL and OBJ; [`read_volume`] also insists on a volume and checks it. Every format is one
//! module with a `parse` over bytes, which never trusts a count that it has not held against the size of the file. What is
//! in a file and not in the mesh is told in [`Notice`]s.
//!
//! [`write`](mod@write) has VTU and PVD for ParaView, MSH 2.2 and CSV. Every file is written aside and renamed, so that a
//! reader sees the old file or the new one, never half of one.

mod assembly;
mod cell_kind;
mod cursor;
mod error;
pub mod gmsh;
mod imported;
pub mod obj;
pub mod picture;
mod read;
pub mod stl;
pub mod vtk;
mod vtk_cells;
pub mod vtu;
pub mod write;

pub use cell_kind::{CellKind, Shape};
pub use error::{ParseError, Place, Problem, ReadError};
pub use imported::{Imported, ImportedMesh, Notice, grouped};
pub use read::{ImportedVolume, read_mesh, read_mesh_bytes, read_volume, read_volume_bytes};

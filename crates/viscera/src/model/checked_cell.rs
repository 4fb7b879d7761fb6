use super::ModelError;
use super::tet_loop::RestTet;
use crate::mesh::{GaussRule, VolumeMesh};

/// Volume of a cell at rest [m³].
///
/// # Errors
/// [`ModelError::Mesh`] for a cell without volume.
pub(super) fn checked_volume(mesh: &VolumeMesh, cell: usize) -> Result<f64, ModelError> {
    match mesh {
        VolumeMesh::Tet(mesh) => Ok(RestTet::new(mesh, cell)?.volume),
        VolumeMesh::Hex(mesh) => Ok(mesh.gauss_points(cell, GaussRule::Two)?.iter().map(|point| point.volume).sum()),
    }
}

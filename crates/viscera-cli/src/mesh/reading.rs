//! Meshes in, for the commands.

use viscera::mesh::{MeshReport, VolumeMesh};
use viscera_io::{Imported, ImportedMesh, ReadError, read_mesh};

use super::arguments::MeshSource;
use crate::failure::Failure;
use crate::terminal;

impl MeshSource {
    /// Reads the file as it is. What of it is not in the mesh is told.
    pub(super) fn read(&self) -> Result<ImportedMesh, Failure> {
        let Imported { mesh, notices } =
            read_mesh(&self.file, self.unit.in_metres() * self.scale).map_err(|error| match error {
                ReadError::Content { .. } | ReadError::Mesh { .. } => Failure::problem(error),
                _ => Failure::input(error),
            })?;
        for notice in notices {
            terminal::complain(&format!("note: {notice}"));
        }
        Ok(mesh)
    }

    /// A name for messages about what is wrong with the mesh.
    pub(super) fn blame(&self, error: impl std::fmt::Display) -> Failure {
        Failure::problem(format!("{}: {error}", self.file.display()))
    }

    /// Checks a volume, as a scene does that uses it.
    pub(super) fn checked(&self, mesh: impl Into<VolumeMesh>) -> Result<(VolumeMesh, MeshReport), Failure> {
        let checked = match mesh.into() {
            VolumeMesh::Tet(mesh) => mesh.checked().map(|(mesh, report)| (mesh.into(), report)),
            VolumeMesh::Hex(mesh) => mesh.checked().map(|(mesh, report)| (mesh.into(), report)),
        };
        checked.map_err(|error| self.blame(error))
    }
}

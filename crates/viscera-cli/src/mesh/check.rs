//! `viscera mesh check`.

use viscera::mesh::VolumeMesh;
use viscera_io::ImportedMesh;

use super::arguments::MeshSource;
use crate::failure::Failure;
use crate::terminal::say;

pub(super) fn check(source: &MeshSource) -> Result<(), Failure> {
    match source.read()? {
        ImportedMesh::Tet(mesh) => volume(source, mesh.into()),
        ImportedMesh::Hex(mesh) => volume(source, mesh.into()),
        ImportedMesh::Surface(mesh) => {
            let report = mesh.check().map_err(|error| source.blame(error))?;
            say(&report.to_string());
            report.require_closed().map_err(|error| source.blame(error))?;
            say("the surface is closed: it can be filled with `viscera mesh tetrahedralize`");
            Ok(())
        }
    }
}

fn volume(source: &MeshSource, mesh: VolumeMesh) -> Result<(), Failure> {
    let (_, report) = source.checked(mesh)?;
    say(&report.to_string());
    say(if report.is_clean() { "the mesh is good" } else { "the mesh can be used, with what is said above" });
    Ok(())
}

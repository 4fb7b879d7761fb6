//! `viscera mesh convert`.

use std::path::Path;

use viscera::mesh::VolumeMesh;
use viscera_io::ImportedMesh;

use super::arguments::MeshSource;
use super::writing::{require_known_ending, write_surface, write_volume};
use crate::failure::Failure;
use crate::terminal::{complain, say};

pub(super) fn convert(source: &MeshSource, out: &Path) -> Result<(), Failure> {
    require_known_ending(out)?;
    let volume = |mesh: VolumeMesh| {
        let (mesh, report) = source.checked(mesh)?;
        report.remarks().iter().for_each(|remark| complain(remark));
        write_volume(out, &mesh)
    };
    match source.read()? {
        ImportedMesh::Tet(mesh) => volume(mesh.into())?,
        ImportedMesh::Hex(mesh) => volume(mesh.into())?,
        ImportedMesh::Surface(mesh) => write_surface(out, &mesh)?,
    }
    say(&format!("wrote {}", out.display()));
    Ok(())
}

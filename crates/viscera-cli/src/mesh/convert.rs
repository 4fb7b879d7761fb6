//! `viscera mesh convert`.

use std::path::Path;

use viscera::mesh::VolumeMesh;
use viscera_io::{ImportedMesh, grouped};

use super::arguments::MeshSource;
use super::writing::{require_known_ending, write_surface, write_volume};
use crate::failure::Failure;
use crate::terminal::{complain, say};

pub(super) fn convert(source: &MeshSource, reorder: bool, out: &Path) -> Result<(), Failure> {
    require_known_ending(out)?;
    let volume = |mesh: VolumeMesh| {
        let (mesh, report) = source.checked(mesh)?;
        report.remarks().iter().for_each(|remark| complain(remark));
        if !reorder {
            return write_volume(out, &mesh);
        }
        let ordered = mesh.reordered().map_err(|error| source.blame(error))?.mesh;
        say(&format!(
            "numbers of a cell's nodes lie {} apart in the mean, {} before",
            grouped(ordered.node_span().round() as usize),
            grouped(mesh.node_span().round() as usize)
        ));
        write_volume(out, &ordered)
    };
    match source.read()? {
        ImportedMesh::Tet(mesh) => volume(mesh.into())?,
        ImportedMesh::Hex(mesh) => volume(mesh.into())?,
        ImportedMesh::Surface(_) if reorder => {
            return Err(Failure::input(format!(
                "{}: a surface has no cells to reorder; leave out `--reorder`",
                source.file.display()
            )));
        }
        ImportedMesh::Surface(mesh) => write_surface(out, &mesh)?,
    }
    say(&format!("wrote {}", out.display()));
    Ok(())
}

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
        let [span, before] = [&ordered, &mesh].map(|mesh| grouped(mesh.node_span().round() as usize));
        if ordered.node_span() >= mesh.node_span() {
            say(&format!(
                "numbers of a cell's nodes lie {before} apart in the mean: a new order would not be better, and theirs stays"
            ));
            return write_volume(out, &mesh);
        }
        say(&format!("numbers of a cell's nodes lie {span} apart in the mean, {before} before"));
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

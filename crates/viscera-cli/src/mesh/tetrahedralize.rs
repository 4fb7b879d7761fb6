//! `viscera mesh tetrahedralize`.

use std::path::Path;

use viscera::mesh::{SurfaceError, TetMesh};
use viscera_io::ImportedMesh;

use super::arguments::MeshSource;
use super::writing::{require_known_ending, write_volume};
use crate::failure::Failure;
use crate::terminal::say;

pub(super) fn tetrahedralize(source: &MeshSource, edge: f64, out: &Path) -> Result<(), Failure> {
    require_known_ending(out)?;
    let ImportedMesh::Surface(surface) = source.read()? else {
        return Err(Failure::input(format!(
            "{}: the file holds a volume mesh already; give a file of triangles (STL, OBJ)",
            source.file.display()
        )));
    };
    let blame = |error: SurfaceError| source.blame(error);
    // What is wrong is told with all its places before it is refused.
    let look = surface.check().map_err(blame)?;
    if let Err(error) = look.require_closed() {
        say(&look.to_string());
        return Err(blame(error));
    }
    let (mesh, report) = TetMesh::from_surface(&surface, edge).map_err(blame)?;
    say(&report.to_string());
    if let Some(quality) = mesh.quality() {
        say(&quality.to_string());
    }
    write_volume(out, &mesh.into())?;
    say(&format!("wrote {}", out.display()));
    Ok(())
}

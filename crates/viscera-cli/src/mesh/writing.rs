//! Meshes out, in the format that the ending says.

use std::path::Path;

use viscera::mesh::{SurfaceMesh, VolumeMesh};
use viscera_io::write::{Encoding, Field, Grid, WriteError, write_hex_msh, write_tet_msh, write_vtu};

use crate::failure::Failure;

/// Writes a volume with its regions.
pub(super) fn write_volume(path: &Path, mesh: &VolumeMesh) -> Result<(), Failure> {
    match (ending(path)?, mesh) {
        (Ending::Vtu, mesh) => write_vtu_with_regions(path, mesh),
        (Ending::Msh, VolumeMesh::Tet(mesh)) => write_tet_msh(path, mesh),
        (Ending::Msh, VolumeMesh::Hex(mesh)) => write_hex_msh(path, mesh),
    }
    .map_err(Failure::input)
}

/// Writes a surface.
pub(super) fn write_surface(path: &Path, mesh: &SurfaceMesh) -> Result<(), Failure> {
    match ending(path)? {
        Ending::Vtu => write_vtu(path, &Grid::from(mesh), Encoding::Raw).map_err(Failure::input),
        Ending::Msh => Err(Failure::input(format!(
            "{}: a surface is written as .vtu only; `viscera mesh tetrahedralize` makes a volume of it",
            path.display()
        ))),
    }
}

enum Ending {
    Vtu,
    Msh,
}

/// Refuses a file that could not be written, before the work is done.
pub(super) fn require_known_ending(path: &Path) -> Result<(), Failure> {
    ending(path).map(|_| ())
}

fn ending(path: &Path) -> Result<Ending, Failure> {
    match path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase().as_str() {
        "vtu" => Ok(Ending::Vtu),
        "msh" => Ok(Ending::Msh),
        _ => Err(Failure::input(format!(
            "{}: the ending says no format that can be written; end the name with .vtu or .msh",
            path.display()
        ))),
    }
}

/// VTU has no regions: each becomes a field that is 1 in it, of cells where it has cells, else of nodes.
fn write_vtu_with_regions(path: &Path, mesh: &VolumeMesh) -> Result<(), WriteError> {
    let mut of_nodes = Vec::new();
    let mut of_cells = Vec::new();
    for region in regions(mesh) {
        let (list, count, fields) = match region.cells.is_empty() {
            true => (region.nodes, mesh.nodes().len(), &mut of_nodes),
            false => (region.cells, mesh.cell_count(), &mut of_cells),
        };
        let mut marks = vec![0; count];
        list.iter().for_each(|&number| marks[number as usize] = 1);
        fields.push((region.name, marks));
    }
    let mut grid = Grid::from(mesh);
    grid.point_data.extend(of_nodes.iter().map(|(name, marks)| Field::label(name, marks)));
    grid.cell_data.extend(of_cells.iter().map(|(name, marks)| Field::label(name, marks)));
    write_vtu(path, &grid, Encoding::Raw)
}

/// A named part of a mesh of either kind.
pub(super) struct RegionOf<'a> {
    pub(super) name: &'a str,
    pub(super) nodes: &'a [u32],
    pub(super) cells: &'a [u32],
    pub(super) faces: usize,
}

/// The named parts of a mesh, by name.
pub(super) fn regions(mesh: &VolumeMesh) -> Vec<RegionOf<'_>> {
    macro_rules! list {
        ($mesh:expr) => {
            $mesh
                .regions
                .iter()
                .map(|(name, region)| RegionOf {
                    name,
                    nodes: &region.nodes,
                    cells: &region.cells,
                    faces: region.faces.len(),
                })
                .collect()
        };
    }
    match mesh {
        VolumeMesh::Tet(mesh) => list!(mesh),
        VolumeMesh::Hex(mesh) => list!(mesh),
    }
}

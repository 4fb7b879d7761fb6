use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use viscera::mesh::{HexMesh, Mesh, NamedRegion, TetMesh};

use super::{WriteError, write_atomically};

/// Gmsh's numbers of the element types of a mesh: cell, face, point.
struct Types {
    cell: u8,
    face: u8,
}

/// Gmsh's number of a point.
const POINT: u8 = 15;

/// Writes tetrahedra as MSH 2.2 (text), regions as physical groups with names.
///
/// As Gmsh does, a cell of several regions is listed once for each. Nodes of a region that are in none of its cells and
/// faces are listed as points, so that reading brings back the same regions.
///
/// # Errors
/// [`WriteError::Name`] for a name that the format cannot hold, or [`WriteError::Unwritable`].
pub fn write_tet_msh(path: impl AsRef<Path>, mesh: &TetMesh) -> Result<(), WriteError> {
    write_msh(path.as_ref(), mesh, &Types { cell: 4, face: 2 })
}

/// Writes hexahedra as MSH 2.2, as [`write_tet_msh`] does.
///
/// # Errors
/// As there.
pub fn write_hex_msh(path: impl AsRef<Path>, mesh: &HexMesh) -> Result<(), WriteError> {
    write_msh(path.as_ref(), mesh, &Types { cell: 5, face: 3 })
}

fn write_msh<const CORNERS: usize, const FACE: usize>(
    path: &Path,
    mesh: &Mesh<CORNERS, FACE>,
    types: &Types,
) -> Result<(), WriteError> {
    if let Some(name) = mesh.regions.keys().find(|name| name.trim().is_empty() || name.contains(['"', '\n', '\r'])) {
        return Err(WriteError::Name { name: name.clone() });
    }
    check(mesh)?;
    write_atomically(path, |out| {
        writeln!(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat")?;
        write_names(out, mesh)?;
        writeln!(out, "$Nodes\n{}", mesh.nodes.len())?;
        for (number, node) in mesh.nodes.iter().enumerate() {
            writeln!(out, "{} {} {} {}", number + 1, node.x, node.y, node.z)?;
        }
        writeln!(out, "$EndNodes")?;
        write_elements(out, mesh, types)
    })
}

/// Every node and cell that cells and regions name must be there.
fn check<const CORNERS: usize, const FACE: usize>(mesh: &Mesh<CORNERS, FACE>) -> Result<(), WriteError> {
    let nodes = mesh.nodes.len();
    for (cell, corners) in mesh.cells.iter().enumerate() {
        if let Some(&node) = corners.iter().find(|&&node| node as usize >= nodes) {
            return Err(WriteError::MissingNode { cell, node, nodes });
        }
    }
    for (name, region) in &mesh.regions {
        let missing_node =
            region.nodes.iter().chain(region.faces.iter().flatten()).find(|&&node| node as usize >= nodes);
        let missing_cell = region.cells.iter().find(|&&cell| cell as usize >= mesh.cells.len());
        let missing = missing_node.map(|node| ("node", node)).or(missing_cell.map(|cell| ("cell", cell)));
        if let Some((what, &number)) = missing {
            return Err(WriteError::Region { region: name.clone(), what, number });
        }
    }
    Ok(())
}

/// A region has one number and up to three groups: of points, faces and cells.
fn write_names<const CORNERS: usize, const FACE: usize>(
    out: &mut impl Write,
    mesh: &Mesh<CORNERS, FACE>,
) -> io::Result<()> {
    let mut lines = Vec::new();
    for (number, (name, region)) in mesh.regions.iter().enumerate() {
        let parts =
            [(0, !loose_nodes(mesh, region).is_empty()), (2, !region.faces.is_empty()), (3, !region.cells.is_empty())];
        let present = parts.into_iter().filter(|&(_, present)| present);
        lines.extend(present.map(|(dimension, _)| format!("{dimension} {} \"{name}\"", number + 1)));
    }
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(out, "$PhysicalNames\n{}", lines.len())?;
    lines.iter().try_for_each(|line| writeln!(out, "{line}"))?;
    writeln!(out, "$EndPhysicalNames")
}

/// Nodes of a region that none of its cells and faces has.
fn loose_nodes<const CORNERS: usize, const FACE: usize>(
    mesh: &Mesh<CORNERS, FACE>,
    region: &NamedRegion<FACE>,
) -> Vec<u32> {
    let in_cells = region.cells.iter().flat_map(|&cell| mesh.cells[cell as usize]);
    let covered: BTreeSet<u32> = in_cells.chain(region.faces.iter().copied().flatten()).collect();
    region.nodes.iter().copied().filter(|node| !covered.contains(node)).collect()
}

fn write_elements<const CORNERS: usize, const FACE: usize>(
    out: &mut impl Write,
    mesh: &Mesh<CORNERS, FACE>,
    types: &Types,
) -> io::Result<()> {
    let mut groups_of_cell = vec![Vec::new(); mesh.cells.len()];
    let mut lines = Vec::new();
    for (number, region) in mesh.regions.values().enumerate() {
        let group = number + 1;
        region.cells.iter().for_each(|&cell| groups_of_cell[cell as usize].push(group));
        lines.extend(loose_nodes(mesh, region).iter().map(|&node| element(POINT, group, &[node])));
        lines.extend(region.faces.iter().map(|face| element(types.face, group, face)));
    }
    for (corners, groups) in mesh.cells.iter().zip(&groups_of_cell) {
        if groups.is_empty() {
            lines.push(element(types.cell, 0, corners));
        }
        lines.extend(groups.iter().map(|&group| element(types.cell, group, corners)));
    }
    writeln!(out, "$Elements\n{}", lines.len())?;
    for (number, line) in lines.iter().enumerate() {
        writeln!(out, "{} {line}", number + 1)?;
    }
    writeln!(out, "$EndElements")
}

/// Type, two tags (physical and elementary group), nodes.
fn element(kind: u8, group: usize, nodes: &[u32]) -> String {
    let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
    format!("{kind} 2 {group} {} {}", group.max(1), nodes.join(" "))
}

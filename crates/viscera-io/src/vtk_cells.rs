use crate::assembly::{Assembly, GroupSet};
use crate::cell_kind::{CellKind, Shape};
use crate::{ParseError, Place, Problem};

/// Adds one cell of a VTK type. What VTK orders differently (pixels, voxels) or joins (strips) is put into our terms.
pub(crate) fn add(
    assembly: &mut Assembly,
    cell: u64,
    cell_type: i64,
    nodes: &[i64],
    place: impl Fn() -> Place,
) -> Result<(), ParseError> {
    let mut corners = Vec::with_capacity(nodes.len());
    for &node in nodes {
        match u32::try_from(node) {
            Ok(index) if (index as usize) < assembly.nodes.len() => corners.push(index),
            _ => return Err(Problem::MissingNode { cell, node }.at(place())),
        }
    }
    let Some(kind) = CellKind::from_vtk(cell_type) else {
        return Err(Problem::UnknownCell { number: cell_type }.at(place()));
    };
    let expected = match kind.shape {
        _ if kind.curved => corners.len(),
        Shape::Triangle => 3,
        Shape::Quadrilateral | Shape::Tetrahedron => 4,
        Shape::Hexahedron => 8,
        Shape::Polygon => corners.len().max(3),
        _ => corners.len(),
    };
    if corners.len() != expected {
        return Err(Problem::Corners { cell, kind, found: corners.len() }.at(place()));
    }
    match cell_type {
        6 => add_strip(assembly, &corners),
        8 => assembly.cell(kind, &[0, 1, 3, 2].map(|i: usize| corners[i]), GroupSet::NONE),
        11 => assembly.cell(kind, &[0, 1, 3, 2, 4, 5, 7, 6].map(|i: usize| corners[i]), GroupSet::NONE),
        _ => assembly.cell(kind, &corners, GroupSet::NONE),
    }
    Ok(())
}

/// A strip of triangles: every second one is listed clockwise.
fn add_strip(assembly: &mut Assembly, corners: &[u32]) {
    for (number, window) in corners.windows(3).enumerate() {
        let [a, b, c] = [window[0], window[1], window[2]];
        let triangle = if number % 2 == 0 { [a, b, c] } else { [b, a, c] };
        assembly.cell(Shape::Triangle.straight(), &triangle, GroupSet::NONE);
    }
}

/// Cuts a list of nodes into cells at `offsets` (the end of every cell) and adds them.
pub(crate) fn add_all(
    assembly: &mut Assembly,
    connectivity: &[i64],
    offsets: &[i64],
    types: &[i64],
    place: Place,
) -> Result<(), ParseError> {
    if offsets.len() != types.len() {
        let (expected, found) = (types.len() as u64, offsets.len() as u64);
        return Err(Problem::Length { what: "offsets of cells", expected, found }.at(place));
    }
    let mut start = 0;
    for (cell, (&offset, &cell_type)) in offsets.iter().zip(types).enumerate() {
        let end = usize::try_from(offset).unwrap_or(usize::MAX);
        let Some(nodes) = connectivity.get(start..end) else {
            let found = connectivity.len() as u64;
            return Err(Problem::Length { what: "nodes of cells", expected: end as u64, found }.at(place));
        };
        add(assembly, cell as u64, cell_type, nodes, || place)?;
        start = end;
    }
    if start != connectivity.len() {
        let (expected, found) = (start as u64, connectivity.len() as u64);
        return Err(Problem::Length { what: "nodes of cells", expected, found }.at(place));
    }
    Ok(())
}

use super::nodes::NodeNumbers;
use super::{next_section, skip_section};
use crate::assembly::{Assembly, GroupSet};
use crate::cell_kind::CellKind;
use crate::cursor::Cursor;
use crate::{Imported, ParseError, Problem};

/// Version 1, from behind `$NOD`: text only, without names.
pub(super) fn parse(mut cursor: Cursor) -> Result<Imported, ParseError> {
    let mut assembly = Assembly::default();
    let nodes = read_nodes(&mut cursor, &mut assembly)?;
    while let Some(section) = next_section(&mut cursor)? {
        match section {
            "$ELM" => read_cells(&mut cursor, &nodes, &mut assembly)?,
            other => skip_section(&mut cursor, other)?,
        }
    }
    assembly.finish()
}

fn read_nodes(cursor: &mut Cursor, assembly: &mut Assembly) -> Result<NodeNumbers, ParseError> {
    let mut nodes = NodeNumbers::default();
    let count = cursor.number("the number of nodes")?;
    for _ in 0..cursor.bounded(count, 8, "nodes")? {
        read_node(cursor, &mut nodes, assembly)?;
    }
    cursor.keyword("$ENDNOD")?;
    Ok(nodes)
}

/// One line: number x y z, the same in versions 1 and 2.
pub(super) fn read_node(
    cursor: &mut Cursor,
    nodes: &mut NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    let mut fields = cursor.fields("a node has 4: its number, x, y and z")?;
    let number = fields.number("the number of a node")?;
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        *coordinate = fields.number("a coordinate")?;
    }
    nodes.add(assembly, number, position, || fields.place())?;
    fields.end()
}

fn read_cells(cursor: &mut Cursor, nodes: &NodeNumbers, assembly: &mut Assembly) -> Result<(), ParseError> {
    let count = cursor.number("the number of elements")?;
    let mut corners = Vec::new();
    for _ in 0..cursor.bounded(count, 12, "elements")? {
        let mut fields = cursor.fields(
            "an element has 5 and its nodes: number, type, physical group, elementary group, number of nodes",
        )?;
        let cell = fields.number("the number of an element")?;
        let kind_number = fields.number("the type of an element")?;
        let group = fields.number::<i32>("the physical group of an element")?.unsigned_abs();
        fields.number::<i32>("the elementary group of an element")?;
        let listed = fields.number::<usize>("the number of nodes of an element")?;
        let Some((kind, size)) = CellKind::from_gmsh(kind_number) else {
            return Err(Problem::UnknownCell { number: kind_number }.at(fields.place()));
        };
        if listed != size {
            return Err(Problem::Corners { cell, kind, found: listed }.at(fields.place()));
        }
        corners.clear();
        for _ in 0..size {
            let node = fields.number("the number of a node")?;
            corners.push(nodes.find(cell, node, || fields.place())?);
        }
        fields.end()?;
        let set = if group == 0 { GroupSet::NONE } else { assembly.set(vec![(kind.shape.dimension(), group)]) };
        assembly.cell(kind, &corners, set);
    }
    cursor.keyword("$ENDELM")
}

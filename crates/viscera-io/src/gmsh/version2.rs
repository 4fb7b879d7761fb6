use super::nodes::NodeNumbers;
use super::version1::read_node;
use super::{Format, next_section, read_names, skip_section};
use crate::assembly::{Assembly, GroupSet};
use crate::cell_kind::CellKind;
use crate::cursor::Cursor;
use crate::{ParseError, Problem};

/// Version 2.0 to 2.2, from behind the header.
pub(super) fn parse(mut cursor: Cursor, format: &Format, assembly: &mut Assembly) -> Result<(), ParseError> {
    let mut nodes = NodeNumbers::default();
    while let Some(section) = next_section(&mut cursor)? {
        match section {
            "$PhysicalNames" => read_names(&mut cursor, assembly)?,
            "$Nodes" => read_nodes(&mut cursor, format, &mut nodes, assembly)?,
            "$ParametricNodes" => return Err(super::parametric(&cursor)),
            "$Elements" => {
                let count = cursor.number("the number of elements")?;
                let count = cursor.bounded(count, 8, "elements")?;
                match format.binary {
                    false => read_text_cells(&mut cursor, count, &nodes, assembly)?,
                    true => read_binary_cells(&mut cursor, count, &nodes, assembly)?,
                }
                cursor.keyword("$EndElements")?;
            }
            other => skip_section(&mut cursor, other)?,
        }
    }
    Ok(())
}

fn read_nodes(
    cursor: &mut Cursor,
    format: &Format,
    nodes: &mut NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    let count = cursor.number("the number of nodes")?;
    if !format.binary {
        for _ in 0..cursor.bounded(count, 8, "nodes")? {
            read_node(cursor, nodes, assembly)?;
        }
        return cursor.keyword("$EndNodes");
    }
    cursor.line();
    for _ in 0..cursor.bounded(count, 28, "nodes")? {
        let place = cursor.here();
        let number = cursor.binary_i32("the number of a node")?;
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            *coordinate = cursor.binary_f64("a coordinate")?;
        }
        let number = u64::try_from(number).map_err(|_| {
            Problem::Unexpected { expected: "the number of a node", found: number.to_string() }.at(place)
        })?;
        nodes.add(assembly, number, position, || place)?;
    }
    cursor.keyword("$EndNodes")
}

/// One line: number, type, number of tags, tags (the first is the physical group), nodes.
fn read_text_cells(
    cursor: &mut Cursor,
    count: usize,
    nodes: &NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    let mut corners = Vec::new();
    for _ in 0..count {
        let mut fields =
            cursor.fields("an element has its number, type, number of tags, the tags, and the nodes of its type")?;
        let cell = fields.number("the number of an element")?;
        let kind_number = fields.number("the type of an element")?;
        let tags = fields.number::<usize>("the number of tags of an element")?;
        let Some((kind, size)) = CellKind::from_gmsh(kind_number) else {
            return Err(Problem::UnknownCell { number: kind_number }.at(fields.place()));
        };
        let mut group = 0;
        for tag in 0..tags {
            let value = fields.number::<i32>("a tag of an element")?;
            group = if tag == 0 { value.unsigned_abs() } else { group };
        }
        corners.clear();
        for _ in 0..size {
            let node = fields.number("the number of a node")?;
            corners.push(nodes.find(cell, node, || fields.place())?);
        }
        fields.end()?;
        let set = physical(kind, group, assembly);
        assembly.cell(kind, &corners, set);
    }
    Ok(())
}

/// Blocks of one type: type, number of elements, number of tags; then number, tags and nodes of each.
fn read_binary_cells(
    cursor: &mut Cursor,
    count: usize,
    nodes: &NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    cursor.line();
    let mut corners = Vec::new();
    let mut left = count;
    while left > 0 {
        let place = cursor.here();
        let kind_number = cursor.binary_i32("the type of a block of elements")?;
        let in_block = cursor.binary_i32("the number of elements in a block")?;
        let tags = cursor.binary_i32("the number of tags of an element")?;
        let Some((kind, size)) = CellKind::from_gmsh(kind_number.into()) else {
            return Err(Problem::UnknownCell { number: kind_number.into() }.at(place));
        };
        let in_block = match usize::try_from(in_block) {
            Ok(number) if (1..=left).contains(&number) => number,
            _ => {
                let found = in_block.to_string();
                return Err(
                    Problem::Unexpected { expected: "no more elements than the section announces", found }.at(place)
                );
            }
        };
        left -= in_block;
        for _ in 0..in_block {
            let place = cursor.here();
            let cell = cursor.binary_i32("the number of an element")?.unsigned_abs().into();
            let mut group = 0;
            for tag in 0..tags {
                let value = cursor.binary_i32("a tag of an element")?;
                group = if tag == 0 { value.unsigned_abs() } else { group };
            }
            corners.clear();
            for _ in 0..size {
                let node = cursor.binary_i32("the number of a node")?;
                corners.push(nodes.find(cell, node.into(), || place)?);
            }
            let set = physical(kind, group, assembly);
            assembly.cell(kind, &corners, set);
        }
    }
    Ok(())
}

fn physical(kind: CellKind, group: u32, assembly: &mut Assembly) -> GroupSet {
    if group == 0 { GroupSet::NONE } else { assembly.set(vec![(kind.shape.dimension(), group)]) }
}

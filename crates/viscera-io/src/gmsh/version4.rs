use std::collections::BTreeMap;

use super::nodes::NodeNumbers;
use super::{Format, next_section, parametric, read_names, skip_section};
use crate::assembly::{Assembly, Group, GroupSet};
use crate::cell_kind::CellKind;
use crate::cursor::Cursor;
use crate::{ParseError, Place, Problem};

/// Groups of every geometric entity, by dimension and tag.
type Entities = BTreeMap<(u8, i32), GroupSet>;

/// Version 4.1, from behind the header: nodes and elements in blocks, one block for each geometric entity; the entity,
/// not the element, knows its physical groups.
pub(super) fn parse(cursor: Cursor, format: &Format, assembly: &mut Assembly) -> Result<(), ParseError> {
    let mut reader = Reader { cursor, binary: format.binary, word: format.word };
    let mut nodes = NodeNumbers::default();
    let mut entities = Entities::new();
    while let Some(section) = next_section(&mut reader.cursor)? {
        match section {
            "$PhysicalNames" => read_names(&mut reader.cursor, assembly)?,
            "$Entities" => read_entities(&mut reader, &mut entities, assembly)?,
            "$Nodes" => read_nodes(&mut reader, &mut nodes, assembly)?,
            "$Elements" => read_cells(&mut reader, &entities, &nodes, assembly)?,
            "$PartitionedEntities" => {
                return Err(Problem::Unsupported {
                    what: "a partitioned mesh".to_owned(),
                    mend: "save it in one part (in Gmsh: `gmsh in.msh -save -part 0 -format msh41 -o out.msh`)",
                }
                .at(reader.cursor.here()));
            }
            other => skip_section(&mut reader.cursor, other)?,
        }
    }
    Ok(())
}

/// One number after another, as words or as bytes.
struct Reader<'a> {
    cursor: Cursor<'a>,
    binary: bool,
    word: usize,
}

impl Reader<'_> {
    fn int(&mut self, expected: &'static str) -> Result<i32, ParseError> {
        if self.binary { self.cursor.binary_i32(expected) } else { self.cursor.number(expected) }
    }

    fn double(&mut self, expected: &'static str) -> Result<f64, ParseError> {
        if self.binary { self.cursor.binary_f64(expected) } else { self.cursor.number(expected) }
    }

    fn size(&mut self, expected: &'static str) -> Result<u64, ParseError> {
        match (self.binary, self.word) {
            (false, _) => self.cursor.number(expected),
            (true, 4) => Ok(self.cursor.binary_i32(expected)? as u32 as u64),
            (true, _) => self.cursor.binary_u64(expected),
        }
    }

    fn count(&mut self, what: &'static str, smallest_text: usize, smallest_binary: usize) -> Result<usize, ParseError> {
        let count = self.size(what)?;
        self.cursor.bounded(count, if self.binary { smallest_binary } else { smallest_text }, what)
    }

    fn place(&self) -> Place {
        self.cursor.here()
    }

    /// Binary data starts right behind the line with the section's name.
    fn open(&mut self) {
        if self.binary {
            self.cursor.line();
        }
    }
}

fn read_entities(reader: &mut Reader, entities: &mut Entities, assembly: &mut Assembly) -> Result<(), ParseError> {
    reader.open();
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = reader.count("entities", 8, 32)?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = reader.int("the tag of an entity")?;
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                reader.double("the extent of an entity")?;
            }
            let mut groups: Vec<Group> = Vec::new();
            for _ in 0..reader.count("physical groups of an entity", 2, 4)? {
                groups.push((dimension as u8, reader.int("the tag of a physical group")?.unsigned_abs()));
            }
            if dimension > 0 {
                for _ in 0..reader.count("bounding entities", 2, 4)? {
                    reader.int("the tag of a bounding entity")?;
                }
            }
            entities.insert((dimension as u8, tag), assembly.set(groups));
        }
    }
    reader.cursor.keyword("$EndEntities")
}

fn read_nodes(reader: &mut Reader, nodes: &mut NodeNumbers, assembly: &mut Assembly) -> Result<(), ParseError> {
    reader.open();
    let blocks = reader.count("blocks of nodes", 8, 20)?;
    let total = reader.count("nodes", 8, 32)?;
    reader.size("the smallest number of a node")?;
    reader.size("the largest number of a node")?;
    let mut numbers = Vec::new();
    for _ in 0..blocks {
        reader.int("the dimension of an entity")?;
        reader.int("the tag of an entity")?;
        match reader.int("0 or 1 for parametric nodes")? {
            0 => {}
            1 => return Err(parametric(&reader.cursor)),
            other => return Err(reader.cursor.unexpected("0 or 1 for parametric nodes", &other.to_string())),
        }
        let count = reader.count("nodes of a block", 8, 32)?;
        numbers.clear();
        for _ in 0..count {
            numbers.push(reader.size("the number of a node")?);
        }
        for &number in &numbers {
            read_position(reader, number, nodes, assembly)?;
        }
    }
    if assembly.nodes.len() != total {
        let (expected, found) = (total as u64, assembly.nodes.len() as u64);
        return Err(Problem::Length { what: "nodes in all blocks", expected, found }.at(reader.place()));
    }
    reader.cursor.keyword("$EndNodes")
}

fn read_position(
    reader: &mut Reader,
    number: u64,
    nodes: &mut NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    let mut position = [0.0; 3];
    if reader.binary {
        let place = reader.place();
        for coordinate in &mut position {
            *coordinate = reader.cursor.binary_f64("a coordinate")?;
        }
        return nodes.add(assembly, number, position, || place);
    }
    let mut fields = reader.cursor.fields("the place of a node has 3: x, y and z")?;
    for coordinate in &mut position {
        *coordinate = fields.number("a coordinate")?;
    }
    nodes.add(assembly, number, position, || fields.place())?;
    fields.end()
}

fn read_cells(
    reader: &mut Reader,
    entities: &Entities,
    nodes: &NodeNumbers,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    reader.open();
    let blocks = reader.count("blocks of elements", 8, 20)?;
    let total = reader.count("elements", 4, 16)?;
    reader.size("the smallest number of an element")?;
    reader.size("the largest number of an element")?;
    let mut found = 0;
    let mut corners = Vec::new();
    for _ in 0..blocks {
        let before = reader.cursor.clone();
        let dimension = reader.int("the dimension of an entity")?;
        let tag = reader.int("the tag of an entity")?;
        let kind_number = i64::from(reader.int("the type of a block of elements")?);
        let Some((kind, size)) = CellKind::from_gmsh(kind_number) else {
            return Err(Problem::UnknownCell { number: kind_number }.at(before.here()));
        };
        let count = reader.count("elements of a block", 2 + 2 * size, reader.word * (1 + size))?;
        let set = u8::try_from(dimension).ok().and_then(|dimension| entities.get(&(dimension, tag)));
        for _ in 0..count {
            read_cell(reader, size, nodes, &mut corners)?;
            assembly.cell(kind, &corners, set.copied().unwrap_or(GroupSet::NONE));
        }
        found += count;
    }
    if found != total {
        let (expected, found) = (total as u64, found as u64);
        return Err(Problem::Length { what: "elements in all blocks", expected, found }.at(reader.place()));
    }
    reader.cursor.keyword("$EndElements")
}

fn read_cell(reader: &mut Reader, size: usize, nodes: &NodeNumbers, corners: &mut Vec<u32>) -> Result<(), ParseError> {
    corners.clear();
    if reader.binary {
        let place = reader.place();
        let cell = reader.size("the number of an element")?;
        for _ in 0..size {
            let node = reader.size("the number of a node")?;
            corners.push(nodes.find(cell, node as i64, || place)?);
        }
        return Ok(());
    }
    let mut fields = reader.cursor.fields("an element has its number and the nodes of its type")?;
    let cell = fields.number("the number of an element")?;
    for _ in 0..size {
        let node = fields.number("the number of a node")?;
        corners.push(nodes.find(cell, node, || fields.place())?);
    }
    fields.end()
}

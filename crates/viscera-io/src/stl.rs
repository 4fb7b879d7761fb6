//! STL surfaces, text and binary.
//!
//! Corners at exactly the same coordinates are one node. Normals are not read: the order of the corners says where
//! outside is. Binary files are told by their length, since some start with `solid` as text files do.
//!
//! Not read by way of the crate `stl_io`: its errors do not say where, and text is cut to single precision.

use std::collections::HashMap;

use crate::assembly::{Assembly, GroupSet};
use crate::cell_kind::Shape;
use crate::cursor::Cursor;
use crate::{Imported, Notice, ParseError, Place, Problem};

/// Bytes before the triangles: 80 of header, 4 of count.
const HEADER: usize = 84;
/// Bytes of a triangle: normal and three corners as f32, and two bytes of attributes.
const TRIANGLE: usize = 50;

/// Reads a STL file. Coordinates stay in the file's unit.
///
/// # Errors
/// [`ParseError`] with the line (text) or byte (binary) of the first thing that is wrong.
pub fn parse(bytes: &[u8]) -> Result<Imported, ParseError> {
    if !has_binary_length(bytes) && bytes.trim_ascii_start().starts_with(b"solid") {
        parse_text(bytes)
    } else {
        parse_binary(bytes)
    }
}

/// Whether the length is what the count at byte 80 makes of it.
pub(crate) fn has_binary_length(bytes: &[u8]) -> bool {
    bytes.get(80..HEADER).is_some_and(|count| {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        count > 0 && bytes.len() == HEADER + TRIANGLE * count
    })
}

/// Gathers triangles and merges their corners.
#[derive(Default)]
struct Soup {
    assembly: Assembly,
    node_at: HashMap<[u64; 3], u32>,
}

impl Soup {
    fn corner(&mut self, position: [f64; 3], place: impl FnOnce() -> Place) -> Result<u32, ParseError> {
        // Adding zero makes −0 and +0 the same place.
        let key = position.map(|coordinate| (coordinate + 0.0).to_bits());
        if let Some(&node) = self.node_at.get(&key) {
            return Ok(node);
        }
        let node = self.assembly.node(self.assembly.nodes.len() as u64, position, place)?;
        self.node_at.insert(key, node);
        Ok(node)
    }

    fn triangle(&mut self, corners: &[u32; 3]) {
        self.assembly.cell(Shape::Triangle.straight(), corners, GroupSet::NONE);
    }
}

fn parse_binary(bytes: &[u8]) -> Result<Imported, ParseError> {
    let mut cursor = Cursor::new(bytes);
    cursor.binary = true;
    let mut soup = Soup::default();
    cursor.take(80, "the header of a binary STL file, 80 bytes")?;
    let count = cursor.binary_i32("the number of triangles")? as u32;
    if cursor.rest().len() < TRIANGLE * count as usize {
        let bytes = cursor.rest().len();
        return Err(Problem::TooMany { what: "triangles", count: count.into(), bytes }.at(Place::Byte(80)));
    }
    for _ in 0..count {
        cursor.take(12, "the normal of a triangle")?;
        let mut corners = [0; 3];
        for corner in &mut corners {
            let place = cursor.here();
            let mut position = [0.0; 3];
            for coordinate in &mut position {
                *coordinate = cursor.binary_f32("a coordinate")?.into();
            }
            *corner = soup.corner(position, || place)?;
        }
        cursor.take(2, "the attributes of a triangle")?;
        soup.triangle(&corners);
    }
    if !cursor.rest().is_empty() {
        soup.assembly.notices.push(Notice::TrailingBytes { count: cursor.rest().len() });
    }
    soup.assembly.finish()
}

/// `solid … facet normal x y z outer loop vertex x y z (three times) endloop endfacet … endsolid`; several solids may follow.
fn parse_text(bytes: &[u8]) -> Result<Imported, ParseError> {
    let mut cursor = Cursor::new(bytes);
    let mut soup = Soup::default();
    loop {
        cursor.skip_blank();
        if cursor.rest().is_empty() {
            return soup.assembly.finish();
        }
        cursor.keyword("solid")?;
        cursor.line();
        loop {
            match cursor.word("facet or endsolid")? {
                "facet" => read_facet(&mut cursor, &mut soup)?,
                "endsolid" => break,
                other => return Err(cursor.unexpected("facet or endsolid", other)),
            }
        }
        cursor.line();
    }
}

fn read_facet(cursor: &mut Cursor, soup: &mut Soup) -> Result<(), ParseError> {
    cursor.keyword("normal")?;
    cursor.line();
    cursor.keyword("outer")?;
    cursor.keyword("loop")?;
    let mut corners = [0; 3];
    for corner in &mut corners {
        let mut fields = cursor.fields("a corner has 4: `vertex` and x, y and z")?;
        let word = fields.word()?;
        if word != "vertex" {
            return Err(Problem::Unexpected { expected: "vertex", found: crate::cursor::excerpt(word.as_bytes()) }
                .at(fields.place()));
        }
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            *coordinate = fields.number("a coordinate")?;
        }
        *corner = soup.corner(position, || fields.place())?;
        fields.end()?;
    }
    cursor.keyword("endloop")?;
    cursor.keyword("endfacet")?;
    soup.triangle(&corners);
    Ok(())
}

//! Wavefront OBJ surfaces: `v` and `f`. Texture, normals, materials and groups mean nothing to tissue.
//!
//! Source: Wavefront Advanced Visualizer manual, appendix B1. Faces may name nodes from the end (-1 is the last one) and
//! may have any number of corners; they are split into triangles from their first corner.
//!
//! Not read by way of the crate `tobj`: it lets NaN through, passes over statements that it does not know, cuts to single
//! precision, and its errors do not say where.

use std::collections::BTreeSet;

use crate::assembly::{Assembly, GroupSet};
use crate::cell_kind::Shape;
use crate::cursor::{Cursor, Fields};
use crate::{Imported, Notice, ParseError, Problem};

/// Statements that say how a surface looks or is called, not where it is.
const LOOKS: [&str; 10] = ["vt", "vn", "vp", "g", "o", "s", "mtllib", "usemtl", "lod", "mg"];

/// Reads an OBJ file. Coordinates stay in the file's unit.
///
/// # Errors
/// [`ParseError`] with the line of the first thing that is wrong.
pub fn parse(bytes: &[u8]) -> Result<Imported, ParseError> {
    let mut cursor = Cursor::new(bytes);
    let mut assembly = Assembly::default();
    let mut other = BTreeSet::new();
    let mut faces = 0;
    loop {
        cursor.skip_blank();
        if cursor.rest().is_empty() {
            break;
        }
        if cursor.rest().starts_with(b"#") {
            cursor.line();
            continue;
        }
        let mut fields = cursor.fields("a statement such as `v` or `f`")?;
        match fields.word()? {
            "v" => read_node(fields, &mut assembly)?,
            "f" => {
                faces += 1;
                read_face(fields, faces, &mut assembly)?;
            }
            "l" | "p" => assembly.cell(Shape::Edge.straight(), &[], GroupSet::NONE),
            statement if LOOKS.contains(&statement) => {}
            statement if statement.bytes().all(|byte| byte.is_ascii_alphabetic() || byte == b'_') => {
                other.insert(statement.to_owned());
            }
            statement => {
                let found = crate::cursor::excerpt(statement.as_bytes());
                return Err(
                    Problem::Unexpected { expected: "a statement such as `v` or `f`", found }.at(fields.place())
                );
            }
        }
    }
    if !other.is_empty() {
        assembly.notices.push(Notice::StatementsSkipped { names: other.into_iter().collect() });
    }
    assembly.finish()
}

/// `v x y z`, and perhaps a weight or a colour, which are not read.
fn read_node(mut fields: Fields, assembly: &mut Assembly) -> Result<(), ParseError> {
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        *coordinate = fields.number("a coordinate")?;
    }
    let number = assembly.nodes.len() as u64 + 1;
    assembly.node(number, position, || fields.place())?;
    let extra = fields.rest::<f64>("a weight or a colour")?;
    match extra.len() {
        0 | 1 | 3 | 4 => Ok(()),
        _ => Err(Problem::Columns {
            expected: "a node has x, y and z, and perhaps a weight and a colour",
            found: 4 + extra.len(),
        }
        .at(fields.place())),
    }
}

/// `f a b c …`, each corner `node`, `node/texture`, `node//normal` or `node/texture/normal`.
fn read_face(mut fields: Fields, face: u64, assembly: &mut Assembly) -> Result<(), ParseError> {
    let mut corners = Vec::new();
    while let Some(word) = fields.next_word() {
        let node = word.split('/').next().unwrap_or_default();
        let node: i64 = node.parse().map_err(|_| {
            let found = crate::cursor::excerpt(word.as_bytes());
            Problem::Unexpected { expected: "the number of a node", found }.at(fields.place())
        })?;
        let count = assembly.nodes.len() as i64;
        match node {
            1.. if node <= count => corners.push((node - 1) as u32),
            ..=-1 if node >= -count => corners.push((count + node) as u32),
            _ => return Err(Problem::MissingNode { cell: face, node }.at(fields.place())),
        }
    }
    if corners.len() < 3 {
        let kind = Shape::Polygon.straight();
        return Err(Problem::Corners { cell: face, kind, found: corners.len() }.at(fields.place()));
    }
    assembly.cell(Shape::Polygon.straight(), &corners, GroupSet::NONE);
    Ok(())
}

//! VTK's XML files: unstructured grids (.vtu) and polygonal surfaces (.vtp).
//!
//! Source: VTK User's Guide, "XML file formats". Data may be text, base64 or appended (raw, base64), either byte order, and
//! compressed with zlib. Several pieces are put behind each other. Values at points and cells are named in the notices.

mod data;

use roxmltree::{Document, Node};

use crate::assembly::Assembly;
use crate::{Imported, Notice, ParseError, Place, Problem, vtk_cells};
use data::Storage;

/// Elements that hold cells, and the VTK type of all of them where they do not say it themselves.
const CELL_LISTS: [(&str, Option<i64>); 5] =
    [("Cells", None), ("Verts", Some(2)), ("Lines", Some(4)), ("Strips", Some(6)), ("Polys", Some(7))];

/// Reads a .vtu or .vtp file. Coordinates stay in the file's unit.
///
/// # Errors
/// [`ParseError`] with the line of the element in which the first wrong thing stands.
pub fn parse(bytes: &[u8]) -> Result<Imported, ParseError> {
    let (text, appended) = data::split_appended(bytes)?;
    let document = Document::parse(&text)
        .map_err(|error| Problem::Xml { detail: error.to_string() }.at(Place::Line(error.pos().row as usize)))?;
    let reader = Reader { document: &document, storage: Storage::new(document.root_element(), appended, bytes.len()) };
    reader.read()
}

struct Reader<'a> {
    document: &'a Document<'a>,
    storage: Result<Storage<'a>, Problem>,
}

impl<'a> Reader<'a> {
    fn read(self) -> Result<Imported, ParseError> {
        let root = self.document.root_element();
        let Self { document, storage } = self;
        let mut storage = storage.map_err(|problem| problem.at(line_of(document, root)))?;
        let grid = root.children().find(|node| matches!(node.tag_name().name(), "UnstructuredGrid" | "PolyData"));
        let Some(grid) = grid else {
            let what = format!("a VTK file of kind `{}`", root.attribute("type").unwrap_or("none"));
            let mend = "write an UnstructuredGrid or PolyData in one file (ParaView: save as .vtu or .vtp)";
            return Err(Problem::Unsupported { what, mend }.at(line_of(document, root)));
        };
        let mut assembly = Assembly::default();
        let mut skipped = Vec::new();
        for piece in grid.children().filter(|node| node.has_tag_name("Piece")) {
            read_piece(document, &mut storage, piece, &mut assembly)?;
            for data in piece.children().filter(|node| matches!(node.tag_name().name(), "PointData" | "CellData")) {
                skipped.extend(data.children().filter_map(|array| array.attribute("Name")).map(str::to_owned));
            }
        }
        if !skipped.is_empty() {
            skipped.sort();
            skipped.dedup();
            assembly.notices.push(Notice::DataSkipped { names: skipped });
        }
        assembly.finish()
    }
}

/// Puts a problem at the line of an element.
fn at_node(document: &Document, start: usize) -> impl FnOnce(Problem) -> ParseError {
    move |problem| problem.at(Place::Line(document.text_pos_at(start).row as usize))
}

fn line_of(document: &Document, node: Node) -> Place {
    Place::Line(document.text_pos_at(node.range().start).row as usize)
}

fn read_piece(
    document: &Document,
    storage: &mut Storage,
    piece: Node,
    assembly: &mut Assembly,
) -> Result<(), ParseError> {
    let first_node = assembly.nodes.len() as i64;
    let here = |node: Node| at_node(document, node.range().start);
    let points = count(piece, "NumberOfPoints").map_err(here(piece))?;
    if let Some(array) = child(piece, "Points").and_then(|points| child(points, "DataArray")) {
        let coordinates = storage.reals(array).map_err(here(array))?;
        if points.checked_mul(3) != Some(coordinates.len() as u64) {
            let (expected, found) = (points.saturating_mul(3), coordinates.len() as u64);
            return Err(here(array)(Problem::Length { what: "coordinates of points", expected, found }));
        }
        for xyz in coordinates.chunks_exact(3) {
            let number = assembly.nodes.len() as u64;
            assembly.node(number, [xyz[0], xyz[1], xyz[2]], || line_of(document, array))?;
        }
    } else if points > 0 {
        return Err(here(piece)(Problem::Length { what: "coordinates of points", expected: points, found: 0 }));
    }
    for (name, common_type) in CELL_LISTS {
        let Some(list) = child(piece, name) else { continue };
        let arrays = ["connectivity", "offsets", "types"]
            .map(|name| list.children().find(|array| array.attribute("Name") == Some(name)));
        let [Some(connectivity), Some(offsets), types] = arrays else { continue };
        let mut nodes = storage.integers(connectivity).map_err(here(connectivity))?;
        let offsets = storage.integers(offsets).map_err(here(offsets))?;
        let types = match (common_type, types) {
            (Some(cell_type), _) => vec![cell_type; offsets.len()],
            (None, Some(types)) => storage.integers(types).map_err(here(types))?,
            (None, None) => Vec::new(),
        };
        let (expected, found) = (count(piece, &format!("NumberOf{name}")).map_err(here(piece))?, types.len() as u64);
        if expected != found {
            return Err(here(list)(Problem::Length { what: "cells of a piece", expected, found }));
        }
        // A piece counts its nodes from 0; a negative number must stay one that no node has.
        for node in nodes.iter_mut().filter(|node| **node >= 0) {
            *node = node.saturating_add(first_node);
        }
        vtk_cells::add_all(assembly, &nodes, &offsets, &types, Place::File)
            .map_err(|ParseError { problem, .. }| here(list)(problem))?;
    }
    Ok(())
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// A count among the attributes; 0 where it is absent.
fn count(node: Node, name: &str) -> Result<u64, Problem> {
    let found = node.attribute(name).unwrap_or("0").trim();
    let expected = "a number of points or cells of a piece";
    found.parse().map_err(|_| Problem::Unexpected { expected, found: crate::cursor::excerpt(found.as_bytes()) })
}

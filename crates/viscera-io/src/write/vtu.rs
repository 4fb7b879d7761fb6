use std::io::{self, Write};
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use viscera::mesh::{HexMesh, Point, SurfaceMesh, TetMesh, VolumeMesh};

use super::field::{Field, Values};
use super::{WriteError, write_atomically};

/// What a VTU file holds: a mesh at one moment, and values at its nodes and cells.
#[derive(Clone, Debug)]
pub struct Grid<'a> {
    /// Positions of the nodes [m]: the rest shape or the current one.
    pub positions: &'a [Point],
    /// Cells.
    pub cells: Cells<'a>,
    /// Values at the nodes.
    pub point_data: Vec<Field<'a>>,
    /// Values at the cells.
    pub cell_data: Vec<Field<'a>>,
}

/// Cells of one kind.
#[derive(Clone, Copy, Debug)]
pub enum Cells<'a> {
    /// Tetrahedra.
    Tet(&'a [[u32; 4]]),
    /// Hexahedra.
    Hex(&'a [[u32; 8]]),
    /// Triangles.
    Triangle(&'a [[u32; 3]]),
}

/// How the numbers stand in the file. ParaView reads both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Raw bytes behind the XML: smallest and fastest, but not proper XML.
    #[default]
    Raw,
    /// Base64 in the XML: a third larger, readable by every XML program.
    Base64,
}

impl<'a> From<&'a TetMesh> for Grid<'a> {
    fn from(mesh: &'a TetMesh) -> Self {
        Self::new(&mesh.nodes, Cells::Tet(&mesh.cells))
    }
}

impl<'a> From<&'a HexMesh> for Grid<'a> {
    fn from(mesh: &'a HexMesh) -> Self {
        Self::new(&mesh.nodes, Cells::Hex(&mesh.cells))
    }
}

impl<'a> From<&'a SurfaceMesh> for Grid<'a> {
    fn from(mesh: &'a SurfaceMesh) -> Self {
        Self::new(&mesh.nodes, Cells::Triangle(&mesh.triangles))
    }
}

impl<'a> From<&'a VolumeMesh> for Grid<'a> {
    fn from(mesh: &'a VolumeMesh) -> Self {
        match mesh {
            VolumeMesh::Tet(mesh) => mesh.into(),
            VolumeMesh::Hex(mesh) => mesh.into(),
        }
    }
}

impl<'a> Grid<'a> {
    /// A grid without values.
    pub fn new(positions: &'a [Point], cells: Cells<'a>) -> Self {
        Self { positions, cells, point_data: Vec::new(), cell_data: Vec::new() }
    }

    /// The same cells at other positions [m].
    pub fn at(mut self, positions: &'a [Point]) -> Self {
        self.positions = positions;
        self
    }

    /// Adds values at the nodes.
    pub fn with_point_data(mut self, field: Field<'a>) -> Self {
        self.point_data.push(field);
        self
    }

    /// Adds values at the cells.
    pub fn with_cell_data(mut self, field: Field<'a>) -> Self {
        self.cell_data.push(field);
        self
    }

    fn check(&self) -> Result<(), WriteError> {
        let nodes = self.positions.len();
        for cell in 0..self.cells.len() {
            if let Some(&node) = self.cells.corners(cell).iter().find(|&&node| node as usize >= nodes) {
                return Err(WriteError::MissingNode { cell, node, nodes });
            }
        }
        let at_nodes = self.point_data.iter().map(|field| (field, "nodes", nodes));
        let at_cells = self.cell_data.iter().map(|field| (field, "cells", self.cells.len()));
        for (field, what, places) in at_nodes.chain(at_cells) {
            let Field { name, components, ref values } = *field;
            let (expected, found) = (places * components, values.len());
            if found != expected {
                return Err(WriteError::FieldLength {
                    field: name.to_owned(),
                    what,
                    places,
                    components,
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }
}

impl Cells<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Tet(cells) => cells.len(),
            Self::Hex(cells) => cells.len(),
            Self::Triangle(cells) => cells.len(),
        }
    }

    fn corners(&self, cell: usize) -> &[u32] {
        match self {
            Self::Tet(cells) => &cells[cell],
            Self::Hex(cells) => &cells[cell],
            Self::Triangle(cells) => &cells[cell],
        }
    }

    fn vtk_type(&self) -> u8 {
        match self {
            Self::Tet(_) => 10,
            Self::Hex(_) => 12,
            Self::Triangle(_) => 5,
        }
    }
}

/// Writes a grid as an unstructured grid of VTK (.vtu), which ParaView opens.
///
/// # Errors
/// [`WriteError`]: a field of the wrong length, a cell with a missing node, or a file that cannot be written.
pub fn write_vtu(path: impl AsRef<Path>, grid: &Grid, encoding: Encoding) -> Result<(), WriteError> {
    grid.check()?;
    write_atomically(path, |out| write_document(out, grid, encoding))
}

/// The same bytes in memory.
///
/// # Errors
/// [`WriteError`]: a field of the wrong length, or a cell with a missing node.
pub fn vtu_bytes(grid: &Grid, encoding: Encoding) -> Result<Vec<u8>, WriteError> {
    grid.check()?;
    let mut bytes = Vec::new();
    write_document(&mut bytes, grid, encoding)
        .map_err(|source| WriteError::Unwritable { path: "memory".into(), source })?;
    Ok(bytes)
}

fn write_document(out: &mut impl Write, grid: &Grid, encoding: Encoding) -> io::Result<()> {
    let count = grid.cells.len();
    let corners = (0..count).flat_map(|cell| grid.cells.corners(cell)).flat_map(|&node| i64::from(node).to_le_bytes());
    let per_cell = if count == 0 { 0 } else { grid.cells.corners(0).len() as i64 };
    let offsets = (1..=count as i64).flat_map(|cell| (cell * per_cell).to_le_bytes());
    let mut arrays = Arrays { encoding, offset: 0, appended: Vec::new() };

    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    writeln!(out, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{count}\">", grid.positions.len())?;
    writeln!(out, "<Points>")?;
    arrays.write_field(out, &Field::vector("Points", grid.positions))?;
    writeln!(out, "</Points>\n<Cells>")?;
    arrays.write(out, "connectivity", "Int64", 1, corners.collect())?;
    arrays.write(out, "offsets", "Int64", 1, offsets.collect())?;
    arrays.write(out, "types", "UInt8", 1, vec![grid.cells.vtk_type(); count])?;
    writeln!(out, "</Cells>\n<PointData>")?;
    grid.point_data.iter().try_for_each(|field| arrays.write_field(out, field))?;
    writeln!(out, "</PointData>\n<CellData>")?;
    grid.cell_data.iter().try_for_each(|field| arrays.write_field(out, field))?;
    writeln!(out, "</CellData>\n</Piece>\n</UnstructuredGrid>")?;
    if encoding == Encoding::Raw {
        write!(out, "<AppendedData encoding=\"raw\">_")?;
        for bytes in &arrays.appended {
            out.write_all(&(bytes.len() as u64).to_le_bytes())?;
            out.write_all(bytes)?;
        }
        writeln!(out, "\n</AppendedData>")?;
    }
    writeln!(out, "</VTKFile>")
}

/// Writes data arrays, or notes where their bytes will follow.
struct Arrays {
    encoding: Encoding,
    offset: usize,
    appended: Vec<Vec<u8>>,
}

impl Arrays {
    fn write_field(&mut self, out: &mut impl Write, field: &Field) -> io::Result<()> {
        let Field { name, components, values } = field;
        self.write(out, name, values.type_name(), *components, Values::bytes(values))
    }

    fn write(
        &mut self,
        out: &mut impl Write,
        name: &str,
        type_name: &str,
        components: usize,
        bytes: Vec<u8>,
    ) -> io::Result<()> {
        let name = escaped(name);
        write!(out, "<DataArray type=\"{type_name}\" Name=\"{name}\" NumberOfComponents=\"{components}\"")?;
        match self.encoding {
            Encoding::Raw => {
                writeln!(out, " format=\"appended\" offset=\"{}\"/>", self.offset)?;
                self.offset += 8 + bytes.len();
                self.appended.push(bytes);
            }
            Encoding::Base64 => {
                let sized: Vec<u8> = (bytes.len() as u64).to_le_bytes().into_iter().chain(bytes).collect();
                writeln!(out, " format=\"binary\">{}</DataArray>", STANDARD.encode(sized))?;
            }
        }
        Ok(())
    }
}

/// A name as the value of an XML attribute.
pub(super) fn escaped(name: &str) -> String {
    let mut text = String::new();
    for character in name.chars() {
        match character {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            other if other.is_control() => text.push(' '),
            other => text.push(other),
        }
    }
    text
}

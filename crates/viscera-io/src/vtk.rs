//! Legacy VTK files (`# vtk DataFile`), versions 1 to 5.1, text and binary: unstructured grids and polygonal surfaces.
//!
//! Source: VTK User's Guide, "VTK file formats", and for 5.x the VTK 9 release notes (offsets and connectivity apart).
//! Binary data is big-endian. Values at points and cells are named in the notices and not read.

use crate::assembly::Assembly;
use crate::cursor::Cursor;
use crate::{Imported, Notice, ParseError, Problem, vtk_cells};

/// Reads a legacy VTK file. Coordinates stay in the file's unit.
///
/// # Errors
/// [`ParseError`] with the line (text) or byte (binary) of the first thing that is wrong.
pub fn parse(bytes: &[u8]) -> Result<Imported, ParseError> {
    let mut file = File { cursor: Cursor::new(bytes), binary: false, split: false };
    file.cursor.big_endian = true;
    file.read_header()?;
    let mut grid = Grid::default();
    loop {
        file.cursor.skip_blank();
        if file.cursor.rest().is_empty() {
            break;
        }
        match file.cursor.word("a section")? {
            "POINTS" => file.read_points(&mut grid.assembly)?,
            "CELLS" => grid.cells = file.read_cells()?,
            "CELL_TYPES" => grid.types = file.read_types()?,
            "VERTICES" => file.read_polygons(&mut grid, 2)?,
            "LINES" => file.read_polygons(&mut grid, 4)?,
            "POLYGONS" => file.read_polygons(&mut grid, 7)?,
            "TRIANGLE_STRIPS" => file.read_polygons(&mut grid, 6)?,
            "FIELD" => file.skip_field()?,
            "METADATA" => file.skip_metadata(),
            "POINT_DATA" | "CELL_DATA" => {
                grid.assembly.notices.push(Notice::DataSkipped { names: names_of_data(file.cursor.rest()) });
                break;
            }
            other => return Err(file.cursor.unexpected("a section such as POINTS or CELLS", other)),
        }
    }
    let Cells { connectivity, offsets } = &grid.cells;
    vtk_cells::add_all(&mut grid.assembly, connectivity, offsets, &grid.types, file.cursor.here())?;
    grid.assembly.finish()
}

#[derive(Default)]
struct Grid {
    assembly: Assembly,
    cells: Cells,
    types: Vec<i64>,
}

/// Nodes of all cells behind each other, and where each cell ends.
#[derive(Default)]
struct Cells {
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
}

struct File<'a> {
    cursor: Cursor<'a>,
    binary: bool,
    /// Version 5: offsets and connectivity are two arrays.
    split: bool,
}

impl File<'_> {
    fn read_header(&mut self) -> Result<(), ParseError> {
        let first = String::from_utf8_lossy(self.cursor.line());
        let Some(version) = first.strip_prefix("# vtk DataFile Version ") else {
            return Err(self.cursor.unexpected("`# vtk DataFile Version …`", &first));
        };
        self.split = version.trim().starts_with('5');
        self.cursor.line();
        self.binary = match self.cursor.word("ASCII or BINARY")? {
            "ASCII" => false,
            "BINARY" => true,
            other => return Err(self.cursor.unexpected("ASCII or BINARY", other)),
        };
        self.cursor.binary = self.binary;
        self.cursor.keyword("DATASET")?;
        match self.cursor.word("the kind of data set")? {
            "UNSTRUCTURED_GRID" | "POLYDATA" => Ok(()),
            other => Err(Problem::Unsupported {
                what: format!("a VTK data set of kind `{}`", crate::cursor::excerpt(other.as_bytes())),
                mend: "write an UNSTRUCTURED_GRID or POLYDATA (ParaView: filter Append Datasets or Extract Surface)",
            }
            .at(self.cursor.here())),
        }
    }

    fn count(&mut self, what: &'static str) -> Result<u64, ParseError> {
        self.cursor.number(what)
    }

    /// A number as text, or as bytes of one of VTK's types.
    fn integer(&mut self, wide: bool, expected: &'static str) -> Result<i64, ParseError> {
        match (self.binary, wide) {
            (false, _) => self.cursor.number(expected),
            (true, false) => self.cursor.binary_i32(expected).map(i64::from),
            (true, true) => self.cursor.binary_i64(expected),
        }
    }

    fn real(&mut self, double: bool) -> Result<f64, ParseError> {
        match (self.binary, double) {
            (false, _) => self.cursor.number("a coordinate"),
            (true, false) => self.cursor.binary_f32("a coordinate").map(f64::from),
            (true, true) => self.cursor.binary_f64("a coordinate"),
        }
    }

    fn read_points(&mut self, assembly: &mut Assembly) -> Result<(), ParseError> {
        let count = self.count("the number of points")?;
        let double = match self.cursor.word("float or double")? {
            "double" => true,
            "float" => false,
            other => return Err(self.cursor.unexpected("points as float or double", other)),
        };
        self.cursor.line();
        let smallest = if self.binary { if double { 24 } else { 12 } } else { 6 };
        let count = self.cursor.bounded(count, smallest, "points")?;
        for number in 0..count as u64 {
            let before = self.cursor.clone();
            let position = [self.real(double)?, self.real(double)?, self.real(double)?];
            assembly.node(number, position, || before.here())?;
        }
        Ok(())
    }

    /// Cells of either version: (number of nodes, nodes) for each, or all ends and then all nodes.
    fn read_cells(&mut self) -> Result<Cells, ParseError> {
        let count = self.count("the number of cells")?;
        let size = self.count("the size of the list of cells")?;
        self.cursor.line();
        if self.split { self.read_split_cells(count, size) } else { self.read_joined_cells(count, size) }
    }

    fn read_joined_cells(&mut self, count: u64, size: u64) -> Result<Cells, ParseError> {
        let smallest = if self.binary { 4 } else { 2 };
        let count = self.cursor.bounded(count, smallest, "cells")?;
        let size = self.cursor.bounded(size, smallest, "numbers in the list of cells")?;
        let mut cells = Cells::default();
        for _ in 0..count {
            let nodes = self.integer(false, "the number of nodes of a cell")?;
            let left = size.saturating_sub(cells.connectivity.len() + cells.offsets.len() + 1);
            if !usize::try_from(nodes).is_ok_and(|nodes| nodes <= left) {
                let (expected, found) = (nodes.max(0) as u64, left as u64);
                return Err(Problem::Length { what: "nodes of a cell", expected, found }.at(self.cursor.here()));
            }
            for _ in 0..nodes {
                cells.connectivity.push(self.integer(false, "a node of a cell")?);
            }
            cells.offsets.push(cells.connectivity.len() as i64);
        }
        Ok(cells)
    }

    fn read_split_cells(&mut self, offsets: u64, size: u64) -> Result<Cells, ParseError> {
        let mut lists = [Vec::new(), Vec::new()];
        for (list, (keyword, count)) in lists.iter_mut().zip([("OFFSETS", offsets), ("CONNECTIVITY", size)]) {
            self.cursor.keyword(keyword)?;
            let wide = match self.cursor.word("vtktypeint64 or vtktypeint32")? {
                "vtktypeint64" => true,
                "vtktypeint32" => false,
                other => return Err(self.cursor.unexpected("vtktypeint64 or vtktypeint32", other)),
            };
            self.cursor.line();
            let smallest = if self.binary { if wide { 8 } else { 4 } } else { 2 };
            for _ in 0..self.cursor.bounded(count, smallest, "numbers in the list of cells")? {
                list.push(self.integer(wide, "a node or offset of a cell")?);
            }
        }
        let [mut offsets, connectivity] = lists;
        if !offsets.is_empty() && offsets.remove(0) != 0 {
            return Err(self.cursor.unexpected("cells whose first offset is 0", "another number"));
        }
        Ok(Cells { connectivity, offsets })
    }

    fn read_types(&mut self) -> Result<Vec<i64>, ParseError> {
        let count = self.count("the number of cell types")?;
        self.cursor.line();
        let count = self.cursor.bounded(count, if self.binary { 4 } else { 2 }, "cell types")?;
        (0..count).map(|_| self.integer(false, "a cell type")).collect()
    }

    /// A list of cells that all have one type.
    fn read_polygons(&mut self, grid: &mut Grid, cell_type: i64) -> Result<(), ParseError> {
        let place = self.cursor.here();
        let cells = self.read_cells()?;
        let types = vec![cell_type; cells.offsets.len()];
        vtk_cells::add_all(&mut grid.assembly, &cells.connectivity, &cells.offsets, &types, place)
    }

    /// `FIELD name n`, then n arrays: name, components, tuples, type, values. Writers put time and cycle there.
    fn skip_field(&mut self) -> Result<(), ParseError> {
        self.cursor.word("the name of a field")?;
        let arrays = self.count("the number of arrays")?;
        for _ in 0..self.cursor.bounded(arrays, 8, "arrays")? {
            self.cursor.word("the name of an array")?;
            let components = self.count("the number of components")?;
            let tuples = self.count("the number of tuples")?;
            let kind = self.cursor.word("the type of an array")?;
            let Some(width) = width_of(kind) else {
                return Err(self.cursor.unexpected("the type of an array, such as double", kind));
            };
            self.cursor.line();
            let values = components.saturating_mul(tuples);
            let values = self.cursor.bounded(values, if self.binary { width } else { 2 }, "values")?;
            if self.binary {
                self.cursor.take(values * width, "the values of an array")?;
            } else {
                (0..values).try_for_each(|_| self.cursor.word("a value").map(drop))?;
            }
        }
        Ok(())
    }

    /// `METADATA` and what follows, up to a blank line.
    fn skip_metadata(&mut self) {
        self.cursor.line();
        while !self.cursor.line().trim_ascii().is_empty() {}
    }
}

/// Bytes of a number of one of VTK's types.
fn width_of(kind: &str) -> Option<usize> {
    match kind {
        "char" | "unsigned_char" | "signed_char" => Some(1),
        "short" | "unsigned_short" => Some(2),
        "int" | "unsigned_int" | "float" => Some(4),
        "long" | "unsigned_long" | "double" | "vtktypeint64" | "vtktypeuint64" | "vtkIdType" => Some(8),
        _ => None,
    }
}

/// Names of the arrays that follow, as far as they stand in plain words.
fn names_of_data(bytes: &[u8]) -> Vec<String> {
    let mut names = Vec::new();
    for line in bytes.split(|&byte| byte == b'\n') {
        let Ok(line) = std::str::from_utf8(line) else { continue };
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["SCALARS" | "VECTORS" | "TENSORS" | "NORMALS", name, ..] => names.push(name.to_owned()),
            // An array of a FIELD.
            [name, components, tuples, kind] if width_of(kind).is_some() => {
                let counts = [components, tuples].map(str::parse::<u64>);
                names.extend(counts.iter().all(Result::is_ok).then(|| name.to_owned()));
            }
            _ => {}
        }
    }
    names
}

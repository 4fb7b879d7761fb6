use std::fmt;
use std::path::PathBuf;

use viscera::mesh::MeshError;

use crate::{CellKind, grouped};

/// Why a mesh file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// There is no file of this name.
    #[error("{}: there is no such file; check the name, and the folder that it is relative to", path.display())]
    NoSuchFile {
        /// The file asked for.
        path: PathBuf,
    },
    /// The file is there, but the system does not give it.
    #[error("{}: the file cannot be read: {source}", path.display())]
    Unreadable {
        /// The file asked for.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Neither content nor extension tells what the file is.
    #[error(
        "{}: the format is not known (the file starts with `{start}`); Viscera reads Gmsh (.msh 1, 2.2, 4.1), VTK (.vtk, .vtu), STL and OBJ",
        path.display()
    )]
    UnknownFormat {
        /// The file asked for.
        path: PathBuf,
        /// How it starts.
        start: String,
    },
    /// The content is wrong.
    #[error("{}, {source}", path.display())]
    Content {
        /// The file asked for.
        path: PathBuf,
        /// What is wrong, and where.
        source: ParseError,
    },
    /// A body needs a volume, and the file has only its skin.
    #[error(
        "{}: this file holds {} triangles and no volume; run `viscera mesh tetrahedralize` to fill it with tetrahedra",
        path.display(), grouped(*triangles)
    )]
    SurfaceOnly {
        /// The file asked for.
        path: PathBuf,
        /// How many triangles it holds.
        triangles: usize,
    },
    /// The file was read, but what it holds cannot be simulated.
    #[error("{}: {source}", path.display())]
    Mesh {
        /// The file asked for.
        path: PathBuf,
        /// What is wrong with the mesh.
        source: MeshError,
    },
    /// The length of the file's unit is not a positive number.
    #[error("a scale of {scale} makes no mesh; give the length of the file's unit in metres, such as 0.001 for mm")]
    Scale {
        /// The scale that was given.
        scale: f64,
    },
}

/// What is wrong with the content of a file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct ParseError {
    /// Where.
    pub place: Place,
    /// What.
    pub problem: Problem,
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of text, from 1.
    Line(usize),
    /// A byte of binary data, from 0.
    Byte(usize),
    /// The file as a whole.
    File,
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Line(line) => write!(out, "line {line}"),
            Self::Byte(byte) => write!(out, "byte {byte}"),
            Self::File => write!(out, "as a whole"),
        }
    }
}

/// What can be wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The file ends too early.
    #[error("the file ends where {expected} should stand; it was cut off: copy or export it again")]
    Truncated {
        /// What should follow.
        expected: &'static str,
    },
    /// A count is larger than the rest of the file could hold.
    #[error(
        "{count} {what} are promised, but only {bytes} bytes follow; the count is damaged or the file was cut off: export it again"
    )]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// How many are promised.
        count: u64,
        /// How many bytes are left.
        bytes: usize,
    },
    /// Something else stands here.
    #[error("expected {expected}, found `{found}`; correct it or export the file again")]
    Unexpected {
        /// What should stand here.
        expected: &'static str,
        /// What does.
        found: String,
    },
    /// The line has too few or too many columns.
    #[error("this line has {found} columns, but {expected}; correct it or export the file again")]
    Columns {
        /// What a line of this kind holds.
        expected: &'static str,
        /// How many columns it has.
        found: usize,
    },
    /// A list is shorter or longer than another part of the file says.
    #[error("{what}: {expected} are needed, {found} are there; the file contradicts itself: export it again")]
    Length {
        /// Which list.
        what: &'static str,
        /// How many there should be.
        expected: u64,
        /// How many there are.
        found: u64,
    },
    /// A coordinate is NaN or infinite.
    #[error("node {node} lies at ({}, {}, {}), which is not a finite place; repair the program that wrote the file", position[0], position[1], position[2])]
    NotFinite {
        /// The node, by the file's own number.
        node: u64,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A cell names a node that is not in the file.
    #[error("cell {cell} names node {node}, which the file does not have; nodes were lost: export it again")]
    MissingNode {
        /// The cell, by the file's own number.
        cell: u64,
        /// The node, by the file's own number.
        node: i64,
    },
    /// Two nodes have one number.
    #[error("node {node} is defined twice; renumber the nodes or export the file again")]
    NodeTwice {
        /// The node, by the file's own number.
        node: u64,
    },
    /// A cell has another number of corners than its kind.
    #[error("cell {cell} is one of the {kind}, but lists {found} corners; export the file again")]
    Corners {
        /// The cell, by the file's own number.
        cell: u64,
        /// What it says it is.
        kind: CellKind,
        /// How many corners it lists.
        found: usize,
    },
    /// The format knows no cell of this type.
    #[error("cell type {number} is not known; export the file with tetrahedra or hexahedra of first order")]
    UnknownCell {
        /// The type's number.
        number: i64,
    },
    /// A part of the format that is not read.
    #[error("{what} cannot be read; {mend}")]
    Unsupported {
        /// What it is.
        what: String,
        /// What to do.
        mend: &'static str,
    },
    /// Tetrahedra and hexahedra in one file.
    #[error(
        "the file mixes {} tetrahedra and {} hexahedra, and a body is made of one kind; export them as two files or mesh with one kind",
        grouped(*tetrahedra), grouped(*hexahedra)
    )]
    MixedCells {
        /// How many tetrahedra.
        tetrahedra: usize,
        /// How many hexahedra.
        hexahedra: usize,
    },
    /// There is nothing in the file that a body or a surface is made of.
    #[error(
        "there are no tetrahedra, hexahedra or triangles of first order in the file ({held}); export the volume, with first-order cells"
    )]
    NoCells {
        /// What there is instead.
        held: String,
    },
    /// More nodes or cells than numbers of 32 bits can name.
    #[error("more than 4 294 967 295 {what}; cut the mesh into parts")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
    },
    /// The XML around the data is malformed.
    #[error("the XML is malformed ({detail}); export the file again")]
    Xml {
        /// What the XML reader says.
        detail: String,
    },
    /// Encoded or compressed data cannot be unpacked.
    #[error("the {encoding} data cannot be unpacked ({detail}); export the file again, or as plain text")]
    Damaged {
        /// base64 or zlib.
        encoding: &'static str,
        /// What the decoder says.
        detail: String,
    },
}

impl Problem {
    /// The problem at its place.
    pub(crate) fn at(self, place: Place) -> ParseError {
        ParseError { place, problem: self }
    }
}

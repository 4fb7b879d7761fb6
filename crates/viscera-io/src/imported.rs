use std::fmt;

use viscera::mesh::{HexMesh, Point, SurfaceMesh, TetMesh};

use crate::CellKind;

/// What a file held.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The mesh.
    pub mesh: ImportedMesh,
    /// What of the file is not in the mesh, or is there in another form. A person should see these.
    pub notices: Vec<Notice>,
}

/// A mesh from a file: a volume of one kind of cell, or a skin.
#[derive(Clone, Debug, PartialEq)]
pub enum ImportedMesh {
    /// Tetrahedra.
    Tet(TetMesh),
    /// Hexahedra.
    Hex(HexMesh),
    /// Triangles, where the file holds no volume.
    Surface(SurfaceMesh),
}

impl ImportedMesh {
    /// Positions of all nodes [unit of the file, or m after scaling].
    pub fn nodes(&self) -> &[Point] {
        match self {
            Self::Tet(mesh) => &mesh.nodes,
            Self::Hex(mesh) => &mesh.nodes,
            Self::Surface(mesh) => &mesh.nodes,
        }
    }

    /// Multiplies every coordinate: from the file's unit to metres.
    pub fn scale(&mut self, metres_per_unit: f64) {
        let nodes = match self {
            Self::Tet(mesh) => &mut mesh.nodes,
            Self::Hex(mesh) => &mut mesh.nodes,
            Self::Surface(mesh) => &mut mesh.nodes,
        };
        for node in nodes {
            *node = *node * metres_per_unit;
        }
    }
}

/// Something in a file that is not in the mesh, or is there in another form.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// Cells that a mesh of this kind does not have.
    Skipped {
        /// Their kind.
        kind: CellKind,
        /// How many.
        count: usize,
        /// The mesh is a volume and they were parts of it: there are holes where they were.
        leaves_holes: bool,
    },
    /// Faces with more than three corners, made into triangles.
    Split {
        /// Their kind.
        kind: CellKind,
        /// How many.
        count: usize,
    },
    /// Triangles whose corners fall together, left out.
    Collapsed {
        /// How many.
        count: usize,
    },
    /// Values at nodes or cells, which a mesh does not carry.
    DataSkipped {
        /// Their names.
        names: Vec<String>,
    },
    /// Statements that are not understood.
    StatementsSkipped {
        /// Their first words.
        names: Vec<String>,
    },
    /// Groups of a file that holds only a surface, which has no regions.
    GroupsSkipped {
        /// Their names.
        names: Vec<String>,
    },
    /// A group that is named, but to which nothing belongs.
    EmptyGroup {
        /// Its name.
        name: String,
    },
    /// Bytes after the end of what the file announces.
    TrailingBytes {
        /// How many.
        count: usize,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Skipped { kind, count, leaves_holes: false } => {
                write!(out, "{} {kind} are not part of the mesh", grouped(*count))
            }
            Self::Skipped { kind, count, leaves_holes: true } => write!(
                out,
                "{} {kind} are left out, and the body has holes where they were; export it with one kind of first-order cell",
                grouped(*count)
            ),
            Self::Split { kind, count } => write!(out, "{} {kind} were split into triangles", grouped(*count)),
            Self::Collapsed { count } => {
                write!(out, "{} triangles have two corners at one place and are left out", grouped(*count))
            }
            Self::DataSkipped { names } => write!(out, "values at nodes and cells are not read: {}", names.join(", ")),
            Self::StatementsSkipped { names } => {
                write!(out, "statements not understood, and not read: {}", names.join(", "))
            }
            Self::GroupsSkipped { names } => {
                write!(out, "a surface has no regions; these groups are not kept: {}", names.join(", "))
            }
            Self::EmptyGroup { name } => write!(out, "the group `{name}` is named, but nothing belongs to it"),
            Self::TrailingBytes { count } => {
                write!(out, "{} bytes behind the end of the announced data are not read", grouped(*count))
            }
        }
    }
}

/// A count with its thousands set apart: 12 345.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

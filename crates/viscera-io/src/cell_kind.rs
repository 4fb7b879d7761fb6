use std::fmt;

/// The shape of a cell in a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// One node.
    Point,
    /// Two corners.
    Edge,
    /// Three corners.
    Triangle,
    /// Four corners in a surface.
    Quadrilateral,
    /// Any number of corners in a surface.
    Polygon,
    /// Four corners.
    Tetrahedron,
    /// Five corners.
    Pyramid,
    /// Six corners.
    Wedge,
    /// Eight corners.
    Hexahedron,
    /// Any other solid.
    Polyhedron,
}

/// A kind of cell in a mesh file: its shape, and whether it has nodes besides its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CellKind {
    /// Shape.
    pub shape: Shape,
    /// Second or higher order: nodes on edges, faces or inside.
    pub curved: bool,
}

impl fmt::Display for CellKind {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let shape = match self.shape {
            Shape::Point => "points",
            Shape::Edge => "edges",
            Shape::Triangle => "triangles",
            Shape::Quadrilateral => "quadrilaterals",
            Shape::Polygon => "polygons",
            Shape::Tetrahedron => "tetrahedra",
            Shape::Pyramid => "pyramids",
            Shape::Wedge => "wedges",
            Shape::Hexahedron => "hexahedra",
            Shape::Polyhedron => "polyhedra",
        };
        write!(out, "{}{shape}", if self.curved { "second- or higher-order " } else { "" })
    }
}

impl Shape {
    /// The kind with corners alone.
    pub(crate) fn straight(self) -> CellKind {
        CellKind { shape: self, curved: false }
    }

    fn curved(self) -> CellKind {
        CellKind { shape: self, curved: true }
    }

    /// 0 for a point, 1 for an edge, 2 for a face, 3 for a solid.
    pub(crate) fn dimension(self) -> u8 {
        match self {
            Self::Point => 0,
            Self::Edge => 1,
            Self::Triangle | Self::Quadrilateral | Self::Polygon => 2,
            _ => 3,
        }
    }
}

impl CellKind {
    /// Kind and number of nodes of an element type of Gmsh (reference manual, "MSH file format").
    pub(crate) fn from_gmsh(number: i64) -> Option<(Self, usize)> {
        use Shape::*;
        Some(match number {
            1 => (Edge.straight(), 2),
            2 => (Triangle.straight(), 3),
            3 => (Quadrilateral.straight(), 4),
            4 => (Tetrahedron.straight(), 4),
            5 => (Hexahedron.straight(), 8),
            6 => (Wedge.straight(), 6),
            7 => (Pyramid.straight(), 5),
            8 => (Edge.curved(), 3),
            9 => (Triangle.curved(), 6),
            10 => (Quadrilateral.curved(), 9),
            11 => (Tetrahedron.curved(), 10),
            12 => (Hexahedron.curved(), 27),
            13 => (Wedge.curved(), 18),
            14 => (Pyramid.curved(), 14),
            15 => (Point.straight(), 1),
            16 => (Quadrilateral.curved(), 8),
            17 => (Hexahedron.curved(), 20),
            18 => (Wedge.curved(), 15),
            19 => (Pyramid.curved(), 13),
            20 => (Triangle.curved(), 9),
            21 => (Triangle.curved(), 10),
            22 => (Triangle.curved(), 12),
            23 | 24 => (Triangle.curved(), 15),
            25 => (Triangle.curved(), 21),
            26 => (Edge.curved(), 4),
            27 => (Edge.curved(), 5),
            28 => (Edge.curved(), 6),
            29 => (Tetrahedron.curved(), 20),
            30 => (Tetrahedron.curved(), 35),
            31 => (Tetrahedron.curved(), 56),
            36 => (Quadrilateral.curved(), 16),
            37 => (Quadrilateral.curved(), 25),
            38 => (Quadrilateral.curved(), 36),
            92 => (Hexahedron.curved(), 64),
            93 => (Hexahedron.curved(), 125),
            _ => return None,
        })
    }

    /// Kind of a cell type of VTK (vtkCellType.h). Pixels and voxels, which differ from quadrilaterals and hexahedra only
    /// in the order of their corners, are left to the caller.
    pub(crate) fn from_vtk(number: i64) -> Option<Self> {
        use Shape::*;
        Some(match number {
            1 | 2 => Point.straight(),
            3 | 4 => Edge.straight(),
            5 => Triangle.straight(),
            6 | 7 => Polygon.straight(),
            8 | 9 => Quadrilateral.straight(),
            10 => Tetrahedron.straight(),
            11 | 12 => Hexahedron.straight(),
            13 => Wedge.straight(),
            14 => Pyramid.straight(),
            15 | 16 | 41 | 42 => Polyhedron.straight(),
            21 | 35 | 68 | 75 => Edge.curved(),
            22 | 34 | 69 | 76 => Triangle.curved(),
            23 | 28 | 30 | 70 | 77 => Quadrilateral.curved(),
            36 => Polygon.curved(),
            24 | 71 | 78 => Tetrahedron.curved(),
            25 | 29 | 33 | 72 | 79 => Hexahedron.curved(),
            26 | 31 | 32 | 73 | 80 => Wedge.curved(),
            27 | 37 | 74 | 81 => Pyramid.curved(),
            _ => return None,
        })
    }
}

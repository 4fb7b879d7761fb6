use std::fmt;

use super::super::{Point, measure};
use super::SurfaceError;

/// A loop of edges that have one triangle only.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Nodes around it, in order.
    pub nodes: Vec<u32>,
    /// Length around it [m].
    pub length: f64,
    /// Mean of its nodes [m].
    pub near: Point,
}

/// An edge of more than two triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct NonManifoldEdge {
    /// Its ends.
    pub nodes: [u32; 2],
    /// How many triangles share it.
    pub triangles: usize,
    /// Its middle [m].
    pub near: Point,
}

/// What is wrong with a surface, what was mended, and how large it is. Node numbers are those of the repaired surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceReport {
    /// Triangles left after repair.
    pub triangles: usize,
    /// Nodes left after repair.
    pub nodes: usize,
    /// Nodes that lay on another one and were merged with it: all but one in six in a triangle soup such as STL.
    pub merged_nodes: usize,
    /// Triangles of the original with two corners in one place, dropped.
    pub degenerate: Vec<u32>,
    /// Triangles of the original with the corners of an earlier one, dropped.
    pub duplicate: Vec<u32>,
    /// Triangles of the original that faced against most of their component, turned.
    pub flipped: Vec<u32>,
    /// Components that as a whole faced the wrong way, turned.
    pub inside_out: usize,
    /// Parts that no edge connects.
    pub components: usize,
    /// How many of these are cavities: they lie inside another one and face inwards.
    pub cavities: usize,
    /// Loops of free edges, the longest first.
    pub holes: Vec<Hole>,
    /// Edges of more than two triangles.
    pub non_manifold_edges: Vec<NonManifoldEdge>,
    /// Nodes in which parts of the surface touch that share no edge there. They do no harm to a mesh of tetrahedra.
    pub non_manifold_nodes: Vec<u32>,
    /// Middle of an edge where the surface has one side only [m].
    pub one_sided: Option<Point>,
    /// Volume enclosed [m³], cavities left out; meaningless with holes.
    pub volume: f64,
    /// Area [m²].
    pub area: f64,
}

impl SurfaceReport {
    /// Refuses a surface that does not tell inside from outside everywhere.
    ///
    /// # Errors
    /// [`SurfaceError::NonManifoldEdges`], [`SurfaceError::Holes`], [`SurfaceError::OneSided`], the gravest first.
    pub fn require_closed(&self) -> Result<(), SurfaceError> {
        if let Some(first) = self.non_manifold_edges.first() {
            let count = self.non_manifold_edges.len();
            return Err(SurfaceError::NonManifoldEdges { count, triangles: first.triangles, near: first.near });
        }
        if let Some(longest) = self.holes.first() {
            let Hole { nodes, length, near } = longest;
            return Err(SurfaceError::Holes {
                count: self.holes.len(),
                length: *length,
                edges: nodes.len(),
                near: *near,
            });
        }
        self.one_sided.map_or(Ok(()), |near| Err(SurfaceError::OneSided { near }))
    }
}

impl fmt::Display for SurfaceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = |count: usize, one: &str, many: &str| match count {
            1 => format!("1 {one}"),
            _ => format!("{count} {many}"),
        };
        write!(f, "{}, ", counted(self.triangles, "triangle", "triangles"))?;
        write!(f, "{}, ", counted(self.nodes, "node", "nodes"))?;
        write!(f, "{}", counted(self.components, "component", "components"))?;
        if self.cavities > 0 {
            write!(f, " ({})", counted(self.cavities, "cavity", "cavities"))?;
        }
        writeln!(f, ", {}, {}", measure::area(self.area), measure::volume(self.volume))?;
        let mended = [
            (self.merged_nodes, counted(self.merged_nodes, "node on another one", "nodes on others"), "merged"),
            (
                self.degenerate.len(),
                counted(self.degenerate.len(), "triangle without area", "triangles without area"),
                "dropped",
            ),
            (
                self.duplicate.len(),
                counted(self.duplicate.len(), "duplicate triangle", "duplicate triangles"),
                "dropped",
            ),
            (self.flipped.len(), counted(self.flipped.len(), "flipped facet", "flipped facets"), "turned"),
            (self.inside_out, counted(self.inside_out, "component inside out", "components inside out"), "turned"),
        ];
        for (_, what, done) in mended.iter().filter(|(count, ..)| *count > 0) {
            writeln!(f, "mended: {what}, {done}")?;
        }
        for hole in &self.holes {
            let Point { x, y, z } = hole.near;
            let edges = hole.nodes.len();
            let around = measure::length(hole.length);
            writeln!(f, "hole: {edges} edges, {around} around, near ({x:.4}, {y:.4}, {z:.4}) m")?;
        }
        for edge in &self.non_manifold_edges {
            let Point { x, y, z } = edge.near;
            writeln!(f, "edge of {} triangles near ({x:.4}, {y:.4}, {z:.4}) m", edge.triangles)?;
        }
        if !self.non_manifold_nodes.is_empty() {
            let touching = counted(self.non_manifold_nodes.len(), "node in which parts", "nodes in which parts");
            writeln!(f, "{touching} of the surface touch without sharing an edge")?;
        }
        if let Some(Point { x, y, z }) = self.one_sided {
            writeln!(f, "one side only, like a Möbius band, near ({x:.4}, {y:.4}, {z:.4}) m")?;
        }
        if self.require_closed().is_ok() { writeln!(f, "closed") } else { writeln!(f, "not closed") }
    }
}

use super::super::{GenerateError, Point, measure};

/// Why a surface cannot be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// There are no triangles.
    #[error("the surface has no triangles; export the skin of the organ as a triangle mesh")]
    Empty,
    /// A triangle names a node that does not exist.
    #[error(
        "triangle {triangle} names node {node}, but the surface has only {nodes} nodes; the file is damaged or was cut off"
    )]
    MissingNode {
        /// Triangle, from 0.
        triangle: usize,
        /// The node that it names, from 0.
        node: u32,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("node {node} of the surface is not at a finite place; repair the file that it came from")]
    NotFinite {
        /// Node, from 0.
        node: usize,
    },
    /// The surface does not enclose a volume: some edges have one triangle only.
    #[error(
        "the surface has {count} hole{s}, the longest {around} around, with {edges} edges, near ({x:.4}, {y:.4}, {z:.4}) m; close {it} in the program that made the surface",
        around = measure::length(*length), s = if *count == 1 { "" } else { "s" }, it = if *count == 1 { "it" } else { "them" },
        x = near.x, y = near.y, z = near.z
    )]
    Holes {
        /// How many loops of free edges.
        count: usize,
        /// Length of the longest [m].
        length: f64,
        /// Edges of the longest.
        edges: usize,
        /// Centre of the longest [m].
        near: Point,
    },
    /// More than two triangles share an edge, so that inside and outside are not told apart there.
    #[error(
        "{count} edge{s} of the surface {have} more than two triangles, the first with {triangles} near ({x:.4}, {y:.4}, {z:.4}) m; remove inner walls, or separate the parts that touch along an edge",
        s = if *count == 1 { "" } else { "s" }, have = if *count == 1 { "has" } else { "have" },
        x = near.x, y = near.y, z = near.z
    )]
    NonManifoldEdges {
        /// How many such edges.
        count: usize,
        /// Triangles of the first.
        triangles: usize,
        /// Middle of the first [m].
        near: Point,
    },
    /// The surface has one side only, like a Möbius band, so that its facets cannot all face outwards.
    #[error("the surface around ({x:.4}, {y:.4}, {z:.4}) m cannot be turned outwards: it has one side only; remove the facets that join its inside to its outside", x = near.x, y = near.y, z = near.z)]
    OneSided {
        /// Middle of an edge where two orientations meet [m].
        near: Point,
    },
    /// The edge length does not suit the surface.
    #[error(transparent)]
    Generate(#[from] GenerateError),
}

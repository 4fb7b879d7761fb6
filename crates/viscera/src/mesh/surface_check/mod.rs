//! What a triangle surface must be to be filled with tetrahedra: closed, two-sided, facing outwards. What can be mended
//! without guessing is mended and counted; the rest is named with its place.

mod error;
mod orientation;
mod report;
mod welding;

use std::collections::{BTreeMap, BTreeSet};

use super::groups::Groups;
use super::{Point, SurfaceMesh};
pub use error::SurfaceError;
pub use report::{Hole, NonManifoldEdge, SurfaceReport};

/// The triangles of every edge, by its ends in ascending order.
type EdgeUses = BTreeMap<[u32; 2], Vec<u32>>;

impl SurfaceMesh {
    /// Looks the surface over without changing it.
    ///
    /// # Errors
    /// [`SurfaceError::Empty`], [`SurfaceError::MissingNode`], [`SurfaceError::NotFinite`]: nothing to look at.
    pub fn check(&self) -> Result<SurfaceReport, SurfaceError> {
        self.repaired().map(|(_, report)| report)
    }

    /// Mends what can be mended without guessing: merges nodes closer than 10⁻⁷ of the size, drops triangles with two
    /// corners in one place and duplicates, turns flipped facets and whole components outwards (cavities inwards).
    ///
    /// Holes, edges of more than two triangles and one-sided surfaces stay; [`SurfaceReport::require_closed`] refuses them.
    ///
    /// # Errors
    /// [`SurfaceError::Empty`], [`SurfaceError::MissingNode`], [`SurfaceError::NotFinite`]: nothing to mend.
    pub fn repaired(&self) -> Result<(SurfaceMesh, SurfaceReport), SurfaceError> {
        self.check_indices()?;
        let mut report = SurfaceReport::default();
        let (mut surface, origins) = welding::weld(self, &mut report);
        if surface.triangles.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let uses = edge_uses(&surface.triangles);
        orientation::orient(&mut surface, &origins, &uses, &mut report);
        report.triangles = surface.triangles.len();
        report.nodes = surface.nodes.len();
        report.holes = holes(&surface, &uses);
        report.non_manifold_edges = non_manifold_edges(&surface, &uses);
        report.non_manifold_nodes = non_manifold_nodes(&surface, &uses);
        report.volume = surface.enclosed_volume();
        report.area = surface.area();
        Ok((surface, report))
    }

    /// Sum of the areas of the triangles [m²].
    pub fn area(&self) -> f64 {
        let corner = |node: u32| self.nodes[node as usize];
        self.triangles.iter().map(|&[a, b, c]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).norm()).sum()
    }

    fn check_indices(&self) -> Result<(), SurfaceError> {
        if self.triangles.is_empty() {
            return Err(SurfaceError::Empty);
        }
        if let Some(node) = self.nodes.iter().position(|node| !node.is_finite()) {
            return Err(SurfaceError::NotFinite { node });
        }
        let nodes = self.nodes.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&node) = corners.iter().find(|&&node| node as usize >= nodes) {
                return Err(SurfaceError::MissingNode { triangle, node, nodes });
            }
        }
        Ok(())
    }
}

pub(in crate::mesh) fn edge_uses(triangles: &[[u32; 3]]) -> EdgeUses {
    let mut uses = EdgeUses::new();
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            uses.entry([from.min(to), from.max(to)]).or_default().push(triangle as u32);
        }
    }
    uses
}

/// Loops of free edges, the longest first.
fn holes(surface: &SurfaceMesh, uses: &EdgeUses) -> Vec<Hole> {
    let mut free = BTreeMap::<u32, BTreeSet<u32>>::new();
    for &[a, b] in uses.iter().filter(|(_, triangles)| triangles.len() == 1).map(|(edge, _)| edge) {
        free.entry(a).or_default().insert(b);
        free.entry(b).or_default().insert(a);
    }
    let mut holes = Vec::new();
    while let Some((&start, _)) = free.first_key_value() {
        // Every node has an even number of free edges, so the walk ends where it began.
        let mut nodes = Vec::new();
        let mut here = start;
        while let Some(next) = free.get_mut(&here).and_then(BTreeSet::pop_first) {
            nodes.push(here);
            free.entry(next).or_default().remove(&here);
            here = next;
            if here == start {
                break;
            }
        }
        free.retain(|_, ends| !ends.is_empty());
        let place = |i: usize| surface.nodes[nodes[i % nodes.len()] as usize];
        let length = (0..nodes.len()).map(|i| (place(i + 1) - place(i)).norm()).sum();
        let near = (0..nodes.len()).fold(Point::ZERO, |sum, i| sum + place(i)) / nodes.len() as f64;
        holes.push(Hole { nodes, length, near });
    }
    holes.sort_by(|a, b| b.length.total_cmp(&a.length));
    holes
}

pub(in crate::mesh) fn non_manifold_edges(surface: &SurfaceMesh, uses: &EdgeUses) -> Vec<NonManifoldEdge> {
    let shared = uses.iter().filter(|(_, triangles)| triangles.len() > 2);
    shared
        .map(|(&nodes, triangles)| {
            let [a, b] = nodes.map(|node| surface.nodes[node as usize]);
            NonManifoldEdge { nodes, triangles: triangles.len(), near: (a + b) * 0.5 }
        })
        .collect()
}

/// Nodes whose triangles fall into several fans that share no edge at the node.
pub(in crate::mesh) fn non_manifold_nodes(surface: &SurfaceMesh, uses: &EdgeUses) -> Vec<u32> {
    let mut corners_of = vec![0usize; surface.nodes.len()];
    surface.triangles.iter().flatten().for_each(|&node| corners_of[node as usize] += 1);
    // Walking from triangle to triangle over the edges at a node joins them; what is left over is a second fan.
    let mut fans = Groups::new(3 * surface.triangles.len());
    let slot = |triangle: u32, node: u32| {
        let corners = surface.triangles[triangle as usize];
        3 * triangle as usize + (0..3).find(|&i| corners[i] == node).unwrap_or(0)
    };
    for (&nodes, triangles) in uses {
        for node in nodes {
            for pair in triangles.windows(2) {
                if fans.join(slot(pair[0], node), slot(pair[1], node)) {
                    corners_of[node as usize] -= 1;
                }
            }
        }
    }
    (0..surface.nodes.len() as u32).filter(|&node| corners_of[node as usize] > 1).collect()
}

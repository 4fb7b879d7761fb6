use std::fmt;

use super::{Point, measure};

/// What the check of a mesh found and repaired: see [`TetMesh::checked`](super::TetMesh::checked).
///
/// Shown as lines for a person; the first says what the mesh is, each further one what was done or should be looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshReport {
    /// Nodes that are left.
    pub nodes: usize,
    /// Cells.
    pub cells: usize,
    /// Sum of the volumes of the cells, after repair [m³].
    pub volume: f64,
    /// Cells whose corners were listed in mirrored order; now they are right.
    pub mirrored_cells: usize,
    /// Nodes of no cell; they were removed, and the nodes behind them renumbered.
    pub isolated_nodes: usize,
    /// Faces and nodes of regions that went with the isolated nodes.
    pub region_entries_removed: usize,
    /// Parts that share no node with each other.
    pub components: usize,
    /// Faces that more than two cells share.
    pub overshared_faces: usize,
    /// Nodes that lie where an earlier node lies, though they are not one node.
    pub coincident_nodes: usize,
    /// The first such pair and its place.
    pub first_coincidence: Option<([u32; 2], Point)>,
    /// The cell with the least volume for its longest edge.
    pub flattest_cell: usize,
    /// Its quality: 1 for a regular tetrahedron or a cube, 0 for a flat cell.
    pub flattest_quality: f64,
}

impl MeshReport {
    /// Below this quality a cell is a sliver: it is reported, because it shortens the stable step and its stresses are
    /// poor. A regular cell pressed to a hundredth of its height has about this quality.
    pub const SLIVER: f64 = 0.01;

    /// Whether nothing was repaired and nothing is odd.
    pub fn is_clean(&self) -> bool {
        self.remarks().is_empty()
    }

    /// One line for everything that was repaired or should be looked at.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        let mut remark = |count: usize, text: String| remarks.extend((count > 0).then_some(text));
        remark(
            self.mirrored_cells,
            format!("repaired: {} cells were listed mirrored and were turned", self.mirrored_cells),
        );
        remark(
            self.isolated_nodes,
            format!("repaired: {} nodes belong to no cell and were removed; later nodes moved up", self.isolated_nodes),
        );
        remark(
            self.region_entries_removed,
            format!("repaired: {} nodes and faces of regions went with them", self.region_entries_removed),
        );
        remark(
            self.components.saturating_sub(1),
            format!("warning: the mesh is in {} parts that share no node and will move apart", self.components),
        );
        remark(
            self.overshared_faces,
            format!("warning: {} faces are shared by more than two cells; cells overlap there", self.overshared_faces),
        );
        if let Some(([first, second], place)) = self.first_coincidence {
            let Point { x, y, z } = place;
            remark(
                self.coincident_nodes,
                format!(
                    "warning: {} nodes lie on another node (first: {first} and {second} at ({x}, {y}, {z})); \
                     unless a cut is meant, merge them before export",
                    self.coincident_nodes
                ),
            );
        }
        if self.cells > 0 && self.flattest_quality < Self::SLIVER {
            remark(
                1,
                format!(
                    "warning: cell {} is nearly flat (quality {:.1e}, 1 is regular); improve the mesh there",
                    self.flattest_cell, self.flattest_quality
                ),
            );
        }
        remarks
    }
}

impl fmt::Display for MeshReport {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{} nodes, {} cells, {}", self.nodes, self.cells, measure::volume(self.volume))?;
        self.remarks().iter().try_for_each(|remark| write!(out, "\n{remark}"))
    }
}

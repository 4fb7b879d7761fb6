use super::super::{Point, TetMesh};

/// A flat triangulation: nodes in the plane z = 0 and triangles, of either orientation.
pub(super) struct FlatMesh {
    pub(super) nodes: Vec<[f64; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl FlatMesh {
    /// Raises the triangles along z into `layers` of prisms, each of three tetrahedra.
    ///
    /// Node `n` of the flat mesh becomes node `layer * nodes + n`. The diagonal of an upright quadrilateral goes up from
    /// its smaller flat node in even layers and down in odd ones: a rule that both neighbours of the quadrilateral see
    /// alike, that never runs around a prism in a circle (which no tetrahedra could fill), and whose twist changes sign
    /// from layer to layer.
    pub(super) fn extrude(&self, height: f64, layers: usize) -> TetMesh {
        let per_layer = self.nodes.len() as u32;
        let nodes = (0..=layers).flat_map(|layer| {
            let z = height * layer as f64 / layers as f64;
            self.nodes.iter().map(move |&[x, y]| Point::new(x, y, z))
        });
        let mut mesh = TetMesh::new(nodes.collect(), Vec::with_capacity(3 * layers * self.triangles.len()));
        for layer in 0..layers as u32 {
            let (from, to) = if layer % 2 == 0 { (layer, layer + 1) } else { (layer + 1, layer) };
            for &triangle in &self.triangles {
                let mut sorted = triangle;
                sorted.sort_unstable();
                let [a, b, c] = sorted.map(|node| node + from * per_layer);
                let [d, e, f] = sorted.map(|node| node + to * per_layer);
                mesh.cells.extend([[a, d, e, f], [a, b, e, f], [a, b, c, f]]);
            }
        }
        for cell in 0..mesh.cells.len() {
            if mesh.cell_volume(cell) < 0.0 {
                mesh.cells[cell].swap(2, 3);
            }
        }
        mesh
    }
}

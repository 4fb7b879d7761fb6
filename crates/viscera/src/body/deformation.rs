use super::SimulatedBody;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{HEX_FACES, Point, TET_FACES, VolumeMesh, hexahedron_volume};

impl<T: Scalar> SimulatedBody<T> {
    /// Volume of a cell now [m³]; negative where the cell is turned inside out.
    pub fn cell_volume(&self, cell: usize) -> f64 {
        let place = |node: u32| self.state.positions[node as usize].cast::<f64>();
        match &self.mesh {
            VolumeMesh::Tet(mesh) => {
                let [a, b, c, d] = mesh.cells[cell].map(place);
                (b - a).dot((c - a).cross(d - a)) / 6.0
            }
            VolumeMesh::Hex(mesh) => hexahedron_volume(&mesh.cells[cell].map(place)),
        }
    }

    /// V/V0 of a cell: 1 at rest, negative where the cell is turned inside out.
    pub fn volume_ratio(&self, cell: usize) -> f64 {
        self.cell_volume(cell) / self.cell_volumes[cell]
    }

    /// Smallest and largest coordinates of a cell now [m].
    pub(crate) fn cell_bounds(&self, cell: usize) -> (Point, Point) {
        let places = self.mesh.cell(cell).iter().map(|&node| self.state.positions[node as usize].cast::<f64>());
        let nowhere = (Vec3::splat(f64::INFINITY), Vec3::splat(f64::NEG_INFINITY));
        places.fold(nowhere, |(low, high), place| (low.min(place), high.max(place)))
    }

    /// Whether a place is in a cell as it is now; hexahedra as if their faces were flat.
    pub(crate) fn is_in_cell(&self, cell: usize, place: Point) -> bool {
        let at = |node: u32| self.state.positions[node as usize].cast::<f64>();
        let within = |corners: &[u32], face: &[usize]| {
            let [a, b, c] = [face[0], face[1], face[2]].map(|corner| at(corners[corner]));
            (b - a).cross(c - a).dot(place - a) <= 0.0
        };
        match &self.mesh {
            VolumeMesh::Tet(mesh) => TET_FACES.iter().all(|face| within(&mesh.cells[cell], face)),
            VolumeMesh::Hex(mesh) => HEX_FACES.iter().all(|face| within(&mesh.cells[cell], face)),
        }
    }

    /// Deformation gradient F of a cell now; of a hexahedron, that at its centre.
    pub fn deformation_gradient(&self, cell: usize) -> Mat3<f64> {
        let place = |node: u32| self.state.positions[node as usize].cast::<f64>();
        let rest = |node: u32| self.mesh.nodes()[node as usize];
        match &self.mesh {
            VolumeMesh::Tet(mesh) => {
                let corners = mesh.cells[cell];
                tet_frame(corners.map(place)) * tet_frame(corners.map(rest)).inverse()
            }
            VolumeMesh::Hex(mesh) => {
                let corners = mesh.cells[cell];
                hex_frame(corners.map(place)) * hex_frame(corners.map(rest)).inverse()
            }
        }
    }

    /// Equivalent strain of a cell, √(⅔ dev E : dev E) with the Green strain E: how far its shape is distorted, whatever
    /// its turn and its volume. In small uniaxial tension without change of volume it is the elongation.
    pub fn equivalent_strain(&self, cell: usize) -> f64 {
        // E = ½(FᵀF − I), and the deviator does not see I: dev E = ½ dev FᵀF, |dev C|² = |C|² − ⅓ (tr C)².
        let stretch = self.deformation_gradient(cell).gram();
        let trace = stretch.trace();
        let deviator = (stretch.squared_norm() - trace * trace / 3.0).max(0.0);
        (2.0 / 3.0 * 0.25 * deviator).sqrt()
    }
}

/// Edges from the first corner.
fn tet_frame([a, b, c, d]: [Point; 4]) -> Mat3<f64> {
    Mat3::from_columns(b - a, c - a, d - a)
}

/// Derivative of the trilinear map at the centre: mean edges along the three directions.
fn hex_frame([a, b, c, d, e, f, g, h]: [Point; 8]) -> Mat3<f64> {
    let mean = |ends: [(Point, Point); 4]| ends.into_iter().fold(Point::ZERO, |sum, (p, q)| sum + (q - p)) * 0.25;
    Mat3::from_columns(
        mean([(a, b), (d, c), (e, f), (h, g)]),
        mean([(a, d), (b, c), (e, h), (f, g)]),
        mean([(a, e), (b, f), (c, g), (d, h)]),
    )
}

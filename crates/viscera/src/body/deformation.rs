use super::SimulatedBody;
use crate::math::{Mat3, Scalar};
use crate::mesh::{Point, VolumeMesh, hexahedron_volume};

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

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::body::Body;
    use crate::material::{StVenantKirchhoff, Tissue};
    use crate::math::Vec3;
    use crate::mesh::{HexMesh, TetMesh, VolumeMesh};
    use crate::model::TotalLagrangian;
    use crate::world::{World, WorldConfig};

    /// A homogeneous deformation, turned by a right angle, has the same F in every cell, and its strain knows no turn.
    #[test]
    fn a_turned_stretch_shows_its_gradient_volume_and_strain_in_every_cell() {
        let size = [0.1, 0.2, 0.3];
        let meshes: [VolumeMesh; 2] =
            [TetMesh::box_grid([2, 1, 1], size).into(), HexMesh::box_grid([2, 1, 1], size).into()];
        for mesh in meshes {
            let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.4).unwrap());
            let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
            let id = world.add(Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue))).unwrap();
            // x' = R diag(1.2, 1, 1) x with R a quarter turn about z: (x, y) to (−y, 1.2 x).
            world.body_mut(id).set_positions(|x| Vec3::new(-x.y, 1.2 * x.x, x.z));
            let body = world.body(id);
            for cell in 0..body.mesh().cell_count() {
                let gradient = body.deformation_gradient(cell);
                let wanted = [[0.0, 1.2, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
                for (column, wanted) in gradient.columns.iter().zip(wanted) {
                    assert!((*column - Vec3::from(wanted)).norm() < 1e-12, "{gradient:?}");
                }
                assert_relative_eq!(body.volume_ratio(cell), 1.2, max_relative = 1e-12);
                // E = diag(0.22, 0, 0): dev E : dev E = ⅔ 0.22², so that the equivalent strain is ⅔ 0.22.
                assert_relative_eq!(body.equivalent_strain(cell), 2.0 / 3.0 * 0.22, max_relative = 1e-10);
            }
        }
    }
}

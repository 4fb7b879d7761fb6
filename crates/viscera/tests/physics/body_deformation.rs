//! Deformation as it is shown.

use approx::assert_relative_eq;

use viscera::body::Body;
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::TotalLagrangian;
use viscera::world::{World, WorldConfig};

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

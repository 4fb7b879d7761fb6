//! Tetrahedra that are almost flat, turned inside out: what rounding leaves of them may be wrong, but is a number.

use viscera::material::{StableNeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{TetMesh, VolumeMesh};
use viscera::model::{Precision, TotalLagrangian};

use crate::support::{Evaluate, Random, Vector};

/// A tetrahedron of 10 cm and so many times less in height.
fn sliver(flatness: f64, random: &mut Random) -> VolumeMesh {
    let mut corners = random.vectors(4, 0.1);
    if (corners[1] - corners[0]).dot((corners[2] - corners[0]).cross(corners[3] - corners[0])) < 0.0 {
        corners.swap(2, 3);
    }
    corners.iter_mut().for_each(|x| *x = Vector::new(x.x, x.y, x.z / flatness));
    TetMesh::new(corners, vec![[0, 1, 2, 3]]).into()
}

/// Of 2000 slivers the energy of 140 was no number: I_C, a sum of large terms, came out negative, and its logarithm is taken.
#[test]
fn slivers_in_single_precision_have_an_energy_and_forces() {
    let mut random = Random::new(11);
    for number in 0..2000 {
        let mesh = sliver(10f64.powi(number % 5), &mut random);
        let recipe = TotalLagrangian::new(Tissue::uniform(StableNeoHookean::from_young_poisson(1e4, 0.45).unwrap()));
        let model = f32::build_model(&recipe, &mesh).unwrap();
        let x: Vec<Vec3<f32>> = mesh.nodes().iter().map(|x| Vector::new(-x.x, x.y, x.z).cast()).collect();
        let dx: Vec<Vec3<f32>> = random.vectors(4, 0.1).iter().map(|dx| dx.cast()).collect();
        let (energy, forces, product) = (model.energy(&x), model.forces(&x), model.product(&x, &dx));
        assert!(energy.is_finite(), "{energy} J of {:?}", mesh.nodes());
        assert!(forces.iter().chain(&product).all(|v| v.is_finite()), "of {:?}", mesh.nodes());
    }
}

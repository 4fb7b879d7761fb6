use viscera::math::Mat3;
use viscera::mesh::{TetMesh, VolumeMesh};
use viscera::model::{ForceModel, MassSpring, ModelRecipe};

use crate::support::{Vector, YOUNG, hex_bar, tissue};

fn net(mesh: &VolumeMesh) -> Box<dyn ForceModel<f64>> {
    MassSpring::new(tissue()).build_double(mesh).unwrap()
}

/// Energy over volume of a stretch along the unit vector `axis`, with Poisson's ratio 1/4, over that of the tissue.
fn relative_energy(mesh: &VolumeMesh, volume: f64, axis: Vector) -> f64 {
    let strain = 1e-6;
    let f = Mat3::IDENTITY * (1.0 - 0.25 * strain) + axis.outer(axis) * (1.25 * strain);
    let x: Vec<_> = mesh.nodes().iter().map(|&node| f * node).collect();
    net(mesh).energy(&x) / (0.5 * YOUNG * strain * strain * volume)
}

/// Cubes whose edges and diagonals are springs have the tissue's Young's modulus along every axis, exactly: the weights 17/130
/// and 18/65 are made so.
#[test]
fn a_net_on_cubes_is_isotropic_and_has_the_youngs_modulus_of_its_tissue() {
    let mesh = VolumeMesh::from(hex_bar());
    for axis in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.48, 0.6, 0.64]] {
        let ratio = relative_energy(&mesh, 0.003, axis.into());
        // Springs are linear in their length, which a strain of 1e-6 bends by as much.
        assert!((ratio - 1.0).abs() < 1e-5, "{ratio} along {axis:?}");
    }
}

/// Over all directions, tetrahedra of any shape have it too: van Gelder's formula needs no factor. The twelve directions to the corners
/// of an icosahedron are a mean over the sphere that is exact for polynomials up to degree five; ⟨(n·ε n)²⟩ has degree four.
#[test]
fn a_net_on_tetrahedra_has_the_youngs_modulus_of_its_tissue_in_the_mean_over_directions() {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corners = [
        [0.0, 1.0, golden],
        [0.0, -1.0, golden],
        [1.0, golden, 0.0],
        [-1.0, golden, 0.0],
        [golden, 0.0, 1.0],
        [golden, 0.0, -1.0],
    ];
    let mesh = TetMesh::cylinder(0.05, 0.2, 3, 8).unwrap();
    let (volume, mesh) = (mesh.volume(), VolumeMesh::from(mesh));
    let of = |corner: [f64; 3]| relative_energy(&mesh, volume, Vector::from(corner) / Vector::from(corner).norm());
    let mean = corners.into_iter().map(of).sum::<f64>() / 6.0;
    assert!((mean - 1.0).abs() < 1e-5, "{mean}");
}

//! Newton's third law inside a body: internal forces sum to nothing and turn nothing; homogeneous strain loads only the surface.

use viscera::mesh::{CubeCut, TetMesh, VolumeMesh};
use viscera::model::Scratch;

use crate::support::{
    Evaluate, Random, Vector, deformed, hex_mesh, inner_nodes, largest, models_and_penalty, tet_mesh,
};

fn sum(forces: &[Vector]) -> Vector {
    forces.iter().fold(Vector::ZERO, |sum, &force| sum + force)
}

fn torque(x: &[Vector], forces: &[Vector]) -> Vector {
    x.iter().zip(forces).fold(Vector::ZERO, |sum, (&x, &force)| sum + x.cross(force))
}

/// At large random deformations, inverted cells among them.
#[test]
fn net_force_vanishes_and_so_does_net_torque_where_it_is_claimed() {
    let meshes: [VolumeMesh; 4] = [
        tet_mesh([3, 2, 2]).into(),
        hex_mesh([3, 2, 2]).into(),
        TetMesh::cylinder(0.04, 0.1, 2, 3).unwrap().into(),
        TetMesh::box_grid_cut([2, 2, 2], [0.1, 0.1, 0.1], CubeCut::Ten).into(),
    ];
    let mut random = Random::new(51);
    for mesh in &meshes {
        for noise in [0.0, 0.01, 0.06] {
            let x = deformed(mesh, random.deformation(0.5), random.vector(), noise, &mut random);
            for named in models_and_penalty::<f64>(mesh) {
                let forces = named.model.forces(&x);
                let scale = largest(&forces) * x.len() as f64;
                let net = sum(&forces).norm();
                assert!(
                    !named.claims.force_free || net <= 1e-14 * scale,
                    "{}: net force {net:e} of {scale:e}",
                    named.name
                );
                if named.claims.torque_free {
                    let (net, arm) = (torque(&x, &forces).norm(), largest(&x));
                    assert!(net <= 1e-13 * scale * arm, "{}: net torque {net:e} of {:e}", named.name, scale * arm);
                }
            }
        }
    }
}

/// A product along a translation is nothing; along a rotation of an objective body it turns the forces: K(x)(ω×x) = ω×f.
#[test]
fn products_know_rigid_motions() {
    for mesh in [VolumeMesh::from(tet_mesh([2, 2, 2])), hex_mesh([2, 2, 2]).into()] {
        let mut random = Random::new(52);
        let x = deformed(&mesh, random.deformation(0.4), random.vector() * 0.1, 0.01, &mut random);
        let (shift, spin) = (random.vector(), random.vector());
        for named in models_and_penalty::<f64>(&mesh) {
            let scale = largest(&named.model.product(&x, &random.vectors(x.len(), 1.0)));
            let shifted = largest(&named.model.product(&x, &vec![shift; x.len()]));
            assert!(shifted <= 1e-13 * scale, "{}: {shifted:e} of {scale:e}", named.name);
            if named.claims.objective && named.claims.exact_products {
                let turning: Vec<_> = x.iter().map(|&x| spin.cross(x)).collect();
                let product = named.model.product(&x, &turning);
                let forces = named.model.forces(&x);
                let error = (0..x.len()).map(|i| (product[i] - spin.cross(forces[i])).norm()).fold(0.0, f64::max);
                assert!(error <= 1e-13 * scale, "{}: {error:e} of {scale:e}", named.name);
            }
        }
    }
}

/// The patch test on a mesh without any regularity: inner nodes feel nothing, and the energy is the volume's.
#[test]
fn homogeneous_deformation_leaves_inner_nodes_without_force() {
    for mesh in [VolumeMesh::from(tet_mesh([3, 3, 3])), hex_mesh([3, 3, 3]).into()] {
        let mut random = Random::new(53);
        let inner = inner_nodes(&mesh);
        assert_eq!(inner.len(), 8);
        for _ in 0..3 {
            let x = deformed(&mesh, random.deformation(0.5), random.vector(), 0.0, &mut random);
            for named in models_and_penalty::<f64>(&mesh).into_iter().filter(|named| named.claims.passes_patch_test) {
                let forces = named.model.forces(&x);
                let scale = largest(&forces);
                let worst = inner.iter().map(|&node| forces[node].norm()).fold(0.0, f64::max);
                assert!(worst <= 1e-13 * scale, "{}: {worst:e} of {scale:e}", named.name);
            }
        }
    }
}

/// Forces that are left on copies of the nodes, to be added up later, have the bits of those that are added to nothing.
#[test]
fn forces_summed_on_copies_are_those_that_are_added() {
    let mut summed = 0;
    for mesh in [VolumeMesh::from(tet_mesh([2, 2, 2])), hex_mesh([2, 2, 2]).into()] {
        let mut random = Random::new(53);
        let x = deformed(&mesh, random.deformation(0.4), random.vector() * 0.1, 0.01, &mut random);
        for named in models_and_penalty::<f64>(&mesh) {
            let (mut scratch, mut written) = (Scratch::new(x.len()), random.vectors(x.len(), 1.0));
            let Some(patches) = named.model.sum_forces(&x, &mut scratch) else { continue };
            scratch.write_sums(patches, &mut written);
            assert_eq!(written, named.model.forces(&x), "{}", named.name);
            summed += 1;
        }
    }
    assert!(summed > 4, "{summed} models sum on copies of the nodes");
}

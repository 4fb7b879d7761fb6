//! Tubes of tissue with fibres along their axis, clamped at both ends and pushed aside in the middle: stiffer fibres,
//! smaller deflection, after INRIA RR-4028 (figure 6).

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::material::{Lame, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::Region;
use viscera::model::{TensorMass, TotalLagrangian};

use crate::support::{
    DENSITY, Reference, Vector, assert_relative, assert_vector, number, numbers, settle, vector, vectors, world,
};

/// One part in a thousand: what is left of the motion when it counts as at rest.
const TOLERANCE: f64 = 1e-3;

#[test]
fn fibres_along_a_tube_hold_it_back() {
    let case = Reference::read("F02_ti_tube");
    let (material, height) = (&case.data["material"], number(&case.data["mesh"]["H_m"]));
    let transverse = Lame::new(number(&material["lambda_Pa"]), number(&material["mu_Pa"])).unwrap();
    let loaded = numbers(&case.data["loads"]["nodes_0based"]);
    for reference in case.data["reference"].as_array().unwrap() {
        let factor = number(&reference["factor"]);
        let longitudinal = Lame::new(number(&reference["lambdaL_Pa"]), number(&reference["muL_Pa"])).unwrap();
        let direction = vector(&material["a0"]).to_array();
        let tissue = Tissue::uniform(TransverseStVenantKirchhoff::new(transverse, direction, longitudinal).unwrap());
        // The tables and the direct element take turns: both must arrive.
        let body = Body::new(case.mesh(), DENSITY);
        let body =
            if factor == 5.0 { body.model(TensorMass::new(tissue)) } else { body.model(TotalLagrangian::new(tissue)) };
        let end = |z: f64| Region::plane([0.0, 0.0, z], [0.0, 0.0, 1.0], 0.0);
        let total = Curve::constant(vector(&case.data["loads"]["total_force_N"]));
        let body = body
            .damping(60.0)
            .fix(end(0.0))
            .fix(end(height))
            .load(Load::Force { region: Region::Nodes(loaded.clone()), total });
        let mut world = world([0.0; 3], 1e-2);
        let id = world.add(body).unwrap();
        let seen = settle(&mut world, id, 1e-12);

        let body = world.body(id);
        let displacement = |node: usize| body.positions()[node] - body.mesh().nodes()[node];
        let mean =
            loaded.iter().fold(Vector::ZERO, |sum, &node| sum + displacement(node as usize)) / loaded.len() as f64;
        assert_vector(mean, vector(&reference["mean_deflection_of_loaded_nodes_m"]), TOLERANCE);
        assert_relative(seen.volume_variation, number(&reference["volume_variation"]), TOLERANCE);
        assert_relative(seen.elastic_energy, number(&reference["strain_energy_J"]), TOLERANCE);
        let expected = vectors(&reference["nodal_displacement_m"]);
        let largest = expected.iter().map(|u| u.norm()).fold(0.0, f64::max);
        for (node, &expected) in expected.iter().enumerate() {
            let error = (displacement(node) - expected).norm() / largest;
            assert!(error < TOLERANCE, "fibres ×{factor}, node {node}: {error:.2e}");
        }
    }
}

//! A cylinder bent by a force on its top: displacement and volume variation of the linear law, of St Venant–Kirchhoff,
//! and of the latter with its volume kept, after INRIA RR-4028 (figures 3 and 5, table 2).

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::material::Tissue;
use viscera::mesh::Region;
use viscera::model::{LinearTensorMass, ModelRecipe, TensorMass, TotalLagrangian};

use crate::support::{
    DENSITY, Reference, Vector, assert_relative, assert_vector, linear, number, settle, stvk, vector, world,
};

/// Displacement of the loaded node [m] and volume variation of the whole at rest.
fn bend(case: &Reference, recipe: Box<dyn ModelRecipe>, keep_volume: f64, force: f64) -> (Vector, f64) {
    let (node, height) = (number(&case.data["loads"]["node_0based"]) as u32, number(&case.data["mesh"]["H_m"]));
    // Twice the first frequency of a clamped rod, 1.875² √(E r²/4ρ)/H²: critical damping of the slowest mode.
    let (young, radius) = (number(&case.data["material"]["E_Pa"]), number(&case.data["mesh"]["R_m"]));
    let damping = 2.0 * 1.875_f64.powi(2) * (young * radius * radius / (4.0 * DENSITY)).sqrt() / (height * height);
    let body = Body::new(case.mesh(), DENSITY)
        .boxed_model(recipe)
        .keep_volume(keep_volume)
        .damping(damping)
        .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0))
        .load(Load::Force {
            region: Region::Nodes(vec![node]),
            total: Curve::constant(vector(&case.data["loads"]["direction"]) * force),
        });
    let mut world = world([0.0; 3], 1e-2);
    let id = world.add(body).unwrap();
    let seen = settle(&mut world, id, 1e-12);
    let body = world.body(id);
    (body.positions()[node as usize] - body.mesh().nodes()[node as usize], seen.volume_variation)
}

/// One part in a thousand: what is left of the motion when it counts as at rest.
const TOLERANCE: f64 = 1e-3;

fn assert_bends_as(expected: &serde_json::Value, (tip, volume_variation): (Vector, f64)) {
    assert_vector(tip, vector(&expected["tip_displacement_m"]), TOLERANCE);
    assert_relative(volume_variation, number(&expected["volume_variation"]), TOLERANCE);
}

#[test]
fn a_bent_cylinder_swells_under_the_linear_law_and_not_under_st_venant_kirchhoff() {
    let case = Reference::read("F01_cylinder_bending");
    let (young, poisson) = (number(&case.data["material"]["E_Pa"]), number(&case.data["material"]["nu"]));
    let kappa = number(&case.data["material"]["volume_penalty_kappa_Pa"]);
    let tissue: Tissue = stvk(young, poisson);
    for load in case.data["reference"].as_array().unwrap() {
        let force = number(&load["force_x_N"]);
        let linear = Box::new(LinearTensorMass::new(linear(young, poisson)));
        assert_bends_as(&load["linear"], bend(&case, linear, 0.0, force));
        assert_bends_as(&load["stvk"], bend(&case, Box::new(TotalLagrangian::new(tissue.clone())), 0.0, force));
        let kept = bend(&case, Box::new(TensorMass::new(tissue.clone())), kappa, force);
        assert_bends_as(&load["stvk_volume_penalty"], kept);
    }
}

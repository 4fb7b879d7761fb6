//! What a body answers to small forces is the slope of its equilibria.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::material::{NeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::solver::Iterative;

use crate::reference::{settle, world};

const TIP: [f64; 3] = [0.1, 0.1, 0.4];

/// A beam that is pulled at a corner by a force along x.
fn beam(force: f64) -> Body {
    let law = NeoHookean::from_young_poisson(10e3, 0.4).unwrap();
    let total = Curve::constant(Vec3::new(force, 0.0, 0.0));
    Body::new(TetMesh::box_grid([2, 2, 6], TIP), 1000.0)
        .model(TotalLagrangian::new(Tissue::uniform(law)))
        .fix(Region::Named("z-min".into()))
        .load(Load::Force { region: Region::nearest(TIP), total })
}

/// Equilibria with forces of ±h against one linear solve: they differ in second order of h.
#[test]
fn the_answer_to_a_small_force_is_the_slope_of_the_equilibrium() {
    let gravity = [0.0, -0.3, 0.0];
    let positions = |force: f64| {
        let (mut world, id) = world(beam(force), gravity);
        settle(&mut world, id).unwrap();
        world.body(id).positions().to_vec()
    };
    let (mut middle, id) = world(beam(0.0), gravity);
    settle(&mut middle, id).unwrap();
    let tip = Region::nearest(TIP).nodes(middle.body(id).mesh()).unwrap()[0] as usize;
    let mut forces = vec![Vec3::ZERO; middle.body(id).positions().len()];
    forces[tip] = Vec3::new(1.0, 0.0, 0.0);
    let answers = middle.respond(id, &[forces], 0.0, &mut Iterative::default()).unwrap();
    let h = 1e-4;
    let (after, before) = (positions(h), positions(-h));
    let largest = answers[0].iter().map(|u| u.norm()).fold(0.0, f64::max);
    for ((answer, after), before) in answers[0].iter().zip(after).zip(before) {
        let slope = (after - before) / (2.0 * h);
        assert!((*answer - slope).norm() < 1e-5 * largest, "{answer:?} against {slope:?}");
    }
}

/// With inertia far above the stiffness every free node answers for itself: u = f/(α m).
#[test]
fn a_heavy_body_answers_with_its_masses() {
    let (mut world, id) = world(beam(0.0), [0.0; 3]);
    let alpha = 1e12;
    let body = world.body(id);
    let masses = body.state().masses.clone();
    let tip = Region::nearest(TIP).nodes(body.mesh()).unwrap()[0] as usize;
    let forces = vec![Vec3::new(0.0, 1.0, 0.0); masses.len()];
    let answers = world.respond(id, &[forces], alpha, &mut Iterative::default()).unwrap();
    assert!((answers[0][tip].y * alpha * masses[tip] - 1.0).abs() < 1e-5);
}

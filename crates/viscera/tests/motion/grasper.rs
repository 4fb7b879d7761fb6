//! Jaws that take hold of tissue, carry it, feel it and let go.

use viscera::body::{Body, NodeMotion};
use viscera::curve::Curve;
use viscera::instrument::Grasper;
use viscera::mesh::TetMesh;
use viscera::model::{Precision, TotalLagrangian};

use crate::support::{DENSITY, Vector, assert_vector, free_bar, in_both_precisions, side, stvk, world};

const TIP: Vector = Vector::new(0.02, 0.02, 0.16); // m, middle of the free end

/// Closed, the jaws hold the nodes within their radius and carry them along without turning; open, they hold none.
fn jaws_carry_what_they_took_until_they_open<T: Precision>(tolerance: f64) {
    let away = TIP + Vector::new(0.01, 0.004, 0.02);
    let path = Curve::piecewise_linear(vec![(0.02, TIP), (0.1, away)]).unwrap();
    let mut world = world::<T>([0.0; 3], 5e-3);
    let id = world.add(free_bar().fix(side("z-min")).damping(5.0)).unwrap();
    let grasper = world
        .add_instrument(Grasper {
            path: path.clone(),
            radius: 0.022,
            close: 0.01,
            open: Some(0.15),
            ..Grasper::default()
        })
        .unwrap();
    let within: Vec<usize> = {
        let nodes = world.body(id).mesh().nodes();
        (0..nodes.len()).filter(|&node| (nodes[node] - TIP).norm() <= 0.022).collect()
    };
    assert_eq!(within.len(), 6, "the middle, its four neighbours on the side, and one below");
    for step in 0..40 {
        let begin = world.time();
        world.step().unwrap();
        let seen = world.observe_instrument(grasper);
        let closed = (0.01..0.15).contains(&(begin + 1e-9));
        assert_eq!(seen.held_nodes, if closed { within.len() } else { 0 }, "step {step}");
        assert_eq!(seen.tip, path.at(world.time()));
        let body = world.body(id);
        for &node in &within {
            let held = body.state().motions[node] == NodeMotion::Held(0);
            assert_eq!(held, closed);
            if held {
                let carried = body.mesh().nodes()[node] + path.at(world.time()) - TIP;
                assert_vector(body.positions()[node].cast(), carried, tolerance);
            }
        }
        if !closed {
            assert_eq!(seen.force, Vector::ZERO);
        }
    }
    assert!(world.observe(id).kinetic_energy > 0.0, "the tissue springs back");
}
in_both_precisions!(jaws_carry_what_they_took_until_they_open, f32: 1e-5, f64: 1e-12);

/// A piece that hangs from the jaws alone pulls at them with its weight.
fn a_hanging_weight_is_felt_as_mass_times_gravity<T: Precision>(tolerance: f64) {
    let gravity = Vector::new(0.0, 0.0, -2.0); // m/s², along the bar
    let mut world = world::<T>(gravity.to_array(), 5e-3);
    let id = world
        .add(
            Body::new(TetMesh::box_grid([2, 2, 4], [0.04, 0.04, 0.08]), DENSITY)
                .model(TotalLagrangian::new(stvk(20e3, 0.4)))
                .damping(40.0),
        )
        .unwrap();
    let path = Curve::constant(Vector::new(0.02, 0.02, 0.08));
    let grasper =
        world.add_instrument(Grasper { path, radius: 0.03, close: 0.0, open: None, ..Grasper::default() }).unwrap();
    for _ in 0..400 {
        world.step().unwrap();
    }
    let weight = gravity * world.observe(id).mass;
    assert_vector(world.observe_instrument(grasper).force, -weight, tolerance);
}
in_both_precisions!(a_hanging_weight_is_felt_as_mass_times_gravity, f32: 1e-3, f64: 1e-6);

//! Tools that push on a pre-computed body: it does not let them in, it does not stick to them, and it pushes back with the force that
//! its support feels.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::instrument::{Mount, Path, Probe, Shaft};
use viscera::solver::Stop;
use viscera::world::{BodyId, InstrumentId, Integrator, World};

use crate::support::{SIZE, Vector, difference, displacements, in_full, run, standing, tetrahedra, world};

const RADIUS: f64 = 8e-3;

/// A rod across the top that goes down into it by `depth` and up again.
fn rod(depth: f64) -> Probe {
    let above = Vector::new(0.5 * SIZE[0], SIZE[1] + 0.05, SIZE[2] + RADIUS + 2e-3);
    let down = above - Vector::new(0.0, 0.0, 2e-3 + depth);
    let path: Path = Curve::piecewise_linear(vec![(0.0, above), (0.05, down), (1.0, down), (1.05, above)]).unwrap();
    let shaft = Shaft { radius: RADIUS, length: 0.2 };
    let mount = Mount { direction: Curve::constant(Vector::new(0.0, 1.0, 0.0)), ..Mount::default() };
    Probe { path, mount, shaft, friction: 0.0 }
}

fn pressed(body: Body, integrator: Integrator, steps: usize) -> (World<f64>, BodyId, InstrumentId) {
    let mut world = world([0.0; 3], integrator);
    let id = world.add(body).unwrap();
    let tool = world.add_instrument(rod(6e-3)).unwrap();
    run(&mut world, steps);
    (world, id, tool)
}

/// How deep the surface is inside the rod, at most [m].
fn depth(world: &World<f64>, id: BodyId, tool: InstrumentId) -> f64 {
    let rods = world.tool_capsules(tool);
    let body = world.body(id);
    let nodes = body.surface().into_iter().flat_map(|triangle| triangle.nodes);
    let distance = |place: Vector, rod: &viscera::contact::Capsule| {
        let line = rod.to - rod.from;
        let along = ((place - rod.from).dot(line) / line.squared_norm()).clamp(0.0, 1.0);
        (place - rod.from - line * along).norm() - rod.radius
    };
    nodes
        .map(|node| rods.iter().map(|rod| -distance(body.positions()[node as usize], rod)).fold(0.0, f64::max))
        .fold(0.0, f64::max)
}

#[test]
fn a_rod_is_kept_out_and_feels_what_the_support_feels() {
    let (mut world, id, tool) = pressed(standing(tetrahedra()), Integrator::default(), 10);
    let (force, reaction) = (world.observe_instrument(tool), world.observe(id).reaction);
    assert!(force.contacts > 0 && force.force.z < -0.05, "{force:?}");
    assert!((force.force + reaction).norm() < 1e-8 * reaction.norm(), "{force:?} and {reaction:?}");
    let depth = depth(&world, id, tool);
    assert!(depth < 0.1 * RADIUS, "{depth} m deep");
    // Still, the same contacts give the same answer: nothing creeps.
    let before = displacements(&world, id);
    world.step().unwrap();
    assert!(difference(&displacements(&world, id), &before) < 0.05);
}

/// A rod that leaves takes nothing along.
#[test]
fn tissue_is_at_rest_again_when_the_rod_has_left() {
    let (mut world, id, tool) = pressed(standing(tetrahedra()), Integrator::default(), 110);
    assert_eq!(world.body(id).max_displacement(), 0.0);
    assert_eq!(world.observe_instrument(tool).force, Vector::ZERO);
    world.step().unwrap();
}

/// The same block moved by implicit steps under the same rod, strongly damped, comes to where the pre-computed one is at once.
#[test]
fn a_damped_block_in_motion_comes_to_rest_where_the_precomputed_one_is() {
    let (mut answered, id, tool) = pressed(standing(tetrahedra()), Integrator::default(), 14);
    let settings = Implicit {
        newton: Newton::Full { relative: 1e-8, at_most: 30 },
        linear: Stop::Tolerance { relative: 1e-10, at_most: 2000 },
        scheme: Scheme::BackwardEuler,
        ..Implicit::default()
    };
    let moving = in_full(standing(tetrahedra()), false).damping(20.0);
    let (mut moved, other, rod) = pressed(moving, Integrator::Implicit(settings), 90);
    let (force, wanted) = (answered.observe_instrument(tool).force.z, moved.observe_instrument(rod).force.z);
    assert!((force - wanted).abs() < 0.1 * wanted.abs(), "{force} and {wanted} N");
    let apart = difference(&displacements(&answered, id), &displacements(&moved, other));
    assert!(apart < 0.1, "{apart}");
    let (energy, wanted) = (answered.observe(id).elastic_energy, moved.observe(other).elastic_energy);
    assert!((energy / wanted - 1.0).abs() < 0.25, "{energy} and {wanted} J");
}

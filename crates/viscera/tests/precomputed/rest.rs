//! A pre-computed body in a world: at the end of every step it is the static solution under all that drives and loads it.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::implicit::Implicit;
use viscera::instrument::Grasper;
use viscera::mesh::Region;
use viscera::world::{BodyId, Integrator, World};

use crate::support::{
    SIZE, Vector, bottom, difference, displacements, hexahedra, in_full, loose, run, solved, standing, tetrahedra, top,
    world,
};

const GRAVITY: [f64; 3] = [0.3, -0.2, -1.0];

/// Weight, a force, a traction, a plate that moves, and faces that slide. All of it but the weight is there at once, or comes in 20 ms.
fn under_load(body: Body, at_once: bool) -> Body {
    let side = Region::plane([SIZE[0], 0.0, 0.0], [1.0, 0.0, 0.0], 4e-3);
    let front = Region::plane([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 4e-3);
    let half = Region::HalfSpace { point: Vector::new(0.04, 0.0, 0.0), normal: Vector::new(1.0, 0.0, 0.0) };
    let vector = |end: Vector| {
        let ramp = vec![(0.0, if at_once { end } else { Vector::ZERO }), (0.02, end)];
        Curve::piecewise_linear(ramp).unwrap()
    };
    let number = |end: f64| Curve::piecewise_linear(vec![(0.0, if at_once { end } else { 0.0 }), (0.02, end)]).unwrap();
    body.fix(Region::Intersection(vec![bottom(), side.clone()]))
        .slide(bottom(), [0.0, 0.1, 1.0])
        .prescribe_along(Region::Intersection(vec![front, half]), [0.0, 1.0, 0.0], number(1e-3))
        .prescribe(Region::Intersection(vec![top(), side]), vector(Vector::new(2e-3, -1e-3, 3e-3)))
        .load(Load::Force { region: top(), total: vector(Vector::new(0.1, 0.05, -0.2)) })
        .load(Load::Traction { region: top(), traction: vector(Vector::new(5.0, -8.0, 3.0)) })
}

fn after(body: Body, gravity: [f64; 3], steps: usize) -> (World<f64>, BodyId) {
    let mut world = world(gravity, Integrator::default());
    let id = world.add(body).unwrap();
    run(&mut world, steps);
    (world, id)
}

#[test]
fn a_body_under_everything_at_once_is_the_static_solution_after_a_step() {
    for is_hex in [false, true] {
        let mesh = || if is_hex { hexahedra() } else { tetrahedra() };
        let (found, id) = after(under_load(loose(mesh()), true), GRAVITY, 1);
        let (full, other) = solved(in_full(under_load(loose(mesh()), true), is_hex), GRAVITY);
        let apart = difference(&displacements(&found, id), &displacements(&full, other));
        assert!(apart < 1e-8, "hexahedra {is_hex}: {apart:.1e}");
    }
}

/// The pressure acts as it does at rest; so it does in the linear solve that the body is compared with, which begins there.
#[test]
fn a_pressed_body_is_the_static_solution_after_a_step() {
    let body = || {
        let region = Region::plane([SIZE[0], 0.0, 0.0], [1.0, 0.0, 0.0], 4e-3);
        standing(tetrahedra()).load(Load::Pressure { region, pressure: Curve::constant(40.0) })
    };
    let (found, id) = after(body(), GRAVITY, 1);
    let (full, other) = solved(in_full(body(), false), GRAVITY);
    assert!(difference(&displacements(&found, id), &displacements(&full, other)) < 1e-8);
}

/// Half of everything is half of the answer.
#[test]
fn a_body_follows_its_curves_in_proportion() {
    let body = || under_load(loose(tetrahedra()), false);
    let (half, id) = after(body(), [0.0; 3], 1);
    let (whole, other) = after(body(), [0.0; 3], 2);
    let twice: Vec<_> = displacements(&half, id).into_iter().map(|u| u * 2.0).collect();
    assert!(difference(&twice, &displacements(&whole, other)) < 1e-11);
}

/// What fixes a body carries its weight and loads, and nothing moves.
#[test]
fn weight_forces_and_guides_give_the_static_solution_to_the_last_digits() {
    let body = || {
        standing(tetrahedra()).load(Load::Force { region: top(), total: Curve::constant(Vector::new(0.1, 0.05, -0.2)) })
    };
    let (mut found, id) = after(body(), GRAVITY, 1);
    let (mut full, other) = solved(in_full(body(), false), GRAVITY);
    assert!(difference(&displacements(&found, id), &displacements(&full, other)) < 1e-8);
    let (reaction, wanted) = (found.observe(id).reaction, full.observe(other).reaction);
    assert!((reaction - wanted).norm() < 1e-8 * wanted.norm(), "{reaction:?} and {wanted:?}");
    assert!(found.observe(id).at_rest && found.observe(id).kinetic_energy == 0.0);
}

fn grasper() -> Grasper {
    let corner = Vector::new(SIZE[0], SIZE[1], SIZE[2]);
    let path = vec![(0.0, corner), (0.01, corner), (0.03, corner + Vector::new(4e-3, 2e-3, 6e-3))];
    Grasper {
        path: Curve::piecewise_linear(path).unwrap(),
        radius: 0.03,
        close: 0.01,
        open: Some(0.05),
        ..Grasper::default()
    }
}

/// A corner that is grasped and pulled: positions and the jaws' force are those of the static solution with these nodes at their
/// places, whatever integrator the world has; let go, the block is at rest again at once.
#[test]
fn a_grasped_corner_is_the_static_solution_with_its_nodes_imposed() {
    let mut seen = Vec::new();
    for integrator in [Integrator::default(), Integrator::Implicit(Implicit::default())] {
        let mut world = world([0.0; 3], integrator);
        let id = world.add(standing(tetrahedra())).unwrap();
        let tool = world.add_instrument(grasper()).unwrap();
        run(&mut world, 4);
        let motions = &world.body(id).state().motions;
        let held: Vec<u32> = (0..motions.len() as u32)
            .filter(|&node| matches!(motions[node as usize], viscera::body::NodeMotion::Held(_)))
            .collect();
        assert!(held.len() >= 3, "{held:?}");
        let ways: Vec<_> = held.iter().map(|_| Vector::new(4e-3, 2e-3, 6e-3)).collect();
        let body = crate::support::prescribed(in_full(standing(tetrahedra()), false), &held, &ways);
        let (mut full, other) = solved(body, [0.0; 3]);
        assert!(difference(&displacements(&world, id), &displacements(&full, other)) < 1e-8);
        let forces = full.internal_forces(other);
        let wanted = held.iter().fold(Vector::ZERO, |sum, &node| sum + forces[node as usize]);
        let force = world.observe_instrument(tool).force;
        assert!((force - wanted).norm() < 1e-8 * wanted.norm(), "{force:?} and {wanted:?}");
        // What fixes the block answers what pulls it.
        let reaction = world.observe(id).reaction;
        assert!((reaction + force).norm() < 1e-8 * force.norm());
        seen.push(displacements(&world, id));
        run(&mut world, 2);
        assert_eq!(world.body(id).max_displacement(), 0.0);
        assert_eq!(world.observe_instrument(tool).force, Vector::ZERO);
    }
    assert!(seen[0] == seen[1], "the integrator of other bodies has no part in it");
}

/// Jaws that hold with a tenth of the force that it takes: nodes slip, and the sum of the forces is the grip.
#[test]
fn nodes_slip_through_jaws_at_the_grip() {
    let pull = |grip: f64| {
        let mut world = world([0.0; 3], Integrator::default());
        let id = world.add(standing(tetrahedra())).unwrap();
        let tool = world.add_instrument(Grasper { grip, ..grasper() }).unwrap();
        run(&mut world, 4);
        (world.observe_instrument(tool).force.norm(), world.body(id).max_displacement())
    };
    let (firm, firm_way) = pull(f64::INFINITY);
    let (weak, weak_way) = pull(0.1 * firm);
    assert!(weak <= 0.1 * firm * (1.0 + 1e-9) && weak > 0.03 * firm, "{weak} of {firm} N");
    assert!(weak_way < 0.5 * firm_way);
}

/// Single precision differs from double by its own rounding and no more.
#[test]
fn single_precision_rounds_places_and_nothing_else() {
    let (double, id) = after(standing(tetrahedra()), GRAVITY, 1);
    let config = viscera::world::WorldConfig { gravity: GRAVITY, step: 0.01, integrator: Integrator::default() };
    let mut single = World::<f32>::new(config).unwrap();
    let other = single.add(standing(tetrahedra())).unwrap();
    single.step().unwrap();
    for (a, b) in single.body(other).positions().iter().zip(double.body(id).positions()) {
        assert!((a.cast::<f64>() - *b).norm() < 2e-7 * SIZE[2]);
    }
}

//! Bodies that are grown together, with every integrator: beams in pieces beside whole ones, and what hangs from what.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::instrument::Grasper;
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::math::Mat3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Precision, TotalLagrangian};
use viscera::solver::{Envelope, Iterative, Stop};
use viscera::world::{Attachment, AttachmentId, BodyId, Integrator, Substep, World, WorldError};

use super::support::*;

const SIDE: f64 = 0.04; // m
const EDGE: f64 = 0.02;
const FIXED: Integrator = Integrator::Explicit(Substep::Fixed(2e-4));

fn named(name: &str) -> Region {
    Region::Named(name.into())
}

/// Implicit steps whose equations are solved to rounding, so that two ways to the same answer can be told apart from two answers.
fn thorough(scheme: Scheme, newton: Newton, matrix: MatrixForm) -> Integrator {
    let linear = Stop::Tolerance { relative: 1e-12, at_most: 2000 };
    Integrator::Implicit(Implicit { scheme, newton, linear, matrix, ..Implicit::default() })
}

const FULL: Newton = Newton::Full { relative: 1e-11, at_most: 40 };

fn every_integrator() -> Vec<Integrator> {
    let schemes =
        [Scheme::BackwardEuler, Scheme::AVERAGE_ACCELERATION, Scheme::Bdf2, Scheme::Newmark { beta: 0.36, gamma: 0.7 }];
    let mut ways = vec![FIXED, Integrator::QuasiStatic(QuasiStatic::default())];
    ways.push(Integrator::QuasiStatic(QuasiStatic { small_strain: true, ..QuasiStatic::default() }));
    for scheme in schemes {
        ways.push(thorough(scheme, Newton::Linearised, MatrixForm::Free));
        ways.push(thorough(scheme, FULL, MatrixForm::Assembled));
    }
    ways.push(thorough(Scheme::EnergyMomentum, FULL, MatrixForm::Free));
    ways
}

/// How a scene is told: turned, shifted, in other units.
#[derive(Clone, Copy)]
struct Telling {
    turn: Mat3<f64>,
    shift: Vector,
    /// Units of length in a metre.
    length: f64,
}

const PLAIN: Telling = Telling { turn: Mat3::IDENTITY, shift: Vector::ZERO, length: 1.0 };

impl Telling {
    fn place(&self, x: Vector) -> Vector {
        (self.turn * x + self.shift) * self.length
    }

    fn world<T: Precision>(&self, gravity: Vector, integrator: Integrator) -> World<T> {
        world((self.turn * gravity * self.length).to_array(), 4e-3, integrator)
    }

    /// A part of a beam along z, of soft tissue, from one cross-section to another [cells].
    fn part(&self, from: usize, to: usize) -> Body {
        let length = EDGE * (to - from) as f64;
        let mut mesh = TetMesh::box_grid([2, 2, to - from], [SIDE, SIDE, length]);
        let low = Vector::new(0.0, 0.0, EDGE * from as f64);
        mesh.nodes.iter_mut().for_each(|node| *node = self.place(*node + low));
        let law = StVenantKirchhoff::from_young_poisson(20e3 / self.length, 0.3).unwrap();
        let tissue = TotalLagrangian::new(Tissue::uniform(law));
        Body::new(mesh, 1000.0 / self.length.powi(3)).model(tissue).damping(2.0).name(format!("part from {from}"))
    }

    /// A beam that sticks out of a wall, in these parts, each grown to the one before.
    fn beam<T: Precision>(&self, cuts: &[usize], integrator: Integrator, shape: impl Fn(Body) -> Body) -> World<T> {
        let mut world = self.world(Vector::new(0.5, -3.0, 0.0), integrator);
        let mut before = None;
        for ends in cuts.windows(2) {
            let part = shape(self.part(ends[0], ends[1]));
            let part = if before.is_none() { part.fix(named("z-min")) } else { part };
            let id = world.add(part).unwrap();
            if let Some(to) = before.replace(id) {
                world.attach(Attachment { body: id, region: named("z-min"), to }).unwrap();
            }
        }
        world
    }
}

/// Where the nodes of all bodies are that lay at the same place at rest, against those of the first world [m]: the largest distance, and how far
/// the first world's nodes went.
fn difference<T: Precision>(whole: &World<T>, pieces: &World<T>) -> (f64, f64) {
    let all = |world: &World<T>| -> Vec<(Vector, Vector)> {
        let of_body = |id: BodyId| {
            let body = world.body(id);
            body.mesh().nodes().iter().copied().zip(body.positions().iter().map(|x| x.cast())).collect::<Vec<_>>()
        };
        world.body_ids().flat_map(of_body).collect()
    };
    let (whole, size) = (all(whole), whole.body(BodyId(0)).mesh().size());
    let (mut apart, mut way) = (0.0f64, 0.0f64);
    for (rest, place) in all(pieces) {
        let same = whole.iter().find(|(other, _)| (*other - rest).norm() < 1e-6 * size).unwrap();
        apart = apart.max((same.1 - place).norm());
        way = way.max((same.1 - same.0).norm());
    }
    (apart, way)
}

fn step<T: Precision>(world: &mut World<T>, steps: usize) {
    for number in 0..steps {
        world.step().unwrap_or_else(|error| panic!("step {number}: {error}"));
    }
}

/// A beam that was cut and grown together again at the nodes that it had there moves as if it had never been cut.
#[test]
fn a_beam_in_pieces_is_the_whole_beam() {
    for integrator in every_integrator() {
        for cuts in [&[0, 3, 6][..], &[0, 2, 3, 6]] {
            let mut whole = PLAIN.beam::<f64>(&[0, 6], integrator, |body| body);
            let mut pieces = PLAIN.beam::<f64>(cuts, integrator, |body| body);
            step(&mut whole, 20);
            step(&mut pieces, 20);
            let (apart, way) = difference(&whole, &pieces);
            assert!(way > 2e-3, "{integrator:?}: it bends by {way:.2e} m");
            assert!(apart < 1e-7 * way, "{integrator:?}, cut at {cuts:?}: {apart:.2e} m of {way:.2e} m");
        }
    }
}

/// The same with nodes that slide on a plane askew, whose mobilities differ by direction, and with damping of the stiffness that differs from
/// part to part only in how it is scaled.
#[test]
fn pieces_that_slide_are_the_whole_beam_that_slides() {
    let turn = Mat3::from_columns(Vector::new(0.6, 0.8, 0.0), Vector::new(-0.8, 0.6, 0.0), Vector::new(0.0, 0.0, 1.0));
    let askew = Telling { turn, shift: Vector::ZERO, length: 1.0 };
    let normal = (turn * Vector::new(1.0, 0.0, 0.0)).to_array();
    for integrator in [FIXED, thorough(Scheme::BackwardEuler, Newton::Linearised, MatrixForm::Free)] {
        let slides = |body: Body| {
            let body = body.slide(named("x-min"), normal);
            if integrator == FIXED { body } else { body.stiffness_damping(5e-3) }
        };
        let mut whole = askew.beam::<f64>(&[0, 6], integrator, slides);
        let mut pieces = askew.beam::<f64>(&[0, 2, 6], integrator, slides);
        step(&mut whole, 20);
        step(&mut pieces, 20);
        let (apart, way) = difference(&whole, &pieces);
        assert!(way > 1e-3 && apart < 1e-7 * way, "{integrator:?}: {apart:.2e} m of {way:.2e} m");
    }
}

/// Ties that say what others say already change nothing: each part grown to the other, and one of them twice.
#[test]
fn ties_that_say_the_same_count_once() {
    for integrator in every_integrator() {
        let mut once = PLAIN.beam::<f64>(&[0, 3, 6], integrator, |body| body);
        let mut again = PLAIN.beam::<f64>(&[0, 3, 6], integrator, |body| body);
        let [root, tip] = [BodyId(0), BodyId(1)];
        again.attach(Attachment { body: tip, region: named("z-min"), to: root }).unwrap();
        again.attach(Attachment { body: root, region: named("z-max"), to: tip }).unwrap();
        step(&mut once, 10);
        step(&mut again, 10);
        let (apart, way) = difference(&once, &again);
        assert!(apart < 1e-7 * way, "{integrator:?}: {apart:.2e} m of {way:.2e} m");
    }
}

/// A block of fine cells under one of coarse cells, whose meshes do not match, half a millimetre apart.
fn hanging(integrator: Integrator) -> (World<f64>, BodyId, AttachmentId) {
    let mut world = world::<f64>(GRAVITY, 5e-3, integrator);
    let above = block([2, 2, 2], [0.04, 0.03, 0.04], Vector::ZERO, 20e3).fix(named("y-max")).damping(30.0);
    let above = world.add(above.name("above")).unwrap();
    let low = Vector::new(0.003, -0.0305, 0.002);
    let below = block([3, 3, 3], [0.034, 0.03, 0.036], low, 20e3).damping(30.0).name("below");
    let below = world.add(below).unwrap();
    let id = world.attach(Attachment { body: below, region: named("y-max"), to: above }).unwrap();
    (world, below, id)
}

/// At rest an attachment pulls with the weight that hangs from it, in implicit steps and in equilibria. At small strain it does so but for what
/// the law makes of displacements that are those of the stiffness at rest, as for every other reaction.
#[test]
fn an_attachment_carries_the_weight_below() {
    for integrator in every_integrator() {
        let (steps, tolerance) = match integrator {
            // Neo-Hookean tissue has no mean forces.
            Integrator::Implicit(Implicit { scheme: Scheme::EnergyMomentum, .. }) => continue,
            Integrator::QuasiStatic(QuasiStatic { small_strain: true, .. }) => (1, 0.05),
            Integrator::QuasiStatic(_) => (1, 1e-8),
            _ => (300, 1e-2),
        };
        let (mut world, below, attachment) = hanging(integrator);
        step(&mut world, steps);
        let weight = Vector::from(GRAVITY) * world.observe(below).mass;
        let error = (world.attachment_force(attachment) + weight).norm() / weight.norm();
        assert!(error <= tolerance, "{integrator:?}: {error:.2e} of the weight is missing");
    }
}

/// Thrown and spinning, two bodies of meshes that do not match keep momentum, angular momentum and energy under the scheme that keeps them
/// for one.
#[test]
fn the_energy_momentum_scheme_keeps_for_two_what_it_keeps_for_one() {
    let integrator = thorough(Scheme::EnergyMomentum, FULL, MatrixForm::Free);
    let mut world = world::<f64>([0.0; 3], 5e-3, integrator);
    let law = || Tissue::uniform(StVenantKirchhoff::from_young_poisson(20e3, 0.3).unwrap());
    let body = |cells, size, low: Vector| {
        let mut mesh = TetMesh::box_grid(cells, size);
        mesh.nodes.iter_mut().for_each(|node| *node += low);
        Body::new(mesh, 1000.0).model(TotalLagrangian::new(law()))
    };
    let above = world.add(body([2, 2, 2], [0.04, 0.03, 0.04], Vector::ZERO)).unwrap();
    let below = world.add(body([3, 3, 3], [0.034, 0.03, 0.036], Vector::new(0.003, -0.0305, 0.002))).unwrap();
    world.attach(Attachment { body: below, region: named("y-max"), to: above }).unwrap();
    for id in [above, below] {
        world.body_mut(id).set_velocities(|x| Vector::new(0.3, -0.1, 0.2) + Vector::new(1.0, 2.0, 3.0).cross(x));
    }
    let sums = |world: &mut World<f64>| {
        let of = [above, below].map(|id| world.observe(id));
        let energy: f64 = of.iter().map(|own| own.kinetic_energy + own.elastic_energy).sum();
        (of[0].momentum + of[1].momentum, of[0].angular_momentum + of[1].angular_momentum, energy)
    };
    let (momentum, angular, energy) = sums(&mut world);
    step(&mut world, 40);
    let (momentum_after, angular_after, energy_after) = sums(&mut world);
    assert_vector(momentum_after, momentum, 1e-9);
    assert_vector(angular_after, angular, 1e-8);
    assert!((energy_after / energy - 1.0).abs() < 1e-8, "{energy} J, then {energy_after} J");
}

/// Metres or millimetres, upright or askew: the same motion.
#[test]
fn neither_units_nor_pose_change_what_is_tied() {
    let turn =
        Mat3::from_columns(Vector::new(0.36, 0.48, -0.8), Vector::new(-0.8, 0.6, 0.0), Vector::new(0.48, 0.64, 0.6));
    let others =
        [Telling { length: 1000.0, ..PLAIN }, Telling { turn, shift: Vector::new(0.3, -0.2, 0.1), length: 1.0 }];
    for integrator in
        [FIXED, thorough(Scheme::Bdf2, FULL, MatrixForm::Free), Integrator::QuasiStatic(QuasiStatic::default())]
    {
        for other in others {
            let mut plain = PLAIN.beam::<f64>(&[0, 2, 6], integrator, |body| body);
            let mut told = other.beam::<f64>(&[0, 2, 6], integrator, |body| body);
            step(&mut plain, 10);
            step(&mut told, 10);
            let tip = BodyId(1);
            let way = plain.body(tip).max_displacement();
            for (&x, &y) in plain.body(tip).positions().iter().zip(told.body(tip).positions()) {
                let apart = (other.place(x) - y).norm() / other.length;
                assert!(apart < 1e-6 * way, "{integrator:?}: {apart:.2e} m of {way:.2e} m");
            }
        }
    }
}

/// A snapshot put back goes on with the same bits, also where a cut has ended ties in between.
#[test]
fn snapshots_of_tied_bodies_go_on_with_the_same_bits() {
    for integrator in [FIXED, implicit(), Integrator::QuasiStatic(QuasiStatic::default())] {
        let (mut world, below, _) = hanging(integrator);
        step(&mut world, 5);
        let snapshot = world.read_snapshot(&world.snapshot().to_bytes()).unwrap();
        let go_on = |world: &mut World<f64>| {
            step(world, 3);
            world.body(below).positions().to_vec()
        };
        let first = go_on(&mut world);
        // A corner of the seam, so that a tie ends and the rest hold.
        world.remove_cells(below, &[36, 37, 38, 39, 40, 41]).unwrap();
        step(&mut world, 2);
        world.restore(&snapshot).unwrap();
        assert_eq!(go_on(&mut world), first, "{integrator:?}");
    }
}

/// In implicit steps too a cut through the tied cells parts the bodies.
#[test]
fn a_cut_along_the_seam_parts_bodies_in_implicit_steps() {
    let (mut world, below, attachment) = hanging(implicit());
    step(&mut world, 5);
    let nodes = world.body(below).mesh().nodes();
    let lies_above =
        |&cell: &u32| world.body(below).mesh().cell(cell as usize).iter().any(|&n| nodes[n as usize].y > -0.001);
    let cells: Vec<u32> = (0..world.body(below).mesh().cell_count() as u32).filter(lies_above).collect();
    world.remove_cells(below, &cells).unwrap();
    let before = world.observe(below);
    step(&mut world, 10);
    assert_eq!(world.attachment_force(attachment), Vector::ZERO);
    let fallen = (world.observe(below).momentum - before.momentum) / before.mass;
    // Ten steps of backward Euler against damping of 30/s: v ← (v + g Δt)/(1 + 0.15).
    let (mut speed, start) = (before.momentum.y / before.mass, before.momentum.y / before.mass);
    (0..10).for_each(|_| speed = (speed - 9.81 * 5e-3) / 1.15);
    assert!((fallen.y / (speed - start) - 1.0).abs() < 1e-6, "{fallen:?}");
}

/// Multigrid knows one body each.
#[test]
fn multigrid_is_refused() {
    let settings = Implicit { preconditioner: Preconditioning::Multigrid, ..Implicit::default() };
    let mut world = world::<f64>(GRAVITY, 5e-3, Integrator::Implicit(settings));
    let body = |low: f64, name: &str| block([1, 1, 1], [0.02; 3], Vector::new(0.0, low, 0.0), 1e4).name(name);
    let [a, b] = [world.add(body(0.0, "liver")).unwrap(), world.add(body(0.02, "stomach")).unwrap()];
    let refused = world.attach(Attachment { body: b, region: named("y-min"), to: a }).unwrap_err();
    assert_eq!(refused, WorldError::AttachmentNeedsBlockJacobi { body: "stomach".into(), to: "liver".into() });
}

/// A factorisation too, whichever comes first.
#[test]
fn factorisation_of_equilibria_is_refused() {
    let mut world = world::<f64>(GRAVITY, 5e-3, Integrator::QuasiStatic(QuasiStatic::default()));
    let body = |low: f64, name: &str| block([1, 1, 1], [0.02; 3], Vector::new(0.0, low, 0.0), 1e4).name(name);
    let [a, b] = [world.add(body(0.0, "liver")).unwrap(), world.add(body(0.02, "stomach")).unwrap()];
    let expected = WorldError::AttachmentNeedsIterative { body: "stomach".into(), to: "liver".into() };
    let attachment = Attachment { body: b, region: named("y-min"), to: a };
    world.set_static_solver(Box::new(Envelope::default())).unwrap();
    assert_eq!(world.attach(attachment.clone()).unwrap_err(), expected);
    world.set_static_solver(Box::new(Iterative::default())).unwrap();
    world.attach(attachment).unwrap();
    assert_eq!(world.set_static_solver(Box::new(Envelope::default())).unwrap_err(), expected);
    assert!(!world.static_solver().factorises());
}

/// What jaws hold at a tied node carries what hangs from the other body too.
#[test]
fn jaws_at_tied_nodes_carry_both_bodies() {
    for integrator in [FIXED, implicit()] {
        let mut world = world::<f64>(GRAVITY, 4e-3, integrator);
        let upper = block([2, 2, 2], [0.02; 3], Vector::ZERO, 40e3).damping(30.0).name("upper");
        let lower = block([2, 2, 2], [0.02; 3], Vector::new(0.0, -0.02, 0.0), 40e3).damping(30.0).name("lower");
        let [upper, lower] = [upper, lower].map(|body| world.add(body).unwrap());
        world.attach(Attachment { body: lower, region: named("y-max"), to: upper }).unwrap();
        let seam = Vector::new(0.01, 0.0, 0.01);
        let grasper = Grasper { path: still(seam), radius: 0.0105, close: 0.0, ..Grasper::default() };
        let tool = world.add_instrument(grasper).unwrap();
        step(&mut world, 300);
        let mass: f64 = [upper, lower].map(|id| world.observe(id).mass).iter().sum();
        assert_vector(world.tool(tool).holding_force, Vector::from(GRAVITY) * -mass, 1e-3);
    }
}

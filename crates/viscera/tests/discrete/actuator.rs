use viscera::body::{Actuator, ActuatorLine, Body, BodyError};
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Newton, Preconditioning, Scheme};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{LinearElastic, NeoHookean, Tissue};
use viscera::mesh::{HexMesh, Region, VolumeMesh};
use viscera::model::{Corotational, MassSpring, Precomputed, TotalLagrangian};
use viscera::solver::{Iterative, Stop};
use viscera::world::{BodyId, Integrator, World, WorldConfig, WorldError};

use crate::support::{DENSITY, Vector, bar, between, hex_bar, run, tissue, tumbling, world};

/// Cross-section of the bar [m²].
const AREA: f64 = 0.01;

fn region(name: &str) -> Region {
    Region::Named(name.into())
}

fn ramp(from: f64, to: f64) -> Curve<f64> {
    Curve::piecewise_linear(vec![(0.0, from), (1.0, to)]).unwrap()
}

/// From the lower end of a bar to the upper one.
fn spring(stiffness: f64, length: Curve<f64>, tension: Curve<f64>) -> Actuator {
    let line = ActuatorLine::Between { from: region("z-min"), to: region("z-max") };
    Actuator { line, stiffness, length, tension }
}

fn fibres(stiffness: f64, length: Curve<f64>, tension: Curve<f64>) -> Actuator {
    let line = ActuatorLine::Along { region: Region::All, direction: [0.0, 0.0, 2.0] };
    Actuator { line, stiffness, length, tension }
}

fn corner(world: &World<f64>, id: BodyId, place: [f64; 3]) -> Vector {
    let node = Region::nearest(place).nodes(world.body(id).mesh()).unwrap()[0];
    world.body(id).positions()[node as usize]
}

/// k (l − s L) + T between two nodes, of which one is led away at an angle: along the line between them, and equal at both ends.
#[test]
fn between_two_nodes_it_pulls_as_a_spring_does() {
    let (near, far) = (Region::nearest([0.0; 3]), Region::nearest([0.1, 0.1, 0.3]));
    let way = Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (1.0, Vector::new(0.05, -0.1, 0.1))]).unwrap();
    let actuator = Actuator {
        line: ActuatorLine::Between { from: near.clone(), to: far.clone() },
        stiffness: 30.0,
        length: ramp(1.0, 0.6),
        tension: ramp(0.0, 2.0),
    };
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).actuator(actuator);
    let (mut world, id) = world::<f64>([0.0; 3], body.fix(between(0.0, 0.25)).prescribe(region("z-max"), way));
    let rest = Vector::new(0.1, 0.1, 0.3).norm();
    let ends = [near, far].map(|end| end.nodes(world.body(id).mesh()).unwrap()[0] as usize);
    for time in [0.25, 0.5, 1.0] {
        let left = time - world.time();
        run(&mut world, left);
        let line = world.body(id).positions()[ends[1]] - world.body(id).positions()[ends[0]];
        let (length, share) = (line.norm(), 1.0 - 0.4 * time);
        let pull = line / length * (30.0 * (length - share * rest) + 2.0 * time);
        let forces = world.external_forces(id);
        assert!((forces[ends[0]] - pull).norm() < 1e-12 * pull.norm(), "{:?}, not {pull:?}", forces[ends[0]]);
        assert!((forces[ends[1]] + pull).norm() < 1e-12 * pull.norm());
        assert!(forces.iter().enumerate().all(|(node, force)| ends.contains(&node) || force.norm() == 0.0));
    }
}

/// Two rigid blocks of masses m and M, joined by next to nothing but an actuator, vibrate at ω² = k/m + k/M; the time between the first
/// and the third passage through rest is a period.
#[test]
fn it_swings_two_blocks_at_the_frequency_of_a_spring() {
    let soft = Tissue::uniform(LinearElastic::from_young_poisson(1e-6, 0.0).unwrap());
    // Of hexahedra, so that the mean place of each side's nodes is its centre of mass, and nothing turns.
    let mesh = HexMesh::box_grid([2, 2, 1], [0.1, 0.1, 0.1]);
    let stiffness = 200.0;
    let body = Body::new(mesh, 1000.0)
        .model(Corotational::new(soft))
        .rigid(region("z-min"))
        .rigid(region("z-max"))
        .actuator(spring(stiffness, Curve::constant(1.0), Curve::constant(0.0)));
    let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: 1e-3, ..WorldConfig::default() }).unwrap();
    let id = world.add(body).unwrap();
    world.body_mut(id).set_velocities(|x| Vector::new(0.0, 0.0, if x.z > 0.05 { 0.1 } else { -0.1 }));
    let mut passages = Vec::new();
    let mut before = 0.0;
    while passages.len() < 3 {
        world.step().unwrap();
        let heights = [0.1, 0.0].map(|height| corner(&world, id, [0.0, 0.0, height]).z);
        let stretch = heights[0] - heights[1] - 0.1;
        if before * stretch < 0.0 || passages.is_empty() {
            passages.push(world.time() - if before == 0.0 { 1e-3 } else { 1e-3 * stretch / (stretch - before) });
        }
        before = stretch;
    }
    let body = world.body(id);
    let upper = |node: usize| body.mesh().nodes()[node].z > 0.05;
    let mass = |of: bool| {
        body.state().masses.iter().enumerate().filter(|pair| upper(pair.0) == of).map(|pair| pair.1).sum::<f64>()
    };
    let period = std::f64::consts::TAU / (stiffness / mass(true) + stiffness / mass(false)).sqrt();
    let measured = passages[2] - passages[0];
    assert!((measured / period - 1.0).abs() < 2e-3, "{measured} s, not {period} s");
}

/// Held where they are, fibres pull at what is on either side of a cut with their stress times its area, in tetrahedra and in
/// hexahedra.
#[test]
fn isometric_fibres_pull_with_their_stress_times_the_area() {
    for mesh in [VolumeMesh::from(bar()), hex_bar().into()] {
        let actuator = fibres(3e3, ramp(1.0, 0.8), ramp(0.0, 500.0));
        let body = Body::new(mesh, DENSITY).model(Corotational::new(tissue())).actuator(actuator).fix(Region::All);
        let (mut world, id) = world::<f64>([0.0; 3], body);
        for time in [0.5, 1.0] {
            run(&mut world, 0.5);
            let expected = AREA * (3e3 * 0.2 + 500.0) * time;
            let forces = world.external_forces(id).to_vec();
            let nodes = world.body(id).mesh().nodes();
            let above =
                forces.iter().zip(nodes).filter(|(_, x)| x.z > 0.16).fold(Vector::ZERO, |sum, pair| sum + *pair.0);
            assert!((above.z + expected).abs() < 1e-12 * expected, "{} N, not {expected} N", -above.z);
            assert!(above.x.abs() + above.y.abs() < 1e-12 * expected);
        }
    }
}

/// Tissue of Young's modulus E and Poisson's ratio 0 with fibres of their own E_a, slack at s and pulling with T besides, is at rest at
/// the stretch (E + E_a s − T)/(E + E_a); so says every integrator.
#[test]
fn active_tissue_shortens_to_where_its_stresses_balance() {
    let stretch = (10e3 + 4e3 * 0.7 - 1e3) / (10e3 + 4e3);
    let law = LinearElastic::from_young_poisson(10e3, 0.0).unwrap();
    let accurate = Implicit {
        newton: Newton::Full { relative: 1e-9, at_most: 40 },
        linear: Stop::Tolerance { relative: 1e-11, at_most: 2000 },
        ..Implicit::default()
    };
    let integrators = [
        Integrator::default(),
        Integrator::Implicit(accurate),
        Integrator::Implicit(Implicit { matrix: MatrixForm::Assembled, ..accurate }),
        Integrator::Implicit(Implicit { preconditioner: Preconditioning::Multigrid, ..accurate }),
        Integrator::QuasiStatic(QuasiStatic::default()),
    ];
    for mesh in [VolumeMesh::from(bar()), hex_bar().into()] {
        for integrator in integrators {
            let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: 0.02, integrator }).unwrap();
            let damping = if matches!(integrator, Integrator::QuasiStatic(_)) { 0.0 } else { 7.0 };
            let body = Body::new(mesh.clone(), DENSITY)
                .model(Corotational::new(Tissue::uniform(law)))
                .damping(damping)
                .fix(region("z-min"))
                .actuator(fibres(4e3, ramp(1.0, 0.7), ramp(0.0, 1e3)));
            let id = world.add(body).unwrap();
            run(&mut world, 6.0);
            let length = corner(&world, id, [0.1, 0.1, 0.3]).z / 0.3;
            assert!((length - stretch).abs() < 1e-6, "{length} of its length, not {stretch}: {integrator:?}");
        }
    }
}

fn active(mesh: impl Into<VolumeMesh>) -> Body {
    let law = NeoHookean::from_young_poisson(5e3, 0.3).unwrap();
    Body::new(mesh, DENSITY)
        .model(TotalLagrangian::new(Tissue::uniform(law)))
        .actuator(fibres(2e3, ramp(1.0, 0.8), ramp(0.0, 300.0)))
        .actuator(spring(60.0, ramp(1.0, 0.5), Curve::constant(3.0)))
}

/// What pulls at one end pulls at the other, along the line between them.
#[test]
fn an_active_body_keeps_momentum_and_angular_momentum() {
    let (mut world, id) = world::<f64>([0.0; 3], active(bar()));
    world.body_mut(id).set_velocities(tumbling);
    let start = world.observe(id);
    run(&mut world, 0.6);
    let seen = world.observe(id);
    assert!(seen.elastic_energy > 1e-2, "{} J", seen.elastic_energy);
    assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
    assert!((seen.angular_momentum - start.angular_momentum).norm() < 1e-11 * start.angular_momentum.norm());

    for mesh in [VolumeMesh::from(bar()), hex_bar().into()] {
        let (mut world, id) = self::world::<f64>([0.0; 3], active(mesh));
        world.body_mut(id).set_positions(wrung);
        let forces = world.external_forces(id).to_vec();
        let places = world.body(id).positions();
        let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let net = forces.iter().fold(Vector::ZERO, |sum, &force| sum + force);
        let torque = forces.iter().zip(places).fold(Vector::ZERO, |sum, (&force, x)| sum + x.cross(force));
        assert!(largest > 0.1 && net.norm() < 1e-13 * largest && torque.norm() < 1e-13 * largest);
    }
}

/// Bent and twisted by some centimetres.
fn wrung(x: Vector) -> Vector {
    let angle = 1.5 * x.z;
    let (sin, cos) = angle.sin_cos();
    Vector::new(cos * x.x - sin * x.y + 2.0 * x.z * x.z, sin * x.x + cos * x.y, 1.1 * x.z + 0.1 * x.x * x.z)
}

/// (K + αM) u = f for the answer u to forces f: the change of all forces over ± h u, h small, and αM u are f. The law's tangent is exact, so what
/// differs would be that of the actuators.
#[test]
fn the_tangent_is_the_derivative_of_the_forces() {
    // Enough for a wrung bar to be held where it is [1/s²], and a tenth of the stiffness.
    const INERTIA: f64 = 3e3;
    for mesh in [VolumeMesh::from(bar()), hex_bar().into()] {
        let (mut world, id) = world::<f64>([0.0; 3], active(mesh).fix(region("z-min")));
        world.body_mut(id).set_positions(wrung);
        let wanted: Vec<_> = (0..world.body(id).positions().len())
            .map(|node| Vector::new((node as f64).sin(), (2.3 * node as f64).cos(), (0.7 * node as f64).sin()))
            .collect();
        let answer =
            world.respond(id, std::slice::from_ref(&wanted), INERTIA, &mut Iterative::new(1e-13)).unwrap().remove(0);
        let held = region("z-min").nodes(world.body(id).mesh()).unwrap();
        let rest = world.body(id).mesh().nodes().to_vec();
        let masses = world.body(id).state().masses.clone();
        let mut forces = |share: f64| {
            let now = world.body(id).positions().to_vec();
            let number = |x: Vector| now.iter().position(|&place| place == x).unwrap();
            world.body_mut(id).set_positions(|x| wrung(rest[number(x)]) + answer[number(x)] * share);
            let external = world.external_forces(id).to_vec();
            let internal = &world.body(id).state().internal_forces;
            internal.iter().zip(&external).map(|(&f, &r)| f - r).collect::<Vec<_>>()
        };
        let h = 2e-5 / answer.iter().map(|u| u.norm()).fold(0.0, f64::max);
        let (after, before) = (forces(h), forces(-h));
        for node in (0..wanted.len()).filter(|&node| !held.contains(&(node as u32))) {
            let inertial = answer[node] * (INERTIA * masses[node]);
            let change = (after[node] - before[node]) / (2.0 * h) + inertial;
            assert!((change - wanted[node]).norm() < 1e-5, "node {node}: {change:?}, not {:?}", wanted[node]);
        }
    }
}

/// The stiffness of actuators is in the matrix of an implicit step: Newton's method takes few iterations, and all forms of the matrix and
/// its preconditioner come to the same.
#[test]
fn implicit_steps_know_the_stiffness_of_actuators() {
    let settings = Implicit {
        scheme: Scheme::BackwardEuler,
        newton: Newton::Full { relative: 1e-10, at_most: 30 },
        linear: Stop::Tolerance { relative: 1e-12, at_most: 3000 },
        ..Implicit::default()
    };
    let forms = [
        settings,
        Implicit { matrix: MatrixForm::Assembled, ..settings },
        Implicit { preconditioner: Preconditioning::Multigrid, ..settings },
    ];
    let shapes = forms.map(|settings| {
        let integrator = Integrator::Implicit(settings);
        let mut world = World::<f64>::new(WorldConfig { gravity: [0.0; 3], step: 0.02, integrator }).unwrap();
        let law = NeoHookean::from_young_poisson(5e3, 0.3).unwrap();
        // Forty times as stiff as the bar is along itself, and pulled together by a third within a step.
        let body = Body::new(bar(), DENSITY)
            .model(TotalLagrangian::new(Tissue::uniform(law)))
            .fix(region("z-min"))
            .actuator(spring(6e3, Curve::constant(0.9), Curve::constant(0.0)));
        let id = world.add(body).unwrap();
        for _ in 0..5 {
            let report = world.step().unwrap().implicit.unwrap();
            assert!(report.converged && report.newton_iterations <= 8, "{report:?}");
        }
        world.body(id).positions().to_vec()
    });
    for other in &shapes[1..] {
        let apart = shapes[0].iter().zip(other).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1e-8, "{apart} m apart");
    }
}

/// A commanded pull of a tonne by weak fibres is bounded in an explicit step, and single precision takes the same way.
#[test]
fn explicit_steps_are_as_short_as_actuators_are_stiff() {
    let stable = |stiffness: f64| {
        let body = Body::new(bar(), DENSITY).model(MassSpring::new(tissue()));
        let actuator = spring(stiffness, Curve::constant(1.0), Curve::constant(0.0));
        let (world, id) = world::<f64>([0.0; 3], body.actuator(actuator));
        world.body(id).stable_step()
    };
    // ω² = 2 k/(n m) of n nodes of mass m at each end, n m a twelfth of 3 kg on the average, m half of that in the lightest corner.
    let expected = 2.0 / (2.0 * 1e9 / 0.25_f64).sqrt();
    let ratio = stable(1e9) / expected;
    assert!((0.4..=1.01).contains(&ratio), "{ratio} of what the spring alone asks for");

    let (mut double, a) = world::<f64>([0.0; 3], active(bar()).fix(region("z-min")).damping(5.0));
    let (mut single, b) = world::<f32>([0.0; 3], active(bar()).fix(region("z-min")).damping(5.0));
    run(&mut double, 0.5);
    run(&mut single, 0.5);
    let pairs = double.body(a).positions().iter().zip(single.body(b).positions());
    let apart = pairs.map(|(&x, &y)| (x - y.cast()).norm()).fold(0.0, f64::max);
    assert!(apart < 2e-5 && double.observe(a).max_displacement > 0.02, "{apart} m apart");
}

/// An actuator whose end is cut away pulls no more; a snapshot from before has it back.
#[test]
fn an_actuator_goes_with_what_it_pulls_at() {
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).fix(between(0.0, 0.1));
    let (mut world, id) =
        world::<f64>([0.0; 3], body.actuator(spring(0.0, Curve::constant(1.0), Curve::constant(4.0))));
    let before = world.snapshot();
    let pull = |world: &mut World<f64>| world.external_forces(id).iter().map(|force| force.norm()).sum::<f64>();
    assert!((pull(&mut world) - 8.0).abs() < 1e-12);
    // Of a part of the end, the rest pulls with all of it.
    let cells = between(0.25, 0.3).cells(world.body(id).mesh()).unwrap();
    let (some, others) = cells.split_at(cells.len() / 2);
    world.remove_cells(id, some).unwrap();
    assert!((pull(&mut world) - 8.0).abs() < 1e-12);
    world.remove_cells(id, others).unwrap();
    assert_eq!(pull(&mut world), 0.0);
    world.restore(&before).unwrap();
    assert!((pull(&mut world) - 8.0).abs() < 1e-12);
}

#[test]
fn actuators_out_of_range_are_refused() {
    let refusal = |actuator: Actuator| {
        let body = Body::new(bar(), DENSITY).name("bar").model(MassSpring::new(tissue()));
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        world.add(body.actuator(actuator)).unwrap_err().to_string()
    };
    let one = || Curve::constant(1.0);
    assert_eq!(
        refusal(spring(-1.0, one(), one())),
        "body `bar`: actuator stiffness = -1 is out of range: it must be zero or positive [N/m]"
    );
    assert_eq!(
        refusal(fibres(0.0, Curve::constant(-0.1), one())),
        "body `bar`: active fibre length = -0.1 is out of range: it must be zero or positive, a share of the length at rest"
    );
    let line = ActuatorLine::Between { from: region("z-min"), to: region("z-min") };
    let message = refusal(Actuator { line, ..spring(1.0, one(), one()) });
    assert!(message.contains("its two ends lie in one place"), "{message}");
    let line = ActuatorLine::Along { region: Region::All, direction: [0.0; 3] };
    let message = refusal(Actuator { line, ..fibres(1.0, one(), one()) });
    assert!(message.contains("active fibre direction") && message.contains("a vector with a length"), "{message}");

    let linear = Body::new(bar(), DENSITY).model(Precomputed::new(tissue())).fix(region("z-min"));
    let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
    let error = world.add(linear.actuator(spring(1.0, one(), one()))).unwrap_err();
    assert!(matches!(error, WorldError::Body(BodyError::LinearModel { .. })), "{error}");
}

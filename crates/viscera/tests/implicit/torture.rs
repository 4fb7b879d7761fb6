//! Steps out of shapes that no step should meet.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::material::{Lame, LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, TransverseLinear};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::corotational::Tangent;
use viscera::model::{Corotational, ModelKind, ModelRecipe, NodallyIntegrated, StiffnessWarping, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{BodyId, StepError, World};

use super::support::*;

/// A cube of 10 cm and two layers of cells, held at the bottom, damped near critically.
fn cube(mesh: impl Into<VolumeMesh>, model: impl ModelRecipe + 'static, settings: Implicit) -> (World<f64>, BodyId) {
    let body = Body::new(mesh, 1000.0).model(model).damping(50.0).fix(root());
    let settings = Implicit { linear: Stop::Tolerance { relative: 1e-6, at_most: 100 }, ..settings };
    implicit_world(NO_GRAVITY, 2e-2, settings, body)
}

fn tetrahedra() -> TetMesh {
    TetMesh::box_grid([1, 1, 2], [0.1; 3])
}

fn neo_hookean() -> viscera::material::Tissue {
    uniform(NeoHookean::from_young_poisson(10e3, 0.4).unwrap())
}

fn energy(world: &mut World<f64>, id: BodyId) -> f64 {
    let seen = world.observe(id);
    seen.kinetic_energy + seen.elastic_energy
}

/// A corner pushed out through the bottom comes back in full steps of turned tissue, whose tangent is the linear one. A line
/// search that never went farther than the correction did not balance the first step in 100 iterations.
#[test]
fn a_corner_pushed_through_the_opposite_side_comes_back() {
    let settings =
        Implicit { newton: Newton::Full { relative: 1e-8, at_most: 100 }, ..Implicit::accurate(Scheme::BackwardEuler) };
    let (mut world, id) = cube(tetrahedra(), Corotational::new(linear_tissue()), settings);
    let corner = Vector::splat(0.1);
    world.body_mut(id).set_positions(|x| if x == corner { Vector::new(x.x, x.y, -0.05) } else { x });
    let start = energy(&mut world, id);
    let mut before = start;
    for _ in 0..60 {
        world.step().unwrap();
        let now = energy(&mut world, id);
        // Newton's residual of 1e-8, squared, is what an energy near its minimum feels of it.
        assert!(now <= before + 1e-16 * start, "{now} J after {before} J");
        before = now;
    }
    let away = world.body(id).max_displacement();
    assert!(away < 1e-6 * 0.17, "{away} m");
}

/// From a thousand times the length the equations of a whole step were not solved, and none after it: in parts they are, and gain no energy.
#[test]
fn a_step_that_is_not_solved_whole_is_made_in_parts() {
    let settings =
        Implicit { newton: Newton::Full { relative: 1e-8, at_most: 30 }, ..Implicit::accurate(Scheme::BackwardEuler) };
    let stable = uniform(StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap());
    let (mut world, id) = cube(tetrahedra(), TotalLagrangian::new(stable), settings);
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    let start = energy(&mut world, id);
    let (mut before, mut again) = (start, 0);
    for _ in 0..60 {
        let report = world.step().unwrap();
        assert_eq!(report.substeps, 1 << report.retries);
        again += report.retries;
        let now = energy(&mut world, id);
        assert!(now <= before + 1e-16 * start, "{now} J after {before} J");
        before = now;
    }
    assert!(again > 0 && world.body(id).max_displacement() < 1e-5, "{}", world.body(id).max_displacement());
}

/// Full steps of a cube that nothing holds, turned inside out or let go at a thousand times its length: the forces alone led Newton's method
/// about for 100 iterations, in 64 parts of the step as well. Along directions in which the potential falls it arrives: of corotational tissue
/// so long on creases of its energy, where no forces balance.
#[test]
fn full_steps_out_of_impossible_shapes_are_solved() {
    let settings =
        Implicit { newton: Newton::Full { relative: 1e-8, at_most: 100 }, ..Implicit::accurate(Scheme::BackwardEuler) };
    let settings = Implicit { linear: Stop::Tolerance { relative: 1e-6, at_most: 100 }, ..settings };
    let turned = Corotational::new(linear_tissue()).tangent(Tangent::Exact);
    let turned = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).model(turned);
    let direct = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).model(TotalLagrangian::new(neo_hookean()));
    let held = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).model(Corotational::new(linear_tissue()));
    for (body, stretch) in [(turned, -1.0), (direct, 1000.0), (held, 1000.0)] {
        let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, settings, body.damping(50.0));
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, stretch * x.z));
        let mut before = energy(&mut world, id);
        for _ in 0..3 {
            world.step().unwrap();
            let now = energy(&mut world, id);
            assert!(now < before, "{now} J after {before} J, from {stretch} times the length");
            before = now;
        }
    }
}

/// Tissue whose rotations are held in products, fallen together under ten times its modulus in one step: after 100 iterations the forces still
/// did not balance, in 64 parts as well. With the derivative itself they do after 40.
#[test]
fn full_steps_of_tissue_that_falls_together_are_solved() {
    let soft = uniform(LinearElastic::from_young_poisson(100.0, 0.4999).unwrap());
    let body = Body::new(tetrahedra(), 1000.0).model(Corotational::new(soft)).fix(root());
    let newton = Newton::Full { relative: 1e-8, at_most: 100 };
    let linear = Stop::Tolerance { relative: 1e-6, at_most: 100 };
    let settings = Implicit { newton, linear, ..Implicit::default() };
    let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 1.0, settings, body);
    let mut before = world.observe(id).gravity_energy;
    for _ in 0..4 {
        let report = world.step().unwrap();
        assert!(report.retries == 0 && report.implicit.unwrap().residual < 1e-8, "{report:?}");
        let seen = world.observe(id);
        let now = seen.kinetic_energy + seen.elastic_energy + seen.gravity_energy;
        assert!(now < before, "{now} J after {before} J");
        before = now;
    }
}

/// Linearised backward Euler gains no energy from tissue integrated at the nodes and let go at a thousand times its length. It
/// rose to 6000 times the energy at the start where linear solves that had climbed were taken.
#[test]
fn linearised_steps_from_a_thousand_times_the_length_gain_no_energy() {
    let (mut world, id) = cube(tetrahedra(), NodallyIntegrated::new(neo_hookean()), Implicit::default());
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    let start = energy(&mut world, id);
    for _ in 0..60 {
        world.step().unwrap();
        let now = energy(&mut world, id);
        assert!(now <= start, "{now} J from {start} J");
    }
    assert!(energy(&mut world, id) < 1e-3 * start);
}

/// Where a linearised step goes astray and its full equations have no solution near by either, it is made again in parts, and gains no
/// energy: plain neo-Hookean tissue, let go at a thousand times its length, rose to 1e14 times the energy at the start. One length of ten needs
/// parts; which, rounding decides.
#[test]
fn steps_that_throw_tissue_across_a_hump_are_made_in_parts() {
    let mut again = 0;
    for length in (0..60).map(|number| 100.0 * 1.06_f64.powi(number)) {
        let mesh = TetMesh::box_grid([2; 3], [0.1; 3]);
        let body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(neo_hookean())).damping(50.0);
        let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, Implicit::default(), body);
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, length * x.z));
        let start = energy(&mut world, id);
        for _ in 0..100 {
            again += world.step().unwrap().retries;
            let now = energy(&mut world, id);
            assert!(now <= start, "{now} J from {start} J");
        }
    }
    assert!(again > 0);
}

/// A corner let go from a thousand sizes behind the other side, or more, in steps of 20 s: where rounding willed it, in one case of twenty, the
/// solution that was found gained energy, in 64 parts too, and the step was undone. With shorter parts to begin with none is for that. (One in fifteen is not
/// solved, and undone.)
#[test]
fn full_steps_that_gain_energy_in_equal_parts_begin_with_shorter_ones() {
    let newton = Newton::Full { relative: 1e-4, at_most: 200 };
    let settings = Implicit {
        newton,
        linear: Stop::Tolerance { relative: 1e-6, at_most: 100 },
        ..Implicit::accurate(Scheme::BackwardEuler)
    };
    let (mut shorter, mut unsolved) = (0, 0);
    for depth in (0..120).map(|number| 100.0 * 1.02_f64.powi(number)) {
        let body = Body::new(tetrahedra(), 1000.0).model(TotalLagrangian::new(neo_hookean())).damping(50.0).fix(root());
        let (mut world, id) = implicit_world(NO_GRAVITY, 20.0, settings, body);
        let corner = Vector::splat(0.1);
        world.body_mut(id).set_positions(|x| if x == corner { Vector::new(x.x, x.y, -depth) } else { x });
        let mut start = energy(&mut world, id);
        let rounding = f64::EPSILON * start;
        for _ in 0..6 {
            let before = world.body(id).positions().to_vec();
            match world.step() {
                Ok(report) => shorter += u32::from(report.retries > 6),
                Err(StepError::NotConverged { .. }) => {
                    assert_eq!(world.body(id).positions(), &before[..]);
                    unsolved += 1;
                    break;
                }
                Err(error) => panic!("{error}"),
            }
            let now = energy(&mut world, id);
            assert!(now <= start + rounding, "{now} J after {start} J");
            start = now;
        }
    }
    assert!(shorter > 0 && unsolved <= 12, "{shorter} with shorter parts, {unsolved} unsolved");
}

/// Corotational hexahedra of 100 Pa that fall together under ten times that, in steps of a second: their forces have no potential, and all that is found
/// gains energy. Such a step is undone, and says what bears it.
#[test]
fn a_full_step_that_gains_energy_however_it_is_made_is_undone() {
    let settings = Implicit {
        newton: Newton::Full { relative: 1e-8, at_most: 100 },
        linear: Stop::Tolerance { relative: 1e-6, at_most: 100 },
        ..Implicit::accurate(Scheme::BackwardEuler)
    };
    let run = |settings: Implicit| {
        let soft = uniform(LinearElastic::from_young_poisson(100.0, 0.45).unwrap());
        let mesh = HexMesh::box_grid([1, 1, 2], [0.1; 3]);
        let body = Body::new(mesh, 1000.0).model(Corotational::new(soft)).fix(root());
        let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 1.0, settings, body);
        (0..4).find_map(|_| {
            let before = world.body(id).positions().to_vec();
            let error = world.step().err()?;
            assert_eq!(world.body(id).positions(), &before[..]);
            Some(error)
        })
    };
    let error = run(settings).expect("one of the steps gains energy");
    assert!(matches!(error, StepError::GainedEnergy { advice: "the linearised one", .. }), "{error}");
    assert_eq!(run(Implicit { newton: Newton::Linearised, ..settings }), None);
}

/// In the last attempts no iteration climbs, and linear solves have four times as many iterations. Let go at a thousand times its length, free tissue
/// integrated at the nodes gained energy in 64 parts too and was undone in the first step; at a little more, it did with those iterations as well, and
/// comes back by parts that are shorter to begin with.
#[test]
fn the_last_attempts_find_what_others_do_not() {
    let newton = Newton::Full { relative: 1e-8, at_most: 100 };
    let linear = Stop::Tolerance { relative: 1e-6, at_most: 100 };
    let settings = Implicit { newton, linear, ..Implicit::accurate(Scheme::BackwardEuler) };
    let [mut last, mut shorter] = [0; 2];
    for percent in 0..8 {
        let stable = uniform(StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap());
        let body = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).model(NodallyIntegrated::new(stable));
        let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, settings, body.damping(50.0));
        let stretch = 1000.0 + 10.0 * f64::from(percent);
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, stretch * x.z));
        let start = energy(&mut world, id);
        let mut before = start;
        for _ in 0..30 {
            let retries = world.step().unwrap().retries;
            (last, shorter) = (last + u32::from(retries == 6), shorter + u32::from(retries > 6));
            let now = energy(&mut world, id);
            assert!(now <= before, "{now} J after {before} J");
            before = now;
        }
        assert!(before < 1e-6 * start, "{before} J are left of {start} J, stretched {stretch} times");
    }
    assert!(last > 0 && shorter > 0, "{last} steps in 64 parts, {shorter} in more");
}

/// With 8e-7 of their forces left after 400 iterations of Newton's method whose linear solves ended after 100, hexahedra of neo-Hookean tissue were undone
/// in the ninth step.
#[test]
fn full_steps_of_hexahedra_from_a_thousand_times_the_length_are_solved() {
    let newton = Newton::Full { relative: 1e-8, at_most: 100 };
    let linear = Stop::Tolerance { relative: 1e-6, at_most: 100 };
    let settings = Implicit { newton, linear, ..Implicit::accurate(Scheme::BackwardEuler) };
    let body = Body::new(HexMesh::box_grid([2; 3], [0.1; 3]), 1000.0).model(TotalLagrangian::new(neo_hookean()));
    let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, settings, body.damping(50.0).fix(root()));
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    let mut before = energy(&mut world, id);
    for _ in 0..30 {
        world.step().unwrap();
        let now = energy(&mut world, id);
        assert!(now <= before, "{now} J after {before} J");
        before = now;
    }
}

/// Forces that are not the gradient of an energy gain some of what is called so in any step: full steps of warped stiffness were taken for
/// failures and undone, the fourth of these at a stretch of 1.0002.
#[test]
fn full_steps_without_a_potential_are_made() {
    let body = Body::new(tetrahedra(), 1000.0)
        .model(StiffnessWarping::new(uniform(LinearElastic::from_young_poisson(1e6, 0.4999).unwrap())))
        .fix(root());
    let newton = Newton::Full { relative: 1e-8, at_most: 100 };
    let settings = Implicit { newton, ..Implicit::accurate(Scheme::BackwardEuler) };
    let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 1e-2, settings, body);
    for _ in 0..10 {
        world.step().unwrap();
    }
    assert!(world.observe(id).gravity_energy < 0.4904, "it sinks");
}

/// Where forces without a potential jump, full equations may have no solution in the shortest parts either: corotational hexahedra, let go at a
/// thousand times their length, were undone in the first step. Those parts are linearised now and say that they have not converged; the cube
/// goes on, and gains no energy.
#[test]
fn full_steps_that_have_no_solution_are_linearised() {
    let newton = Newton::Full { relative: 1e-8, at_most: 10 };
    let settings = Implicit { newton, ..Implicit::accurate(Scheme::BackwardEuler) };
    let (mut world, id) = cube(HexMesh::box_grid([1, 1, 2], [0.1; 3]), Corotational::new(linear_tissue()), settings);
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    let start = energy(&mut world, id);
    let (mut before, mut unsolved) = (start, 0);
    for _ in 0..60 {
        let report = world.step().unwrap();
        let solver = report.implicit.unwrap();
        assert!(solver.converged || (report.retries == 6 && solver.residual > 1e-8), "{report:?}");
        unsolved += usize::from(!solver.converged);
        let now = energy(&mut world, id);
        assert!(now <= before + 1e-6 * start, "{now} J after {before} J");
        before = now;
    }
    assert!(unsolved > 0 && before < 1e-6 * start, "{unsolved} steps, {before} J from {start} J");
}

/// What a scheme without a bound gains of forces without a potential, again and again, keeps tissue moving: fibred corotational hexahedra, let
/// go by Newmark's method out of one point or turned inside out, still moved after a minute. Steps that gain much are made in parts, and it
/// comes to rest within four seconds.
#[test]
fn full_steps_that_gain_much_without_a_potential_are_made_in_parts() {
    let matrix = Lame::from_young_poisson(10e3, 0.4).unwrap();
    let fibres = Lame { mu: matrix.mu + 5e3, ..matrix };
    let tissue = uniform(TransverseLinear::new(matrix, [2.0, 3.0, 6.0], fibres).unwrap());
    let newton = Newton::Full { relative: 1e-8, at_most: 100 };
    let settings = Implicit { newton, ..Implicit::accurate(Scheme::AVERAGE_ACCELERATION) };
    let shapes: [fn(Vector) -> Vector; 2] = [|_| Vector::splat(0.05), |x| Vector::new(x.x, x.y, -x.z)];
    for (number, shape) in shapes.into_iter().enumerate() {
        let mesh = HexMesh::box_grid([2, 2, 2], [0.1; 3]);
        let (mut world, id) = cube(mesh, Corotational::new(tissue.clone()), settings);
        world.body_mut(id).set_positions(shape);
        for _ in 0..200 {
            world.step().unwrap();
        }
        let away = world.body(id).max_displacement();
        assert!(away < 1e-7, "shape {number}: {away} m");
    }
}

/// Newmark's method has no bound. Linearised steps that gain nine times the energy of before in the shortest parts too, all together, are undone and
/// say so: plain neo-Hookean tissue, let go at a thousand times its length or more, went on until nodes were thrown a million sizes away, one of
/// twenty held cubes after a step to 41 times its energy.
#[test]
fn a_linearised_step_that_gains_many_times_its_energy_is_undone() {
    let settings = Implicit { scheme: Scheme::AVERAGE_ACCELERATION, ..Implicit::default() };
    let mut said = 0;
    for length in (0..20).map(|number| 1000.0 * 1.05_f64.powi(number)) {
        let mesh = TetMesh::box_grid([2; 3], [0.1; 3]);
        let body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(neo_hookean())).damping(50.0);
        let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, settings, body);
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, length * x.z));
        for _ in 0..60 {
            let (start, places) = (energy(&mut world, id), world.body(id).positions().to_vec());
            let Err(error) = world.step() else {
                let now = energy(&mut world, id);
                assert!(now <= 10.0 * start, "{now} J after {start} J");
                continue;
            };
            assert!(matches!(error, StepError::GainedEnergy { .. }), "{error}");
            assert!(error.to_string().contains("or backward Euler"), "{error}");
            assert_eq!(world.body(id).positions(), &places[..]);
            said += 1;
            break;
        }
    }
    assert!(said > 0);
}

/// What rounding makes of energies is that of the softest place on the way of a step, not of the stiffest: a hybrid body of neo-Hookean
/// tissue, let go at a thousand times its length, came to 1e26 times its energy in the first step.
#[test]
fn rounding_excuses_no_gain() {
    let settings = Implicit { scheme: Scheme::AVERAGE_ACCELERATION, ..Implicit::default() };
    let linear = Stop::Tolerance { relative: 1e-6, at_most: 100 };
    let recipe = ModelKind::Hybrid.recipe(neo_hookean());
    let body = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).boxed_model(recipe).damping(50.0);
    let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, Implicit { linear, ..settings }, body);
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    let start = energy(&mut world, id);
    let made = world.step().is_ok();
    let now = energy(&mut world, id);
    assert!(now <= 10.0 * start && (made || now == start), "{now} J from {start} J");
}

/// Where nodes end farther than a million sizes away in the shortest parts too, as in the free fall of a step of 0.02 s under 1e20 m/s², the step
/// is undone and says so.
#[test]
fn a_step_that_throws_nodes_a_million_sizes_away_is_undone() {
    let body = Body::new(tetrahedra(), 1000.0).model(TotalLagrangian::new(neo_hookean()));
    let (mut world, id) = implicit_world([0.0, 0.0, -1e20], 2e-2, Implicit::default(), body);
    let before = world.body(id).positions().to_vec();
    let error = world.step().unwrap_err();
    assert!(matches!(error, StepError::Diverged { .. }), "{error}");
    assert_eq!(world.body(id).positions(), &before[..]);
    assert!(energy(&mut world, id).is_finite());
}

/// Schemes that have no bound make steps that throw tissue across a hump of its energy in parts, linearised or in full: flattened, in their mirror
/// image, or with a corner poked through, bodies come to rest with no more energy than at the start. Newmark's method rose to 1e20 times it,
/// until nodes were thrown a million sizes away.
#[test]
fn schemes_without_a_bound_come_out_of_impossible_shapes() {
    let full = Newton::Full { relative: 1e-8, at_most: 100 };
    let corner = Vector::splat(0.1);
    let shapes: [fn(Vector, Vector) -> Vector; 3] = [
        |x, _| Vector::new(0.05, x.y, x.z),
        |x, _| Vector::new(x.x, x.y, -x.z),
        |x, corner| if x == corner { Vector::new(x.x, x.y, -0.05) } else { x },
    ];
    let mut again = 0;
    for (scheme, newton) in [Scheme::AVERAGE_ACCELERATION, Scheme::Bdf2]
        .into_iter()
        .flat_map(|scheme| [Newton::Linearised, full].map(|newton| (scheme, newton)))
    {
        for shape in shapes {
            let settings = Implicit { scheme, newton, ..Implicit::default() };
            let (mut world, id) = cube(tetrahedra(), NodallyIntegrated::new(neo_hookean()), settings);
            world.body_mut(id).set_positions(|x| shape(x, corner));
            let start = energy(&mut world, id);
            for _ in 0..150 {
                again += world.step().unwrap().retries;
                let now = energy(&mut world, id);
                assert!(now <= 1.1 * start, "{scheme:?}, {newton:?}: {now} J from {start} J");
            }
            // One of them in another shape that holds, with 0.013 of it.
            assert!(energy(&mut world, id) < 0.02 * start, "{scheme:?}, {newton:?}");
        }
    }
    assert!(again > 0);
}

/// Linearised steps of Newmark's method that end far from balance are looked at as well, and tissue with turning cells comes back from a thousand
/// times its length with no more energy than at the start. It came to 1e7 times that, and was thrown a million sizes away.
#[test]
fn linearised_steps_far_from_balance_gain_no_energy() {
    let settings = Implicit { scheme: Scheme::AVERAGE_ACCELERATION, ..Implicit::default() };
    let turning: Box<dyn ModelRecipe> = Box::new(Corotational::new(linear_tissue()));
    let warped: Box<dyn ModelRecipe> = Box::new(StiffnessWarping::new(linear_tissue()));
    // A step without a potential gains and loses a little.
    for (model, share) in [(turning, 1e-3), (warped, 1e-2)] {
        let body = Body::new(TetMesh::box_grid([2; 3], [0.1; 3]), 1000.0).boxed_model(model).damping(50.0).fix(root());
        let (mut world, id) = implicit_world(NO_GRAVITY, 2e-2, settings, body);
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
        let (start, mut again) = (energy(&mut world, id), 0);
        for _ in 0..300 {
            again += world.step().unwrap().retries;
            let now = energy(&mut world, id);
            assert!(now <= (1.0 + share) * start, "{now} J from {start} J");
        }
        assert!(
            again > 0 && energy(&mut world, id) < 1e-12 * start,
            "{again} times again, {} J",
            energy(&mut world, id)
        );
    }
}

/// Energy–momentum steps of stiff tissue that falls on its hold keep their energy, and are made: the elastic energy of mid-step was taken for that of
/// the end, and steps were undone for what they had not gained.
#[test]
fn energy_momentum_steps_under_weight_are_made() {
    let stiff = uniform(StVenantKirchhoff::from_young_poisson(1e6, 0.45).unwrap());
    let body = Body::new(tetrahedra(), 1000.0).model(TotalLagrangian::new(stiff)).fix(root());
    let (mut world, id) = implicit_world([0.0, -9.81, 0.0], 1e-2, Implicit::accurate(Scheme::EnergyMomentum), body);
    let all = |world: &mut World<f64>| {
        let seen = world.observe(id);
        seen.kinetic_energy + seen.elastic_energy + seen.gravity_energy
    };
    let start = all(&mut world);
    for _ in 0..20 {
        assert_eq!(world.step().unwrap().retries, 0);
    }
    assert!((all(&mut world) - start).abs() < 1e-8 * start.abs(), "{} J from {start} J", all(&mut world));
}

/// Tissue with rotations at its nodes comes back in linearised steps. With the paper's products, which are not symmetric where neighbours have turned
/// differently, conjugate gradients solved not one of 3000 steps out of these shapes.
#[test]
fn nodes_that_have_turned_differently_come_back_in_linearised_steps() {
    for stretch in [-1.0, 1000.0] {
        let tissue = uniform(LinearElastic::from_young_poisson(10e3, 0.4).unwrap());
        let mesh = TetMesh::box_grid([2; 3], [0.1; 3]);
        let (mut world, id) = cube(mesh, StiffnessWarping::new(tissue), Implicit::default());
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, stretch * x.z));
        run(&mut world, 400);
        let away = world.body(id).max_displacement();
        assert!(away < 1e-6 * 0.17, "{stretch}: {away} m");
    }
}

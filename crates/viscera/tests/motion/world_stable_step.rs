//! The longest stable sub-step: bounded from the safe side, refused beyond, and the bound is no idle caution.

use viscera::body::Body;
use viscera::dynamics::{Drive, explicit};
use viscera::material::{LawFamily, LawKind, LawVisitor, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::frequency::frequency_bound;
use viscera::model::{ModelKind, ModelRecipe, NodallyIntegrated, Precision, Scratch, TotalLagrangian};
use viscera::stage::Stages;
use viscera::world::{BodyId, Integrator, Substep, World, WorldConfig, WorldError};

use crate::support::{DENSITY, Vector, assert_relative, linear, side, stvk};

/// An example tissue of every law.
fn every_law() -> impl Iterator<Item = Tissue> {
    struct Example;
    impl LawVisitor for Example {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            Tissue::uniform(L::example())
        }
    }
    LawKind::ALL.iter().map(|law| law.visit(Example))
}

/// ω_max² of the free body at its positions [1/s²], from below: 300 rounds of power iteration on M⁻¹K, to 0.1 %.
fn largest_squared_frequency(world: &World<f64>, id: BodyId) -> f64 {
    let state = world.body(id).state();
    let nodes = state.positions.len();
    let mut scratch = Scratch::new(nodes);
    // A start without symmetry, so that no mode is missed.
    let mut mode: Vec<Vector> = (0..nodes)
        .map(|node| Vector::from([0.7, 1.3, 2.9].map(|a| (a * (node as f64 + 1.0) * (node as f64 + 0.3)).sin())))
        .collect();
    let mut squared = 0.0;
    for _ in 0..300 {
        let mut forces = vec![Vec3::ZERO; nodes];
        for model in &state.models {
            model.add_product(&state.positions, &mode, &mut scratch, &mut forces);
        }
        let dot = |a: &[Vector], b: &[Vector]| -> f64 {
            (0..nodes).map(|node| state.masses[node] * a[node].dot(b[node])).sum()
        };
        let next: Vec<Vector> = (0..nodes).map(|node| forces[node] / state.masses[node]).collect();
        squared = dot(&mode, &next) / dot(&mode, &mode);
        let length = dot(&next, &next).sqrt();
        mode = next.into_iter().map(|vector| vector / length).collect();
    }
    squared
}

/// The bar, free, in a world that lets every step be one sub-step of any length: `advance` is called directly.
fn free(mesh: impl Into<VolumeMesh>, tissue: &Tissue, keep_volume: f64) -> (World<f64>, BodyId) {
    let mut world = World::new(WorldConfig { gravity: [0.0; 3], ..WorldConfig::default() }).unwrap();
    let body = Body::new(mesh, DENSITY).model(TotalLagrangian::new(tissue.clone())).keep_volume(keep_volume);
    let id = world.add(body).unwrap();
    (world, id)
}

/// Under every law, at rest and deformed, no mode is faster than the bound; at rest the bound is at most a third above.
#[test]
fn the_bound_is_above_the_fastest_mode_under_every_law() {
    let deformations: [fn(Vector) -> Vector; 4] = [
        |x| x,
        |x| Vector::new(1.2 * x.x, 0.9 * x.y, 1.4 * x.z),
        |x| Vector::new(0.95 * x.x, 0.9 * x.y + 0.1 * x.z, 0.95 * x.z),
        |x| Vector::new(x.x + 8.0 * x.z * x.z, x.y * (1.0 + 2.0 * x.z), 1.1 * x.z),
    ];
    let meshes: [(VolumeMesh, f64); 3] = [
        (TetMesh::box_grid([2, 2, 4], [0.04, 0.05, 0.16]).into(), 0.0),
        (TetMesh::box_grid([2, 2, 4], [0.04, 0.05, 0.16]).into(), 2e4),
        (HexMesh::box_grid([2, 2, 4], [0.04, 0.05, 0.16]).into(), 0.0),
    ];
    for tissue in every_law() {
        for (mesh, keep_volume) in &meshes {
            let bound = frequency_bound::<f64>(mesh, &tissue, &[DENSITY], *keep_volume).unwrap();
            for (number, deformation) in deformations.iter().enumerate() {
                let (mut world, id) = free(mesh.clone(), &tissue, *keep_volume);
                world.body_mut(id).set_positions(deformation);
                let mut scratch = Scratch::new(world.body(id).positions().len());
                let fastest = largest_squared_frequency(&world, id);
                let above = (bound.squared_frequency(world.body(id).positions(), &mut scratch) / fastest).sqrt();
                assert!(above >= 1.0, "{}, deformation {number}: the bound is only {above} of ω", tissue.kind());
                if number == 0 {
                    assert!(above < 1.34, "{} at rest: {above}", tissue.kind());
                }
            }
        }
    }
}

/// The same of every model, which may make more of the law than the law does; and of points that are held together ten
/// times as much as by default.
#[test]
fn the_bound_is_above_the_fastest_mode_of_every_model() {
    let mesh: VolumeMesh = TetMesh::box_grid([2, 2, 4], [0.04, 0.05, 0.16]).into();
    let mut recipes: Vec<Box<dyn ModelRecipe>> = Vec::new();
    for tissue in every_law() {
        let able = ModelKind::ALL.iter().filter(|kind| kind.info().moves && kind.info().laws.contains(&tissue.kind()));
        recipes.extend(able.map(|kind| kind.recipe(tissue.clone())));
        if ModelKind::NodallyIntegrated.info().laws.contains(&tissue.kind()) {
            recipes.push(Box::new(NodallyIntegrated::new(tissue.clone()).stabilise(0.1)));
        }
    }
    for recipe in recipes {
        let name = format!("{} of {}", recipe.kind(), recipe.tissue().kind());
        let bound = f64::build_frequency_bound(recipe.as_ref(), &mesh, &[DENSITY], 0.0).unwrap();
        let mut world = World::new(WorldConfig { gravity: [0.0; 3], ..WorldConfig::default() }).unwrap();
        let id = world.add(Body::new(mesh.clone(), DENSITY).boxed_model(recipe)).unwrap();
        for stretch in [1.0, 1.3] {
            world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y * (1.0 + 0.5 * x.z), stretch * x.z));
            let fastest = largest_squared_frequency(&world, id);
            let positions = world.body(id).positions();
            let above = (bound.squared_frequency(positions, &mut Scratch::new(positions.len())) / fastest).sqrt();
            assert!(above >= 1.0, "{name}, stretched to {stretch}: the bound is only {above} of ω");
        }
    }
}

/// The kinetic energy after `steps` sub-steps of `factor` times the true limit 2/ω_max over that of the beginning.
fn growth(factor: f64, steps: usize) -> f64 {
    let (mut world, id) = free(TetMesh::box_grid([2, 2, 4], [0.04, 0.04, 0.08]), &linear(5e3, 0.4), 0.0);
    let limit = 2.0 / largest_squared_frequency(&world, id).sqrt();
    world.body_mut(id).set_velocities(|x| {
        let wave = 400.0 * x.x + 310.0 * x.y + 530.0 * x.z;
        Vector::new(wave.sin(), (1.7 * wave).cos(), (2.3 * wave).sin()) * 1e-3
    });
    let before = world.observe(id).kinetic_energy;
    let drive = Drive { end: 0.0, frames: &[], rods: &[], gravity: Vec3::ZERO };
    for _ in 0..steps {
        explicit::advance(world.body_mut(id), factor * limit, &drive, Stages::unobserved());
    }
    world.observe(id).kinetic_energy / before
}

/// 2/ω_max is the border: just below it the motion stays bounded over ten thousand sub-steps, at 1.3 times it blows up
/// within fifty, each of which multiplies the amplitude by (1.3 + √(1.3² − 1))² = 4.5.
#[test]
fn beyond_the_true_limit_the_motion_blows_up_and_below_it_does_not() {
    assert!(growth(0.99, 10_000) < 100.0, "at 0.99 the energy grew {} times", growth(0.99, 10_000));
    assert!(growth(1.3, 50) > 1e40);
}

/// A fixed sub-step too long is refused with a number, and that number works: the energy only sways.
#[test]
fn the_sub_step_that_a_refusal_names_works() {
    let bar = || {
        Body::new(TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]), DENSITY)
            .name("bar")
            .model(TotalLagrangian::new(stvk(5e3, 0.4)))
            .fix(side("z-min"))
    };
    let config = |substep| WorldConfig {
        gravity: [0.0; 3],
        step: 5e-3,
        integrator: Integrator::Explicit(Substep::Fixed(substep)),
    };
    let mut too_long = World::<f64>::new(config(5e-3)).unwrap();
    let error = too_long.add(bar()).unwrap_err();
    let WorldError::UnstableSubstep { body, substep, stable } = &error else { panic!("{error}") };
    assert_eq!((body.as_str(), *substep), ("bar", 5e-3));
    assert!(error.to_string().contains(&format!("{stable:.3e}")), "{error}");

    // Stretching stiffens the tissue, so the motion is small: a thousandth of stretch.
    let mut world = World::<f64>::new(config(0.99 * stable)).unwrap();
    let id = world.add(bar()).unwrap();
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.001 * x.z));
    let first = world.observe(id).elastic_energy;
    for _ in 0..2000 {
        world.step().unwrap();
    }
    let seen = world.observe(id);
    assert_relative(seen.kinetic_energy + seen.elastic_energy, first, 0.05);
}

/// A step is divided evenly into sub-steps no longer than the fixed one.
#[test]
fn fixed_sub_steps_divide_the_step() {
    let config =
        WorldConfig { gravity: [0.0; 3], step: 5e-3, integrator: Integrator::Explicit(Substep::Fixed(0.9e-3)) };
    let mut world = World::<f64>::new(config).unwrap();
    let mesh = TetMesh::box_grid([1, 1, 2], [0.04, 0.04, 0.08]);
    world.add(Body::new(mesh, DENSITY).model(TotalLagrangian::new(linear(1e3, 0.3)))).unwrap();
    assert_eq!(world.step().unwrap().substeps, 6);
}

//! Hybrid bodies: one part moves and is cut, the other follows; together they are the body that moves as a whole.

use viscera::body::{Body, BodyError, Load, NodeMotion};
use viscera::curve::Curve;
use viscera::dynamics::implicit::Implicit;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::instrument::Cautery;
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, VolumeMesh};
use viscera::model::{ForceModel, Hybrid, ModelError, ModelRecipe, Scratch, TensorMass};
use viscera::solver::Iterative;
use viscera::world::{BodyId, Integrator, World, WorldError};

use crate::support::{
    Random, SIZE, Vector, bottom, difference, displacements, hexahedra, in_full, loose, run, solved, tetrahedra,
    tissue, top, world,
};

const GRAVITY: [f64; 3] = [0.3, -0.2, -1.0];

/// The upper half moves.
fn upper() -> Region {
    Region::HalfSpace { point: Vector::new(0.0, 0.0, 0.6 * SIZE[2]), normal: Vector::new(0.0, 0.0, 1.0) }
}

/// A block that stands, is pulled at its top and pressed at the side of its lower half.
fn loaded(mesh: VolumeMesh, share: f64) -> Body {
    let low = Region::Box { low: Vector::new(-0.01, -0.01, 0.01), high: Vector::new(0.01, 0.1, 0.05) };
    loose(mesh)
        .fix(bottom())
        .load(Load::Force { region: top(), total: Curve::constant(Vector::new(0.2, 0.1, 0.3) * share) })
        .load(Load::Force { region: low, total: Curve::constant(Vector::new(0.3, 0.0, -0.1) * share) })
}

fn hybrid(mesh: VolumeMesh, share: f64) -> Body {
    loaded(mesh, share).model(Hybrid::new(tissue(6e3)).dynamic(upper()))
}

fn settled(body: Body, gravity: [f64; 3]) -> (World<f64>, BodyId) {
    let mut world = world(gravity, Integrator::default());
    let id = world.add(body).unwrap();
    world.settle(id, &QuasiStatic::default(), &mut Iterative::new(1e-13)).unwrap();
    (world, id)
}

/// Linear tissue in both parts: weight, loads on either part and reactions are those of the whole.
#[test]
fn at_rest_a_hybrid_of_linear_tissue_is_the_static_solution_of_the_whole() {
    for is_hex in [false, true] {
        let mesh = || if is_hex { hexahedra() } else { tetrahedra() };
        let (mut found, id) = settled(hybrid(mesh(), 1.0), GRAVITY);
        let (mut full, other) = solved(in_full(loaded(mesh(), 1.0), is_hex), GRAVITY);
        let following =
            found.body(id).state().motions.iter().filter(|motion| **motion == NodeMotion::Following).count();
        assert!(following > 10, "{following} nodes follow");
        let apart = difference(&displacements(&found, id), &displacements(&full, other));
        assert!(apart < 1e-8, "hexahedra {is_hex}: {apart:.1e}");
        let (reaction, wanted) = (found.observe(id).reaction, full.observe(other).reaction);
        assert!((reaction - wanted).norm() < 1e-8 * wanted.norm(), "{reaction:?} and {wanted:?}");
    }
}

/// Damped steps of either integrator end in that solution, and the reaction of the part that follows comes to rest with them.
#[test]
fn a_hybrid_that_moves_comes_to_the_static_solution_of_the_whole() {
    let (full, other) = solved(in_full(loaded(tetrahedra(), 1.0), false), GRAVITY);
    let wanted = displacements(&full, other);
    for integrator in [Integrator::default(), Integrator::Implicit(Implicit::default())] {
        let mut world = world(GRAVITY, integrator);
        let id = world.add(hybrid(tetrahedra(), 1.0).damping(25.0)).unwrap();
        world.step().unwrap();
        let first = world.observe(id).interface_residual.unwrap();
        run(&mut world, 250);
        let last = world.observe(id).interface_residual.unwrap();
        assert!(first > 0.1 && last < 1e-5, "the residual of the interface goes from {first} to {last}");
        let apart = difference(&displacements(&world, id), &wanted);
        assert!(apart < 1e-4, "{integrator:?}: {apart:.1e}");
    }
}

/// St Venant–Kirchhoff tissue where it moves, and its law at rest where it follows: for small loads the two are one.
#[test]
fn a_hybrid_of_non_linear_tissue_is_the_whole_for_small_loads_and_near_it_for_larger_ones() {
    let stvk = || Tissue::uniform(StVenantKirchhoff::from_young_poisson(6e3, 0.42).unwrap());
    let apart = |share: f64| {
        let (found, id) = settled(loaded(tetrahedra(), share).model(Hybrid::new(stvk()).dynamic(upper())), [0.0; 3]);
        let (full, other) = settled(loaded(tetrahedra(), share).model(TensorMass::new(stvk())), [0.0; 3]);
        difference(&displacements(&found, id), &displacements(&full, other))
    };
    // What is left out is of second order in the strain of the part that follows.
    let (small, large) = (apart(1e-4), apart(1e-1));
    assert!(small < 1e-4, "{small:.1e}");
    assert!(large < 0.05 && large > 100.0 * small, "{large:.1e}");
}

/// Every third cell that moves and has no corner on the boundary: with one, a cut may leave that node to the other part alone.
fn cut_of(recipe: &Hybrid, mesh: &VolumeMesh) -> Vec<u32> {
    let supports =
        viscera::model::precomputed::Supports { mesh, filters: &vec![Default::default(); mesh.nodes().len()] };
    let supported = recipe.supported(&supports).unwrap().unwrap();
    let condensation = supported.condensation().unwrap();
    let inside = |cell: &&u32| mesh.cell(**cell as usize).iter().all(|node| !condensation.boundary().contains(node));
    condensation.dynamic_cells().iter().filter(inside).step_by(3).copied().collect()
}

/// A hybrid that lost cells equals one that never had them, in forces, products and energy; cells of the other part stay.
#[test]
fn after_a_cut_the_model_is_the_one_that_is_built_afresh() {
    let VolumeMesh::Tet(mesh) = tetrahedra() else { unreachable!("the block is made of tetrahedra") };
    let whole = VolumeMesh::from(mesh.clone());
    let stvk = Tissue::uniform(StVenantKirchhoff::from_young_poisson(6e3, 0.42).unwrap());
    let recipe = Hybrid::new(stvk).dynamic(upper());
    let cut = cut_of(&recipe, &whole);
    let mut model = recipe.build_double(&whole).unwrap();
    model.remove(&cut);
    let mut rest = mesh.clone();
    let mut number = 0;
    rest.cells.retain(|_| {
        number += 1;
        !cut.contains(&(number - 1))
    });
    let fresh = recipe.build_double(&rest.into()).unwrap();
    let mut random = Random::new();
    let x: Vec<_> = mesh.nodes.iter().map(|&node| node + random.vector() * 2e-3).collect();
    let dx: Vec<_> = x.iter().map(|_| random.vector()).collect();
    assert!(difference(&forces(model.as_ref(), &x), &forces(fresh.as_ref(), &x)) < 1e-12);
    assert!(difference(&product(model.as_ref(), &x, &dx), &product(fresh.as_ref(), &x, &dx)) < 1e-12);
    assert!((model.energy(&x) / fresh.energy(&x) - 1.0).abs() < 1e-12);
    let before = forces(model.as_ref(), &x);
    model.remove(&[0]);
    assert!(before == forces(model.as_ref(), &x), "cell 0 lies in the part that is pre-computed");
}

fn forces(model: &dyn ForceModel<f64>, x: &[Vector]) -> Vec<Vector> {
    let mut out = vec![Vector::ZERO; x.len()];
    model.add_forces(x, &mut Scratch::new(x.len()), &mut out);
    out
}

fn product(model: &dyn ForceModel<f64>, x: &[Vector], dx: &[Vector]) -> Vec<Vector> {
    let mut out = vec![Vector::ZERO; x.len()];
    model.add_product(x, dx, &mut Scratch::new(x.len()), &mut out);
    out
}

fn dot(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| a.dot(b)).sum()
}

/// Forces are the gradient of the energy, products their derivative and symmetric; nothing pushes the body as a whole.
#[test]
fn the_condensed_part_has_an_energy_and_no_net_force() {
    let mesh = tetrahedra();
    let model = Hybrid::new(tissue(6e3)).dynamic(upper()).build_double(&mesh).unwrap();
    let mut random = Random::new();
    let x: Vec<_> = mesh.nodes().iter().map(|&node| node + random.vector() * 2e-3).collect();
    let (dx, dy): (Vec<_>, Vec<_>) = x.iter().map(|_| (random.vector(), random.vector())).unzip();
    let forces = forces(model.as_ref(), &x);
    let at = |h: f64| x.iter().zip(&dx).map(|(&x, &d)| x + d * h).collect::<Vec<_>>();
    let (h, slope) = (1e-5, dot(&forces, &dx));
    let difference = (model.energy(&at(h)) - model.energy(&at(-h))) / (2.0 * h);
    assert!((difference - slope).abs() < 1e-8 * slope.abs(), "{difference} and {slope}");
    let (along, across) = (product(model.as_ref(), &x, &dx), product(model.as_ref(), &x, &dy));
    assert!((dot(&along, &dy) - dot(&across, &dx)).abs() < 1e-11 * dot(&along, &dx).abs());
    let net = forces.iter().fold(Vector::ZERO, |sum, &force| sum + force);
    let largest = forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
    assert!(net.norm() < 1e-9 * largest, "{net:?}");
}

/// At automatic sub-steps a free vibration of the whole keeps its energy: the bound counts what the boundary pulls along.
#[test]
fn a_free_vibration_keeps_its_energy_at_automatic_substeps() {
    let mut world = world([0.0; 3], Integrator::default());
    let id = world.add(loose(tetrahedra()).fix(bottom()).model(Hybrid::new(tissue(6e3)).dynamic(upper()))).unwrap();
    world.body_mut(id).set_positions(|x| x + Vector::new(0.1, 0.05, 0.1) * x.z);
    let mut energy = || {
        let seen = world.observe(id);
        let energy = seen.kinetic_energy + seen.elastic_energy;
        world.step().unwrap();
        energy
    };
    let start = energy();
    for step in 0..150 {
        let now = energy();
        assert!((now / start - 1.0).abs() < 0.15, "step {step}: {now} J of {start} J");
    }
}

/// A cautery that burns through both parts takes cells of the one that moves; asked for a cell of the other, the world refuses.
#[test]
fn only_the_part_that_moves_can_be_cut_and_the_rest_is_whole_afterwards() {
    let mut world = world([0.0; 3], Integrator::default());
    let id = world.add(hybrid(tetrahedra(), 1.0).damping(20.0)).unwrap();
    let path = vec![(0.0, Vector::new(0.04, 0.03, 0.02)), (0.1, Vector::new(0.04, 0.03, 0.1))];
    let path = Curve::piecewise_linear(path).unwrap();
    world.add_instrument(Cautery { path, radius: 0.003, on: (0.0, 0.1), ..Cautery::default() }).unwrap();
    let removed: usize = (0..12).map(|_| world.step().unwrap().removed_cells).sum();
    assert!(removed > 3, "{removed} cells");
    let cells: Vec<u32> = (0..world.body(id).mesh().cell_count() as u32)
        .filter(|&cell| world.body(id).state().removed[cell as usize])
        .collect();
    let high = |cell: u32| {
        let mesh = world.body(id).mesh();
        mesh.cell(cell as usize).iter().any(|&node| mesh.nodes()[node as usize].z >= 0.6 * SIZE[2])
    };
    assert!(cells.iter().all(|&cell| high(cell)), "{cells:?}");
    let refused = world.remove_cells(id, &[0]);
    assert_eq!(refused, Err(WorldError::PrecomputedCell { body: "block".into(), cell: 0 }));

    // What is left is the body that was cut so and has no parts.
    let settings = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
    let mut full = crate::support::world([0.0; 3], Integrator::default());
    let other = full.add(in_full(loaded(tetrahedra(), 1.0), false)).unwrap();
    full.remove_cells(other, &cells).unwrap();
    full.settle(other, &settings, &mut Iterative::new(1e-13)).unwrap();
    let apart = difference(&displacements(&world, id), &displacements(&full, other));
    assert!(apart < 1e-6, "{apart:.1e}");
}

/// Back from a snapshot a hybrid goes on with the same bits.
#[test]
fn a_hybrid_goes_on_from_a_snapshot_with_the_same_bits() {
    let mut world = world(GRAVITY, Integrator::default());
    let id = world.add(hybrid(tetrahedra(), 1.0).damping(5.0)).unwrap();
    run(&mut world, 5);
    let bytes = world.snapshot().to_bytes();
    let end = |world: &mut World<f64>| {
        run(world, 5);
        world.body(id).positions().to_vec()
    };
    let first = end(&mut world);
    let snapshot = world.read_snapshot(&bytes).unwrap();
    world.restore(&snapshot).unwrap();
    assert!(end(&mut world) == first);
}

#[test]
fn a_part_that_moves_has_to_be_somewhere() {
    let nowhere = Region::Sphere { centre: Vector::new(1.0, 1.0, 1.0), radius: 0.01 };
    let body = loose(tetrahedra()).model(Hybrid::new(tissue(6e3)).dynamic(nowhere));
    match world([0.0; 3], Integrator::default()).add(body) {
        Err(WorldError::Body(BodyError::Model { source: ModelError::Region(_), .. })) => {}
        other => panic!("{other:?}"),
    }
    let message = world([0.0; 3], Integrator::default())
        .add(loose(tetrahedra()).model(Hybrid::new(tissue(6e3)).dynamic(upper())).keep_volume(1e3))
        .unwrap_err()
        .to_string();
    assert!(message.contains("keep-volume"), "{message}");
}

//! Multigrid changes the number of iterations, and nothing else.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::executor::Executor;
use viscera::material::{LawFamily, LawVisitor, LinearElastic, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Mat3;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{Corotational, ModelKind, ModelRecipe, NodallyIntegrated, Precision, Scratch, TotalLagrangian};
use viscera::solver::{
    BlockJacobi, BlockMatrix, ConjugateGradient, Filter, FilteredNodes, Multigrid, Preconditioner, Problem, Stop,
};
use viscera::world::Integrator;

use super::support::*;

/// A bar of so many cells that there are two lattices.
fn fine_mesh() -> TetMesh {
    TetMesh::box_grid([6, 6, 18], [0.1, 0.1, 0.3])
}

fn fine_bar(recipe: impl ModelRecipe + 'static) -> Body {
    Body::new(fine_mesh(), 1000.0).model(recipe).fix(root())
}

/// Where a body is after `steps` of 10 ms, cells being removed after the first, and the most linear iterations of a step.
fn shape(body: Body, settings: Implicit, steps: usize, cut: &[u32]) -> (Vec<Vector>, u32) {
    let (mut world, id) = implicit_world([0.0, -3.0, 0.0], 1e-2, settings, body);
    let mut most = 0;
    for step in 0..steps {
        most = most.max(world.step().unwrap().implicit.unwrap().linear_iterations);
        if step == 0 {
            world.remove_cells(id, cut).unwrap();
        }
    }
    (world.body(id).positions().to_vec(), most)
}

/// Both preconditioners lead to the same place, to 1e-9 of the way of about 1 cm: linear solves are carried to 1e-13.
fn assert_same(build: impl Fn() -> Body, settings: Implicit, cut: &[u32], what: &str) {
    let (expected, by_blocks) = shape(build(), settings, 3, cut);
    let (found, by_multigrid) = shape(build(), multigrid(settings), 3, cut);
    let difference = distance(&found, &expected);
    assert!(difference < 1e-11, "{what}: {difference:e} m apart");
    assert!(by_multigrid < by_blocks, "{what}: {by_multigrid} iterations, {by_blocks} with block-Jacobi");
}

fn example(kind: ModelKind) -> Box<dyn ModelRecipe> {
    struct Example;
    impl LawVisitor for Example {
        type Output = Tissue;
        fn visit<L: LawFamily>(self) -> Tissue {
            Tissue::uniform(L::example())
        }
    }
    kind.recipe(kind.info().laws[0].visit(Example))
}

#[test]
fn every_model_moves_as_with_block_jacobi() {
    for &kind in ModelKind::ALL.iter().filter(|kind| kind.info().moves) {
        let tetrahedra = TetMesh::box_grid([3, 3, 9], [0.1, 0.1, 0.3]);
        let body = |mesh: VolumeMesh| Body::new(mesh, 1000.0).boxed_model(example(kind)).fix(root()).damping(1.0);
        assert_same(|| body(tetrahedra.clone().into()), linearised(), &[], &format!("{kind}"));
        if kind.info().hexahedra {
            let hexahedra = HexMesh::box_grid([3, 3, 9], [0.1, 0.1, 0.3]);
            assert_same(|| body(hexahedra.clone().into()), linearised(), &[], &format!("{kind} of hexahedra"));
        }
    }
}

#[test]
fn schemes_damping_and_slides_move_as_with_block_jacobi() {
    let slid = |recipe: TotalLagrangian| {
        let side = |axis: usize| {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            Region::plane([0.0; 3], normal, 0.0)
        };
        // Nodes that are held, that move in an oblique plane, and along a line.
        fine_bar(recipe).slide(side(0), [0.6, 0.0, 0.8]).slide(side(1), [0.0, 1.0, 0.0]).stiffness_damping(5e-3)
    };
    for settings in [linearised(), full(Scheme::Bdf2, 1e-11)] {
        assert_same(|| slid(TotalLagrangian::new(tissue())), settings, &[], "slid");
        assert_same(|| fine_bar(Corotational::new(linear_tissue())).keep_volume(5e3), settings, &[], "turned");
    }
}

/// A slit along the bar, and a piece that floats away: what is left decides the coarse matrices.
#[test]
fn cut_bodies_move_as_with_block_jacobi() {
    let mesh = fine_mesh();
    let centre = |cell: &[u32; 4]| cell.iter().fold(Vector::ZERO, |sum, &node| sum + mesh.nodes[node as usize] * 0.25);
    let is_cut = |p: Vector| (p.z > 0.2 && p.z < 0.3 - 0.08) || (p.z < 0.2 && p.z > 0.05 && p.x > 0.05 && p.x < 0.066);
    let cut: Vec<u32> =
        (0..mesh.cells.len() as u32).filter(|&cell| is_cut(centre(&mesh.cells[cell as usize]))).collect();
    assert!(cut.len() > 300);
    assert_same(|| fine_bar(TotalLagrangian::new(tissue())), linearised(), &cut, "plain");
    assert_same(|| fine_bar(NodallyIntegrated::new(tissue())), linearised(), &cut, "at the nodes");
}

/// Cut half through, or slit along most of its length, a bar that comes to rest takes a quarter to a half as many iterations again as the
/// whole one: of lattices that reached across cuts it took twice to five times as many, and the more the finer the mesh. What was cut off
/// comes back with a snapshot, and then it is the bar of before.
#[test]
fn a_cut_takes_few_iterations_more() {
    let mesh = fine_mesh();
    let cells = |is_cut: fn(Vector) -> bool| -> Vec<u32> {
        let centre = |cell: &[u32; 4]| {
            cell.iter().map(|&node| mesh.nodes[node as usize] * 0.25).fold(Vector::ZERO, |a, b| a + b)
        };
        (0..mesh.cells.len() as u32).filter(|&cell| is_cut(centre(&mesh.cells[cell as usize]))).collect()
    };
    let settings = Implicit { linear: Stop::Tolerance { relative: 1e-6, at_most: 3000 }, ..Implicit::default() };
    let body = fine_bar(Corotational::new(linear_tissue()));
    let (mut world, id) = world::<f64>([0.0, -0.1, 0.0], 1.0, Integrator::Implicit(multigrid(settings)), body);
    let whole = world.snapshot();
    let mut iterations = |cut: &[u32]| {
        world.restore(&whole).unwrap();
        world.remove_cells(id, cut).unwrap();
        world.step().unwrap().implicit.unwrap().linear_iterations
    };
    let without = iterations(&[]);
    let half = iterations(&cells(|p| p.z > 0.15 && p.z < 0.167 && p.y > 0.05));
    let slit = iterations(&cells(|p| p.x > 0.05 && p.x < 0.067 && p.z > 0.07));
    assert!(2 * half <= 3 * without && 2 * slit <= 3 * without, "{without}, cut half through {half}, slit {slit}");
    assert_eq!(iterations(&[]), without);
}

/// The lattices lie along the axes and are numbered by the nodes: a turned and renumbered bar moves alike all the same.
#[test]
fn turned_and_renumbered_bodies_move_alike() {
    let mesh = fine_mesh();
    let (sin, cos) = (0.6, 0.8);
    let turn = Mat3::from_columns(Vector::new(cos, sin, 0.0), Vector::new(-sin, cos, 0.0), Vector::new(0.0, 0.0, 1.0))
        * Mat3::from_columns(Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, cos, sin), Vector::new(0.0, -sin, cos));
    let last = mesh.nodes.len() as u32 - 1;
    let nodes: Vec<Vector> = mesh.nodes.iter().rev().map(|&node| turn * node).collect();
    let cells = mesh.cells.iter().rev().map(|cell| cell.map(|node| last - node)).collect();
    let held: Vec<u32> = (0..=last).filter(|&node| mesh.nodes[node as usize].z == 0.0).collect();
    let run_of = |mesh: TetMesh, held: Vec<u32>, down: Vector| {
        let body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue())).fix(Region::Nodes(held));
        let (mut world, id) = implicit_world(down.to_array(), 1e-2, multigrid(linearised()), body);
        run(&mut world, 3);
        world.body(id).positions().to_vec()
    };
    let down = Vector::new(0.0, -3.0, 0.0);
    let expected: Vec<Vector> = run_of(mesh.clone(), held.clone(), down).into_iter().map(|x| turn * x).collect();
    let mut found = run_of(TetMesh::new(nodes, cells), held.iter().map(|node| last - node).collect(), turn * down);
    found.reverse();
    let difference = distance(&found, &expected);
    assert!(difference < 1e-11, "{difference:e} m apart");
}

/// x·P⁻¹y = y·P⁻¹x and x·P⁻¹x > 0, under all four kinds of filters, for a matrix that resists and for one that does not: tissue
/// pressed to half its length without any mass.
#[test]
fn the_cycle_is_symmetric_and_positive() {
    let mesh = VolumeMesh::from(fine_mesh());
    let (nodes, serial) = (mesh.nodes().len(), Executor::serial());
    let wave = |node: usize, phase: f64| ((node * node % 9973) as f64 + phase).sin();
    let vector =
        |node: usize, phase: f64| Vector::new(wave(node, phase), wave(node, phase + 1.0), wave(node, phase + 2.0));
    let (p, q) = (Vector::new(0.6, 0.0, 0.8), Vector::new(0.0, 1.0, 0.0));
    let kinds = [Filter::Plane(p), Filter::Line(p, q), Filter::Held];
    let filter = |node: usize| if node.is_multiple_of(5) { kinds[node / 5 % 3] } else { Filter::Free };
    let filters: Vec<_> = (0..nodes).map(filter).collect();
    let residual = |phase: f64| -> Vec<Vector> { (0..nodes).map(|n| filters[n].apply(vector(n, phase))).collect() };
    let tissues = [tissue(), uniform(StableNeoHookean::from_young_poisson(10e3, 0.49).unwrap())];
    for (tissue, press) in tissues.iter().flat_map(|tissue| [1.0, 0.5].map(|press| (tissue, press))) {
        let model = f64::build_model(&TotalLagrangian::new(tissue.clone()), &mesh).unwrap();
        let places: Vec<Vector> = mesh.nodes().iter().map(|x| Vector::new(x.x, x.y, press * x.z)).collect();
        let (mut matrix, mut diagonal) = (BlockMatrix::new(&mesh, 1), BlockJacobi::new(nodes));
        let mut multigrid = Multigrid::new(&mesh, 1);
        let mut scratch = Scratch::new(nodes);
        model.add_blocks(&places, &mut scratch, &mut matrix);
        model.add_blocks(&places, &mut scratch, &mut diagonal);
        model.add_blocks(&places, &mut scratch, &mut multigrid);
        let masses = vec![0.0; nodes];
        diagonal.invert(&masses, FilteredNodes::of(&filters).with(&filters), &serial);
        let mut cycle = multigrid.set_up(&mut matrix, &mut diagonal, &filters, &masses, &serial);
        let mut correct = |residual: &[Vector]| {
            let mut corrected = vec![Vector::ZERO; nodes];
            let size = cycle.apply(&mut matrix, &filters, residual, &mut corrected, &serial);
            (corrected, size.corrected)
        };
        let (x, y) = (residual(0.3), residual(0.8));
        let dot = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(&a, &b)| a.dot(b)).sum::<f64>();
        let ((of_x, own), (of_y, other)) = (correct(&x), correct(&y));
        let (there, back) = (dot(&x, &of_y), dot(&y, &of_x));
        assert!(own > 0.0 && other > 0.0, "pressed to {press}: {own:e}, {other:e}");
        assert!((there - back).abs() < 1e-10 * (own * other).sqrt(), "pressed to {press}: {there:e} and {back:e}");
        let largest = of_x.iter().map(|corrected| corrected.norm()).fold(0.0, f64::max);
        for (node, (filter, corrected)) in filters.iter().zip(&of_x).enumerate() {
            let strayed = (*corrected - filter.apply(*corrected)).norm();
            assert!(strayed <= 1e-14 * largest, "node {node} moves where it is held");
        }
    }
}

/// Loads a million times larger in held directions change nothing: the lattices once took what rounding leaves of them there for a
/// load, and solves stopped at 1e-11.
#[test]
fn loads_in_held_directions_do_not_disturb() {
    let mesh = VolumeMesh::from(fine_mesh());
    let (nodes, serial) = (mesh.nodes().len(), Executor::serial());
    let oblique = Filter::Plane(Vector::new(0.6, 0.0, 0.8));
    let filter = |x: &Vector| {
        if x.z == 0.0 {
            Filter::Held
        } else if x.x == 0.0 {
            oblique
        } else {
            Filter::Free
        }
    };
    let filters: Vec<_> = mesh.nodes().iter().map(filter).collect();
    let model = f64::build_model(&TotalLagrangian::new(tissue()), &mesh).unwrap();
    let (mut matrix, mut diagonal) = (BlockMatrix::new(&mesh, 1), BlockJacobi::new(nodes));
    let (mut multigrid, mut scratch) = (Multigrid::new(&mesh, 1), Scratch::new(nodes));
    model.add_blocks(mesh.nodes(), &mut scratch, &mut matrix);
    model.add_blocks(mesh.nodes(), &mut scratch, &mut diagonal);
    model.add_blocks(mesh.nodes(), &mut scratch, &mut multigrid);
    let masses = vec![0.0; nodes];
    let filtered_nodes = FilteredNodes::of(&filters);
    let filtered = filtered_nodes.with(&filters);
    diagonal.invert(&masses, filtered, &serial);
    let mut cycle = multigrid.set_up(&mut matrix, &mut diagonal, &filters, &masses, &serial);
    let mut iterations = |reaction: f64| {
        let load = |node: usize| {
            let across = Vector::new((node as f64).sin(), 0.3, 0.7) * reaction;
            Vector::new(0.0, -1.0, 0.0) + (across - filters[node].apply(across))
        };
        let rhs: Vec<Vector> = (0..nodes).map(load).collect();
        let prescribed = vec![Vector::ZERO; nodes];
        let problem = Problem { rhs: &rhs, filtered, prescribed: &prescribed, masses: &masses, executor: &serial };
        let mut x = prescribed.clone();
        let stop = Stop::Tolerance { relative: 1e-13, at_most: 200 };
        ConjugateGradient::new(nodes, 200).solve(&mut matrix, &mut cycle, &problem, stop, &mut x).iterations
    };
    let without = iterations(0.0);
    assert!(without < 40 && iterations(1e6) <= without + 1);
}

/// Nearly incompressible tissue in a step of a second, that is at rest: a third of the iterations at ν = 0.499, a tenth at 0.45,
/// in both precisions.
#[test]
fn tissue_at_rest_takes_few_iterations() {
    fn iterations<T: Precision>(poisson: f64, settings: Implicit) -> u32 {
        let tissue = uniform(LinearElastic::from_young_poisson(10e3, poisson).unwrap());
        let settings = Implicit { linear: Stop::Tolerance { relative: 1e-4, at_most: 3000 }, ..settings };
        let body = fine_bar(Corotational::new(tissue));
        let (mut world, _) = world::<T>([0.0, -0.1, 0.0], 1.0, Integrator::Implicit(settings), body);
        world.step().unwrap().implicit.unwrap().linear_iterations
    }
    fn assert_few<T: Precision>() {
        for (poisson, share) in [(0.45, 10), (0.499, 3)] {
            let by_blocks = iterations::<T>(poisson, Implicit::default());
            let by_multigrid = iterations::<T>(poisson, multigrid(Implicit::default()));
            assert!(share * by_multigrid < by_blocks, "{} of {poisson}: {by_multigrid}, {by_blocks}", T::NAME);
        }
    }
    assert_few::<f32>();
    assert_few::<f64>();
}

/// St Venant–Kirchhoff tissue pressed to 55 % of its length buckles: negative curvature is noticed, and the step ends at a place.
#[test]
fn buckling_tissue_is_noticed() {
    let tissue = uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap());
    let body = fine_bar(TotalLagrangian::new(tissue));
    let (mut world, id) = implicit_world(NO_GRAVITY, 1.0, multigrid(Implicit::default()), body);
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 0.55 * x.z));
    let report = world.step().unwrap().implicit.unwrap();
    assert!(report.negative_curvature, "{report:?}");
}

/// Where a law leaves the numbers, so do blocks of removed cells, of which zero is what is left: that panicked, being a block where none should be.
#[test]
fn cut_tissue_that_leaves_the_numbers_does_not_panic() {
    let stable = Tissue::uniform(StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap());
    let mesh = TetMesh::box_grid([3, 3, 6], [0.1, 0.1, 0.2]);
    let body = Body::new(mesh, 1000.0).model(NodallyIntegrated::new(stable)).fix(root());
    let settings = multigrid(Implicit::default());
    let (mut world, id) = implicit_world([0.0; 3], 1e-2, settings, body);
    world.remove_cells(id, &(0..100).collect::<Vec<_>>()).unwrap();
    world.body_mut(id).set_positions(|x| x * 1e160);
    let is_solved = world.step().is_ok_and(|report| report.implicit.unwrap().converged);
    assert!(!is_solved && world.body(id).state().is_finite());
}

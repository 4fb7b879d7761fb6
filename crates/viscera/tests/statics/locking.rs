//! Nodal pressures: a model of their own energy, and tetrahedra that do not lock.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Mat3;
use viscera::mesh::{CubeCut, Region, TetMesh, VolumeMesh};
use viscera::model::{ForceModel, ModelRecipe, Scratch, TotalLagrangian};
use viscera::solver::ConjugateGradient;

use crate::reference::{Vector, bottom, world};

fn wavy(x: Vector, size: f64) -> Vector {
    x + Vector::new((90.0 * x.y).sin() + x.z, (70.0 * x.z + 1.0).sin() - x.x, (80.0 * x.x).cos() * 0.5) * size
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

/// Fails unless vectors agree to `tolerance` of the largest.
#[track_caller]
fn assert_near(actual: &[Vector], expected: &[Vector], tolerance: f64, what: &str) {
    let largest = expected.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let error = actual.iter().zip(expected).map(|(&a, &e)| (a - e).norm()).fold(0.0, f64::max);
    assert!(error <= tolerance * largest, "{what}: off by {:.2e} of the largest", error / largest);
}

const NEARLY_INCOMPRESSIBLE: Lame = Lame { lambda: 2.48e6, mu: 4.97e3 };

/// Both laws, in the plain and in the metric form of the second.
fn recipes() -> [(&'static str, TotalLagrangian); 3] {
    let neo = Tissue::uniform(NeoHookean::new(NEARLY_INCOMPRESSIBLE));
    let stable = Tissue::uniform(StableNeoHookean::new(NEARLY_INCOMPRESSIBLE));
    [
        ("neo-Hookean", TotalLagrangian::new(neo)),
        ("stable neo-Hookean", TotalLagrangian::new(stable.clone())),
        ("plain stable neo-Hookean", TotalLagrangian::new(stable).plain()),
    ]
}

fn build(recipe: TotalLagrangian, mesh: &VolumeMesh) -> Box<dyn ForceModel<f64>> {
    recipe.build_double(mesh).unwrap()
}

fn block() -> VolumeMesh {
    TetMesh::box_grid([3, 2, 2], [0.03, 0.02, 0.02]).into()
}

/// Five points; h⁴ of the fifth derivative and roundings of W/h stay below 1e-7 of the largest force.
#[test]
fn forces_are_the_gradient_of_the_energy_and_products_that_of_forces() {
    let mesh = block();
    let x: Vec<_> = mesh.nodes().iter().map(|&x| wavy(x, 1e-3)).collect();
    let dx: Vec<_> = mesh.nodes().iter().map(|&x| wavy(x * 3.0, 1.0)).collect();
    let h = 1e-6;
    for (what, recipe) in recipes() {
        let model = build(recipe.nodal_pressure(), &mesh);
        let at = |s: f64| x.iter().zip(&dx).map(|(&x, &dx)| x + dx * (s * h)).collect::<Vec<_>>();
        let slope = |f: &dyn Fn(f64) -> f64| (8.0 * (f(1.0) - f(-1.0)) - (f(2.0) - f(-2.0))) / (12.0 * h);
        let work: f64 = forces(&*model, &x).iter().zip(&dx).map(|(f, &dx)| f.dot(dx)).sum();
        let expected = slope(&|s| model.energy(&at(s)));
        assert!((work - expected).abs() <= 1e-7 * expected.abs(), "{what}: {work} is not {expected}");
        let [back2, back, ahead, ahead2] = [-2.0, -1.0, 1.0, 2.0].map(|s| forces(&*model, &at(s)));
        let slopes: Vec<_> =
            (0..x.len()).map(|i| ((ahead[i] - back[i]) * 8.0 - (ahead2[i] - back2[i])) / (12.0 * h)).collect();
        assert_near(&product(&*model, &x, &dx), &slopes, 1e-7, what);
    }
}

/// Where all cells change their volume alike there is nothing to average: the plain element, force by force.
#[test]
fn a_homogeneous_deformation_meets_the_plain_element() {
    let mesh = block();
    let f = Mat3::from_columns(Vector::new(1.1, 0.1, 0.0), Vector::new(-0.2, 0.9, 0.1), Vector::new(0.0, 0.3, 1.2));
    let x: Vec<_> = mesh.nodes().iter().map(|&x| f * x).collect();
    for (what, recipe) in recipes() {
        let (plain, averaged) = (build(recipe.clone(), &mesh), build(recipe.nodal_pressure(), &mesh));
        assert_near(&forces(&*averaged, &x), &forces(&*plain, &x), 1e-11, what);
        let (energy, expected) = (averaged.energy(&x), plain.energy(&x));
        assert!((energy - expected).abs() <= 1e-11 * expected, "{what}: {energy} J, not {expected} J");
    }
}

/// Forces and torques of the body on itself vanish.
#[test]
fn nodal_pressures_balance() {
    let mesh = block();
    let x: Vec<_> = mesh.nodes().iter().map(|&x| wavy(x, 2e-3)).collect();
    for (what, recipe) in recipes() {
        let forces = forces(&*build(recipe.nodal_pressure(), &mesh), &x);
        let size: f64 = forces.iter().map(|f| f.norm()).sum();
        let sum = forces.iter().fold(Vector::ZERO, |sum, &f| sum + f);
        let torque = forces.iter().zip(&x).fold(Vector::ZERO, |sum, (&f, &x)| sum + x.cross(f));
        assert!(sum.norm() <= 1e-13 * size && torque.norm() <= 1e-13 * size * 0.05, "{what}: {sum:?}, {torque:?}");
    }
}

/// Removed cells leave nothing behind, also in the averages of their neighbours.
#[test]
fn removal_equals_never_having_been_there() {
    let VolumeMesh::Tet(whole) = block() else { unreachable!("a block of tetrahedra") };
    let removed = [0_u32, 7, 8, 31];
    let kept = (0..whole.cells.len()).filter(|&cell| !removed.contains(&(cell as u32))).map(|cell| whole.cells[cell]);
    let rest = VolumeMesh::from(TetMesh::new(whole.nodes.clone(), kept.collect()));
    let whole = VolumeMesh::from(whole);
    let x: Vec<_> = whole.nodes().iter().map(|&x| wavy(x, 1e-3)).collect();
    for (what, recipe) in recipes() {
        let recipe = recipe.nodal_pressure();
        let (mut cut, fresh) = (build(recipe.clone(), &whole), build(recipe, &rest));
        cut.remove(&removed);
        assert_near(&forces(&*cut, &x), &forces(&*fresh, &x), 1e-12, what);
        assert_near(&product(&*cut, &x, &x), &product(&*fresh, &x, &x), 1e-12, what);
        assert!((cut.energy(&x) - fresh.energy(&x)).abs() <= 1e-12 * fresh.energy(&x), "{what}");
    }
}

#[test]
fn laws_and_cells_without_nodal_pressures_are_refused() {
    let stvk = Tissue::uniform(StVenantKirchhoff::new(NEARLY_INCOMPRESSIBLE));
    let refusal = |recipe: TotalLagrangian, mesh: &VolumeMesh| {
        recipe.nodal_pressure().build_double(mesh).err().unwrap().to_string()
    };
    assert_eq!(
        refusal(TotalLagrangian::new(stvk), &block()),
        "the model `total-lagrangian` cannot compute the law `st-venant-kirchhoff`: nodal pressures need a law of det F; \
         take `neo-hookean` or `stable-neo-hookean`"
    );
    let hexes = viscera::mesh::HexMesh::box_grid([1, 1, 1], [0.1, 0.1, 0.1]).into();
    let neo = Tissue::uniform(NeoHookean::new(NEARLY_INCOMPRESSIBLE));
    assert!(refusal(TotalLagrangian::new(neo), &hexes).starts_with("nodal pressures work on tetrahedra"));
}

/// Force on the plates of a silicone cube of 80 mm, glued to both and compressed by 5 % (the truth cube: E = 14.9 kPa,
/// ν = 0.499).
fn plate_force(cells: usize, model: impl Fn(Tissue) -> TotalLagrangian) -> f64 {
    let size = 0.08;
    // two superposed cuts of each cube: half the modulus in each
    let mesh = TetMesh::box_grid_cut([cells; 3], [size; 3], CubeCut::Ten);
    let tissue = Tissue::uniform(NeoHookean::from_young_poisson(0.5 * 14.9e3, 0.499).unwrap());
    let top = Region::plane([0.0, 0.0, size], [0.0, 0.0, 1.0], 0.0);
    let pressed = Curve::constant(Vector::new(0.0, 0.0, -0.05 * size));
    let body = Body::new(mesh, 500.0).model(model(tissue)).fix(bottom()).prescribe(top, pressed);
    let (mut world, id) = world(body, [0.0; 3]);
    world
        .settle(id, &QuasiStatic { tolerance: 1e-6, ..QuasiStatic::default() }, &mut ConjugateGradient::new(1e-9))
        .unwrap();
    let body = world.body(id);
    let held = |node: &usize| (body.mesh().nodes()[*node].z - size).abs() < 1e-9;
    let forces = &body.state().internal_forces;
    (0..forces.len()).filter(held).map(|node| forces[node].z).sum()
}

/// The converged force is 6.193 N (mixed Q2/Q1 elements, dolfinx 0.5.2). Four cells to an edge are too coarse for it: nodal
/// pressures give 1.50 times as much, the plain element more than three times.
#[test]
fn a_glued_cube_locks_far_less_with_nodal_pressures() {
    let converged = -6.1926137;
    let locked = plate_force(4, TotalLagrangian::new) / converged;
    let free = plate_force(4, |tissue| TotalLagrangian::new(tissue).nodal_pressure()) / converged;
    assert!(locked > 3.0, "the plain element: {locked} of the converged force");
    assert!((1.0..1.52).contains(&free), "nodal pressures: {free} of the converged force");
}

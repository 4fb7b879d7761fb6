//! Damped motion comes to rest where statics says.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::{Precision, TotalLagrangian};
use viscera::world::{BodyObservables, World};

use crate::support::{
    DENSITY, Vector, assert_relative, assert_vector, in_both_precisions, linear, settle, side, world,
};

const YOUNG: f64 = 10e3; // Pa
const LENGTH: f64 = 0.4; // m
const WIDTH: f64 = 0.1; // m
const AREA: f64 = WIDTH * WIDTH; // m²
const GRAVITY: f64 = 0.5; // m/s²
/// Kinetic over elastic energy at which a body counts as at rest, over the square of the tolerance: the critically damped
/// mode is then off by less than the tolerance.
const QUIET: f64 = 0.05;

/// A bar of linear tissue without lateral contraction along z, held at z = 0, critically damped in its slowest mode: that
/// of bending, ω = 1.875² √(E w²/12ρ)/L².
fn bar(mesh: impl Into<VolumeMesh>) -> Body {
    let bending = 1.875_f64.powi(2) * (YOUNG * AREA / (12.0 * DENSITY)).sqrt() / (LENGTH * LENGTH);
    let tissue = linear(YOUNG, 0.0);
    Body::new(mesh, DENSITY).model(TotalLagrangian::new(tissue)).damping(2.0 * bending).fix(side("z-min"))
}

fn hexahedra() -> HexMesh {
    HexMesh::box_grid([1, 1, 8], [WIDTH, WIDTH, LENGTH])
}

fn tetrahedra() -> TetMesh {
    TetMesh::box_grid([2, 2, 8], [WIDTH, WIDTH, LENGTH])
}

/// Mean displacement of the free end [m].
fn end_displacement<T: Precision>(world: &World<T>) -> Vector {
    let body = world.body(world.body_ids().next().unwrap());
    let nodes = side("z-max").nodes(body.mesh()).unwrap();
    let count = nodes.len() as f64;
    let displacement = |node: u32| body.positions()[node as usize].cast() - body.mesh().nodes()[node as usize];
    nodes.into_iter().fold(Vector::ZERO, |sum, node| sum + displacement(node) / count)
}

fn settled<T: Precision>(gravity: [f64; 3], body: Body, quiet: f64) -> (World<T>, BodyObservables) {
    let mut world = world(gravity, 1e-2);
    let id = world.add(body).unwrap();
    let seen = settle(&mut world, id, quiet);
    (world, seen)
}

/// A hanging bar is longer by ρgL²/2E, exactly so at the nodes of a column of hexahedra, and what holds it carries its
/// weight. The tolerance in double precision is that of rest.
fn a_hanging_bar_stretches_under_its_weight<T: Precision>(tolerance: f64) {
    let quiet = QUIET * tolerance * tolerance;
    let (world, seen) = settled::<T>([0.0, 0.0, GRAVITY], bar(hexahedra()), quiet);
    let longer = DENSITY * GRAVITY * LENGTH * LENGTH / (2.0 * YOUNG);
    assert_relative(end_displacement(&world).z, longer, tolerance);
    let weight = DENSITY * AREA * LENGTH * GRAVITY;
    assert_vector(seen.reaction, Vector::new(0.0, 0.0, -weight), tolerance);
    assert_relative(seen.mass, DENSITY * AREA * LENGTH, tolerance);
}
in_both_precisions!(a_hanging_bar_stretches_under_its_weight, f32: 3e-4, f64: 1e-6);

/// A dead traction t along z on the end: u = tL/E, and the reaction is −tA, on tetrahedra too, whose patch test it is.
fn a_pulled_bar_stretches_by_traction_over_young<T: Precision>(tolerance: f64) {
    let traction = Vector::new(0.0, 0.0, 300.0); // Pa
    let load = || Load::Traction { region: side("z-max"), traction: Curve::constant(traction) };
    for body in [bar(hexahedra()), bar(tetrahedra())] {
        let (world, seen) = settled::<T>([0.0; 3], body.load(load()), QUIET * tolerance * tolerance);
        assert_relative(end_displacement(&world).z, traction.z * LENGTH / YOUNG, tolerance);
        assert_vector(seen.reaction, Vector::new(0.0, 0.0, -traction.z * AREA), tolerance);
    }
}
in_both_precisions!(a_pulled_bar_stretches_by_traction_over_young, f32: 3e-4, f64: 1e-6);

/// On hexahedra, four corners carry a quarter of the pressure on their side each: a column stays straight under it.
///
/// Pressure p on the end presses with p·A, and squeezes by pL/E: without lateral contraction the area stays A.
fn a_pressed_bar_is_held_by_pressure_times_area<T: Precision>(tolerance: f64) {
    let pressure = 300.0; // Pa
    let load = || Load::Pressure { region: side("z-max"), pressure: Curve::constant(pressure) };
    for body in [bar(hexahedra()), bar(tetrahedra())] {
        let (world, seen) = settled::<T>([0.0; 3], body.load(load()), QUIET * tolerance * tolerance);
        assert_relative(end_displacement(&world).z, -pressure * LENGTH / YOUNG, tolerance);
        assert_vector(seen.reaction, Vector::new(0.0, 0.0, pressure * AREA), tolerance);
    }
}
in_both_precisions!(a_pressed_bar_is_held_by_pressure_times_area, f32: 3e-4, f64: 1e-6);

/// A force is shared by the nodes of its region and arrives whole.
#[test]
fn a_force_on_a_region_is_held_whole() {
    let total = Vector::new(0.01, -0.02, 0.3); // N
    let load = Load::Force { region: side("z-max"), total: Curve::constant(total) };
    let (_, seen) = settled::<f64>([0.0; 3], bar(tetrahedra()).load(load), 1e-16);
    assert_vector(seen.reaction, -total, 1e-6);
}

/// Pressure all around squeezes a free body by p/K, K = E/3(1 − 2ν), and pushes it nowhere. The area follows the
/// deformation, so a term of the order of p/K = 1e-5 is left.
#[test]
fn pressure_all_around_squeezes_a_free_body_by_pressure_over_bulk_modulus() {
    let poisson = 0.4;
    let bulk = YOUNG / (3.0 * (1.0 - 2.0 * poisson));
    let body = Body::new(TetMesh::box_grid([2, 3, 2], [0.1, 0.2, 0.1]), DENSITY)
        .model(TotalLagrangian::new(linear(YOUNG, poisson)))
        .damping(60.0)
        .load(Load::Pressure { region: Region::Surface, pressure: Curve::constant(1e-5 * bulk) });
    let (_, seen) = settled::<f64>([0.0; 3], body, 1e-14);
    assert_relative(seen.volume_variation, -1e-5, 1e-4);
    assert!(seen.momentum.norm() < 1e-12 * seen.mass, "it drifts: {:?}", seen.momentum);
}

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::implicit::Implicit;
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Corotational, MassSpring, ShapeMemory};
use viscera::world::{Integrator, World, WorldConfig};

use crate::support::{DENSITY, Vector, bar, between, hex_bar, run, tissue, tumbling, world};

/// A bar that a plate presses to 80 % of its height in half a second.
fn pressed() -> Body {
    let way = Curve::piecewise_linear(vec![(0.0, Vec3::ZERO), (0.5, Vector::new(0.0, 0.0, -0.06))]).unwrap();
    Body::new(bar(), DENSITY).damping(5.0).fix(between(0.0, 0.0)).prescribe(between(0.3, 0.3), way)
}

/// The volume is exact after every step, whatever the model, the cells and what presses; without the constraint a tenth of it goes.
#[test]
fn a_pressed_body_keeps_its_volume_to_rounding_in_every_step() {
    let bodies = [
        pressed().model(ShapeMemory::new(tissue())),
        pressed().model(MassSpring::new(tissue())),
        pressed().model(Corotational::new(tissue())).keep_volume(2e4),
        Body::new(hex_bar(), DENSITY).damping(5.0).fix(between(0.0, 0.0)).model(Corotational::new(tissue())),
    ];
    for body in bodies {
        let (mut world, id) = world::<f64>([0.0, -9.81, 0.0], body.keep_volume_exactly("whole", Region::All));
        for _ in 0..60 {
            run(&mut world, 0.01);
            let kept = world.body(id).kept_volumes().next().unwrap();
            assert!(kept.error.abs() <= 1e-12, "{} of {}", kept.error, world.body(id).model());
            assert!((world.observe(id).volume_error - kept.error.abs()).abs() < 1e-15);
        }
        let seen = world.observe(id);
        assert!(seen.max_displacement > 0.005, "{} m", seen.max_displacement);
    }
    let (mut world, id) = world::<f64>([0.0; 3], pressed().model(ShapeMemory::new(tissue())));
    run(&mut world, 0.6);
    let lost = -world.observe(id).volume_variation;
    assert!(lost > 0.05, "without it {lost} of the volume goes");
}

/// In single precision the volume is kept to the rounding of single coordinates.
#[test]
fn in_single_precision_the_volume_is_kept_to_the_rounding_of_coordinates() {
    let body = pressed().model(ShapeMemory::new(tissue())).keep_volume_exactly("whole", Region::All);
    let (mut world, id) = world::<f32>([0.0; 3], body);
    for _ in 0..60 {
        run(&mut world, 0.01);
        let error = world.observe(id).volume_error;
        assert!(error < 2e-6, "{error:e}");
    }
}

/// Whatever presses a closed body from all sides meets just its own pressure from inside, and nothing moves.
#[test]
fn the_pressure_inside_is_the_pressure_on_the_surface() {
    let load = Load::Pressure { region: Region::Surface, pressure: Curve::constant(3e3) };
    let body = Body::new(bar(), DENSITY).model(Corotational::new(tissue())).load(load);
    let (mut world, id) = world::<f64>([0.0; 3], body.keep_volume_exactly("whole", Region::All));
    run(&mut world, 0.1);
    let pressure = world.body(id).kept_volumes().next().unwrap().pressure;
    assert!((pressure / 3e3 - 1.0).abs() < 1e-9, "{pressure} Pa");
    assert!(world.observe(id).max_displacement < 1e-12);
}

/// Pressure from inside has neither sum nor moment: a free body that tumbles, vibrates and keeps its volume keeps momentum and
/// angular momentum too.
#[test]
fn a_free_body_keeps_momentum_and_angular_momentum() {
    let body = Body::new(bar(), DENSITY).model(ShapeMemory::new(tissue())).keep_volume_exactly("whole", Region::All);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    world.body_mut(id).set_velocities(|x| tumbling(x) + Vector::new(0.0, 0.4 * (20.0 * x.z).sin(), 0.2 * x.x));
    let start = world.observe(id);
    let mut pressures = 0.0;
    for _ in 0..200 {
        run(&mut world, 0.01);
        let seen = world.observe(id);
        assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
        let change = (seen.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
        assert!(change < 1e-11, "{change:e}");
        pressures += world.body(id).kept_volumes().next().unwrap().pressure.abs();
    }
    assert!(pressures > 100.0, "the constraint does nothing: {pressures} Pa in all");
}

/// Two volumes that share a wall, squeezed against each other: both are exact, and the wall goes to where they agree.
#[test]
fn volumes_that_share_nodes_are_both_kept() {
    let body = pressed()
        .model(ShapeMemory::new(tissue()))
        .keep_volume_exactly("lower", between(0.0, 0.15))
        .keep_volume_exactly("upper", between(0.15, 0.3));
    let (mut world, id) = world::<f64>([0.0; 3], body);
    for _ in 0..60 {
        run(&mut world, 0.01);
        for kept in world.body(id).kept_volumes() {
            assert!(kept.error.abs() <= 1e-12, "{}: {}", kept.name, kept.error);
        }
    }
}

/// However fine its surface, a volume beside held nodes and rigid parts is kept, to what sums over so many triangles are worth. At rest, with
/// edges of 2 cm, an error of 1.5e-14 was once more than the rounding of coordinates explains.
#[test]
fn the_volume_below_a_fine_surface_is_kept() {
    let named = |name: &str| Region::Named(name.into());
    for (edge, gravity) in [(0.03, 0.0), (0.02, 0.0), (0.02, -1.0), (0.016, 0.0)] {
        let mut body = Body::new(TetMesh::trunk(0.45, edge).unwrap(), 500.0).model(ShapeMemory::new(tissue()));
        for held in ["spine", "pelvis", "ribs-1"] {
            body = body.fix(named(held));
        }
        let body = body.rigid(named("ribs-2")).rigid(named("ribs-3")).keep_volume_exactly("abdomen", named("abdomen"));
        let (mut world, id) = world::<f64>([0.0, gravity, 0.0], body);
        run(&mut world, 0.03);
        let error = world.observe(id).volume_error;
        assert!(error < 1e-12, "{edge} m, {gravity} m/s²: {error:e}");
    }
}

/// A cut takes along the volume that its cells have at that moment; what is left is kept as exactly as before.
#[test]
fn a_cut_takes_along_the_volume_of_its_cells() {
    let body = pressed().model(ShapeMemory::new(tissue())).keep_volume_exactly("whole", Region::All);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    run(&mut world, 0.3);
    let cells: Vec<u32> = (40..52).collect();
    let gone: f64 = cells.iter().map(|&cell| world.body(id).cell_volume(cell as usize)).sum();
    let before = world.body(id).kept_volumes().next().unwrap().wanted;
    world.remove_cells(id, &cells).unwrap();
    let after = world.body(id).kept_volumes().next().unwrap().wanted;
    assert!(((before - after) / gone - 1.0).abs() < 1e-9, "{before} m³ − {gone} m³ is not {after} m³");
    let snapshot = world.snapshot();
    let bytes = snapshot.to_bytes();
    for _ in 0..30 {
        run(&mut world, 0.01);
        assert!(world.observe(id).volume_error <= 1e-12);
    }
    let end = world.body(id).positions().to_vec();
    let read = world.read_snapshot(&bytes).unwrap();
    world.restore(&read).unwrap();
    run(&mut world, 0.3);
    assert!(world.body(id).positions() == end, "a snapshot after a cut goes on otherwise");
}

/// A body all of whose surface is held and pressed together keeps no volume: the step is undone and says which one.
#[test]
fn a_volume_that_nothing_can_keep_is_named() {
    let way = Curve::piecewise_linear(vec![(0.0, Vec3::ZERO), (0.5, Vector::new(0.0, 0.0, -0.06))]).unwrap();
    let body = Body::new(bar(), DENSITY)
        .name("bar")
        .model(ShapeMemory::new(tissue()))
        .prescribe(between(0.2, 0.3), way)
        .fix(between(0.0, 0.15))
        .keep_volume_exactly("whole", Region::All);
    let (mut world, id) = world::<f64>([0.0; 3], body);
    let error = world.step().unwrap_err().to_string();
    assert!(error.contains("the volume `whole` of body `bar` cannot be kept"), "{error}");
    assert_eq!(world.body(id).max_displacement(), 0.0, "the step is not undone");
}

/// Implicit steps say that they do not know it.
#[test]
fn implicit_steps_refuse_it() {
    let integrator = Integrator::Implicit(Implicit::default());
    let mut world = World::<f64>::new(WorldConfig { integrator, ..WorldConfig::default() }).unwrap();
    let body = pressed().name("bar").model(ShapeMemory::new(tissue())).keep_volume_exactly("whole", Region::All);
    assert_eq!(
        world.add(body).unwrap_err().to_string(),
        "body `bar` has volumes kept exactly, which implicit steps do not know; take the explicit integrator"
    );
}

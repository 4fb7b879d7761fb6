//! Ready-made scenes of what pulls by itself, and the scripted inversion of shape memory against a net of springs.

use std::path::Path;

use viscera::math::Vec3;
use viscera::mesh::{Region, VolumeMesh};
use viscera_scene::{BuiltScene, Scene};

/// A scene in double precision.
fn built(name: &str, overrides: &[(&str, &str)]) -> BuiltScene<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name);
    let mut scene = Scene::load(path).unwrap_or_else(|errors| panic!("{errors}"));
    for (key, value) in overrides {
        scene.set(key, value).unwrap_or_else(|errors| panic!("{errors}"));
    }
    scene.build::<f64>().unwrap_or_else(|errors| panic!("{errors}"))
}

/// Fibres of a stress σ in half of an arm of width b bend it with the moment σ b²/2 · b/4, to the curvature 3σ/(2E b) of beam theory, of which
/// four plain tetrahedra across give the better part; a tendon along the other side bends it the other way. Both pull at the arm
/// alone: the foot holds neither force.
#[test]
fn an_arm_bends_by_fibres_and_by_a_tendon_and_its_foot_holds_nothing() {
    let mut built = built("soft-arm.toml", &[]);
    let arm = built.bodies["arm"];
    let tip = Region::nearest([0.015, 0.015, 0.2]).nodes(built.world.body(arm).mesh()).unwrap()[0] as usize;
    let mut ways = Vec::new();
    for step in 1..=built.steps() {
        built.world.step().unwrap_or_else(|error| panic!("{error}"));
        if step == 200 || step == built.steps() {
            let observed = built.world.observe(arm);
            let forces = built.world.external_forces(arm).iter().map(|force| force.norm()).sum::<f64>();
            assert!(observed.reaction.norm() < 1e-4 * forces, "{} N of {forces} N", observed.reaction.norm());
            ways.push(built.world.body(arm).positions()[tip].x - 0.015);
        }
    }
    let curvature = 3.0 * 1e3 / (2.0 * 20e3 * 0.03);
    let expected = (1.0 - (curvature * 0.2f64).cos()) / curvature;
    let share = -ways[0] / expected;
    assert!((0.65..1.1).contains(&share), "the tip goes {} m, beam theory has {expected} m", -ways[0]);
    assert!(ways[1] > 0.02, "the tendon draws the tip to {} m", ways[1]);
}

/// At rest the floor holds what the magnet pulls with: the volume of the bead times the field at its centre, but for what differs across
/// the bead, some (3/5) (a/r)² of it.
#[test]
fn a_magnet_draws_the_bead_and_the_floor_holds_its_pull() {
    let mut built = built("magnet.toml", &[]);
    for _ in 0..built.steps() {
        built.world.step().unwrap_or_else(|error| panic!("{error}"));
    }
    let block = built.bodies["block"];
    let observed = built.world.observe(block);
    let body = built.world.body(block);
    let region = Region::sphere([0.03, 0.03, 0.042], 0.011);
    let cells = region.cells(body.mesh()).unwrap();
    let VolumeMesh::Tet(mesh) = body.mesh() else { panic!("the block is made of hexahedra") };
    let volume: f64 = cells.iter().map(|&cell| mesh.cell_volume(cell as usize)).sum();
    let moment = cells.iter().fold(Vec3::ZERO, |sum, &cell| {
        let corners = mesh.cells[cell as usize].iter().map(|&node| body.positions()[node as usize]);
        sum + corners.fold(Vec3::ZERO, |sum, x| sum + x) * (0.25 * mesh.cell_volume(cell as usize))
    });
    let centre = moment / volume;
    let away = (Vec3::new(0.03, 0.03, 0.08) - centre).norm();
    let pull = volume * 2.5e6 * (0.01 / away).powi(2);
    assert!(centre.z > 0.045, "the bead has come up to {} m", centre.z);
    let across = 0.6 * (0.011 / away).powi(2);
    assert!((observed.reaction.z + pull).abs() < (across + 0.01) * pull, "{} N hold {pull} N", observed.reaction.z);
    assert!(observed.reaction.x.abs() + observed.reaction.y.abs() < 0.01 * pull);
}

/// Two handles drag a liver through itself: where nodes remember their neighbourhood it comes back, and in a net of springs it stays
/// inside out. As many steps, the same handles, the same tissue; explicit, as nets are stepped.
#[test]
fn shape_memory_survives_the_handles_that_break_a_net_of_springs() {
    let run = |model: &str| {
        let overrides = [
            ("body.liver.mesh.edge", "22 mm"),
            ("body.liver.model.kind", model),
            ("integrator.kind", "explicit"),
            ("step", "20 ms"),
            ("duration", "8 s"),
        ];
        let mut built = built("liver-inversion.toml", &overrides);
        let (liver, mut most) = (built.bodies["liver"], 0);
        for _ in 0..built.steps() {
            built.world.step().unwrap_or_else(|error| panic!("{model}: {error}"));
            most = most.max(built.world.observe(liver).inverted_cells);
        }
        (most, built.world.observe(liver), built.world.body(liver).cell_count())
    };
    let (most, memory, cells) = run("shape-memory");
    assert!(20 * most > cells, "{most} of {cells} cells inverted while the handles drag");
    assert_eq!(memory.inverted_cells, 0);
    assert!(memory.max_displacement < 3e-3, "{} m from rest", memory.max_displacement);
    let (_, net, _) = run("mass-spring");
    assert!(10 * net.inverted_cells > cells, "only {} of {cells} cells of the net stay inside out", net.inverted_cells);
}

//! Corotational bodies in motion: stable at the sub-step that the world chooses, and repeatable to the bit.

use viscera::body::Body;
use viscera::material::{LinearElastic, Tissue};
use viscera::mesh::{HexMesh, Region, TetMesh, VolumeMesh};
use viscera::model::Corotational;
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement};
use viscera::world::{BodyId, Integrator, Substep, World, WorldConfig};

use crate::support::Vector;

const SIZE: [f64; 3] = [0.05, 0.05, 0.2];

fn recipe(rotation: Rotation, strain: StrainDisplacement, volume: IntegrationVolume) -> Corotational {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.4).unwrap());
    Corotational::new(tissue).rotation(rotation).strain_displacement(strain).volume(volume)
}

/// A free bar in space.
fn bar(mesh: impl Into<VolumeMesh>, recipe: Corotational) -> (World<f64>, BodyId) {
    let config = WorldConfig { gravity: [0.0; 3], step: 0.01, ..Default::default() };
    let mut world = World::new(config).unwrap();
    let bar = world.add(Body::new(mesh, 1000.0).model(recipe)).unwrap();
    (world, bar)
}

/// Largest error of the energy over a second, relative to what a stretch by a third stores at first; and the sub-steps
/// of a step.
fn energy_error(rotation: Rotation, substep: Substep) -> (f64, u32) {
    let config = WorldConfig { gravity: [0.0; 3], step: 0.01, integrator: Integrator::Explicit(substep) };
    let mut world = World::<f64>::new(config).unwrap();
    let recipe = recipe(rotation, Default::default(), Default::default());
    let id = world.add(Body::new(TetMesh::box_grid([1, 1, 4], SIZE), 1000.0).model(recipe)).unwrap();
    world.body_mut(id).set_positions(|x| Vector::new(-x.y, x.x, 1.33 * x.z));
    let energy = world.observe(id).elastic_energy;
    let (mut worst, mut substeps) = (0.0_f64, 0);
    for _ in 0..100 {
        substeps = world.step().unwrap().substeps;
        let now = world.observe(id);
        worst = worst.max((now.kinetic_energy + now.elastic_energy - energy).abs() / energy);
    }
    (worst, substeps)
}

/// Turned, stretched and let go, for a second of some ten periods. At nine tenths of the stability limit the energy of
/// the fastest modes swings and does not grow; beyond the limit it would be multiplied a thousandfold in a few sub-steps.
/// The swing is of second order: a quarter of the sub-step leaves about a sixteenth of it.
#[test]
fn explicit_steps_of_the_automatic_length_keep_the_energy_of_the_conservative_variants() {
    for rotation in [Rotation::Polar, Rotation::Svd] {
        let (swing, substeps) = energy_error(rotation, Substep::Automatic);
        assert!(swing < 0.2, "{rotation:?}: {swing}");
        let (finer, _) = energy_error(rotation, Substep::Fixed(0.01 / f64::from(4 * substeps)));
        assert!(finer < swing / 10.0, "{rotation:?}: {finer} after {swing}");
    }
}

/// The other variants have no energy to keep; damped, they must come to rest in their rest shape all the same.
#[test]
fn damped_explicit_steps_of_every_variant_come_to_rest_undeformed() {
    for rotation in [Rotation::Polar, Rotation::Qr] {
        for strain in [StrainDisplacement::AtRest, StrainDisplacement::Updated] {
            for volume in [IntegrationVolume::Initial, IntegrationVolume::Current] {
                let meshes: [VolumeMesh; 2] =
                    [TetMesh::box_grid([1, 1, 3], SIZE).into(), HexMesh::box_grid([1, 1, 3], SIZE).into()];
                for mesh in meshes {
                    let what = format!("{rotation:?}, {strain:?}, {volume:?}");
                    let config = WorldConfig { gravity: [0.0; 3], step: 0.01, ..Default::default() };
                    let mut world = World::<f64>::new(config).unwrap();
                    let body = Body::new(mesh, 1000.0).model(recipe(rotation, strain, volume)).damping(20.0);
                    let ground = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
                    let id = world.add(body.fix(ground)).unwrap();
                    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y + 0.5 * x.z * x.z, 1.2 * x.z));
                    let start = world.observe(id).max_displacement;
                    for _ in 0..150 {
                        world.step().unwrap_or_else(|error| panic!("{what}: {error}"));
                    }
                    let end = world.observe(id).max_displacement;
                    assert!(end < 0.05 * start, "{what}: {end} of {start}");
                }
            }
        }
    }
}

/// The rotation of a cell depends on its deformation alone, so a restored body goes the same way to the bit.
#[test]
fn restored_bodies_repeat_their_motion_to_the_bit() {
    let (mut world, id) =
        bar(TetMesh::box_grid([2, 2, 4], SIZE), recipe(Rotation::Polar, Default::default(), Default::default()));
    world.body_mut(id).set_positions(|x| x * 1.1 + uneven_shift(x));
    world.body_mut(id).set_velocities(|x| Vector::new(-x.y, x.x, 0.0) * 3.0);
    run(&mut world, 3);
    let snapshot = world.snapshot();
    run(&mut world, 5);
    let once = world.body(id).positions().to_vec();
    world.restore(&snapshot).unwrap();
    run(&mut world, 5);
    assert_eq!(world.body(id).positions(), once);
}

fn run(world: &mut World<f64>, steps: usize) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// A shift that differs from node to node.
fn uneven_shift(x: Vector) -> Vector {
    Vector::new((131.0 * x.y).sin(), (97.0 * x.z).sin(), (53.0 * x.x).sin()) * 0.002
}

/// A body that a quarter of its cells pass through itself is counted and measured, and has no torque of its own.
#[test]
fn element_health_is_seen_in_the_observables() {
    let (mut world, id) =
        bar(TetMesh::box_grid([1, 1, 4], SIZE), recipe(Rotation::Polar, Default::default(), Default::default()));
    let healthy = world.observe(id);
    assert_eq!(healthy.inverted_cells, 0);
    assert!(healthy.worst_quality > 0.5, "{}", healthy.worst_quality);
    world.body_mut(id).set_positions(|x| if x.z > 0.19 { Vector::new(x.x, x.y, 0.12) } else { x });
    let ill = world.observe(id);
    assert!(ill.inverted_cells > 0 && ill.worst_quality < 0.0, "{} {}", ill.inverted_cells, ill.worst_quality);
    let force = world.body(id).state().internal_forces.iter().map(|force| force.norm()).sum::<f64>();
    assert!(ill.net_internal_force.norm() <= 1e-14 * force);
    assert!(ill.net_internal_torque.norm() <= 1e-14 * force * SIZE[2]);

    let qr = recipe(Rotation::Qr, Default::default(), Default::default());
    let (mut world, id) = bar(TetMesh::box_grid([1, 1, 4], SIZE), qr);
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y + 2.0 * x.z * x.z, x.z));
    let turning = world.observe(id);
    let force = world.body(id).state().internal_forces.iter().map(|force| force.norm()).sum::<f64>();
    assert!(turning.net_internal_torque.norm() > 1e-4 * force * SIZE[2], "QR with B at rest turns the body");
}

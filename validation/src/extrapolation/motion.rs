//! Tissue that a hand holds and moves, stepped in full: the force that the hand should feel in every millisecond.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::Implicit;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::instrument::Grasper;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::world::{InstrumentId, Integrator, Substep, World, WorldConfig};
use viscera_direct::Cholesky;

use crate::references::Vector;
use crate::{Size, ValidationError};

/// A period of the channel [s].
pub(super) const PERIOD: f64 = 1e-3;
/// Where the grasper takes hold of the edge of the left lobe [m], and how far around [m].
const GRASP: Vector = Vector::new(0.13, 0.03, 0.01);
const RADIUS: f64 = 0.03;
/// Time in which the hand comes into motion [s].
const RAMP: f64 = 0.4;

/// What the hand should feel: time [s], place of the tip [m] and force on it [N], in every millisecond.
#[derive(Clone)]
pub(super) struct Felt {
    pub(super) moments: Vec<Moment>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) time: f64,
    pub(super) tip: Vector,
    pub(super) force: Vector,
}

impl Felt {
    /// Largest force [N].
    pub(super) fn largest(&self) -> f64 {
        self.moments.iter().map(|moment| moment.force.norm()).fold(0.0, f64::max)
    }
}

/// Off the place of the grasp [m]: 15 mm to and fro in each direction, at 0.5 to 1.1 Hz, up to 0.15 m/s.
fn way(time: f64) -> Vector {
    let share = (time / RAMP).clamp(0.0, 1.0);
    // From rest with neither a step in velocity nor in acceleration.
    let ramp = share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share);
    let wave = |hertz: f64, phase: f64| (std::f64::consts::TAU * hertz * time + phase).sin();
    Vector::new(0.015 + 0.015 * wave(0.7, 0.3), 0.015 * wave(0.5, 1.1), 0.015 * wave(1.1, 2.0)) * ramp
}

/// The hand's way, off by `offset` [m] after the ramp, as a path of the grasper.
fn path(duration: f64, offset: Vector) -> Result<Curve<Vector>, ValidationError> {
    let count = (duration / PERIOD).round() as u32 + 1;
    let place = |number: u32| {
        let time = f64::from(number) * PERIOD;
        (time, GRASP + way(time) + offset * (time / RAMP).min(1.0))
    };
    Ok(Curve::piecewise_linear((0..=count).map(place).collect())?)
}

fn mesh(size: Size) -> Result<TetMesh, ValidationError> {
    Ok(TetMesh::liver(0.3, if size == Size::Full { 0.02 } else { 0.04 })?)
}

/// Tetrahedra of the liver.
pub(super) fn cells(size: Size) -> Result<usize, ValidationError> {
    Ok(mesh(size)?.cells.len())
}

/// A liver of 30 cm that is held at its back, and a grasper that holds the edge of its left lobe.
fn held(
    size: Size,
    tissue: Tissue,
    integrator: Integrator,
    step: f64,
    path: Curve<Vector>,
) -> Result<(World<f64>, InstrumentId), ValidationError> {
    let mut world = World::new(WorldConfig { gravity: [0.0; 3], step, integrator })?;
    let liver = Body::new(mesh(size)?, 1060.0)
        .model(TotalLagrangian::new(tissue))
        .damping(3.0)
        .fix(Region::Named("back".into()));
    world.add(liver)?;
    let grasper = world.add_instrument(Grasper { path, radius: RADIUS, close: 0.0, ..Grasper::default() })?;
    Ok((world, grasper))
}

fn moment(world: &mut World<f64>, grasper: InstrumentId) -> Moment {
    let seen = world.observe_instrument(grasper);
    // The grasper pulls the tissue; the hand feels the tissue.
    Moment { time: world.time(), tip: seen.tip, force: -seen.force }
}

/// Steps of so many milliseconds of liver of 3 kPa along the hand's way, off by `offset` [m]; explicit ones where `step` is 1.
pub(super) fn stepped(size: Size, step: u32, duration: f64, offset: Vector) -> Result<Felt, ValidationError> {
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(3e3, 0.4)?);
    let integrator = match step {
        1 => Integrator::Explicit(Substep::Automatic),
        _ => Integrator::Implicit(Implicit::default()),
    };
    let step = f64::from(step) * PERIOD;
    let (mut world, grasper) = held(size, tissue, integrator, step, path(duration, offset)?)?;
    let mut moments = Vec::new();
    while world.time() < duration - 0.5 * step {
        world.step()?;
        moments.push(moment(&mut world, grasper));
    }
    Ok(Felt { moments })
}

/// Linear tissue moved so slowly that it is at rest in every millisecond, along a line.
pub(super) fn at_rest_along_a_line(size: Size, moments: u32) -> Result<Felt, ValidationError> {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(3e3, 0.4)?);
    let direction = Vector::new(0.6, 0.48, 0.64);
    let to_and_fro = |number: u32| {
        let time = f64::from(number) * PERIOD;
        (time, GRASP + direction * (0.02 * (std::f64::consts::TAU * time).sin()))
    };
    let path = Curve::piecewise_linear((0..=moments + 1).map(to_and_fro).collect())?;
    let (mut world, grasper) = held(size, tissue, Integrator::Explicit(Substep::Automatic), PERIOD, path)?;
    let bodies: Vec<_> = world.body_ids().collect();
    let mut felt = Vec::new();
    for _ in 0..moments {
        world.step()?;
        // What a tool reports is of the step; at rest the fixed end bears what the hand feels.
        let mut force = Vector::ZERO;
        for &body in &bodies {
            world.settle(body, &QuasiStatic::default(), &mut Cholesky::default())?;
            force += world.observe(body).reaction;
        }
        felt.push(Moment { time: world.time(), tip: world.tool(grasper).pose.tip, force });
    }
    Ok(Felt { moments: felt })
}

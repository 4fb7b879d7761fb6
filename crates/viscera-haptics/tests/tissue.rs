//! The channel on tissue: a block that a hand pulls and presses.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::instrument::Grasper;
use viscera::material::{LinearElastic, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::world::{InstrumentId, Integrator, Substep, World, WorldConfig};
use viscera_haptics::{
    Channel, ChannelSettings, Device, EmulatedDevice, Extrapolation, Hand, Matrix, Pose, Rating, Tool, Vector,
};

const YOUNG: f64 = 5e3;
const SIDE: f64 = 0.06;
const HEIGHT: f64 = 0.12;

/// A bar of 6 × 6 × 12 cm without Poisson's effect, fixed below. A grasper takes all of its upper end.
fn bar(integrator: Integrator, step: f64) -> (World<f64>, InstrumentId) {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, 0.0).unwrap());
    let mut world = World::new(WorldConfig { gravity: [0.0; 3], step, integrator }).unwrap();
    let body = Body::new(TetMesh::box_grid([2, 2, 4], [SIDE, SIDE, HEIGHT]), 1000.0)
        .model(TotalLagrangian::new(tissue))
        .damping(20.0)
        .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 1e-9));
    world.add(body).unwrap();
    // 30 mm above the end, its corners are 52 mm away, and the next layer of nodes 60 mm.
    let grasper = Grasper { radius: 0.055, ..Grasper::default() };
    let id = world.add_instrument(grasper).unwrap();
    (world, id)
}

fn top(offset: Vector) -> Vector {
    Vector::new(0.5 * SIDE, 0.5 * SIDE, HEIGHT + 0.03) + offset
}

fn pose(time: f64, offset: Vector) -> Pose {
    let orientation = Matrix::IDENTITY;
    Pose { time, position: top(offset), orientation, velocity: Vector::ZERO, trigger: 1.0 }
}

/// Implicit steps so long that the tissue comes to rest in each: the stiffness is that of a bar, E A/l along its axis.
#[test]
fn probing_finds_the_stiffness_of_a_bar_and_leaves_no_trace() {
    let go = |probing: bool| {
        let (mut world, id) = bar(Integrator::Implicit(Implicit::accurate(Scheme::BackwardEuler)), 1e4);
        let tool = Tool::new(id);
        let mut tool = if probing { tool.probing(1e-4, 1) } else { tool };
        // It comes open, takes hold, and is pulled by 2 mm.
        let pulled = [0.0, 0.0, 1e-3, 2e-3].into_iter().enumerate();
        let samples: Vec<_> = pulled
            .map(|(number, up)| tool.step(&mut world, &pose(number as f64, Vector::new(0.0, 0.0, up))).unwrap())
            .collect();
        (samples, world.snapshot().to_bytes())
    };
    let (samples, probed) = go(true);
    let stiffness = samples[3].stiffness.unwrap();
    let expected = YOUNG * SIDE * SIDE / HEIGHT;
    assert!((stiffness.columns[2].z / expected - 1.0).abs() < 1e-3, "{} N/m, not {expected}", stiffness.columns[2].z);
    // Reciprocity: a linear body's stiffness is symmetric.
    let skew = stiffness - stiffness.transpose();
    assert!(skew.squared_norm().sqrt() < 1e-3 * expected, "{stiffness:?}");
    assert!((samples[3].force.z + expected * 2e-3).abs() < 1e-3 * expected * 2e-3, "{:?}", samples[3].force);
    assert_eq!(probed, go(false).1, "the world went on as if nobody had asked");
}

/// A hand that presses on the bar through the whole channel, which steps the bar in every millisecond, and holds still.
#[test]
fn a_hand_feels_the_bar_that_it_presses() {
    let (mut world, id) = bar(Integrator::Explicit(Substep::Automatic), 1e-3);
    let mut tool = Tool::new(id);
    let depth = 4e-3;
    let way = move |time: f64| top(Vector::new(0.0, 0.0, -depth * ((time - 0.1) / 0.5).clamp(0.0, 1.0)));
    let mut device = EmulatedDevice::new(Rating::TOUCH, Hand::on_rails(way)).trigger(1.0);
    let settings = ChannelSettings { extrapolation: Extrapolation::Direct, ..ChannelSettings::default() };
    let mut channel = Channel::new(settings, device.rating()).unwrap();
    for tick in 0..1500 {
        let time = f64::from(tick) * 1e-3;
        let reading = device.read(time).unwrap();
        let pose = channel.pose(time, &reading);
        let sample = tool.step(&mut world, &pose).unwrap();
        let force = channel.force(Some(sample));
        device.command(force).unwrap();
    }
    let expected = YOUNG * SIDE * SIDE / HEIGHT * depth;
    let felt = device.felt();
    // At rest the fixed end bears what the hand feels.
    let body = world.body_ids().next().unwrap();
    assert!((world.observe(body).reaction.z / expected - 1.0).abs() < 1e-3);
    assert!((felt.z / expected - 1.0).abs() < 1e-3, "{felt:?}, not {expected} N");
    // What the hand has put in is what the bar holds, ½ K x², and what damping took of it.
    let (energy, stored) = (channel.state().energy, 0.5 * expected * depth);
    assert!(energy > stored && energy < 1.5 * stored, "{energy} J, {stored} J stored");
}

/// Led by x̃ ← x̃ + (x − x̃)(1 − e), e = exp(−Δt/τ), a tool is v Δt e/(1 − e) behind a hand of constant velocity v.
#[test]
fn a_tool_that_follows_is_behind_the_hand_by_its_time() {
    let (mut world, id) = bar(Integrator::Explicit(Substep::Automatic), 1e-3);
    let (speed, delay) = (0.02, 5e-3);
    let mut tool = Tool::new(id).following(delay);
    let mut behind = 0.0;
    for tick in 0..100 {
        let time = f64::from(tick) * 1e-3;
        let there = pose(time, Vector::new(speed * time, 0.0, 0.0));
        behind = there.position.x - tool.step(&mut world, &there).unwrap().position.x;
    }
    let share = (-1e-3_f64 / delay).exp();
    let expected = speed * 1e-3 * share / (1.0 - share);
    assert!((behind / expected - 1.0).abs() < 1e-6, "{behind} m, not {expected} m");
}

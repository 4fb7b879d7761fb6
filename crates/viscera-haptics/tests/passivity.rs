//! Energy between the hand and the tissue.

use viscera_haptics::{
    Channel, ChannelSettings, Contact, Device, EmulatedDevice, Extrapolation, Hand, Limits, PassivityChoice, Rating,
    Reading, Sample, Vector, Watchdog,
};

/// A device that bears everything, so that nothing but energy is in question.
const STRONG: Rating = Rating {
    peak_force: 1e3,
    continuous_force: f64::INFINITY,
    thermal_time: 1.0,
    power: f64::INFINITY,
    stiffness: f64::INFINITY,
    resolution: 0.0,
    workspace: 1.0,
    mass: 0.1,
};

/// Force at once, however steep.
const LIMITS: Limits = Limits {
    peak_force: 1e3,
    continuous_force: f64::INFINITY,
    thermal_time: 1.0,
    power: f64::INFINITY,
    rate: f64::INFINITY,
};

fn channel(extrapolation: Extrapolation, passivity: PassivityChoice) -> Channel {
    // The force is there after a millisecond.
    let watchdog = Watchdog { patience: 10.0, fade: 1.0, recovery: 1e-6 };
    let settings =
        ChannelSettings { extrapolation, passivity, watchdog, limits: Some(LIMITS), ..ChannelSettings::default() };
    Channel::new(settings, STRONG).unwrap()
}

fn along(x: f64) -> Vector {
    Vector::new(x, 0.0, 0.0)
}

/// A wall at x = 0 of `stiffness`, to the side of negative x.
fn wall(time: f64, position: Vector, stiffness: f64) -> Sample {
    Sample {
        time,
        position,
        force: along(-stiffness * position.x.min(0.0)),
        stiffness: None,
        contact: Contact::Pressing,
    }
}

/// A hand presses into a wall by n steps of δ and comes back out. Held over each step, the force is one step behind: on the way in
/// Σ_{0}^{n−1} K i δ·δ is put in, on the way out Σ_{1}^{n} K i δ·δ comes back, K n δ² more.
#[test]
fn a_held_wall_gives_back_more_than_it_got_by_as_much_as_theory_says() {
    const STIFFNESS: f64 = 800.0;
    const STEP: f64 = 0.2e-3;
    const STEPS: i32 = 30;
    let mut channel = channel(Extrapolation::Direct, PassivityChoice::Off);
    let depths = (-20..STEPS).chain((0..=STEPS).rev());
    for (tick, depth) in depths.enumerate() {
        let (time, position) = (tick as f64 * 1e-3, along(-STEP * f64::from(depth)));
        let reading = Reading { position, ..Reading::default() };
        channel.tick(time, &reading, Some(wall(time, position, STIFFNESS)));
    }
    let expected = -STIFFNESS * STEP * STEP * f64::from(STEPS);
    let found = channel.state().energy;
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} J, not {expected} J");
}

/// Fingers that begin before the wall and want to be 10 mm behind it.
fn into_the_wall(time: f64) -> Vector {
    along(if time > 0.0 { -0.01 } else { 0.005 })
}

/// A handle that is pressed against a wall by fingers of 60 N/m, which damp little. Gives its speed [m/s] over time, and the energy
/// that the hand had got by the end.
fn pressed_against_a_wall(interval: u32, passivity: PassivityChoice) -> (Vec<f64>, f64) {
    let hand = Hand::yielding(0.1, 60.0, 0.2, into_the_wall);
    let mut device = EmulatedDevice::new(STRONG, hand);
    let mut channel = channel(Extrapolation::Hold, passivity);
    let mut speeds = Vec::new();
    for tick in 0..4000 {
        let time = f64::from(tick) * 1e-3;
        let reading = device.read(time).unwrap();
        let sample = (tick % interval == 0).then(|| wall(time, reading.position, 600.0));
        let force = channel.tick(time, &reading, sample);
        device.command(force).unwrap();
        speeds.push(device.hand().velocity().norm());
    }
    (speeds, channel.state().energy)
}

fn fastest(speeds: &[f64]) -> f64 {
    speeds.iter().copied().fold(0.0, f64::max)
}

/// A wall that is known every 20 ms and held in between needs K Δt/2 = 6 N s/m of damping to be passive; the fingers have 0.2.
#[test]
fn a_wall_that_breaks_loose_when_it_is_held_comes_to_rest_with_the_controller() {
    // The fingers bring ½ · 60 N/m · (15 mm)².
    let (brought, mass) = (0.5 * 60.0 * 0.015 * 0.015, 0.1);
    let (alone, energy) = pressed_against_a_wall(20, PassivityChoice::Off);
    assert!(fastest(&alone[3000..]) > 100.0, "held alone it breaks loose: {} m/s", fastest(&alone[3000..]));
    assert!(energy < -100.0 * brought, "and feeds on {energy} J out of nothing");

    let (controlled, energy) = pressed_against_a_wall(20, PassivityChoice::OfDevice);
    let half_seconds: Vec<f64> = controlled.chunks(500).map(fastest).collect();
    assert!(half_seconds.is_sorted_by(|before, after| before >= after), "it calms down: {half_seconds:?} m/s");
    assert!(half_seconds[0] < (2.0 * brought / mass).sqrt(), "never faster than what was brought: {half_seconds:?}");
    assert!(half_seconds[7] < 0.1 * half_seconds[0], "{half_seconds:?}");
    // What a period does unforeseen, ½ F²T²/m of 10 N, is paid back in the next.
    assert!(energy > -0.5 * (10.0_f64 * 1e-3).powi(2) / mass, "{energy} J");
}

/// A wall of 600 N/m that is known in every period is passive with damping of K T/2 = 0.3 N s/m in it; this one has 1.5.
#[test]
fn a_wall_that_is_passive_by_itself_is_left_alone() {
    let run = |passivity| {
        let hand = Hand::yielding(0.1, 60.0, 1.0, into_the_wall);
        let mut device = EmulatedDevice::new(STRONG, hand);
        let mut channel = channel(Extrapolation::Direct, passivity);
        for tick in 0..4000 {
            let time = f64::from(tick) * 1e-3;
            let reading = device.read(time).unwrap();
            let pose = channel.pose(time, &reading);
            let mut sample = wall(time, pose.position, 600.0);
            sample.force += if pose.position.x < 0.0 { pose.velocity * -1.5 } else { Vector::ZERO };
            let force = channel.force(Some(sample));
            device.command(force).unwrap();
        }
        (device.hand().velocity().norm(), device.hand().position().x, channel.state().energy)
    };
    let (with, without) = (run(PassivityChoice::OfDevice), run(PassivityChoice::Off));
    assert_eq!(with, without);
    // 60 N/m from −10 mm against 600 N/m from 0: rest at −10 mm · 60/660.
    assert!(with.0 < 1e-6 && (with.1 + 0.01 * 60.0 / 660.0).abs() < 1e-6, "{with:?}");
}

/// What dissipated in the tissue does not pay for trembling after the tool has left it.
#[test]
fn in_the_air_the_account_is_closed() {
    let mut channel = channel(Extrapolation::Direct, PassivityChoice::OfDevice);
    let mut tick = |time: f64, x: f64, force: f64| {
        let position = along(x);
        let sample = Sample { time, position, force: along(force), stiffness: None, contact: Contact::Pressing };
        channel.tick(time, &Reading { position, ..Reading::default() }, Some(sample));
        channel.state().energy
    };
    let mut energy = 0.0;
    for number in 0..100 {
        // Rubbed against 2 N, over 10 cm.
        energy = tick(f64::from(number) * 1e-3, f64::from(number) * 1e-3, -2.0);
    }
    assert!(energy > 0.19, "{energy} J");
    assert!(tick(0.1, 0.1, 0.0) <= 0.0);
}

//! What the channel keeps, whatever comes in.

use viscera_haptics::{
    Channel, ChannelSettings, Contact, Extrapolation, Matrix, PassivityChoice, Rating, Reading, Sample, SettingError,
    Vector, Watchdog, Workspace,
};

/// Numbers of any size, and some that are none.
fn wild(random: &mut fastrand::Rng) -> f64 {
    match random.u8(0..20) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => 0.0,
        _ => (random.f64() - 0.5) * 10.0_f64.powi(random.i32(-12..12)),
    }
}

fn wild_vector(random: &mut fastrand::Rng) -> Vector {
    Vector::new(wild(random), wild(random), wild(random))
}

/// Samples and motions of any size, at times that jump: the force is finite and never above the device's peak.
#[test]
fn no_sample_or_motion_brings_more_force_than_the_device_bears() {
    for extrapolation in Extrapolation::ALL {
        for passivity in [PassivityChoice::OfDevice, PassivityChoice::Off] {
            let mut random = fastrand::Rng::with_seed(11);
            let settings = ChannelSettings { extrapolation, passivity, ..ChannelSettings::default() };
            let mut channel = Channel::new(settings, Rating::TOUCH).unwrap();
            let (mut now, mut largest) = (0.0, 0.0_f64);
            for _ in 0..20_000 {
                now += if random.u8(0..50) == 0 { 0.3 * random.f64() } else { 1e-3 };
                let position = Vector::new(random.f64(), random.f64(), random.f64()) * 0.16;
                let sample = Sample {
                    time: now - 0.05 * random.f64(),
                    position: wild_vector(&mut random),
                    force: wild_vector(&mut random),
                    stiffness: random.bool().then(|| Matrix { columns: [(); 3].map(|()| wild_vector(&mut random)) }),
                    contact: if random.bool() { Contact::Holding } else { Contact::Pressing },
                };
                let sample = (random.u8(0..16) == 0).then_some(sample);
                let force = channel.tick(now, &Reading { position, ..Reading::default() }, sample);
                largest = largest.max(force.norm());
                assert!(force.is_finite() && force.norm() <= Rating::TOUCH.peak_force * (1.0 + 1e-12), "{force:?}");
                // In a pause of 0.3 s the peak goes on: (3.3/0.88)² · 0.3/10 more than what motors bear.
                assert!(channel.state().warmth <= 1.43, "{}", channel.state().warmth);
            }
            assert!(largest > 0.5, "{extrapolation:?}: it was alive, {largest} N");
        }
    }
}

/// A simulation that stops answering, with a hand pressed into stiff tissue.
#[test]
fn the_force_of_a_simulation_that_died_fades_over_the_stated_time() {
    let watchdog = Watchdog { patience: 0.08, fade: 0.25, recovery: 0.1 };
    let settings = ChannelSettings { watchdog, ..ChannelSettings::default() };
    let mut channel = Channel::new(settings, Rating::TOUCH).unwrap();
    let reading = Reading { position: Vector::new(0.0, -0.01, 0.0), ..Reading::default() };
    let died = 0.5;
    let mut forces = Vec::new();
    for tick in 0..1000 {
        let time = f64::from(tick) * 1e-3;
        let sample = Sample {
            time,
            position: reading.position,
            force: Vector::new(0.0, 0.8, 0.0),
            stiffness: None,
            contact: Contact::Holding,
        };
        let alive = tick % 20 == 0 && time <= died;
        forces.push(channel.tick(time, &reading, alive.then_some(sample)).y);
    }
    let at = |time: f64| forces[(time * 1e3).round() as usize];
    assert!((at(died + 0.08) - 0.8).abs() < 1e-12);
    assert!((at(died + 0.08 + 0.125) - 0.4).abs() < 0.8 * 1e-3 / 0.25 + 1e-12);
    assert_eq!(at(died + 0.08 + 0.251), 0.0);
    assert!(forces.windows(2).skip(600).all(|pair| pair[1] <= pair[0]), "it falls all the way");
}

/// Half the motion, three times the force, turned by a quarter about z: work at the hand is 6 times that in the scene.
#[test]
fn a_workspace_that_is_turned_and_scaled_gives_the_force_where_the_hand_is() {
    let (x, y, z) = (Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0));
    let origin = Vector::new(0.1, 0.2, 0.3);
    let workspace = Workspace { origin, rotation: Matrix::from_columns(y, -x, z), scale: 0.5, force: 3.0 };
    let settings = ChannelSettings { workspace, ..ChannelSettings::default() };
    let mut channel = Channel::new(settings, Rating::TOUCH).unwrap();
    let reading = Reading { position: Vector::new(0.02, 0.0, 0.0), ..Reading::default() };
    for tick in 0..500 {
        let pose = channel.pose(f64::from(tick) * 1e-3, &reading);
        assert!((pose.position - (origin + y * 0.01)).norm() < 1e-15);
        let force = (pose.position - origin) * -10.0;
        let (time, position) = (pose.time, pose.position);
        channel.force(Some(Sample { time, position, force, stiffness: None, contact: Contact::Holding }));
    }
    assert!((channel.state().force + x * 0.3).norm() < 1e-12, "{:?}", channel.state().force);
}

#[test]
fn settings_that_make_no_sense_are_named() {
    let refused = |settings: ChannelSettings, rating: Rating| Channel::new(settings, rating).unwrap_err().to_string();
    let good = ChannelSettings::default();
    assert_eq!(
        refused(ChannelSettings { period: 0.0, ..good }, Rating::TOUCH),
        "period = 0 is out of range: it must be positive and finite"
    );
    assert_eq!(
        refused(good, Rating { peak_force: f64::NAN, ..Rating::TOUCH }),
        "rating.peak_force = NaN is out of range: it must be positive and finite"
    );
    let mirrored = Workspace { rotation: Matrix::IDENTITY * -1.0, ..Workspace::default() };
    let error = Channel::new(ChannelSettings { workspace: mirrored, ..good }, Rating::TOUCH).unwrap_err();
    assert_eq!(error, SettingError::NotARotation);
}

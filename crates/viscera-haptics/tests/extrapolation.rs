//! What is left of the true force between samples, against theory.

use viscera_haptics::{Contact, Extrapolation, LocalModel, Matrix, Sample, SampleError, Vector};

/// Force of a spring that stiffens, F = −K x − c |x|² x, with K of three axes that are not the frame's.
struct Spring {
    stiffness: Matrix,
    stiffening: f64,
}

impl Spring {
    fn new(stiffening: f64) -> Self {
        let (a, b, c) =
            (Vector::new(300.0, 40.0, -20.0), Vector::new(40.0, 200.0, 10.0), Vector::new(-20.0, 10.0, 120.0));
        Self { stiffness: Matrix::from_columns(a, b, c), stiffening }
    }

    fn force(&self, x: Vector) -> Vector {
        -(self.stiffness * x + x * (self.stiffening * x.squared_norm()))
    }

    /// −∂F/∂x = K + c (|x|² I + 2 x xᵀ).
    fn slope(&self, x: Vector) -> Matrix {
        self.stiffness + (Matrix::IDENTITY * x.squared_norm() + x.outer(x) * 2.0) * self.stiffening
    }

    fn sample(&self, time: f64, position: Vector, knows_slope: bool) -> Sample {
        Sample {
            time,
            position,
            force: self.force(position),
            stiffness: knows_slope.then(|| self.slope(position)),
            contact: Contact::Holding,
        }
    }
}

/// A hand that goes round a tilted ellipse of 20 mm, once in 0.8 s.
fn hand(time: f64) -> Vector {
    let angle = std::f64::consts::TAU * time / 0.8;
    Vector::new(0.03 + 0.02 * angle.sin(), 0.015 * angle.cos(), 0.005 * (angle + 0.7).sin())
}

fn model(extrapolation: Extrapolation) -> LocalModel {
    LocalModel::new(extrapolation, 2.0, f64::INFINITY, 0.0)
}

/// Root mean square of the error of the force [N] on the way of the hand, with samples every `interval` [s] that come at once.
fn error(spring: &Spring, extrapolation: Extrapolation, knows_slope: bool, interval: f64) -> f64 {
    let (mut model, mut squares, mut count, ticks) = (model(extrapolation), 0.0, 0, (interval * 1e3).round() as u32);
    for tick in 0..3200 {
        let time = f64::from(tick) * 1e-3;
        if tick % ticks == 0 {
            model.push(spring.sample(time, hand(time), knows_slope)).unwrap();
        }
        // From the second round on.
        if tick >= 800 {
            let force = model.force(time, hand(time)).unwrap();
            squares += (force - spring.force(hand(time))).squared_norm();
            count += 1;
        }
    }
    (squares / f64::from(count)).sqrt()
}

/// Half the interval, half the error of a held force and a quarter of those that follow its change.
#[test]
fn hold_is_of_first_order_and_the_others_are_of_second() {
    let spring = Spring::new(4e4);
    for (extrapolation, knows_slope, order) in
        [(Extrapolation::Hold, false, 1), (Extrapolation::Time, false, 2), (Extrapolation::Linearised, true, 2)]
    {
        let errors = [0.032, 0.016, 0.008].map(|interval| error(&spring, extrapolation, knows_slope, interval));
        for pair in errors.windows(2) {
            let found = (pair[0] / pair[1]).log2();
            // A staircase of milliseconds, not of moments: the last interval has eight of them.
            assert!((found - f64::from(order)).abs() < 0.25, "{extrapolation:?}: order {found}, errors {errors:?}");
        }
    }
}

/// Tissue that also resists being moved, by 4 N s/m: a stiffness of tissue at rest knows nothing of that, and by itself left an error
/// of first order. On a bent way, what it knows of the directions across makes it better than what is learnt from the samples.
#[test]
fn a_stiffness_at_rest_is_corrected_for_a_hand_that_moves() {
    let (spring, damping) = (Spring::new(4e4), 4.0);
    let velocity = |time: f64| (hand(time + 1e-6) - hand(time - 1e-6)) / 2e-6;
    let error = |interval: u32, knows_slope: bool| {
        let (mut model, mut squares) = (model(Extrapolation::Linearised), 0.0);
        for tick in 0..3200 {
            let time = f64::from(tick) * 1e-3;
            let resistance = -velocity(time) * damping;
            if tick % interval == 0 {
                let sample = spring.sample(time, hand(time), knows_slope);
                model.push(Sample { force: sample.force + resistance, ..sample }).unwrap();
            }
            if tick >= 800 {
                let force = model.force(time, hand(time)).unwrap();
                squares += (force - spring.force(hand(time)) - resistance).squared_norm();
            }
        }
        squares.sqrt()
    };
    for (coarse, fine) in [(32, 16), (16, 8)] {
        let order = (error(coarse, true) / error(fine, true)).log2();
        assert!((order - 2.0).abs() < 0.25, "{order}");
        assert!(error(fine, true) < error(fine, false), "{} and {}", error(fine, true), error(fine, false));
    }
}

/// Along a line it goes with the square of the interval too; on a bent way it knows nothing of what lies across.
#[test]
fn position_extrapolation_is_of_second_order_along_a_line() {
    let spring = Spring::new(4e4);
    let direction = Vector::new(0.6, 0.0, 0.8);
    let place = |time: f64| direction * (0.03 + 0.02 * (8.0 * time).sin());
    let error = |interval: u32| {
        let (mut model, mut squares) = (model(Extrapolation::Position), 0.0);
        for tick in 0..1600 {
            let time = f64::from(tick) * 1e-3;
            if tick % interval == 0 {
                model.push(spring.sample(time, place(time), false)).unwrap();
            }
            if tick > 100 {
                squares += (model.force(time, place(time)).unwrap() - spring.force(place(time))).squared_norm();
            }
        }
        squares.sqrt()
    };
    let order = (error(32) / error(16)).log2();
    assert!((order - 2.0).abs() < 0.25, "{order}");
}

/// Tissue that is linear and pulled along a line, by a hand that goes to and fro as it likes.
#[test]
fn position_extrapolation_is_exact_for_linear_tissue_along_a_line() {
    let (spring, direction) = (Spring::new(0.0), Vector::new(0.6, 0.48, 0.64));
    let mut model = model(Extrapolation::Position);
    for (number, along) in [0.010, 0.013, 0.012, 0.016].into_iter().enumerate() {
        model.push(spring.sample(number as f64 * 0.03, direction * along, false)).unwrap();
    }
    for along in [0.009, 0.0145, 0.016, 0.0239] {
        let (force, exact) = (model.force(0.1, direction * along).unwrap(), spring.force(direction * along));
        assert!((force - exact).norm() < 1e-12 * exact.norm(), "{force:?} at {along} m");
    }
    // Twice the last way is as far as it goes on.
    let (far, end) = (model.force(0.1, direction * 0.1).unwrap(), spring.force(direction * 0.024));
    assert!((far - end).norm() < 1e-12 * end.norm());
}

/// Three ways in three directions teach all of the stiffness (Broyden's method ends after as many steps as there are directions
/// when these are at right angles).
#[test]
fn the_stiffness_of_linear_tissue_is_learnt_from_four_samples() {
    let spring = Spring::new(0.0);
    let mut model = model(Extrapolation::Linearised);
    let places = [[0.0, 0.0, 0.0], [0.003, 0.0, 0.0], [0.003, 0.002, 0.0], [0.003, 0.002, -0.004]];
    for (number, place) in places.into_iter().enumerate() {
        model.push(spring.sample(number as f64 * 0.03, Vector::from(place), false)).unwrap();
    }
    let elsewhere = Vector::new(-0.01, 0.02, 0.03);
    let (force, exact) = (model.force(0.2, elsewhere).unwrap(), spring.force(elsewhere));
    assert!((force - exact).norm() < 1e-12 * exact.norm(), "{force:?}, not {exact:?}");
}

/// A stiffness above what the device can play is not believed, whoever says it.
#[test]
fn no_slope_is_steeper_than_the_device_can_play() {
    let stiff = Matrix::diagonal(1e6);
    let sample = |time: f64, x: f64, stiffness: Option<Matrix>| Sample {
        time,
        position: Vector::new(x, 0.0, 0.0),
        force: Vector::new(-1e6 * x, 0.0, 0.0),
        stiffness,
        contact: Contact::Holding,
    };
    for (extrapolation, known) in
        [(Extrapolation::Position, None), (Extrapolation::Linearised, None), (Extrapolation::Linearised, Some(stiff))]
    {
        let mut model = LocalModel::new(extrapolation, 2.0, 500.0, 0.0);
        model.push(sample(0.0, 0.0, known)).unwrap();
        model.push(sample(0.03, 1e-4, known)).unwrap();
        let here = model.force(0.04, Vector::new(1e-4, 0.0, 0.0)).unwrap().x;
        let there = model.force(0.04, Vector::new(2e-4, 0.0, 0.0)).unwrap().x;
        let slope = (here - there) / 1e-4;
        assert!(slope > 100.0 && slope <= 500.0 * (1.0 + 1e-9), "{extrapolation:?}: {slope} N/m");
    }
}

/// A hand that leaves tissue it only presses on feels the force end, not turn round; held tissue pulls.
#[test]
fn pressed_tissue_never_pulls() {
    let sample = |time: f64, depth: f64, contact: Contact| Sample {
        time,
        position: Vector::new(0.0, -depth, 0.0),
        force: Vector::new(0.0, 200.0 * depth, 0.0),
        stiffness: None,
        contact,
    };
    for (extrapolation, contact, pulls) in [
        (Extrapolation::Position, Contact::Pressing, false),
        (Extrapolation::Linearised, Contact::Pressing, false),
        (Extrapolation::Position, Contact::Holding, true),
        (Extrapolation::Linearised, Contact::Holding, true),
    ] {
        let mut model = model(extrapolation);
        model.push(sample(0.0, 0.004, contact)).unwrap();
        model.push(sample(0.03, 0.001, contact)).unwrap();
        let outside = model.force(0.05, Vector::new(0.0, 0.002, 0.0)).unwrap();
        assert_eq!(outside.y < -0.1, pulls, "{extrapolation:?}, {contact:?}: {outside:?}");
        assert!(pulls || outside == Vector::ZERO);
    }
}

/// The tool rests, its readings tremble by a count: what is learnt from that is little, and the force stays where it is.
#[test]
fn the_noise_of_a_resting_tool_is_not_taken_for_a_slope() {
    let count = 50e-6;
    for extrapolation in [Extrapolation::Position, Extrapolation::Linearised] {
        let mut model = LocalModel::new(extrapolation, 2.0, f64::INFINITY, count);
        for number in 0..20 {
            // A force that wavers by 10 mN, and places that waver by a hundredth of a count.
            let wavers = if number % 2 == 0 { 1.0 } else { -1.0 };
            let sample = Sample {
                time: f64::from(number) * 0.03,
                position: Vector::new(0.01 * count * wavers, 0.0, 0.0),
                force: Vector::new(1.0 + 5e-3 * wavers, 0.0, 0.0),
                stiffness: None,
                contact: Contact::Holding,
            };
            model.push(sample).unwrap();
        }
        let away = model.force(0.6, Vector::new(count, 0.0, 0.0)).unwrap();
        assert!((away.x - 1.0).abs() < 0.1, "{extrapolation:?}: {away:?}");
    }
}

#[test]
fn samples_that_make_no_sense_are_refused_and_leave_the_model_as_it_was() {
    let (spring, mut model) = (Spring::new(0.0), model(Extrapolation::Time));
    model.push(spring.sample(0.1, Vector::new(0.01, 0.0, 0.0), true)).unwrap();
    let before = model.force(0.2, Vector::ZERO);
    let early = model.push(spring.sample(0.05, Vector::ZERO, true)).unwrap_err();
    assert_eq!(early.to_string(), "the sample is of 0.05 s, after one of 0.1 s: samples go forward in time");
    let broken = Sample { force: Vector::new(0.0, f64::NAN, 0.0), ..spring.sample(0.2, Vector::ZERO, true) };
    assert_eq!(model.push(broken).unwrap_err(), SampleError::NotFinite { what: "force" });
    assert_eq!(model.force(0.2, Vector::ZERO), before);
}

//! How the error falls with the length of the step.

use viscera::dynamics::implicit::Scheme;
use viscera::world::{Integrator, Substep};

use super::support::*;

/// Length of the motion [s]: a good part of the bar's slowest vibration (about 0.6 Hz), many of its fastest.
const DURATION: f64 = 0.1;

/// The bar bends under gravity from rest; its free end moves by some centimetres.
fn shape_after(integrator: Integrator, steps: usize) -> Vec<Vector> {
    let body = bar().fix(root()).damping(2.0);
    let (mut world, id) = world::<f64>([0.0, -9.81, 0.0], DURATION / steps as f64, integrator, body);
    run(&mut world, steps);
    world.body(id).positions().to_vec()
}

/// Halving the step divides the error by 2 for backward Euler and by 4 for the others, against central differences at a
/// step a hundred times shorter than the stable one.
#[test]
fn errors_fall_with_the_order_of_the_scheme() {
    let reference = shape_after(Integrator::Explicit(Substep::Automatic), 4000);
    let orders = [
        (full(Scheme::BackwardEuler, 1e-10), 1.0),
        (full(Scheme::AVERAGE_ACCELERATION, 1e-10), 2.0),
        (full(Scheme::Bdf2, 1e-10), 2.0),
        (full(Scheme::EnergyMomentum, 1e-10), 2.0),
    ];
    for (settings, order) in orders {
        let error = |steps| distance(&shape_after(Integrator::Implicit(settings), steps), &reference);
        let (coarse, fine) = (error(40), error(80));
        let found = (coarse / fine).log2();
        assert!((found - order).abs() < 0.1, "{:?}: {coarse:e}, {fine:e}: order {found}, not {order}", settings.scheme);
    }
}

/// One linear solve a step has the order of the scheme too.
#[test]
fn the_linearised_step_is_of_first_order() {
    let reference = shape_after(Integrator::Explicit(Substep::Automatic), 4000);
    let error = |steps| distance(&shape_after(Integrator::Implicit(linearised()), steps), &reference);
    let found = (error(40) / error(80)).log2();
    assert!((found - 1.0).abs() < 0.1, "order {found}");
}

//! Memory is asked for before the first step.

use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::model::{TensorMass, TotalLagrangian};

use super::support::*;

/// A step allocates nothing, whatever the scheme, the matrix and the model, nor does the first one.
#[test]
fn steps_allocate_nothing() {
    let schemes = [
        Implicit::default(),
        assembled(Implicit::default()),
        Implicit::accurate(Scheme::BackwardEuler),
        Implicit::accurate(Scheme::AVERAGE_ACCELERATION),
        assembled(Implicit::accurate(Scheme::Bdf2)),
        Implicit::accurate(Scheme::EnergyMomentum),
    ];
    for settings in schemes {
        let mut bodies = vec![bar_of(TotalLagrangian::new(tissue()))];
        if settings.scheme != Scheme::EnergyMomentum {
            bodies.push(bar_of(TensorMass::new(tissue())).keep_volume(5e3));
        }
        for body in bodies {
            let (mut world, _) = implicit_world(GRAVITY, 1e-2, settings, body.fix(root()).stiffness_damping(1e-3));
            let info = allocation_counter::measure(|| run(&mut world, 3));
            assert_eq!(info.count_total, 0, "{settings:?}");
        }
    }
}

//! Memory is asked for before the first step.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::mesh::HexMesh;
use viscera::model::{Corotational, TensorMass, TotalLagrangian};

use super::support::*;

/// A step allocates nothing, whatever the scheme, the matrix, the preconditioner and the model, nor does the first one.
#[test]
fn steps_allocate_nothing() {
    let schemes = [
        Implicit::default(),
        assembled(Implicit::default()),
        multigrid(Implicit::default()),
        multigrid(assembled(Implicit::accurate(Scheme::BackwardEuler))),
        Implicit::accurate(Scheme::BackwardEuler),
        Implicit::accurate(Scheme::AVERAGE_ACCELERATION),
        assembled(Implicit::accurate(Scheme::Bdf2)),
        Implicit::accurate(Scheme::EnergyMomentum),
    ];
    for settings in schemes {
        let mut bodies = vec![bar_of(TotalLagrangian::new(tissue()))];
        if settings.scheme != Scheme::EnergyMomentum {
            bodies.push(bar_of(TensorMass::new(tissue())).keep_volume(5e3));
            bodies.push(bar_of(Corotational::new(linear_tissue())).keep_volume(5e3));
            let hexahedra = HexMesh::box_grid([2, 2, 4], [0.1, 0.1, 0.3]);
            bodies.push(Body::new(hexahedra, 1000.0).model(Corotational::new(linear_tissue())));
        }
        for body in bodies {
            let (mut world, _) = implicit_world(GRAVITY, 1e-2, settings, body.fix(root()).stiffness_damping(1e-3));
            let info = allocation_counter::measure(|| run(&mut world, 3));
            assert_eq!(info.count_total, 0, "{settings:?}");
        }
    }
}

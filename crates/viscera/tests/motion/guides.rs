//! Nodes that slide, in explicit and implicit steps.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Precision, TotalLagrangian};
use viscera::world::{Integrator, Substep, World, WorldConfig};

use crate::support::{Vector, in_both_precisions, stvk};

const SIZE: [f64; 3] = [0.02, 0.03, 0.05];
const STRETCH: f64 = 1.2;
const POISSON: f64 = 0.3;

/// A turn by a third of a circle about an axis that is none of the box.
fn turned(v: Vector) -> Vector {
    let axis = Vector::new(1.0, 2.0, 2.0) / 3.0;
    v * -0.5 + axis.cross(v) * 0.75_f64.sqrt() + axis * (axis.dot(v) * 1.5)
}

/// An eighth of a bar on its planes of symmetry, pulled along its length within half a second.
fn eighth() -> Body {
    let mut mesh = TetMesh::box_grid([2, 2, 3], SIZE);
    mesh.nodes.iter_mut().for_each(|node| *node = turned(*node));
    let mut body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(stvk(1e4, POISSON))).damping(20.0);
    for axis in 0..3 {
        let normal = direction(axis).to_array();
        body = body.slide(Region::plane([0.0; 3], normal, 1e-6), normal);
    }
    let top = Region::plane((direction(2) * SIZE[2]).to_array(), direction(2).to_array(), 1e-6);
    let pull = Curve::piecewise_linear(vec![(0.0, 0.0), (0.5, (STRETCH - 1.0) * SIZE[2])]).unwrap();
    body.prescribe_along(top, direction(2).to_array(), pull)
}

fn direction(axis: usize) -> Vector {
    let mut unit = Vector::ZERO;
    unit[axis] = 1.0;
    turned(unit)
}

/// Uniaxial stress: StVK narrows to l_s² = 1 − ν (l² − 1). Driven nodes are where they must be, sliding ones in their plane.
fn a_bar_on_its_planes_of_symmetry_narrows_freely<T: Precision>(tolerance: f64) {
    let narrow = (1.0 - POISSON * (STRETCH * STRETCH - 1.0)).sqrt();
    for integrator in [
        Integrator::Explicit(Substep::Automatic),
        Integrator::Implicit(Implicit::default()),
        Integrator::Implicit(Implicit::accurate(Scheme::Bdf2)),
    ] {
        let config = WorldConfig { gravity: [0.0; 3], step: 0.01, integrator };
        let mut world = World::<T>::new(config).unwrap();
        let id = world.add(eighth()).unwrap();
        for _ in 0..250 {
            world.step().unwrap();
        }
        let body = world.body(id);
        for (&now, &rest) in body.positions().iter().zip(body.mesh().nodes()) {
            let along = |axis: usize, by: f64| direction(axis) * (direction(axis).dot(rest) * by);
            let expected = along(0, narrow) + along(1, narrow) + along(2, STRETCH);
            let off = (now.cast::<f64>() - expected).norm();
            assert!(off < tolerance * SIZE[2], "{integrator:?}: {off:e} m off");
        }
    }
}
in_both_precisions!(a_bar_on_its_planes_of_symmetry_narrows_freely, f32: 2e-4, f64: 1e-5);

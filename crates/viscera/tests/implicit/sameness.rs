//! Different ways to the same motion.

use viscera::body::Body;
use viscera::dynamics::implicit::Scheme;
use viscera::material::{Lame, TransverseStVenantKirchhoff};
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::{Corotational, TensorMass, TotalLagrangian};
use viscera::world::Integrator;

use super::support::*;

fn shape_after(body: Body, settings: viscera::dynamics::implicit::Implicit) -> Vec<Vector> {
    let (mut world, id) = implicit_world([0.0, -3.0, 0.0], 1e-2, settings, body);
    run(&mut world, 8);
    world.body(id).positions().to_vec()
}

/// Assembled rows and products element by element lead to the same place to 1e-10 of the motion (about 1 cm), on
/// tetrahedra with a volume penalty and on hexahedra, of the full law and turned, damped both ways.
#[test]
fn assembled_and_matrix_free_steps_are_the_same() {
    let hexahedra = || {
        let mesh = HexMesh::box_grid([2, 2, 4], [0.1, 0.1, 0.3]);
        Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue()))
    };
    let damped = |body: Body| body.fix(root()).damping(1.0).stiffness_damping(5e-3);
    for settings in [linearised(), full(Scheme::Bdf2, 1e-11)] {
        let turned = |mesh: VolumeMesh| Body::new(mesh, 1000.0).model(Corotational::new(linear_tissue()));
        let turned_tets = || turned(TetMesh::box_grid([2, 2, 6], [0.1, 0.1, 0.3]).into());
        let turned_hexes = || turned(HexMesh::box_grid([2, 2, 4], [0.1, 0.1, 0.3]).into());
        let pairs = [
            [0, 1].map(|_| damped(bar().keep_volume(5e3))),
            [0, 1].map(|_| damped(hexahedra())),
            [0, 1].map(|_| damped(turned_tets().keep_volume(5e3))),
            [0, 1].map(|_| damped(turned_hexes())),
        ];
        for [first, second] in pairs {
            let free = shape_after(first, settings);
            let difference = distance(&free, &shape_after(second, assembled(settings)));
            assert!(difference < 1e-12, "{difference:e} m apart");
        }
    }
}

/// Tensor-mass sums the same forces from tables: the same trajectory, with and without fibres.
#[test]
fn tensor_mass_moves_as_total_lagrangian() {
    let lame = |young, poisson| Lame::from_young_poisson(young, poisson).unwrap();
    let fibres = TransverseStVenantKirchhoff::new(lame(10e3, 0.3), [0.0, 0.6, 0.8], lame(20e3, 0.3)).unwrap();
    for tissue in [tissue(), uniform(fibres)] {
        for settings in [linearised(), full(Scheme::AVERAGE_ACCELERATION, 1e-11)] {
            let direct = shape_after(bar_of(TotalLagrangian::new(tissue.clone())).fix(root()), settings);
            let tables = shape_after(bar_of(TensorMass::new(tissue.clone())).fix(root()), settings);
            let difference = distance(&direct, &tables);
            assert!(difference < 1e-10, "{difference:e} m apart");
        }
    }
}

/// The same world steps through the same bits, and goes on with them after a snapshot, cuts and past states included.
#[test]
fn steps_repeat_bit_by_bit_also_from_a_snapshot() {
    let ways =
        [linearised(), multigrid(linearised()), full(Scheme::Bdf2, 1e-8), full(Scheme::AVERAGE_ACCELERATION, 1e-8)];
    for settings in ways {
        let build = || {
            world::<f32>(
                GRAVITY,
                1e-2,
                Integrator::Implicit(viscera::dynamics::implicit::Implicit {
                    linear: viscera::solver::Stop::Iterations(40),
                    newton: match settings.newton {
                        viscera::dynamics::implicit::Newton::Linearised => settings.newton,
                        _ => viscera::dynamics::implicit::Newton::Full { relative: 1e-3, at_most: 20 },
                    },
                    ..settings
                }),
                bar().fix(root()),
            )
        };
        let (mut first, id) = build();
        let (mut second, _) = build();
        for world in [&mut first, &mut second] {
            run(world, 4);
            world.remove_cells(id, &[100, 101]).unwrap();
            run(world, 4);
        }
        assert_eq!(first.body(id).positions(), second.body(id).positions());
        let snapshot = first.snapshot();
        run(&mut first, 5);
        second.restore(&snapshot).unwrap();
        run(&mut second, 5);
        assert_eq!(first.body(id).positions(), second.body(id).positions());
        assert_eq!(first.body(id).velocities(), second.body(id).velocities());
    }
}

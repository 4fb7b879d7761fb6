//! Threads change how long a step takes, and nothing else.

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, MatrixForm, Preconditioning, Scheme};
use viscera::executor::Executor;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{HexMesh, Region, TetMesh};
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement};
use viscera::model::{
    Corotational, LinearTensorMass, ModelRecipe, NodallyIntegrated, Precision, StiffnessWarping, TensorMass,
    TotalLagrangian,
};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

/// A model, on tetrahedra or hexahedra.
#[derive(Clone, Copy)]
struct Case {
    recipe: fn() -> Box<dyn ModelRecipe>,
    hexahedra: bool,
}

fn lame() -> Lame {
    Lame::from_young_poisson(10e3, 0.4).unwrap()
}

fn linear() -> Tissue {
    Tissue::uniform(LinearElastic::new(lame()))
}

fn stable() -> Tissue {
    Tissue::uniform(StableNeoHookean::new(lame()))
}

const CASES: [Case; 7] = [
    Case { recipe: || Box::new(TotalLagrangian::new(stable())), hexahedra: false },
    Case { recipe: || Box::new(Corotational::new(linear())), hexahedra: false },
    Case { recipe: || Box::new(NodallyIntegrated::new(stable())), hexahedra: false },
    Case { recipe: || Box::new(LinearTensorMass::new(linear())), hexahedra: false },
    Case { recipe: || Box::new(TensorMass::new(Tissue::uniform(StVenantKirchhoff::new(lame())))), hexahedra: false },
    Case { recipe: || Box::new(TotalLagrangian::new(stable())), hexahedra: true },
    Case { recipe: || Box::new(Corotational::new(linear())), hexahedra: true },
];

/// A beam of just more cells than threads begin to share that falls to one side, loses a corner and goes on.
fn end_of_motion<T: Precision>(case: Case, integrator: Integrator, threads: usize) -> Vec<Vec3<T>> {
    let config = WorldConfig { step: 2e-3, gravity: [0.0, -9.81, 0.0], integrator };
    let mut world = World::<T>::new(config).unwrap();
    let held = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
    let size = [0.06, 0.06, 0.24];
    let body = if case.hexahedra {
        Body::new(HexMesh::box_grid([14, 14, 52], size), 1000.0)
    } else {
        Body::new(TetMesh::box_grid([8, 8, 27], size), 1000.0).keep_volume(1e4)
    };
    let body = world.add(body.boxed_model((case.recipe)()).fix(held)).unwrap();
    assert!(world.body(body).cell_count() > 10_000);
    let executor = Executor::threads(threads).unwrap();
    assert_eq!(executor.thread_count(), threads);
    for step in 0..2 {
        world.step_on(&executor).unwrap();
        if step == 0 {
            assert_eq!(world.remove_cells(body, &[10000, 10001, 10002]).unwrap(), 3);
        }
    }
    world.body(body).positions().to_vec()
}

fn check<T: Precision>(case: Case, integrator: Integrator) {
    let name = (case.recipe)().kind();
    let alone = end_of_motion::<T>(case, integrator, 1);
    assert!(alone.iter().any(|x| x.y < T::ZERO), "{name:?}: nothing fell");
    for threads in [2, 8] {
        let together = end_of_motion::<T>(case, integrator, threads);
        assert_eq!(together, alone, "{name:?} on {threads} threads, {integrator:?}");
    }
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let implicit = Implicit { linear: Stop::Iterations(10), ..Implicit::default() };
    for case in CASES {
        for integrator in [Integrator::Explicit(Substep::Automatic), Integrator::Implicit(implicit)] {
            check::<f32>(case, integrator);
            check::<f64>(case, integrator);
        }
    }
}

/// The same for every other way to take an implicit step, and every other corotational element.
#[test]
fn bits_of_other_solvers_and_variants_do_not_either() {
    let few = Stop::Iterations(6);
    let falling = Case { recipe: || Box::new(TotalLagrangian::new(stable())), hexahedra: false };
    for settings in [
        Implicit { linear: few, matrix: MatrixForm::Assembled, ..Implicit::default() },
        Implicit { linear: few, preconditioner: Preconditioning::Multigrid, ..Implicit::default() },
        Implicit { linear: Stop::Iterations(40), ..Implicit::accurate(Scheme::BackwardEuler) },
        Implicit { linear: Stop::Iterations(40), ..Implicit::accurate(Scheme::AVERAGE_ACCELERATION) },
        Implicit { linear: Stop::Iterations(40), ..Implicit::accurate(Scheme::Bdf2) },
    ] {
        check::<f64>(falling, Integrator::Implicit(settings));
    }
    let variants: [fn() -> Box<dyn ModelRecipe>; 5] = [
        || Box::new(Corotational::new(linear()).rotation(Rotation::Qr)),
        || Box::new(Corotational::new(linear()).rotation(Rotation::Svd)),
        || Box::new(Corotational::new(linear()).strain_displacement(StrainDisplacement::Updated)),
        || Box::new(Corotational::new(linear()).volume(IntegrationVolume::Current)),
        || Box::new(StiffnessWarping::new(linear())),
    ];
    for recipe in variants {
        let settings = Implicit { linear: few, ..Implicit::default() };
        check::<f32>(Case { recipe, hexahedra: false }, Integrator::Implicit(settings));
    }
}

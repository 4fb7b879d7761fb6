//! Threads change how long a step takes, and nothing else.

use viscera::body::Body;
use viscera::dynamics::implicit::Implicit;
use viscera::executor::Executor;
use viscera::material::{Lame, LinearElastic, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Corotational, ModelRecipe, NodallyIntegrated, Precision, TensorMass, TotalLagrangian};
use viscera::world::{Integrator, Substep, World, WorldConfig};

fn lame() -> Lame {
    Lame::from_young_poisson(10e3, 0.4).unwrap()
}

/// A beam of 10 368 tetrahedra, the smallest that threads share, that falls to one side, loses a corner and goes on.
fn end_of_motion<T: Precision>(recipe: Box<dyn ModelRecipe>, integrator: Integrator, threads: usize) -> Vec<Vec3<T>> {
    let config = WorldConfig { step: 2e-3, gravity: [0.0, -9.81, 0.0], integrator };
    let mut world = World::<T>::new(config).unwrap();
    let held = Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0);
    let mesh = TetMesh::box_grid([8, 8, 27], [0.06, 0.06, 0.24]);
    let body = world.add(Body::new(mesh, 1000.0).boxed_model(recipe).keep_volume(1e4).fix(held)).unwrap();
    let executor = Executor::threads(threads).unwrap();
    assert_eq!(executor.thread_count(), threads);
    for step in 0..3 {
        world.step_on(&executor).unwrap();
        if step == 1 {
            assert_eq!(world.remove_cells(body, &[10000, 10001, 10002]).unwrap(), 3);
        }
    }
    world.body(body).positions().to_vec()
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    fn check<T: Precision>() {
        let linear = || Tissue::uniform(LinearElastic::new(lame()));
        let stable = || Tissue::uniform(StableNeoHookean::new(lame()));
        let stvk = || Tissue::uniform(StVenantKirchhoff::new(lame()));
        let recipes: [fn(Tissue) -> Box<dyn ModelRecipe>; 4] = [
            |tissue| Box::new(TotalLagrangian::new(tissue)),
            |tissue| Box::new(Corotational::new(tissue)),
            |tissue| Box::new(NodallyIntegrated::new(tissue)),
            |tissue| Box::new(TensorMass::new(tissue)),
        ];
        for (recipe, tissue) in recipes.into_iter().zip([stable(), linear(), stable(), stvk()]) {
            for integrator in [Integrator::Explicit(Substep::Automatic), Integrator::Implicit(Implicit::default())] {
                let model = recipe(tissue.clone());
                let name = model.kind();
                let alone = end_of_motion::<T>(model, integrator, 1);
                assert!(alone.iter().any(|x| x.y < T::ZERO), "{name:?}: nothing fell");
                for threads in [2, 8] {
                    let together = end_of_motion::<T>(recipe(tissue.clone()), integrator, threads);
                    assert_eq!(together, alone, "{name:?} on {threads} threads, {integrator:?}");
                }
            }
        }
    }
    check::<f32>();
    check::<f64>();
}

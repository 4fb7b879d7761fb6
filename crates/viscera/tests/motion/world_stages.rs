//! Stages of a step as an observer hears of them, and the cell that a stable step hangs on.

use std::collections::BTreeMap;
use std::sync::Mutex;

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, MatrixForm};
use viscera::executor::Executor;
use viscera::mesh::TetMesh;
use viscera::model::TotalLagrangian;
use viscera::solver::Stop;
use viscera::stage::{Stage, StageObserver};
use viscera::world::{Integrator, World, WorldConfig};

use crate::support::{assert_relative, bits, free_bar, side, stvk, world};

/// Counts stages and holds them to be nested.
#[derive(Default)]
struct Counter {
    open: Mutex<Vec<Stage>>,
    counts: Mutex<BTreeMap<Stage, u32>>,
}

impl StageObserver for Counter {
    fn enter(&self, stage: Stage) {
        self.open.lock().unwrap().push(stage);
        *self.counts.lock().unwrap().entry(stage).or_default() += 1;
    }

    fn leave(&self, stage: Stage) {
        assert_eq!(self.open.lock().unwrap().pop(), Some(stage));
    }
}

/// Two steps of two equal worlds, of which one is observed: the same bits, and the stages of those two steps.
fn observe(mut observed: World<f64>, mut alone: World<f64>) -> impl Fn(Stage) -> u32 {
    let counter = Counter::default();
    for _ in 0..2 {
        assert_eq!(observed.step_observed(&Executor::serial(), &counter).unwrap(), alone.step().unwrap());
    }
    assert_eq!(bits(&observed), bits(&alone));
    assert!(counter.open.lock().unwrap().is_empty());
    let counts = counter.counts.into_inner().unwrap();
    move |stage| counts.get(&stage).copied().unwrap_or(0)
}

#[test]
fn an_explicit_step_has_its_stages_for_every_sub_step() {
    let hanging = || {
        let mut world = world::<f64>([0.0, -9.81, 0.0], 5e-3);
        world.add(free_bar().fix(side("z-min")).keep_volume(1e4)).unwrap();
        world
    };
    let mut counted = hanging();
    let substeps = (0..2).map(|_| counted.step().unwrap().substeps).sum::<u32>();
    let count = observe(hanging(), hanging());
    // Before the first sub-step, and at the end of each.
    assert_eq!(count(Stage::Forces("total-lagrangian")), substeps + 1);
    assert_eq!(count(Stage::Forces("volume-penalty")), substeps + 1);
    assert_eq!(count(Stage::KickAndDrift), 2 * substeps);
    assert_eq!(count(Stage::Cutting), 2);
    assert_eq!(count(Stage::Newton), 0);
}

#[test]
fn an_implicit_step_has_a_product_for_every_iteration() {
    for (matrix, name) in [(MatrixForm::Free, "total-lagrangian"), (MatrixForm::Assembled, "assembled-matrix")] {
        let hanging = || {
            let settings = Implicit { linear: Stop::Iterations(25), matrix, ..Implicit::default() };
            let config = WorldConfig { integrator: Integrator::Implicit(settings), ..WorldConfig::default() };
            let mut world = World::new(config).unwrap();
            world.add(free_bar().fix(side("z-min"))).unwrap();
            world
        };
        let count = observe(hanging(), hanging());
        assert_eq!(count(Stage::LinearSolve), 2);
        assert_eq!(count(Stage::Preconditioner), 2);
        // One for the residual of the guess, and one for each iteration.
        assert_eq!(count(Stage::Products(name)), 2 * 26);
        assert_eq!(count(Stage::FrequencyBound), 0);
    }
}

/// ω² goes as stiffness over mass: a cell of a tenth of the density sets the stable step of a bar of equal cells, which is √10
/// times as long when the cell is cut away.
#[test]
fn the_lightest_cell_of_equal_ones_sets_the_stable_step() {
    for light in [0, 77, 191] {
        let mesh = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
        let mut densities = vec![1000.0; mesh.cells.len()];
        densities[light] = 100.0;
        let body = Body::new(mesh, 1.0).densities(densities).model(TotalLagrangian::new(stvk(5e3, 0.4)));
        let mut world = world::<f64>([0.0; 3], 5e-3);
        let id = world.add(body).unwrap();
        let stable = world.body(id).stable_step();
        assert_eq!(world.body(id).stiffest_cell(), Some(light));
        world.remove_cells(id, &[light as u32]).unwrap();
        assert_ne!(world.body(id).stiffest_cell(), Some(light));
        assert_relative(world.body(id).stable_step(), 10.0_f64.sqrt() * stable, 1e-12);
    }
}

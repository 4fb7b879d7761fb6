//! The organ that is measured: a liver of 30 cm, held at its back, that sways under little gravity.

use std::time::Instant;

use viscera::body::Body;
use viscera::dynamics::implicit::Implicit;
use viscera::executor::Executor;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Corotational, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

use crate::failure::Failure;

/// Length of the organ [m].
const LENGTH: f64 = 0.3;
/// Of liver, as it is pulled slowly [Pa].
const YOUNG: f64 = 3e3;
const POISSON: f64 = 0.4;
/// [kg/m³]
const DENSITY: f64 = 1060.0;
/// [1/s]
const DAMPING: f64 = 3.0;
/// Gravity [m/s²], as of an organ that lies among others: it moves, and its cells keep their shape.
const GRAVITY: [f64; 3] = [0.0, -1.0, 0.0];
/// Iterations of the linear solver in an implicit step.
const ITERATIONS: u32 = 25;

/// How the organ is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// 1 000 steps of 1 ms in a second, each in as many sub-steps as are stable.
    Explicit,
    /// 60 implicit steps in a second.
    Implicit,
}

/// What an organ of one size took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    pub(super) cells: usize,
    pub(super) nodes: usize,
    /// Edge that the mesh was asked for [m].
    pub(super) edge: f64,
    /// Computing time of a step [s].
    pub(super) time: f64,
    /// Sub-steps in a step.
    pub(super) substeps: f64,
}

/// How carefully to measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Care {
    /// Windows, of which the median counts: whatever else the machine does meanwhile spoils some, not most.
    pub(super) windows: usize,
    /// Length of a window in steps' worth of time [s].
    pub(super) window: f64,
}

/// Which edge makes how many cells: they go with its inverse cube, by a factor that every mesh tells anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizing {
    /// Cells times the cube of the edge [m³].
    volume: f64,
}

impl Default for Sizing {
    /// As of a liver of 30 cm in 10 000 cells of 15 mm.
    fn default() -> Self {
        Self { volume: 1e4 * 0.015_f64.powi(3) }
    }
}

impl Pace {
    pub(super) const ALL: [Self; 2] = [Self::Explicit, Self::Implicit];

    /// Time that a step simulates, and may take [s].
    pub(super) fn step(self) -> f64 {
        match self {
            Self::Explicit => 1e-3,
            Self::Implicit => 1.0 / 60.0,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Explicit => "1000 explicit steps of 1 ms",
            Self::Implicit => "60 implicit steps of 1/60 s",
        }
    }

    /// The settings, in a line.
    pub(super) fn settings(self) -> String {
        match self {
            Self::Explicit => format!(
                "explicit: St Venant-Kirchhoff of {YOUNG:.0} Pa and {POISSON} by total-lagrangian, single precision, automatic sub-steps"
            ),
            Self::Implicit => format!(
                "implicit: linear tissue of {YOUNG:.0} Pa and {POISSON} by corotational, single precision, linearised backward \
                 Euler, {ITERATIONS} iterations of the conjugate gradient"
            ),
        }
    }

    fn world(self, mesh: TetMesh) -> Result<World<f32>, Failure> {
        let integrator = match self {
            Self::Explicit => Integrator::Explicit(Substep::Automatic),
            Self::Implicit => {
                Integrator::Implicit(Implicit { linear: Stop::Iterations(ITERATIONS), ..Implicit::default() })
            }
        };
        let body = Body::new(mesh, DENSITY).damping(DAMPING).fix(Region::Named("back".into()));
        let body = match self {
            Self::Explicit => body.model(TotalLagrangian::new(Tissue::uniform(
                StVenantKirchhoff::from_young_poisson(YOUNG, POISSON).map_err(Failure::problem)?,
            ))),
            Self::Implicit => body.model(Corotational::new(Tissue::uniform(
                LinearElastic::from_young_poisson(YOUNG, POISSON).map_err(Failure::problem)?,
            ))),
        };
        let config = WorldConfig { gravity: GRAVITY, step: self.step(), integrator };
        let mut world = World::new(config).map_err(Failure::problem)?;
        world.add(body).map_err(Failure::problem)?;
        Ok(world)
    }

    /// Measures an organ of about so many cells on the threads of `executor`.
    pub(super) fn measure(
        self,
        cells: f64,
        executor: &Executor,
        care: Care,
        sizing: &mut Sizing,
    ) -> Result<Measured, Failure> {
        let edge = (sizing.volume / cells).cbrt();
        let mesh = TetMesh::liver(LENGTH, edge).map_err(Failure::problem)?;
        let (cells, nodes) = (mesh.cells.len(), mesh.nodes.len());
        sizing.volume = cells as f64 * edge.powi(3);
        let mut world = self.world(mesh)?;
        let mut substeps = 0;
        let mut step = |world: &mut World<f32>| {
            let begin = Instant::now();
            let report = world.step_on(executor).map_err(Failure::problem)?;
            substeps += u64::from(report.substeps);
            Ok::<f64, Failure>(begin.elapsed().as_secs_f64())
        };
        // Caches and branches first; the processor needs some milliseconds to reach its clock.
        let warm = step(&mut world)?.max(step(&mut world)?);
        let each = (care.window / warm.max(1e-9)).ceil().max(2.0) as usize;
        let mut windows = Vec::new();
        for _ in 0..care.windows {
            let times = (0..each).map(|_| step(&mut world)).collect::<Result<Vec<_>, _>>()?;
            windows.push(times.iter().sum::<f64>() / each as f64);
        }
        windows.sort_by(f64::total_cmp);
        let steps = (2 + each * care.windows) as f64;
        Ok(Measured { cells, nodes, edge, time: windows[windows.len() / 2], substeps: substeps as f64 / steps })
    }
}

//! Time per step against the number of cells, for every model: explicit sub-steps and implicit steps of 25 iterations.

use std::time::Instant;

use viscera::body::Body;
use viscera::dynamics::implicit::Implicit;
use viscera::material::{LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::model::{
    Corotational, LinearTensorMass, ModelRecipe, NodallyIntegrated, Precision, StiffnessWarping, TensorMass,
    TotalLagrangian,
};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

use crate::plot::{Plot, Scale};
use crate::report::{Table, brief};
use crate::setting::{Cells, plane};
use crate::{Report, Size, ValidationError};

/// What was found.
pub struct StepCost {
    /// Explicit sub-steps.
    pub explicit: Vec<Cost>,
    /// Implicit steps of 25 iterations.
    pub implicit: Vec<Cost>,
}

/// A model on more and more cells.
pub struct Cost {
    /// Which.
    pub name: &'static str,
    /// Cells, and time per step [ms].
    pub times: Vec<(usize, f64)>,
}

/// What steps.
#[derive(Clone, Copy)]
enum Motion {
    Explicit,
    Implicit,
}

type Recipe = fn() -> Result<Box<dyn ModelRecipe>, ValidationError>;

fn quadratic() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.4)?))
}

fn linear() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.4)?))
}

const MODELS: [(&str, Cells, Recipe); 10] = [
    ("linear tensor-mass", Cells::Six, || Ok(Box::new(LinearTensorMass::new(linear()?)))),
    ("tensor-mass, St Venant–Kirchhoff", Cells::Six, || Ok(Box::new(TensorMass::new(quadratic()?)))),
    ("total-Lagrangian, St Venant–Kirchhoff", Cells::Six, || Ok(Box::new(TotalLagrangian::new(quadratic()?)))),
    ("total-Lagrangian, neo-Hookean", Cells::Six, || {
        Ok(Box::new(TotalLagrangian::new(Tissue::uniform(NeoHookean::from_young_poisson(10e3, 0.4)?))))
    }),
    ("total-Lagrangian, stable neo-Hookean", Cells::Six, || {
        Ok(Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::from_young_poisson(10e3, 0.4)?))))
    }),
    ("integrated at the nodes, stable neo-Hookean", Cells::Six, || {
        Ok(Box::new(NodallyIntegrated::new(Tissue::uniform(StableNeoHookean::from_young_poisson(10e3, 0.4)?))))
    }),
    ("corotational", Cells::Six, || Ok(Box::new(Corotational::new(linear()?)))),
    ("stiffness warping", Cells::Six, || Ok(Box::new(StiffnessWarping::new(linear()?)))),
    ("corotational hexahedra", Cells::Hexahedra, || Ok(Box::new(Corotational::new(linear()?)))),
    ("total-Lagrangian hexahedra, St Venant–Kirchhoff", Cells::Hexahedra, || {
        Ok(Box::new(TotalLagrangian::new(quadratic()?)))
    }),
];

/// # Errors
/// [`ValidationError`] where a step fails.
pub fn study(size: Size) -> Result<StepCost, ValidationError> {
    let grids: &[usize] = if size == Size::Full { &[4, 8, 12, 16, 25] } else { &[3, 4] };
    let all = |motion: Motion| {
        let cost = |&(name, cells, recipe): &(&'static str, Cells, Recipe)| {
            let time = |&across: &usize| {
                let mesh = cells.fill([across; 3], [0.1; 3]);
                let count = mesh.cell_count();
                let body = Body::new(mesh, 1000.0).boxed_model(recipe()?).fix(plane(2, 0.0));
                Ok((count, time_of_step::<f32>(body, motion)?))
            };
            Ok(Cost { name, times: grids.iter().map(time).collect::<Result<_, ValidationError>>()? })
        };
        MODELS.iter().map(cost).collect::<Result<Vec<_>, ValidationError>>()
    };
    Ok(StepCost { explicit: all(Motion::Explicit)?, implicit: all(Motion::Implicit)? })
}

/// Time of an explicit sub-step of a body under its weight, the best of several [ms].
///
/// # Errors
/// [`ValidationError`] where the body makes no sense or a step fails.
pub fn time_of_substep<T: Precision>(body: Body) -> Result<f64, ValidationError> {
    time_of_step::<T>(body, Motion::Explicit)
}

/// The best of several steps [ms]; of explicit ones, per sub-step.
fn time_of_step<T: Precision>(body: Body, motion: Motion) -> Result<f64, ValidationError> {
    let integrator = match motion {
        Motion::Explicit => Integrator::Explicit(Substep::Automatic),
        Motion::Implicit => Integrator::Implicit(Implicit { linear: Stop::Iterations(25), ..Implicit::default() }),
    };
    let mut world = World::<T>::new(WorldConfig { step: 0.01, integrator, ..WorldConfig::default() })?;
    world.add(body)?;
    let mut best = f64::MAX;
    for _ in 0..6 {
        let start = Instant::now();
        let report = world.step()?;
        best = best.min(start.elapsed().as_secs_f64() / f64::from(report.substeps.max(1)));
    }
    Ok(1e3 * best)
}

impl StepCost {
    /// The page.
    pub fn report(&self) -> Report {
        let mut report = Report::new("What a step costs").text(
            "Cubes of E = 10 kPa, ν = 0.4, under their weight; single precision, one thread, the best of six. Numbers are \
             those of the machine that made this page.",
        );
        for (name, title, found) in [
            ("explicit", "One explicit sub-step", &self.explicit),
            ("implicit", "One implicit step of 25 iterations", &self.implicit),
        ] {
            let mut table = Table::new(name, &["model", "cells", "time [ms]", "per cell [ns]"]);
            let mut plot = Plot {
                name,
                title: title.into(),
                x: "cells",
                y: "time [ms]",
                scale: Scale::Logarithmic,
                curves: Vec::new(),
            };
            for Cost { name, times } in found {
                for &(cells, time) in times {
                    let row = [brief(time), brief(1e6 * time / cells as f64)];
                    table.push([&[(*name).to_owned(), cells.to_string()][..], &row].concat());
                }
                plot.curve(*name, times.iter().map(|&(cells, time)| (cells as f64, time)).collect());
            }
            report = report.text(format!("## {title}")).table(table).plot(plot);
        }
        report
    }
}

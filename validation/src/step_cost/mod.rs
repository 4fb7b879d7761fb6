//! Time per step against the number of cells, for every model and the variants of the corotational one: explicit sub-steps and implicit
//! steps of 25 iterations.

use std::time::Instant;

use viscera::body::Body;
use viscera::dynamics::implicit::Implicit;
use viscera::material::{
    Lame, LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseLinear,
};
use viscera::mesh::Region;
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement};
use viscera::model::{
    Corotational, Hybrid, LinearTensorMass, MassSpring, ModelRecipe, NodallyIntegrated, Precision, Precomputed,
    ShapeMemory, StiffnessWarping, TensorMass, TotalLagrangian,
};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, World, WorldConfig};

use crate::plot::{Plot, Scale};
use crate::references::Vector;
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
    /// In which of the drawings it stands.
    family: Family,
    /// Cells, and time per step [ms].
    pub times: Vec<(usize, f64)>,
}

/// What is drawn together.
#[derive(Clone, Copy, PartialEq)]
enum Family {
    /// Laws by elements.
    Elements,
    /// The variants of the corotational model.
    Corotational,
    /// Discrete and pre-computed models.
    Others,
}

const FAMILIES: [Family; 3] = [Family::Elements, Family::Corotational, Family::Others];

impl Family {
    /// What stands behind the title of its drawing.
    fn words(self) -> &'static str {
        match self {
            Self::Elements => "",
            Self::Corotational => ": corotational models",
            Self::Others => ": discrete and pre-computed models",
        }
    }

    /// Whether its drawing shows a model: its own, and for comparison the corotational one and the cheapest law by elements.
    fn shows(self, cost: &Cost) -> bool {
        let compared = match self {
            Self::Elements => "corotational",
            Self::Corotational | Self::Others => "total-Lagrangian, St Venant–Kirchhoff",
        };
        cost.family == self || cost.name == compared
    }
}

/// What steps.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    Explicit,
    Implicit,
}

type Recipe = fn() -> Result<Box<dyn ModelRecipe>, ValidationError>;

const YOUNG: f64 = 10e3;
const POISSON: f64 = 0.4;
/// Edge of the cube [m].
const EDGE: f64 = 0.1;

fn quadratic() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON)?))
}

fn linear() -> Result<Tissue, ValidationError> {
    Ok(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON)?))
}

fn with_fibres() -> Result<Tissue, ValidationError> {
    let lame = Lame::from_young_poisson(YOUNG, POISSON)?;
    let along = Lame::new(3.0 * lame.lambda, 3.0 * lame.mu)?;
    Ok(Tissue::uniform(TransverseLinear::new(lame, [1.0, 1.0, 1.0], along)?))
}

fn corotational() -> Result<Corotational, ValidationError> {
    Ok(Corotational::new(linear()?))
}

/// A model, its cells, and how far it goes.
struct Candidate {
    name: &'static str,
    family: Family,
    cells: Cells,
    /// The most cubes along an edge: what some models keep grows faster than the mesh.
    most: usize,
    /// Whether an implicit step is another than an explicit one.
    implicit: bool,
    recipe: Recipe,
}

const fn candidate(name: &'static str, family: Family, cells: Cells, recipe: Recipe) -> Candidate {
    Candidate { name, family, cells, most: usize::MAX, implicit: true, recipe }
}

use Cells::{Hexahedra, Six};
use Family::Elements;

const MODELS: [Candidate; 19] = [
    candidate("linear tensor-mass", Elements, Six, || Ok(Box::new(LinearTensorMass::new(linear()?)))),
    candidate("tensor-mass, St Venant–Kirchhoff", Elements, Six, || Ok(Box::new(TensorMass::new(quadratic()?)))),
    candidate("total-Lagrangian, St Venant–Kirchhoff", Elements, Six, || {
        Ok(Box::new(TotalLagrangian::new(quadratic()?)))
    }),
    candidate("total-Lagrangian, neo-Hookean", Elements, Six, || {
        Ok(Box::new(TotalLagrangian::new(Tissue::uniform(NeoHookean::from_young_poisson(YOUNG, POISSON)?))))
    }),
    candidate("total-Lagrangian, stable neo-Hookean", Elements, Six, || {
        Ok(Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::from_young_poisson(YOUNG, POISSON)?))))
    }),
    candidate("integrated at the nodes, stable neo-Hookean", Elements, Six, || {
        Ok(Box::new(NodallyIntegrated::new(Tissue::uniform(StableNeoHookean::from_young_poisson(YOUNG, POISSON)?))))
    }),
    candidate("total-Lagrangian hexahedra, St Venant–Kirchhoff", Elements, Hexahedra, || {
        Ok(Box::new(TotalLagrangian::new(quadratic()?)))
    }),
    candidate("corotational", Family::Corotational, Six, || Ok(Box::new(corotational()?))),
    candidate("corotational, QR", Family::Corotational, Six, || Ok(Box::new(corotational()?.rotation(Rotation::Qr)))),
    candidate("corotational, SVD", Family::Corotational, Six, || Ok(Box::new(corotational()?.rotation(Rotation::Svd)))),
    candidate("corotational, B updated", Family::Corotational, Six, || {
        Ok(Box::new(corotational()?.strain_displacement(StrainDisplacement::Updated)))
    }),
    candidate("corotational, B updated, current V", Family::Corotational, Six, || {
        let updated = corotational()?.strain_displacement(StrainDisplacement::Updated);
        Ok(Box::new(updated.volume(IntegrationVolume::Current)))
    }),
    candidate("corotational, fibres", Family::Corotational, Six, || Ok(Box::new(Corotational::new(with_fibres()?)))),
    candidate("corotational hexahedra", Family::Corotational, Hexahedra, || Ok(Box::new(corotational()?))),
    candidate("stiffness warping", Family::Corotational, Six, || Ok(Box::new(StiffnessWarping::new(linear()?)))),
    candidate("mass–spring net", Family::Others, Six, || Ok(Box::new(MassSpring::new(linear()?)))),
    candidate("shape memory", Family::Others, Six, || Ok(Box::new(ShapeMemory::new(linear()?)))),
    Candidate {
        most: 12,
        ..candidate("hybrid, linear, upper half moves", Family::Others, Six, || {
            let half = Vector::new(0.0, 0.0, 0.6 * EDGE);
            let upper = Region::HalfSpace { point: half, normal: Vector::new(0.0, 0.0, 1.0) };
            Ok(Box::new(Hybrid::new(linear()?).dynamic(upper)))
        })
    },
    Candidate {
        most: 8,
        implicit: false,
        ..candidate("pre-computed, a whole step", Family::Others, Six, || Ok(Box::new(Precomputed::new(linear()?))))
    },
];

/// # Errors
/// [`ValidationError`] where a step fails.
pub fn study(size: Size) -> Result<StepCost, ValidationError> {
    let grids: &[usize] = if size == Size::Full { &[4, 8, 12, 16, 25] } else { &[3, 4] };
    let all = |motion: Motion| {
        let cost = |model: &Candidate| {
            let time = |&across: &usize| {
                let mesh = model.cells.fill([across; 3], [EDGE; 3]);
                let count = mesh.cell_count();
                let body = Body::new(mesh, 1000.0).boxed_model((model.recipe)()?).fix(plane(2, 0.0));
                Ok((count, time_of_step::<f32>(body, motion)?))
            };
            let times = grids.iter().filter(|&&across| across <= model.most).map(time);
            let times = times.collect::<Result<_, ValidationError>>()?;
            Ok(Cost { name: model.name, family: model.family, times })
        };
        let models = MODELS.iter().filter(|model| model.implicit || motion == Motion::Explicit);
        models.map(cost).collect::<Result<Vec<_>, ValidationError>>()
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
             those of the machine that made this page. What is pre-computed rests at the end of every step, explicit or not, and \
             its time is that of a whole step; what it keeps, and the hybrid model, grow faster than the mesh, and stop at \
             smaller ones.",
        );
        for (name, title, found, drawings) in [
            (
                "explicit",
                "One explicit sub-step",
                &self.explicit,
                ["explicit", "explicit-corotational", "explicit-others"],
            ),
            (
                "implicit",
                "One implicit step of 25 iterations",
                &self.implicit,
                ["implicit", "implicit-corotational", "implicit-others"],
            ),
        ] {
            let mut table = Table::new(name, &["model", "cells", "time [ms]", "per cell [ns]"]);
            for Cost { name, times, .. } in found {
                for &(cells, time) in times {
                    let row = [brief(time), brief(1e6 * time / cells as f64)];
                    table.push([&[(*name).to_owned(), cells.to_string()][..], &row].concat());
                }
            }
            report = report.text(format!("## {title}")).table(table);
            for (family, drawing) in FAMILIES.into_iter().zip(drawings) {
                let mut plot = Plot::new(
                    drawing,
                    format!("{title}{}", family.words()),
                    ["cells", "time [ms]"],
                    Scale::Logarithmic,
                );
                for Cost { name, times, .. } in found.iter().filter(|cost| family.shows(cost)) {
                    plot.curve(*name, times.iter().map(|&(cells, time)| (cells as f64, time)).collect());
                }
                report = report.plot(plot);
            }
        }
        report
    }
}

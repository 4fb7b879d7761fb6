//! From how many iterations of the conjugate gradient on it pays to assemble the matrix, on 3 430 corotational tetrahedra:
//! Nesme et al. (2005), section 4, find about 50.

use std::time::Instant;

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, MatrixForm};
use viscera::material::{LinearElastic, Tissue};
use viscera::mesh::{CubeCut, TetMesh};
use viscera::model::Corotational;
use viscera::solver::Stop;
use viscera::world::{Integrator, World, WorldConfig};

use crate::plot::{Plot, Scale};
use crate::report::{Table, brief};
use crate::setting::plane;
use crate::{Report, Size, ValidationError};

/// What was found.
pub struct AssemblyCrossover {
    /// Tetrahedra.
    pub cells: usize,
    /// Iterations, and time per step [ms] without a matrix and with one.
    pub times: Vec<(u32, [f64; 2])>,
}

/// # Errors
/// [`ValidationError`] where a step fails.
pub fn study(size: Size) -> Result<AssemblyCrossover, ValidationError> {
    let (grid, counts): (_, &[u32]) = match size {
        Size::Small => ([3, 3, 6], &[5, 20]),
        Size::Full => ([7, 7, 14], &[5, 10, 20, 50, 100, 150, 200, 300, 400, 600]),
    };
    let mesh = TetMesh::box_grid_cut(grid, [0.1, 0.1, 0.2], CubeCut::Five);
    let cells = mesh.cells.len();
    let time = |&count: &u32| {
        let form = |matrix| time_of_step(&mesh, Stop::Iterations(count), matrix);
        Ok((count, [form(MatrixForm::Free)?, form(MatrixForm::Assembled)?]))
    };
    Ok(AssemblyCrossover { cells, times: counts.iter().map(time).collect::<Result<_, ValidationError>>()? })
}

/// The best of several steps [ms], in double precision as the paper's.
fn time_of_step(mesh: &TetMesh, linear: Stop, matrix: MatrixForm) -> Result<f64, ValidationError> {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.4)?);
    let body = Body::new(mesh.clone(), 1000.0).model(Corotational::new(tissue)).fix(plane(2, 0.0));
    let integrator = Integrator::Implicit(Implicit { linear, matrix, ..Implicit::default() });
    let mut world = World::<f64>::new(WorldConfig { step: 0.01, integrator, ..WorldConfig::default() })?;
    world.add(body)?;
    let mut best = f64::MAX;
    for _ in 0..8 {
        let start = Instant::now();
        world.step()?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(1e3 * best)
}

impl AssemblyCrossover {
    /// The number of iterations from which the assembled matrix is faster, between those that were timed.
    pub fn crossover(&self) -> Option<f64> {
        self.times.windows(2).find_map(|pair| {
            let [(a, before), (b, after)] = [pair[0], pair[1]];
            let lead = |times: [f64; 2]| times[1] - times[0];
            let crosses = lead(before) > 0.0 && lead(after) <= 0.0;
            let share = lead(before) / (lead(before) - lead(after));
            crosses.then(|| f64::from(a) + share * f64::from(b - a))
        })
    }

    /// The page.
    pub fn report(&self) -> Report {
        let mut table = Table::new("times", &["iterations", "without a matrix [ms]", "assembled [ms]"]);
        let mut plot = Plot {
            name: "times",
            title: format!("One implicit step, {} corotational tetrahedra, double precision", self.cells),
            x: "iterations of the conjugate gradient",
            y: "time [ms]",
            scale: Scale::Linear,
            curves: Vec::new(),
        };
        for (count, [free, assembled]) in &self.times {
            table.push(vec![count.to_string(), brief(*free), brief(*assembled)]);
        }
        for (form, name) in ["without a matrix", "assembled"].into_iter().enumerate() {
            plot.curve(name, self.times.iter().map(|(count, times)| (f64::from(*count), times[form])).collect());
        }
        let crossing = match self.crossover() {
            Some(count) => format!("Assembling pays from {count:.0} iterations on."),
            None => "The two do not cross within these counts.".into(),
        };
        Report::new("When to assemble the matrix")
            .text(format!(
                "One step of linearised backward Euler on {} corotational tetrahedra (polar), the best of eight, with the \
                 product computed from the elements or from an assembled matrix of 3×3 blocks. Nesme et al. (2005) find \
                 that assembling pays from about 50 iterations on. {crossing}",
                self.cells
            ))
            .table(table)
            .plot(plot)
    }
}

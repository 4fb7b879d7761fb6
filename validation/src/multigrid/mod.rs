//! How many iterations a step of fine tissue takes, with the blocks on the diagonal and with multigrid as the preconditioner: the
//! first grows with the number of cells along the body, the second hardly does, whole or cut half through.

use std::time::Instant;

use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Preconditioning};
use viscera::material::{LinearElastic, Tissue};
use viscera::math::Vec3;
use viscera::mesh::{Liver, Region, TetMesh};
use viscera::model::Corotational;
use viscera::solver::Stop;
use viscera::world::{Integrator, World, WorldConfig};

use crate::plot::{Plot, Scale};
use crate::report::{Table, brief};
use crate::setting::plane;
use crate::{Report, Size, ValidationError};

/// Share to which the residual has to fall.
const TOLERANCE: f64 = 1e-6;
/// The two steps [s]: one of play, and one in which everything comes to rest.
const STEPS: [f64; 2] = [0.01, 1.0];
/// Bodies above this size take their steps once, smaller ones several times.
const LARGE: usize = 200_000;
/// How often the others do.
const REPEATED: u32 = 5;

/// What was found.
pub struct MultigridStudy {
    /// How large the meshes were.
    pub size: Size,
    /// One for each body, size and step.
    pub rows: Vec<Row>,
}

/// One body at one step.
#[derive(Clone, Debug)]
pub struct Row {
    /// "cantilever" or "liver".
    pub body: &'static str,
    /// Whether it was cut half through.
    pub is_cut: bool,
    /// Tetrahedra before the cut.
    pub cells: usize,
    /// Δt [s].
    pub step: f64,
    /// With the blocks on the diagonal.
    pub block_jacobi: Cost,
    /// With multigrid.
    pub multigrid: Cost,
}

/// What a step took.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Iterations of the conjugate gradient.
    pub iterations: u32,
    /// The whole step [ms].
    pub time: f64,
}

/// # Errors
/// [`ValidationError`] where a mesh cannot be made or a step fails.
pub fn study(size: Size) -> Result<MultigridStudy, ValidationError> {
    match size {
        Size::Small => study_on(size, &[3, 6, 9], &[1_000, 5_000, 16_000]),
        Size::Full => study_on(size, &[3, 4, 8, 16, 35], &[1_000, 10_000, 100_000, 1_000_000]),
    }
}

/// The same on beams with so many cells across, and on livers of about so many tetrahedra.
///
/// # Errors
/// As [`study`].
pub fn study_on(size: Size, across: &[usize], cells: &[usize]) -> Result<MultigridStudy, ValidationError> {
    let liver = Liver::new(0.3)?;
    let mut rows = Vec::new();
    for &across in across {
        let mesh = TetMesh::box_grid([across, across, 4 * across], [0.1, 0.1, 0.4]);
        add(&mut rows, "cantilever", &mesh, &plane(2, 0.0))?;
    }
    for &cells in cells {
        let mesh = TetMesh::from_signed_distance(&liver, TetMesh::edge_for_cells(&liver, cells)?)?;
        // Where the great vessels enter.
        let held = Region::Sphere { centre: Vec3::new(0.0, 0.02, -0.03), radius: 0.04 };
        add(&mut rows, "liver", &mesh, &held)?;
    }
    Ok(MultigridStudy { size, rows })
}

fn add(rows: &mut Vec<Row>, body: &'static str, mesh: &TetMesh, held: &Region) -> Result<(), ValidationError> {
    for is_cut in [false, true] {
        let removed = if is_cut { half_through(mesh) } else { Vec::new() };
        for step in STEPS {
            let [block_jacobi, multigrid] = [
                cost(mesh, held, &removed, step, Preconditioning::BlockJacobi)?,
                cost(mesh, held, &removed, step, Preconditioning::Multigrid)?,
            ];
            rows.push(Row { body, is_cut, cells: mesh.cells.len(), step, block_jacobi, multigrid });
        }
    }
    Ok(())
}

/// Cells that a plane across the longest axis meets, in the middle of the body, as far as the middle of its second axis.
fn half_through(mesh: &TetMesh) -> Vec<u32> {
    let bound = |pick: fn(f64, f64) -> f64| {
        let corner = |a: Vec3<f64>, b: Vec3<f64>| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z));
        mesh.nodes.iter().copied().reduce(corner).unwrap_or(Vec3::ZERO)
    };
    let (low, high) = (bound(f64::min), bound(f64::max));
    let (middle, size) = ((low + high) * 0.5, high - low);
    let longest = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let second = (longest + 1) % 3;
    // Between the nodes of a grid: the cut is one layer of cells, however fine the mesh is.
    let plane = middle[longest] + 0.37 * (mesh.volume() / mesh.cells.len() as f64).cbrt();
    let is_met = |cell: usize| {
        let corners = mesh.cells[cell].map(|node| mesh.nodes[node as usize]);
        let ahead = corners.iter().filter(|corner| corner[longest] > plane).count();
        (1..4).contains(&ahead) && corners.iter().map(|corner| corner[second]).sum::<f64>() < 4.0 * middle[second]
    };
    (0..mesh.cells.len()).filter(|&cell| is_met(cell)).map(|cell| cell as u32).collect()
}

/// The first step from rest, E = 10 kPa, ν = 0.45, linearised; little gravity, so that one linear solve is the whole answer.
fn cost(
    mesh: &TetMesh,
    held: &Region,
    removed: &[u32],
    step: f64,
    preconditioner: Preconditioning,
) -> Result<Cost, ValidationError> {
    let linear = Stop::Tolerance { relative: TOLERANCE, at_most: 20_000 };
    let integrator = Integrator::Implicit(Implicit { linear, preconditioner, ..Implicit::default() });
    let config = WorldConfig { gravity: [0.0, -0.01, 0.0], step, integrator };
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.45)?);
    let body = Body::new(mesh.clone(), 1000.0).model(Corotational::new(tissue)).fix(held.clone());
    let mut world = World::<f64>::new(config)?;
    let id = world.add(body)?;
    world.remove_cells(id, removed)?;
    let start = world.snapshot();
    let mut cost = Cost { iterations: 0, time: f64::MAX };
    for _ in 0..if mesh.cells.len() > LARGE { 1 } else { REPEATED } {
        world.restore(&start)?;
        let begun = Instant::now();
        let report = world.step()?;
        cost.time = cost.time.min(1e3 * begun.elapsed().as_secs_f64());
        cost.iterations = report.implicit.map_or(0, |report| report.linear_iterations);
    }
    Ok(cost)
}

impl MultigridStudy {
    /// The rows of a body, whole or cut, at a step.
    pub fn of<'a>(&'a self, body: &'a str, is_cut: bool, step: f64) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.body == body && row.is_cut == is_cut && row.step == step)
    }

    /// The page.
    pub fn report(&self) -> Report {
        let head = [
            "body",
            "tetrahedra",
            "step [ms]",
            "iterations, block-Jacobi",
            "iterations, multigrid",
            "time, block-Jacobi [ms]",
            "time, multigrid [ms]",
            "times faster",
        ];
        let mut table = Table::new("steps", &head);
        for row in &self.rows {
            let Row { body, is_cut, cells, step, block_jacobi, multigrid } = row;
            table.push(vec![
                format!("{body}{}", if *is_cut { ", cut half through" } else { "" }),
                cells.to_string(),
                brief(1e3 * step),
                block_jacobi.iterations.to_string(),
                multigrid.iterations.to_string(),
                brief(block_jacobi.time),
                brief(multigrid.time),
                brief(block_jacobi.time / multigrid.time),
            ]);
        }
        let plot = |name, title: &str, y, value: &dyn Fn(&Cost) -> f64| {
            let mut plot = Plot {
                name,
                title: title.to_owned(),
                x: "tetrahedra",
                y,
                scale: Scale::Logarithmic,
                curves: Vec::new(),
            };
            for body in ["cantilever", "liver"] {
                for step in STEPS {
                    let points = |cost: &dyn Fn(&Row) -> Cost| {
                        self.of(body, false, step).map(|row| (row.cells as f64, value(&cost(row)))).collect()
                    };
                    let name = |way| format!("{body}, {} ms, {way}", brief(1e3 * step));
                    plot.reference(name("block-Jacobi"), points(&|row| row.block_jacobi));
                    plot.curve(name("multigrid"), points(&|row| row.multigrid));
                }
            }
            plot
        };
        let cells = self.rows.iter().map(|row| row.cells);
        let (least, most) = (cells.clone().min().unwrap_or(0), cells.max().unwrap_or(0));
        let repeated = if most > LARGE { format!(", of one above {LARGE} tetrahedra") } else { String::new() };
        Report::new("Iterations of fine tissue, with and without multigrid")
            .text(format!(
                "One step of linearised backward Euler from rest, on corotational tetrahedra of E = 10 kPa, ν = 0.45 and \
                 1000 kg/m³, in double precision on one core, until the residual has fallen to {TOLERANCE:.0e}: a cantilever of \
                 0.1 × 0.1 × 0.4 m and a liver of 0.3 m that is held where its vessels enter, of {least} to {most} tetrahedra, whole and with a layer of cells \
                 removed across the middle, half through. {} \
                 In 10 ms a wave crosses \
                 6 cm, in 1 s the tissue comes to rest. The time is that of the whole step, with the coarse matrices made \
                 anew: the best of {REPEATED}{repeated}.",
                self.size.sentence()
            ))
            .table(table)
            .plot(plot("iterations", "Iterations to a residual of 1e-6", "iterations", &|cost| {
                f64::from(cost.iterations)
            }))
            .plot(plot("times", "Time of a step", "time [ms]", &|cost| cost.time))
    }
}

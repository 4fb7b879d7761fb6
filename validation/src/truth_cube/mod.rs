//! The truth cube: silicone, 80 mm, 343 beads inside whose places were measured under compression by 5, 12.5 and 18.25 %.
//!
//! Measured by Kerdok, Cotin, Ottensmeyer, Galea, Howe, Dawson, Medical Image Analysis 7 (2003), 283; computed before by Nesme,
//! Payan, Faure (2005). Boundary conditions: the lower face is held; the upper face is glued to the plate and follows it
//! by the nominal way. The published columns come out with a glued plate, and not with one that lets the silicone slide.

mod beads;
mod variant;

use std::panic::resume_unwind;
use std::path::Path;
use std::time::Instant;

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::dynamics::implicit::Implicit;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticError};
use viscera::mesh::VolumeMesh;
use viscera::solver::Stop;
use viscera::world::{Integrator, World, WorldConfig};

use self::beads::STRAINS;
use self::variant::Kind;
pub use self::variant::Variant;
use crate::nearly_incompressible::plate_force;
use crate::references::{TRUTH_CUBE, Vector, list, number, read, vectors};
use crate::report::{Table, ratio};
use crate::setting::{Settled, plane};
use crate::{Report, Settings, Size, ValidationError};

const EDGE: f64 = 0.08;
/// Of silicone [kg/m³]; it matters to the time of steps only.
const DENSITY: f64 = 970.0;

/// What was found.
pub struct TruthCube {
    /// Every variant, mesh and strain.
    pub rows: Vec<Row>,
    /// Whether the measured beads were at hand.
    pub measured: bool,
}

/// A variant at a strain.
pub struct Row {
    /// The variant.
    pub variant: Variant,
    /// Cells to an edge.
    pub cells: usize,
    /// Which of the strains.
    pub state: usize,
    /// What came out; none where no equilibrium was found.
    pub outcome: Option<Outcome>,
}

/// What came out.
pub struct Outcome {
    /// Force of the plate over the converged one: of linear tissue for small strains, of neo-Hookean tissue for the rest.
    pub force: f64,
    /// Distance of the beads from their converged neo-Hookean places.
    pub from_converged: Deviation,
    /// Distance of the beads from their measured places.
    pub from_measured: Option<Deviation>,
    /// Time of an implicit step of 25 iterations [ms].
    pub step: f64,
    /// Displacements of the nodes [m], those of a grid: x fastest, then y, then z.
    pub moved: Vec<Vector>,
}

/// A cube that was pressed.
struct Pressed {
    /// Force of the plate [N].
    force: f64,
    /// Displacements of the beads [m].
    beads: Vec<Vector>,
    /// Displacements of the nodes [m].
    nodes: Vec<Vector>,
}

impl Pressed {
    /// What came of pressing by a `share` of the way, over the share.
    fn new(variant: &Variant, settled: &Settled, cells: usize, share: f64) -> Self {
        let over = |moved: Vec<Vector>| moved.into_iter().map(|u| u / share).collect();
        let seen = if variant.is_free_of_locking() { means(settled) } else { settled.displacements() };
        Self {
            force: plate_force(settled, EDGE) / share,
            beads: over(bead_displacements(&seen, cells)),
            nodes: over(settled.displacements()),
        }
    }
}

/// Distances in per cent of 80 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Mean.
    pub mean: f64,
    /// Least.
    pub least: f64,
    /// Largest.
    pub most: f64,
    /// Standard deviation.
    pub sigma: f64,
}

impl Deviation {
    fn between(a: &[Vector], b: &[Vector]) -> Self {
        let apart: Vec<f64> = a.iter().zip(b).map(|(&a, &b)| 100.0 * (a - b).norm() / EDGE).collect();
        let mean = apart.iter().sum::<f64>() / apart.len() as f64;
        let variance = apart.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / apart.len() as f64;
        Self {
            mean,
            least: apart.iter().copied().fold(f64::MAX, f64::min),
            most: apart.iter().copied().fold(0.0, f64::max),
            sigma: variance.sqrt(),
        }
    }

    /// Whether every number is within a tenth of a point, as both are printed.
    fn is_near(&self, published: &Self) -> bool {
        let numbers = |of: &Self| [of.mean, of.least, of.most, of.sigma].map(|number| (100.0 * number).round());
        numbers(self).into_iter().zip(numbers(published)).all(|(a, b)| (a - b).abs() <= 100.0 * MET)
    }

    fn text(&self) -> String {
        format!("{:.2} / {:.2} / {:.2} / {:.2}", self.mean, self.least, self.most, self.sigma)
    }
}

/// # Errors
/// [`ValidationError`] where the measured beads cannot be read, or a plain solve fails.
pub fn study(settings: &Settings) -> Result<TruthCube, ValidationError> {
    let (full, measured) = (settings.size == Size::Full, settings.measured.as_deref());
    let variants = Variant::all(full);
    let mut found = study_on(if full { &[8, 10] } else { &[6] }, &variants, measured)?;
    if full {
        // What does not lock is too soft on few cells, and goes on to where it has converged.
        let free: Vec<_> = variants.into_iter().filter(Variant::is_free_of_locking).collect();
        found.rows.extend(study_on(&[16], &free, measured)?.rows);
    }
    Ok(found)
}

/// The same with so many cells to an edge, by these variants.
///
/// # Errors
/// As [`study`].
pub fn study_on(meshes: &[usize], variants: &[Variant], measured: Option<&Path>) -> Result<TruthCube, ValidationError> {
    let measured = measured.map(beads::read).transpose()?;
    let case = read(TRUTH_CUBE);
    let mut rows = Vec::new();
    for &cells in meshes {
        for variant in variants {
            let step = step_time(variant, cells)?;
            for (state, pressed) in press_all(variant, cells)?.into_iter().enumerate() {
                let converged = |law: &str| &list(&case["converged_reference"][law])[state];
                // The beads of linear tissue are not among the references.
                let beads = vectors(&converged("glued_neohooke")["bead_displacement_m"]);
                let plate = number(&converged(variant.converged_law())["plate_force_z_N"]);
                let outcome = pressed.map(|pressed| Outcome {
                    force: pressed.force / plate,
                    from_converged: Deviation::between(&pressed.beads, &beads),
                    from_measured: measured
                        .as_ref()
                        .map(|measured| Deviation::between(&pressed.beads, &measured[state])),
                    step,
                    moved: pressed.nodes,
                });
                rows.push(Row { variant: variant.clone(), cells, state, outcome });
            }
        }
    }
    Ok(TruthCube { rows, measured: measured.is_some() })
}

fn young_and_poisson() -> (f64, f64) {
    let material = &read(TRUTH_CUBE)["material"];
    (number(&material["E_Pa"]), number(&material["nu"]))
}

/// Presses the cube by each of the strains, all at the same time.
fn press_all(variant: &Variant, cells: usize) -> Result<Vec<Option<Pressed>>, ValidationError> {
    std::thread::scope(|scope| {
        let presses = STRAINS.map(|strain| scope.spawn(move || press(variant, cells, strain)));
        presses.into_iter().map(|press| press.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    })
}

/// Presses the cube. None where it finds no stable equilibrium.
fn press(variant: &Variant, cells: usize, strain: f64) -> Result<Option<Pressed>, ValidationError> {
    let (young, poisson) = young_and_poisson();
    let push = Vector::new(0.0, 0.0, -strain * EDGE);
    let body = |way: Curve<Vector>| -> Result<Body, ValidationError> {
        Ok(variant.body(cells, young, poisson)?.fix(plane(2, 0.0)).prescribe(plane(2, EDGE), way))
    };
    let settle = |share: f64| {
        let settings = QuasiStatic { tolerance: 1e-8, ..QuasiStatic::default() };
        let settled = match Settled::new(body(Curve::constant(push * share))?, [0.0; 3], &settings) {
            Err(ValidationError::Static(StaticError::NoEquilibrium { .. })) => return Ok(None),
            settled => settled?,
        };
        Ok(Some(Pressed::new(variant, &settled, cells, share)))
    };
    match variant.kind {
        // Every law is linear over a way so short.
        Kind::SmallStrain { .. } => settle(1e-6),
        Kind::NeoHookean { .. } => settle(1.0),
        Kind::Corotational { .. } | Kind::StiffnessWarping => {
            // Steps of 0.05 s and more press so far that tetrahedra on 5³ to 7³ cells may fold, at 18.25 %, into another shape that holds at
            // half the force: rounding decides. Where short ones do not come to rest, long ones damp more.
            for (step, at_most) in [(0.02, 100), (0.1, 40)] {
                if let Some(settled) = relax(body(pushed_within(push, 1.0))?, step, at_most)? {
                    return Ok(Some(Pressed::new(variant, &settled, cells, 1.0)));
                }
            }
            Ok(None)
        }
    }
}

/// The plate goes its way in `time` [s].
fn pushed_within(push: Vector, time: f64) -> Curve<Vector> {
    Curve::piecewise_linear(vec![(0.0, Vector::ZERO), (time, push)]).expect("times rise")
}

/// The most iterations that a way to rest may take. Where linear steps lead nowhere, each is solved in full instead, and so without end.
const PATIENCE: u32 = 60_000;

/// Long implicit steps, which damp what moves, until no node moves by more than a millionth of the edge in a step. None where
/// that does not happen within so many steps, or a step is refused, or patience ends.
fn relax(body: Body, step: f64, at_most: u32) -> Result<Option<Settled>, ValidationError> {
    let linear = Stop::Tolerance { relative: 1e-4, at_most: 1000 };
    let integrator = Integrator::Implicit(Implicit { linear, ..Implicit::default() });
    let mut world = World::new(WorldConfig { gravity: [0.0; 3], step, integrator })?;
    let id = world.add(body.damping(20.0))?;
    let mut iterations = 0;
    for _ in 0..at_most {
        let Ok(report) = world.step() else { return Ok(None) };
        iterations += report.implicit.map_or(0, |implicit| implicit.linear_iterations);
        if iterations > PATIENCE {
            return Ok(None);
        }
        let fastest = world.body(id).velocities().iter().map(|v| v.norm()).fold(0.0, f64::max);
        if world.time() > 1.0 + 0.5 * step && fastest * step < 1e-6 * EDGE {
            // Internal forces where the cube came to rest.
            world.observe(id);
            return Ok(Some(Settled::already(world, id)));
        }
    }
    Ok(None)
}

/// Displacements of the nodes as a law sees them that is asked there: the mean over the cells around, weighted as their strains are, whose
/// gradient is the mean strain. The nodes themselves lie to either side of it, unseen, by 0.6 mm on 8³ cells and half as much on 16³.
fn means(settled: &Settled) -> Vec<Vector> {
    let moved = settled.displacements();
    let VolumeMesh::Tet(mesh) = settled.world.body(settled.id).mesh() else { return moved };
    let mut sums = vec![(Vector::ZERO, 0.0); moved.len()];
    for (cell, corners) in mesh.cells.iter().enumerate() {
        let volume = mesh.cell_volume(cell);
        let mean = corners.iter().fold(Vector::ZERO, |sum, &node| sum + moved[node as usize]) * 0.25;
        for &node in corners {
            let (sum, weight) = &mut sums[node as usize];
            *sum += mean * volume;
            *weight += volume;
        }
    }
    // On the surface the cells around lie to one side.
    let is_inside = |node: Vector| node.to_array().iter().all(|&x| x > 1e-9 && x < EDGE - 1e-9);
    let inside = |node: usize| is_inside(mesh.nodes[node]).then(|| sums[node].0 / sums[node].1);
    moved.iter().enumerate().map(|(node, &own)| inside(node).unwrap_or(own)).collect()
}

/// Displacement of the beads, which lie at whole centimetres: between the eight nodes around, linear in each direction.
fn bead_displacements(moved: &[Vector], cells: usize) -> Vec<Vector> {
    let beads = vectors(&read(TRUTH_CUBE)["bead_positions_m"]);
    let at = |bead: Vector| {
        let place = (bead + Vector::new(0.5 * EDGE, 0.5 * EDGE, 0.0)) * (cells as f64 / EDGE);
        // A bead on a node is not moved off it by rounding.
        let low = place.to_array().map(|p| ((p + 1e-9).floor() as usize).min(cells - 1));
        let part = [0, 1, 2].map(|axis| place[axis] - low[axis] as f64);
        let mut sum = Vector::ZERO;
        for corner in 0..8 {
            let up = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = (0..3).map(|axis| if up[axis] == 1 { part[axis] } else { 1.0 - part[axis] }).product::<f64>();
            let [i, j, k] = [0, 1, 2].map(|axis| low[axis] + up[axis]);
            sum += moved[i + (cells + 1) * (j + (cells + 1) * k)] * weight;
        }
        sum
    };
    beads.into_iter().map(at).collect()
}

/// Time of an implicit step of 25 iterations in single precision, the mean of ten [ms].
fn step_time(variant: &Variant, cells: usize) -> Result<f64, ValidationError> {
    const STEPS: u32 = 10;
    let (young, poisson) = young_and_poisson();
    let push = pushed_within(Vector::new(0.0, 0.0, -0.05 * EDGE), 1.0);
    let body = variant.body(cells, young, poisson)?.fix(plane(2, 0.0)).prescribe(plane(2, EDGE), push);
    let integrator = Integrator::Implicit(Implicit { linear: Stop::Iterations(25), ..Implicit::default() });
    let mut world = World::<f32>::new(WorldConfig { gravity: [0.0; 3], step: 0.01, integrator })?;
    world.add(body)?;
    let start = Instant::now();
    for _ in 0..STEPS {
        world.step()?;
    }
    Ok(1e3 * start.elapsed().as_secs_f64() / f64::from(STEPS))
}

/// Within how much of a published number it is met [points].
const MET: f64 = 0.1;

/// As published, small and large strains, and of the converged reference.
const PUBLISHED: [(&str, [Deviation; 3]); 4] = [
    (
        "Ansys, small strain (Nesme et al. 2005)",
        [deviation(1.07, 0.03, 2.94, 0.63), deviation(1.49, 0.10, 4.29, 0.87), deviation(1.97, 0.44, 5.18, 1.00)],
    ),
    (
        "linear, converged (mixed elements)",
        [deviation(1.08, 0.04, 2.93, 0.64), deviation(1.52, 0.02, 4.33, 0.91), deviation(2.04, 0.38, 5.14, 1.06)],
    ),
    (
        "Ansys, large strain (Nesme et al. 2005)",
        [deviation(1.06, 0.04, 2.93, 0.63), deviation(1.45, 0.05, 4.12, 0.83), deviation(1.78, 0.20, 4.83, 0.91)],
    ),
    (
        "neo-Hookean, converged (mixed elements)",
        [deviation(1.07, 0.05, 2.92, 0.64), deviation(1.47, 0.12, 4.15, 0.86), deviation(1.82, 0.22, 4.78, 0.97)],
    ),
];

const fn deviation(mean: f64, least: f64, most: f64, sigma: f64) -> Deviation {
    Deviation { mean, least, most, sigma }
}

impl TruthCube {
    /// Variants that meet every number of the published columns, `[small strain, linear converged, large strain, neo-Hookean converged]`,
    /// within 0.1 points; with their cells to an edge.
    pub fn meeting(&self) -> [Vec<(String, usize)>; 4] {
        PUBLISHED.map(|(_, columns)| {
            let of_one = self.rows.chunks(STRAINS.len()).filter(|rows| {
                rows.iter().zip(columns).all(|(row, published)| {
                    let deviation = row.outcome.as_ref().and_then(|outcome| outcome.from_measured);
                    deviation.is_some_and(|deviation| deviation.is_near(&published))
                })
            });
            of_one.map(|rows| (rows[0].variant.name(), rows[0].cells)).collect()
        })
    }

    /// The page.
    pub fn report(&self) -> Report {
        let mut published = Table::new("published", &["who", "5 %", "12.5 %", "18.25 %", "met here by"]);
        for ((who, columns), met) in PUBLISHED.into_iter().zip(self.meeting()) {
            let met: Vec<String> = met.into_iter().map(|(variant, cells)| format!("{variant}, {cells}³")).collect();
            let by = if met.is_empty() { "–".into() } else { met.join("; ") };
            published.push([who.into()].into_iter().chain(columns.map(|column| column.text())).chain([by]).collect());
        }
        let mut found = Table::new(
            "variants",
            &[
                "variant",
                "cells to an edge",
                "strain",
                "beads from measured",
                "beads from converged neo-Hookean",
                "plate force over converged",
                "step of 25 iterations [ms]",
            ],
        );
        for row in &self.rows {
            let strain = format!("{} %", 100.0 * STRAINS[row.state]);
            let mut cells = vec![row.variant.name(), row.cells.to_string(), strain];
            match &row.outcome {
                Some(outcome) => cells.extend([
                    outcome.from_measured.map_or("–".into(), |deviation| deviation.text()),
                    outcome.from_converged.text(),
                    ratio(outcome.force),
                    format!("{:.2}", outcome.step),
                ]),
                None => cells.extend(["no equilibrium", "–", "–", "–"].map(str::to_owned)),
            }
            found.push(cells);
        }
        let report = Report::new("The truth cube").text(
            "A cube of silicone, 80 mm, E = 14.9 kPa, ν = 0.499, with 343 beads inside, pressed by 5, 12.5 and 18.25 % between \
             plates (Kerdok et al. 2003). The lower face is held, the upper one glued to its plate, which goes its nominal \
             way: so the published columns come out. Deviations are mean / least / largest / σ over the beads, in per cent \
             of 80 mm. Beads were measured to about 0.65 mm, and drift; so no method comes below a mean of 1 %, and the \
             deviation hardly sees locking. The plate's force does, over the converged one: that of linear tissue for small \
             strains, of neo-Hookean tissue for the rest. Plain elements of low order press two to five times \
             too hard, tetrahedra integrated at the nodes come within 2 % on 10³ cells. At 18.25 % linear tissue itself presses \
             18 % less than neo-Hookean tissue. Beads in cells that are integrated at the nodes are read from the mean of the cells \
             around a node, whose gradient is what the law sees. On 10³ cells the largest deviation of that element at 18.25 % \
             is not yet the published 4.83: the bead stands 10 mm below the edge of the plate, where strains are \
             largest, and comes there with finer cells, as the converged reference does. Where no equilibrium is found, long \
             damped steps went on moving: rotations by QR and node-wise warping leave a torque in the body, and B updated \
             has no energy to fall.",
        );
        let report = if self.measured {
            report
        } else {
            report
                .text("The measured beads were not given (`--data FILE`): the column that compares with them is empty.")
        };
        report
            .text("Published, and who meets every number of a line within 0.1 points:")
            .table(published)
            .text("Here:")
            .table(found)
    }
}

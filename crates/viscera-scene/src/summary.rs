//! What a scene holds, for a person to read before running it.

use std::fmt;

use viscera::body::NodeMotion;
use viscera::math::Scalar;
use viscera::mesh::VolumeMesh;
use viscera::world::BodyId;

use crate::build::BuiltScene;
use crate::error::SceneErrors;
use crate::file::{InstrumentFile, IntegratorName, Precision, RegionFile, RegionShape};
use crate::scene::Scene;

/// What a scene holds and what it takes to run it. `Display` writes it as a few lines for each body and instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// What the scene shows.
    pub title: Option<String>,
    /// How long it runs [s].
    pub duration: f64,
    /// Step of the world [s].
    pub step: f64,
    /// Steps that the run takes.
    pub steps: u64,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Substeps of a step at the start; none where the integrator is implicit.
    pub substeps: Option<u64>,
    /// Numbers of the simulation.
    pub precision: Precision,
    /// Bodies, in the order of the file.
    pub bodies: Vec<BodySummary>,
    /// Instruments, in the order of the file.
    pub instruments: Vec<InstrumentSummary>,
}

/// What there is to know about a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySummary {
    /// Its name.
    pub name: String,
    /// Nodes.
    pub nodes: usize,
    /// Cells.
    pub cells: usize,
    /// "tetrahedra" or "hexahedra".
    pub shape: &'static str,
    /// Lengths of the sides of its bounding box [m].
    pub size: [f64; 3],
    /// Mass [kg].
    pub mass: f64,
    /// Name of the law.
    pub law: String,
    /// Name of the force model.
    pub model: String,
    /// Longest stable step of the explicit integrator at the start [s].
    pub stable_step: f64,
    /// How many nodes are fixed, and by which region.
    pub fixed: (usize, String),
    /// Nodes that are moved along a given way.
    pub prescribed: usize,
    /// Nodes that move in a plane or along a line only.
    pub guided: usize,
    /// Names of the bodies that it is grown to.
    pub grown_to: Vec<String>,
    /// Loads.
    pub loads: usize,
    /// What was found and repaired in its mesh file.
    pub notices: Vec<String>,
}

/// What there is to know about an instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct InstrumentSummary {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Its radius [m].
    pub radius: f64,
    /// Length of its path [m].
    pub path: f64,
    /// When it begins and ends its work [s]; to the end of the run where the scene gives none. None where only a hand makes it work.
    pub active: Option<(f64, f64)>,
}

impl Scene {
    /// What the scene holds and what it takes to run it; builds it in the precision that it asks for.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    pub fn summary(&self) -> Result<SceneSummary, SceneErrors> {
        match self.check()?.precision {
            Precision::Single => Ok(self.build::<f32>()?.summary()),
            Precision::Double => Ok(self.build::<f64>()?.summary()),
        }
    }
}

impl<T: Scalar> BuiltScene<T> {
    /// What the scene holds and what it takes to run it.
    pub fn summary(&mut self) -> SceneSummary {
        let ids: Vec<BodyId> = self.bodies.values().copied().collect();
        let stable: Vec<f64> = ids.into_iter().map(|id| self.world.body_mut(id).stable_step()).collect();
        let file = &self.file;
        let named = self.bodies.keys().zip(stable);
        let bodies: Vec<BodySummary> = named.map(|(name, stable)| self.body_summary(name, stable)).collect();
        let stable = bodies.iter().map(|body| body.stable_step).fold(f64::INFINITY, f64::min);
        SceneSummary {
            title: file.title.clone(),
            duration: file.duration.0,
            step: file.step.0,
            steps: self.steps(),
            integrator: file.integrator.kind.name(),
            substeps: (file.integrator.kind == IntegratorName::Explicit)
                .then(|| viscera::dynamics::explicit::substeps_for(file.step.0, 4.0 / (stable * stable)) as u64),
            precision: file.precision,
            bodies,
            instruments: self.instruments.keys().map(|name| self.instrument_summary(name)).collect(),
        }
    }

    fn body_summary(&self, name: &str, stable_step: f64) -> BodySummary {
        let described = &self.file.body[name];
        let body = self.world.body(self.bodies[name]);
        let mesh = body.mesh();
        let (low, high) = mesh.bounds();
        let count = |wanted: fn(NodeMotion) -> bool| body.state().motions.iter().filter(|&&own| wanted(own)).count();
        let fixed = described.fix.as_ref().map_or_else(|| "nothing".to_owned(), in_words);
        let notices = self.notices.iter().filter(|(body, _)| body == name).map(|(_, notice)| notice.clone());
        BodySummary {
            name: name.to_owned(),
            nodes: mesh.nodes().len(),
            cells: mesh.cell_count(),
            shape: if matches!(mesh, VolumeMesh::Tet(_)) { "tetrahedra" } else { "hexahedra" },
            size: (high - low).to_array(),
            mass: body.state().masses.iter().map(|mass| mass.to_f64()).sum(),
            law: body.law().to_owned(),
            model: body.model().to_string(),
            stable_step,
            fixed: (count(|motion| motion == NodeMotion::Fixed), fixed),
            prescribed: count(|motion| matches!(motion, NodeMotion::Prescribed(_))),
            guided: count(|motion| matches!(motion, NodeMotion::Guided(_))),
            grown_to: described.attach.iter().map(|attach| attach.to.clone()).collect(),
            loads: described.load.len(),
            notices: notices.collect(),
        }
    }

    fn instrument_summary(&self, name: &str) -> InstrumentSummary {
        let end = self.file.duration.0;
        let instrument = self.world.instrument(self.instruments[name]);
        let active = match &self.file.instrument[name] {
            InstrumentFile::Probe { .. } => Some((0.0, end)),
            InstrumentFile::Grasper { close: from, open: to, .. }
            | InstrumentFile::Cautery { on: from, off: to, .. } => from.map(|from| (from.0, to.map_or(end, |to| to.0))),
        };
        let stretches = instrument.path().points().windows(2);
        InstrumentSummary {
            name: name.to_owned(),
            kind: instrument.kind().to_owned(),
            radius: instrument.reach(),
            path: stretches.fold(0.0, |way, pair| way + (pair[1].1 - pair[0].1).norm()),
            active,
        }
    }
}

/// A region in a few words.
fn in_words(region: &RegionFile) -> String {
    match region {
        RegionFile::Name(name) => format!("`{name}`"),
        RegionFile::Union(parts) => parts.iter().map(in_words).collect::<Vec<_>>().join(" and "),
        RegionFile::Shape(shape) => match &**shape {
            RegionShape::Box { .. } => "a box".into(),
            RegionShape::Sphere { .. } => "a sphere".into(),
            RegionShape::Plane { .. } => "a plane".into(),
            RegionShape::HalfSpace { .. } => "a half-space".into(),
            RegionShape::Nearest(_) => "the node nearest to a place".into(),
            RegionShape::Group(name) => format!("`{name}`"),
            RegionShape::Nodes(_) => "nodes by number".into(),
            RegionShape::Intersection(parts) => {
                format!("what is in {}", parts.iter().map(in_words).collect::<Vec<_>>().join(" and in "))
            }
        },
    }
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        if let Some(title) = &self.title {
            writeln!(out, "{title}")?;
        }
        let precision = if self.precision == Precision::Single { "single" } else { "double" };
        let Self { duration, steps, step, .. } = self;
        let step = step * 1e3;
        let how = match self.substeps {
            Some(substeps) => format!("each {substeps} substeps"),
            None => format!("by {}", self.integrator),
        };
        writeln!(out, "{duration} s: {steps} steps of {step} ms, {how}, {precision} precision")?;
        self.bodies.iter().try_for_each(|body| body.fmt(out))?;
        self.instruments.iter().try_for_each(|instrument| instrument.fmt(out))
    }
}

impl fmt::Display for BodySummary {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let [x, y, z] = self.size.map(|side| side * 1e3);
        writeln!(out, "\nbody {}", self.name)?;
        writeln!(out, "  mesh    {} {}, {} nodes, {x:.0} x {y:.0} x {z:.0} mm", self.cells, self.shape, self.nodes)?;
        writeln!(out, "  tissue  {} by {}, {:.3} kg", self.law, self.model, self.mass)?;
        if self.stable_step.is_finite() {
            writeln!(out, "  stable  explicit steps up to {:.3} ms", self.stable_step * 1e3)?;
        } else {
            writeln!(out, "  stable  in steps of any length: it rests at the end of each")?;
        }
        writeln!(out, "  fixed   {} nodes: {}", self.fixed.0, self.fixed.1)?;
        if self.prescribed > 0 {
            writeln!(out, "  moved   {} nodes", self.prescribed)?;
        }
        if self.guided > 0 {
            writeln!(out, "  slide   {} nodes", self.guided)?;
        }
        if !self.grown_to.is_empty() {
            writeln!(out, "  grown   to {}", self.grown_to.join(" and "))?;
        }
        if self.loads > 0 {
            writeln!(out, "  loads   {}", self.loads)?;
        }
        self.notices.iter().try_for_each(|notice| writeln!(out, "  note    {}", notice.replace('\n', "\n          ")))
    }
}

impl fmt::Display for InstrumentSummary {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let radius = self.radius * 1e3;
        let path = if self.path > 0.0 { format!("path {:.1} cm", self.path * 1e2) } else { "still".to_owned() };
        let when = self.active.map_or("for a hand".to_owned(), |(from, to)| format!("at work from {from} to {to} s"));
        writeln!(out, "\ninstrument {}", self.name)?;
        writeln!(out, "  {} of radius {radius:.1} mm, {path}, {when}", self.kind)
    }
}

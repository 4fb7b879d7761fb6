//! What steps and searches did, and what is measured about bodies and instruments.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscera::body::KeptVolumeNow;
use viscera::dynamics::implicit::ImplicitReport;
use viscera::dynamics::quasi_static::StaticReport;
use viscera::mesh::FillingReport;
use viscera::world::{BodyObservables, InstrumentObservables, StepReport};

/// What an implicit step did; of several bodies, the worst.
#[pyclass(frozen, name = "ImplicitReport", module = "viscera")]
pub(crate) struct PyImplicitReport(ImplicitReport);

/// What a step did.
#[pyclass(frozen, name = "StepReport", module = "viscera")]
pub(crate) struct PyStepReport(pub(crate) StepReport);

/// How an equilibrium was found.
#[pyclass(frozen, name = "StaticReport", module = "viscera")]
pub(crate) struct PyStaticReport(pub(crate) StaticReport);

#[pymethods]
impl PyStaticReport {
    /// Load steps that succeeded: the share of the load, and the residuals before each iteration and after the last, relative to loads
    /// and reactions.
    #[getter]
    fn steps(&self) -> Vec<(f64, Vec<f64>)> {
        self.0.steps.iter().map(|step| (step.share, step.residuals.clone())).collect()
    }

    /// Shares of the load that were tried in vain.
    #[getter]
    fn retries(&self) -> usize {
        self.0.retries
    }

    /// Newton iterations of all steps that succeeded.
    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations()
    }
}

/// Getters of one class, and the same as a dict.
macro_rules! getters {
    ($class:ident { $($(#[$doc:meta])* $name:ident: $type:ty = |$of:ident| $value:expr;)+ }) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self) -> $type {
                    let $of = &self.0;
                    $value
                }
            )+

            /// All of it by name.
            fn as_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
                let dict = PyDict::new(py);
                $(dict.set_item(stringify!($name), self.$name())?;)+
                Ok(dict)
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                Ok(format!("<{} {}>", stringify!($class).trim_start_matches("Py"), self.as_dict(py)?.repr()?))
            }
        }
    };
}

getters!(PyImplicitReport {
    /// Iterations of Newton's method; 1 for a linearised step.
    newton_iterations: u32 = |of| of.newton_iterations;
    /// Iterations of the conjugate gradient, over all iterations of Newton's method.
    linear_iterations: u32 = |of| of.linear_iterations;
    /// What is left of the residual, relative.
    residual: f64 = |of| of.residual;
    /// Whether that is below what was asked for.
    converged: bool = |of| of.converged;
    /// Whether a linear solve met a direction of negative curvature.
    negative_curvature: bool = |of| of.negative_curvature;
});

getters!(PyStepReport {
    /// Time at the end [s].
    time: f64 = |of| of.time;
    /// Sub-steps taken.
    substeps: u32 = |of| of.substeps;
    /// Times that the step was done again with more sub-steps.
    retries: u32 = |of| of.retries;
    /// Cells removed.
    removed_cells: usize = |of| of.removed_cells;
    /// What the solver did, in an implicit step; None in an explicit one.
    implicit: Option<PyImplicitReport> = |of| of.implicit.map(PyImplicitReport);
});

/// What became of a surface when it was filled with tetrahedra.
#[pyclass(frozen, name = "FillingReport", module = "viscera")]
pub(crate) struct PyFillingReport(pub(crate) FillingReport);

getters!(PyFillingReport {
    /// Edge of the lattice [m].
    edge: f64 = |of| of.edge;
    /// Tetrahedra made.
    cells: usize = |of| of.cells;
    /// Volume of the tetrahedra [m³].
    volume: f64 = |of| of.volume;
    /// Volume that the surface encloses, cavities left out [m³].
    surface_volume: f64 = |of| of.surface.volume;
    /// Share of that volume which the tetrahedra lack: creases cut off, curves cut short, thin parts lost.
    volume_lost: f64 = |of| of.volume_lost;
    /// Share of the area under which the solid is thinner than 1.5 edges, where cells cannot hold it.
    thin_area: f64 = |of| of.thin_area;
    /// The edge with which only a hundredth of the area would be thin [m]; at most `edge`.
    sufficient_edge: f64 = |of| of.sufficient_edge;
    /// Parts of the mesh that no face connects.
    pieces: usize = |of| of.pieces;
    /// Parts of the surface that no edge connects, cavities among them.
    components: usize = |of| of.surface.components;
    /// How many of these are cavities.
    cavities: usize = |of| of.surface.cavities;
    /// All of it in words: what was mended of the surface, what was lost, and the edge that would do.
    text: String = |of| of.to_string();
});

/// A volume that is kept exactly, as it is now.
#[pyclass(frozen, name = "KeptVolume", module = "viscera")]
pub(crate) struct PyKeptVolume(pub(crate) KeptVolumeNow);

getters!(PyKeptVolume {
    /// Its name.
    name: &str = |of| &of.name;
    /// What it is to be [m³].
    wanted: f64 = |of| of.wanted;
    /// (V − V0)/V0 now.
    error: f64 = |of| of.error;
    /// The pressure from inside that kept it in the last sub-step [Pa].
    pressure: f64 = |of| of.pressure;
});

/// Numbers about a body, in double precision whatever the world computes in.
#[pyclass(frozen, name = "BodyObservables", module = "viscera")]
pub(crate) struct PyBodyObservables(pub(crate) BodyObservables);

getters!(PyBodyObservables {
    /// ½ Σ m v² [J].
    kinetic_energy: f64 = |of| of.kinetic_energy;
    /// Energy stored in the tissue [J].
    elastic_energy: f64 = |of| of.elastic_energy;
    /// −Σ m g·x [J].
    gravity_energy: f64 = |of| of.gravity_energy;
    /// Σ m v [kg m/s].
    momentum: [f64; 3] = |of| of.momentum.to_array();
    /// Σ m x×v about the origin [kg m²/s].
    angular_momentum: [f64; 3] = |of| of.angular_momentum.to_array();
    /// Sum of the internal forces [N].
    net_internal_force: [f64; 3] = |of| of.net_internal_force.to_array();
    /// Sum of x×f of the internal forces about the centre of mass [N m].
    net_internal_torque: [f64; 3] = |of| of.net_internal_torque.to_array();
    /// Mass of what is left [kg].
    mass: f64 = |of| of.mass;
    /// Volume of what is left [m³].
    volume: f64 = |of| of.volume;
    /// (V − V0)/V0 of what is left.
    volume_variation: f64 = |of| of.volume_variation;
    /// Largest |V − V0|/V0 of the volumes that are kept exactly; 0 without any.
    volume_error: f64 = |of| of.volume_error;
    /// Largest distance of a node from its place at rest [m].
    max_displacement: f64 = |of| of.max_displacement;
    /// Force by which fixed and prescribed nodes are held [N].
    reaction: [f64; 3] = |of| of.reaction.to_array();
    /// Cells removed.
    removed_cells: usize = |of| of.removed_cells;
    /// Cells whose volume is negative.
    inverted_cells: usize = |of| of.inverted_cells;
    /// What to do about inverted cells that stay so, in a sentence; None where there are none.
    inside_out: Option<String> = |of| of.inside_out.map(|found| found.to_string());
    /// Shape of the worst cell now: radius ratio or scaled Jacobian.
    worst_quality: f64 = |of| of.worst_quality;
    /// Nodes at which the full law acts.
    nonlinear_nodes: usize = |of| of.nonlinear_nodes;
    /// Whether the kinetic energy has died down to a hundred-millionth of the elastic energy.
    at_rest: bool = |of| of.at_rest;
    /// How much the reaction of a pre-computed part changed in the last step, over its size; None for a body without one.
    interface_residual: Option<f64> = |of| of.interface_residual;
});

/// Numbers about an instrument.
#[pyclass(frozen, name = "InstrumentObservables", module = "viscera")]
pub(crate) struct PyInstrumentObservables(pub(crate) InstrumentObservables);

getters!(PyInstrumentObservables {
    /// Where its tip is [m].
    tip: [f64; 3] = |of| of.tip.to_array();
    /// Whether it is at work: jaws closed, current on.
    active: bool = |of| of.active;
    /// Nodes that it holds.
    held_nodes: usize = |of| of.held_nodes;
    /// Force on the tissue [N], the mean over the last step: what carries the held nodes, contact and friction.
    force: [f64; 3] = |of| of.force.to_array();
    /// Moment of that force about the tip [N m].
    torque: [f64; 3] = |of| of.torque.to_array();
    /// Points at which it touches tissue.
    contacts: usize = |of| of.contacts;
});

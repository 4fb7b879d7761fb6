//! Bodies as a user describes them.

use std::sync::Arc;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use viscera::body::{Actuator, Body, Load, LoosePieces, Muscle};
use viscera::curve::Curve;
use viscera::math::Vec3;
use viscera::mesh::{Region, VolumeMesh};

use crate::arrays::{Numbers, scalars};
use crate::mesh::PyVolumeMesh;
use crate::model::{AnyModel, PyModel, choose};
use crate::region::{PyActuator, PyLoad, PyMuscle, number_curve, region, vector_curve};

/// A body to be added to a world: a mesh, its tissue, and what holds and pulls it.
#[pyclass(frozen, name = "Body", module = "viscera")]
pub(crate) struct PyBody(pub(crate) Description);

/// All that is said about a body.
#[derive(Clone, Debug)]
pub(crate) struct Description {
    pub(crate) name: String,
    pub(crate) mesh: Arc<VolumeMesh>,
    /// One density [kg/m³], or one for each cell.
    pub(crate) densities: Vec<f64>,
    pub(crate) model: AnyModel,
    pub(crate) keep_volume: f64,
    pub(crate) damping: f64,
    pub(crate) stiffness_damping: f64,
    pub(crate) fixed: Vec<Region>,
    pub(crate) prescribed: Vec<(Region, Curve<Vec3<f64>>)>,
    pub(crate) guided: Vec<(Region, [f64; 3], Curve<f64>)>,
    pub(crate) exact_volumes: Vec<(String, Region)>,
    pub(crate) rigid: Vec<Region>,
    pub(crate) muscles: Vec<Muscle>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) loads: Vec<Load>,
    pub(crate) loose_pieces: LoosePieces,
}

impl Description {
    /// What the engine is given.
    pub(crate) fn body(&self) -> Body {
        let mut body = Body::new((*self.mesh).clone(), self.densities.first().copied().unwrap_or(0.0))
            .name(&self.name)
            .boxed_model(self.model.recipe())
            .keep_volume(self.keep_volume)
            .damping(self.damping)
            .stiffness_damping(self.stiffness_damping)
            .loose_pieces(self.loose_pieces);
        if self.densities.len() != 1 {
            body = body.densities(self.densities.clone());
        }
        for region in &self.fixed {
            body = body.fix(region.clone());
        }
        for (region, curve) in &self.prescribed {
            body = body.prescribe(region.clone(), curve.clone());
        }
        for (region, normal, curve) in &self.guided {
            body = body.prescribe_along(region.clone(), *normal, curve.clone());
        }
        for (name, region) in &self.exact_volumes {
            body = body.keep_volume_exactly(name, region.clone());
        }
        for region in &self.rigid {
            body = body.rigid(region.clone());
        }
        for muscle in &self.muscles {
            body = body.muscle(muscle.clone());
        }
        for actuator in &self.actuators {
            body = body.actuator(actuator.clone());
        }
        for load in &self.loads {
            body = body.load(load.clone());
        }
        body
    }
}

/// One thing, or a list of them.
fn each<'py>(given: Option<&Bound<'py, PyAny>>) -> PyResult<Vec<Bound<'py, PyAny>>> {
    match given {
        None => Ok(Vec::new()),
        Some(given) if given.is_instance_of::<PyList>() => given.try_iter()?.collect(),
        Some(one) => Ok(vec![one.clone()]),
    }
}

fn pieces<'py>(given: &Bound<'py, PyAny>, count: usize, what: &str) -> PyResult<Bound<'py, PyTuple>> {
    let tuple = given.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == count);
    tuple.cloned().ok_or_else(|| PyTypeError::new_err(format!("{what}, or a list of such")))
}

#[pymethods]
impl PyBody {
    /// A body of `density` [kg/m³, > 0; one number, or one for each cell] with the force model `model`.
    ///
    /// `keep_volume`: stiffness of the volume-keeping force on each tetrahedron [Pa, ≥ 0]. `damping`: rate [1/s, ≥ 0].
    /// `stiffness_damping`: α of Rayleigh's damping [s, ≥ 0], implicit steps only. One or a list of: `fix`, regions that stay;
    /// `slide`, (region, normal) that move across the normal only; `prescribe`, (region, displacement) moved as a `Curve` says
    /// [m]; `prescribe_along`, (region, normal, displacement along it); `load`, loads; `actuator`,
    /// actuators. With explicit steps also: `keep_volume_exactly`,
    /// (name, region of cells) whose common volume is kept to rounding; `rigid`, regions of nodes that each move as one rigid body;
    /// `muscle`, muscles. `loose_pieces`: "free" or "drop" what a cut separates from everything that holds it.
    #[new]
    #[pyo3(signature = (mesh, density, *, model, name="body", keep_volume=0.0, damping=0.0, stiffness_damping=0.0, fix=None,
        slide=None, prescribe=None, prescribe_along=None, load=None, keep_volume_exactly=None, rigid=None, muscle=None,
        actuator=None, loose_pieces="free"))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        mesh: &PyVolumeMesh,
        density: Numbers<'_>,
        model: &PyModel,
        name: &str,
        keep_volume: f64,
        damping: f64,
        stiffness_damping: f64,
        fix: Option<&Bound<'_, PyAny>>,
        slide: Option<&Bound<'_, PyAny>>,
        prescribe: Option<&Bound<'_, PyAny>>,
        prescribe_along: Option<&Bound<'_, PyAny>>,
        load: Option<&Bound<'_, PyAny>>,
        keep_volume_exactly: Option<&Bound<'_, PyAny>>,
        rigid: Option<&Bound<'_, PyAny>>,
        muscle: Option<&Bound<'_, PyAny>>,
        actuator: Option<&Bound<'_, PyAny>>,
        loose_pieces: &str,
    ) -> PyResult<Self> {
        let densities = scalars(&density, "density")?;
        if densities.is_empty() {
            return Err(PyValueError::new_err("density is empty: give one number, or one for each cell"));
        }
        let mut guided = Vec::new();
        for item in each(slide)? {
            let item = pieces(&item, 2, "slide is (region, normal)")?;
            guided.push((region(&item.get_item(0)?)?, item.get_item(1)?.extract()?, Curve::constant(0.0)));
        }
        for item in each(prescribe_along)? {
            let item = pieces(&item, 3, "prescribe_along is (region, normal, displacement)")?;
            let curve = number_curve(&item.get_item(2)?)?;
            guided.push((region(&item.get_item(0)?)?, item.get_item(1)?.extract()?, curve));
        }
        let mut prescribed = Vec::new();
        for item in each(prescribe)? {
            let item = pieces(&item, 2, "prescribe is (region, displacement)")?;
            prescribed.push((region(&item.get_item(0)?)?, vector_curve(&item.get_item(1)?)?));
        }
        let mut exact_volumes = Vec::new();
        for item in each(keep_volume_exactly)? {
            let item = pieces(&item, 2, "keep_volume_exactly is (name, region)")?;
            exact_volumes.push((item.get_item(0)?.extract()?, region(&item.get_item(1)?)?));
        }
        Ok(Self(Description {
            name: name.into(),
            mesh: mesh.mesh.clone(),
            densities,
            model: model.0.clone(),
            keep_volume,
            damping,
            stiffness_damping,
            fixed: each(fix)?.iter().map(region).collect::<PyResult<_>>()?,
            prescribed,
            guided,
            exact_volumes,
            rigid: each(rigid)?.iter().map(region).collect::<PyResult<_>>()?,
            muscles: each(muscle)?
                .iter()
                .map(|muscle| Ok(muscle.cast::<PyMuscle>()?.get().0.clone()))
                .collect::<PyResult<_>>()?,
            actuators: each(actuator)?
                .iter()
                .map(|actuator| Ok(actuator.cast::<PyActuator>()?.get().0.clone()))
                .collect::<PyResult<_>>()?,
            loads: each(load)?
                .iter()
                .map(|load| Ok(load.cast::<PyLoad>()?.get().0.clone()))
                .collect::<PyResult<_>>()?,
            loose_pieces: choose(
                "loose_pieces",
                loose_pieces,
                &[("free", LoosePieces::Free), ("drop", LoosePieces::Drop)],
            )?,
        }))
    }

    /// The name by which messages call it.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Rate of its damping [1/s].
    #[getter]
    fn damping(&self) -> f64 {
        self.0.damping
    }

    /// α of Rayleigh's damping [s].
    #[getter]
    fn stiffness_damping(&self) -> f64 {
        self.0.stiffness_damping
    }

    fn __repr__(&self) -> String {
        let model = self.0.model.recipe();
        let (kind, law) = (model.kind().info().name, model.tissue().kind().name());
        format!("<body `{}` of {} cells: {kind} of {law}>", self.0.name, self.0.mesh.cell_count())
    }
}

//! Instruments: what a user describes, and one in a world.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use viscera::instrument::{Cautery, Grasper, Path};
use viscera::world::InstrumentId;

use crate::error::OrRaise;
use crate::region::vector_curve;
use crate::report::PyInstrumentObservables;
use crate::world::{AnyWorld, PyWorld, in_world};

/// Jaws that hold what they close on.
#[pyclass(frozen, name = "Grasper", module = "viscera")]
pub(crate) struct PyGrasper(Grasper);

#[pymethods]
impl PyGrasper {
    /// The tip's `path` [m] (a place, a `Curve`, or points (time, place)), the `radius` that the jaws reach [m], when they `close` [s],
    /// and when they `open` again, if they do.
    #[new]
    #[pyo3(signature = (path, *, radius=0.01, close=0.0, open=None))]
    fn new(path: &Bound<'_, PyAny>, radius: f64, close: f64, open: Option<f64>) -> PyResult<Self> {
        Ok(Self(Grasper { path: vector_curve(path)?, radius, close, open }))
    }
}

/// A hot tip that removes the tetrahedra that it touches.
#[pyclass(frozen, name = "Cautery", module = "viscera")]
pub(crate) struct PyCautery(Cautery);

#[pymethods]
impl PyCautery {
    /// The tip's `path` [m], how far it burns around (`radius` [m]), and when it is switched `on` and `off` [s].
    #[new]
    #[pyo3(signature = (path, *, radius=0.005, on=0.0, off=f64::INFINITY))]
    fn new(path: &Bound<'_, PyAny>, radius: f64, on: f64, off: f64) -> PyResult<Self> {
        let path: Path = vector_curve(path)?;
        Ok(Self(Cautery { path, radius, on: (on, off) }))
    }
}

/// Adds what was described to a world.
pub(crate) fn add(world: &mut AnyWorld, instrument: &Bound<'_, PyAny>) -> PyResult<InstrumentId> {
    if let Ok(grasper) = instrument.cast::<PyGrasper>() {
        return in_world!(world, world => world.add_instrument(grasper.get().0.clone())).or_raise();
    }
    if let Ok(cautery) = instrument.cast::<PyCautery>() {
        return in_world!(world, world => world.add_instrument(cautery.get().0.clone())).or_raise();
    }
    Err(PyTypeError::new_err("an instrument is a Grasper or a Cautery"))
}

/// An instrument in a world.
#[pyclass(frozen, name = "Instrument", module = "viscera")]
pub(crate) struct PyTool {
    pub(crate) world: Py<PyWorld>,
    pub(crate) id: InstrumentId,
}

#[pymethods]
impl PyTool {
    /// The name under which it was added.
    #[getter]
    fn name(&self, py: Python<'_>) -> String {
        self.world.borrow(py).instrument_names[self.id.0].clone()
    }

    /// "grasper", "cautery".
    #[getter]
    fn kind(&self, py: Python<'_>) -> &'static str {
        in_world!(&self.world.borrow(py).world, world => world.instrument(self.id).kind())
    }

    /// Measures the instrument now.
    fn observe(&self, py: Python<'_>) -> PyInstrumentObservables {
        let mut world = self.world.borrow_mut(py);
        PyInstrumentObservables(in_world!(&mut world.world, world => world.observe_instrument(self.id)))
    }

    /// The world.
    #[getter]
    fn world(&self, py: Python<'_>) -> Py<PyWorld> {
        self.world.clone_ref(py)
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyGrasper>()?;
    module.add_class::<PyCautery>()?;
    module.add_class::<PyTool>()
}

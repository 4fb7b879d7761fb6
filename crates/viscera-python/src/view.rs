//! Arrays that look into the engine's memory: no copy, and the world stands still as long as one is alive.
//!
//! numpy takes the memory by its array interface: an address, a shape, and the object that answers for them. It keeps that object alive, and
//! the object the world. What could write to the memory, move it or free it goes through `PyWorld::change`, which refuses as long
//! as such an object lives (`docs/decisions/0030-python-views.md`).

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::dtype;
use pyo3::exceptions::PyBufferError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscera::math::Vec3;
use viscera::world::BodyId;

use crate::arrays::NumpyScalar;
use crate::world::{PyWorld, in_world};

/// How many arrays look into a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Views(Arc<AtomicUsize>);

impl Views {
    pub(crate) fn count(&self) -> usize {
        self.0.load(Ordering::Acquire)
    }

    /// Refuses a change as long as someone looks.
    pub(crate) fn none_alive(&self) -> PyResult<()> {
        match self.count() {
            0 => Ok(()),
            count => Err(PyBufferError::new_err(format!(
                "the world stands still as long as arrays look into it, and {count} of them are alive: delete them and the slices that \
                 were taken of them, or take copies (`positions`) or arrays that follow (`live_positions`)"
            ))),
        }
    }
}

/// What answers for the memory of one array.
#[pyclass(frozen, name = "_StateView", module = "viscera")]
struct StateView {
    /// Kept alive, since the memory is its own.
    _world: Py<PyWorld>,
    views: Views,
    address: usize,
    nodes: usize,
    kind: String,
}

impl Drop for StateView {
    fn drop(&mut self) {
        self.views.0.fetch_sub(1, Ordering::AcqRel);
    }
}

#[pymethods]
impl StateView {
    /// numpy's array interface, version 3.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", &self.kind)?;
        interface.set_item("shape", (self.nodes, 3))?;
        let is_read_only = true;
        interface.set_item("data", (self.address, is_read_only))?;
        Ok(interface)
    }
}

/// Which vectors of a body an array looks at.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Of {
    Positions,
    Velocities,
}

/// An array of shape (n, 3) that looks at them, closed for writing.
pub(crate) fn view<'py>(world: &Bound<'py, PyWorld>, body: BodyId, of: Of) -> PyResult<Bound<'py, PyAny>> {
    let py = world.py();
    let object = {
        let borrowed = world.try_borrow()?;
        let (address, nodes, kind) = in_world!(&borrowed.world, inner => {
            let body = inner.body(body);
            memory(py, match of {
                Of::Positions => body.positions(),
                Of::Velocities => body.velocities(),
            })?
        });
        let views = borrowed.views.clone();
        views.0.fetch_add(1, Ordering::AcqRel);
        StateView { _world: world.clone().unbind(), views, address, nodes, kind }
    };
    py.import("numpy")?.call_method1("asarray", (object,))
}

/// Address, rows and numpy's word for the numbers of vectors: three of them one after the other, without gaps.
fn memory<T: NumpyScalar>(py: Python<'_>, vectors: &[Vec3<T>]) -> PyResult<(usize, usize, String)> {
    const { assert!(size_of::<Vec3<T>>() == 3 * size_of::<T>()) };
    Ok((vectors.as_ptr().addr(), vectors.len(), dtype::<T>(py).as_any().getattr("str")?.extract()?))
}

//! Many worlds at once, one thread each.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::world::{AnyWorld, PyWorld, in_world};

/// Threads that step worlds, each world on one of them: what vectorised environments use.
#[pyclass(frozen, name = "Threads", module = "viscera")]
pub(crate) struct PyThreads(ThreadPool);

#[pymethods]
impl PyThreads {
    /// So many threads; by default as many as the machine has cores.
    #[new]
    #[pyo3(signature = (count=0))]
    fn new(count: usize) -> PyResult<Self> {
        let pool = ThreadPoolBuilder::new().num_threads(count).build();
        pool.map(Self)
            .map_err(|error| PyRuntimeError::new_err(format!("{count} threads could not be started: {error}")))
    }

    /// How many there are.
    #[getter]
    fn count(&self) -> usize {
        self.0.current_num_threads()
    }

    /// Advances each of `worlds` by `count` steps; other threads of Python run meanwhile. Gives for each None, or what stopped
    /// it: that world is as it was before the step that failed, and the others go on. No world may be listed twice. The bits
    /// do not depend on how many threads there are.
    fn step(&self, py: Python<'_>, worlds: Vec<Py<PyWorld>>, count: u64) -> PyResult<Vec<Option<String>>> {
        let mut borrowed = Vec::with_capacity(worlds.len());
        for world in &worlds {
            borrowed.push(PyWorld::change(world.bind(py))?);
        }
        let mut inner: Vec<&mut AnyWorld> = borrowed.iter_mut().map(|world| &mut world.world).collect();
        let outcomes = py.detach(|| {
            let step = |world: &mut &mut AnyWorld| {
                in_world!(&mut **world, world => {
                    (0..count).try_for_each(|_| world.step().map(drop)).err().map(|error| error.to_string())
                })
            };
            self.0.install(|| inner.par_iter_mut().with_max_len(1).map(step).collect())
        });
        borrowed.iter().try_for_each(|world| world.refresh(py))?;
        Ok(outcomes)
    }
}

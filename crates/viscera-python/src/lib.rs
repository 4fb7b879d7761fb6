//! Viscera for Python: the engine's own names, numpy arrays in and out.
//!
//! What is here is translation and nothing else; the Python side (`python/viscera`) holds what is made of it: bridges to other
//! packages, identification, environments, sweeps.

mod arrays;
mod body;
mod depth;
mod describe;
mod ensemble;
mod error;
mod instrument;
mod integrator;
mod law;
mod mesh;
mod model;
mod region;
mod report;
mod scene;
mod simulated;
mod surface;
mod toml_value;
mod view;
mod world;

use pyo3::prelude::*;

/// The engine.
#[pymodule]
fn _viscera(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    error::register(module)?;
    law::register(module)?;
    model::register(module)?;
    instrument::register(module)?;
    module.add_class::<mesh::PyVolumeMesh>()?;
    module.add_class::<mesh::PyTetMesh>()?;
    module.add_class::<mesh::PyHexMesh>()?;
    module.add_class::<surface::PySurfaceMesh>()?;
    module.add_class::<region::PyRegion>()?;
    module.add_class::<region::PyCurve>()?;
    module.add_class::<region::PyLoad>()?;
    module.add_class::<region::PyMuscle>()?;
    module.add_class::<region::PyActuator>()?;
    module.add_class::<body::PyBody>()?;
    module.add_class::<integrator::PyExplicit>()?;
    module.add_class::<integrator::PyImplicit>()?;
    module.add_class::<integrator::PyQuasiStatic>()?;
    module.add_class::<world::PyWorld>()?;
    module.add_class::<world::PySnapshot>()?;
    module.add_class::<world::PyAttachment>()?;
    module.add_class::<simulated::PySimulatedBody>()?;
    module.add_class::<report::PyFillingReport>()?;
    module.add_class::<report::PyStepReport>()?;
    module.add_class::<report::PyImplicitReport>()?;
    module.add_class::<report::PyStaticReport>()?;
    module.add_class::<report::PyBodyObservables>()?;
    module.add_class::<report::PyKeptVolume>()?;
    module.add_class::<report::PyInstrumentObservables>()?;
    module.add_class::<scene::PyScene>()?;
    module.add_class::<ensemble::PyThreads>()?;
    module.add_function(wrap_pyfunction!(mesh::read, module)?)?;
    module.add_function(wrap_pyfunction!(depth::depth_image, module)?)
}

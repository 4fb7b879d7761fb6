//! The engine's errors as Python exceptions: one class for each enum, with the engine's own text.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use viscera::body::BodyError;
use viscera::curve::CurveError;
use viscera::dynamics::quasi_static::StaticError;
use viscera::executor::ExecutorError;
use viscera::instrument::InstrumentError;
use viscera::material::MaterialError;
use viscera::mesh::{GenerateError, MeshError, RegionError, SurfaceError};
use viscera::model::ModelError;
use viscera::solver::SolverError;
use viscera::world::{SnapshotError, StepError, WorldError};
use viscera_io::ReadError;
use viscera_io::write::WriteError;
use viscera_scene::SceneErrors;

/// An engine's error that becomes an exception.
pub(crate) trait Raise {
    fn raise(self) -> PyErr;
}

/// `?` for results of the engine.
pub(crate) trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Raise> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(Raise::raise)
    }
}

create_exception!(
    viscera,
    Error,
    PyException,
    "What all exceptions of viscera are: something that the engine refuses, and why."
);

macro_rules! exceptions {
    ($($class:ident = $error:ty, $doc:literal;)+) => {
        $(
            create_exception!(viscera, $class, Error, $doc);
            impl Raise for $error {
                fn raise(self) -> PyErr {
                    $class::new_err(self.to_string())
                }
            }
        )+
        /// Puts the exceptions into the module.
        pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
            let py = module.py();
            module.add("Error", py.get_type::<Error>())?;
            module.add("SceneError", py.get_type::<SceneError>())?;
            $(module.add(stringify!($class), py.get_type::<$class>())?;)+
            Ok(())
        }
    };
}

exceptions! {
    MeshRefused = MeshError, "A mesh that is not fit for simulation.";
    SurfaceRefused = SurfaceError, "A surface that cannot be filled.";
    GenerateRefused = GenerateError, "Measures from which no mesh can be made.";
    RegionRefused = RegionError, "A region that selects nothing, or cannot.";
    MaterialRefused = MaterialError, "A parameter that no tissue can have.";
    ModelRefused = ModelError, "A model that does not compute the law, or not on these cells.";
    CurveRefused = CurveError, "A curve that cannot be.";
    BodyRefused = BodyError, "A body that makes no sense.";
    WorldRefused = WorldError, "A world that cannot be set up so.";
    InstrumentRefused = InstrumentError, "A setting of an instrument that makes no sense.";
    StepFailed = StepError, "A step that was not made; the world is as it was before.";
    StaticFailed = StaticError, "No equilibrium was found; the body is in the last one that was.";
    SolverFailed = SolverError, "A linear system that is not solved.";
    SnapshotRefused = SnapshotError, "Bytes that are no snapshot of this world.";
    ReadFailed = ReadError, "A file that cannot be read as a mesh.";
    WriteFailed = WriteError, "A file that cannot be written.";
    ExecutorFailed = ExecutorError, "Threads that could not be started.";
}

create_exception!(
    viscera,
    SceneError,
    Error,
    "What is wrong in a scene. `line` and `column` count from 1, and are None where there is no text; `errors` has the text \
     of each error."
);

impl Raise for SceneErrors {
    fn raise(self) -> PyErr {
        let place = self.first().line_and_column();
        let texts: Vec<String> = self.all().iter().map(ToString::to_string).collect();
        Python::attach(|py| {
            let error = SceneError::new_err(self.to_string());
            let value = error.value(py);
            // An exception takes any attribute.
            let _ = value.setattr("line", place.map(|(line, _)| line));
            let _ = value.setattr("column", place.map(|(_, column)| column));
            let _ = value.setattr("errors", texts);
            error
        })
    }
}

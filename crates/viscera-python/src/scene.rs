//! Scene files, read and written.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use viscera::executor::Executor;
use viscera_scene::file::{Precision, SceneFile};
use viscera_scene::{Scene, SceneError, SceneErrors};

use crate::error::{OrRaise, Raise};
use crate::toml_value::toml;
use crate::world::{AnyWorld, PyWorld};

/// A scene file and its overrides. What is wrong is raised as `SceneError`, with the line itself.
#[pyclass(name = "Scene", module = "viscera")]
#[derive(Clone)]
pub(crate) struct PyScene {
    scene: Scene,
}

/// A world, the steps of its duration, and what was mended in mesh files, by body.
type Built = (Py<PyWorld>, u64, Vec<(String, String)>);

fn from_json<T: serde::de::DeserializeOwned>(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<T> {
    let text: String = py.import("json")?.call_method1("dumps", (value,))?.extract()?;
    serde_json::from_str(&text)
        .map_err(|error| SceneErrors::from(SceneError::without_place(error.to_string(), "")).raise())
}

pub(crate) fn to_python<'py>(py: Python<'py>, value: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

#[pymethods]
impl PyScene {
    /// Reads a scene file. Files that it names are looked for in its folder.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Scene::load(path).or_raise().map(|scene| Self { scene })
    }

    /// Takes a scene from its text (TOML). Files that it names are looked for in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, folder=PathBuf::from(".")))]
    fn parse(text: &str, folder: PathBuf) -> PyResult<Self> {
        Scene::parse(text, folder).or_raise().map(|scene| Self { scene })
    }

    /// A scene from a dict with the keys of scene files; quantities are numbers (SI) or strings with a unit.
    #[staticmethod]
    #[pyo3(signature = (file, folder=PathBuf::from(".")))]
    fn from_dict(py: Python<'_>, file: &Bound<'_, PyDict>, folder: PathBuf) -> PyResult<Self> {
        let file: SceneFile = from_json(py, file.as_any())?;
        Scene::from_file(&file, folder).or_raise().map(|scene| Self { scene })
    }

    /// Sets the value of a dotted key, such as "body.liver.law.young" to "8 kPa"; entries of lists have numbers from 0. A text is read as in
    /// a scene file; numbers, truth values, lists, tuples, dicts and numpy's numbers and arrays are what they are.
    fn set(&mut self, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let text = match value.cast::<PyString>() {
            Ok(text) => text.to_cow()?.into_owned(),
            Err(_) => toml(value)?,
        };
        self.scene.set(key, &text).or_raise()
    }

    /// A copy, for other overrides.
    fn copy(&self) -> Self {
        self.clone()
    }

    /// Where files that it names are looked for.
    #[getter]
    fn folder(&self) -> PathBuf {
        self.scene.folder().to_path_buf()
    }

    /// Checks keys, types, units and ranges, and gives what the file says as a dict, defaults filled in.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.scene.check().or_raise()?)
    }

    /// The scene as TOML, overrides and defaults filled in, quantities as SI numbers.
    fn to_toml(&self) -> PyResult<String> {
        self.scene.check().or_raise()?.to_toml().map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Builds the world: the world, the steps that its duration takes, and what was found and repaired in mesh files as (body,
    /// notice). `precision` is that of the scene, unless "single" or "double" is given; `threads` as for `World`.
    #[pyo3(signature = (*, precision=None, threads=1))]
    fn build(&self, py: Python<'_>, precision: Option<&str>, threads: usize) -> PyResult<Built> {
        let precision = match precision {
            None => self.scene.check().or_raise()?.precision,
            Some(word) => crate::model::choose(
                "precision",
                word,
                &[("single", Precision::Single), ("double", Precision::Double)],
            )?,
        };
        let executor = Executor::threads(threads).or_raise()?;
        let built = py.detach(|| match precision {
            Precision::Single => self.scene.build::<f32>().map(|built| {
                let (steps, names) = (built.steps(), built.instruments.keys().cloned().collect::<Vec<_>>());
                (AnyWorld::Single(built.world), steps, names, built.notices)
            }),
            Precision::Double => self.scene.build::<f64>().map(|built| {
                let (steps, names) = (built.steps(), built.instruments.keys().cloned().collect::<Vec<_>>());
                (AnyWorld::Double(built.world), steps, names, built.notices)
            }),
        });
        let (world, steps, names, notices) = built.or_raise()?;
        Ok((Py::new(py, PyWorld::from_world(world, executor, names))?, steps, notices))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, PathBuf))> {
        let scene = slf.borrow();
        Ok((slf.get_type().getattr("parse")?, (scene.to_toml()?, scene.scene.folder().to_path_buf())))
    }

    fn __repr__(&self) -> String {
        format!("<scene in {}>", self.scene.folder().display())
    }
}

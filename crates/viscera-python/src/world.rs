//! Worlds: bodies, instruments, a clock, in either precision.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use numpy::{PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use viscera::body::SimulatedBody;
use viscera::executor::Executor;
use viscera::world::{
    Attachment, AttachmentId, BodyId, InstrumentId, Snapshot, StepError, StepReport, World, WorldConfig,
};
use viscera_scene::file::SceneFile;

use crate::arrays::{NumpyScalar, vector_array};
use crate::body::{Description, PyBody};
use crate::describe;
use crate::error::OrRaise;
use crate::instrument::{AnyInstrument, PyTool};
use crate::integrator::integrator;
use crate::model::choose;
use crate::region::region;
use crate::report::PyStepReport;
use crate::simulated::PySimulatedBody;
use crate::view::Views;

/// How long steps are made before the interpreter is asked whether someone pressed Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

/// A world in one of the two precisions.
pub(crate) enum AnyWorld {
    Single(World<f32>),
    Double(World<f64>),
}

/// Does the same in whichever precision the world is.
macro_rules! in_world {
    ($world:expr, $name:ident => $work:expr) => {
        match $world {
            $crate::world::AnyWorld::Single($name) => $work,
            $crate::world::AnyWorld::Double($name) => $work,
        }
    };
}
pub(crate) use in_world;

/// Bodies and instruments that move together in time.
///
/// Steps let other threads of Python run. A world is used by one thread at a time: a call while another thread steps it raises
/// RuntimeError ("already mutably borrowed").
#[pyclass(name = "World", module = "viscera")]
pub(crate) struct PyWorld {
    pub(crate) world: AnyWorld,
    pub(crate) executor: Executor,
    /// What was said about each body, where Python said it.
    pub(crate) descriptions: Vec<Option<Description>>,
    /// Names of instruments, and what Python said about them.
    pub(crate) instruments: Vec<(String, Option<AnyInstrument>)>,
    /// What Python grew together.
    pub(crate) attachments: Vec<Attachment>,
    pub(crate) views: Views,
    /// Arrays that follow positions from step to step.
    live: Vec<Option<Py<PyAny>>>,
}

/// All that changes about a world, at one moment: put back, it goes on with the same bits, also after cuts.
#[pyclass(frozen, name = "Snapshot", module = "viscera")]
pub(crate) struct PySnapshot(AnySnapshot);

enum AnySnapshot {
    Single(Snapshot<f32>),
    Double(Snapshot<f64>),
}

#[pymethods]
impl PySnapshot {
    /// The snapshot as bytes that outlive the program; `World.read_snapshot` takes them.
    fn to_bytes<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bytes = match &self.0 {
            AnySnapshot::Single(snapshot) => snapshot.to_bytes(),
            AnySnapshot::Double(snapshot) => snapshot.to_bytes(),
        };
        PyBytes::new(py, &bytes)
    }
}

/// A part of a body that is grown to another body.
#[pyclass(frozen, name = "Attachment", module = "viscera")]
pub(crate) struct PyAttachment {
    world: Py<PyWorld>,
    id: AttachmentId,
}

#[pymethods]
impl PyAttachment {
    /// Force with which the other body pulls at the attached one [N]: the mean over the last step.
    #[getter]
    fn force(&self, py: Python<'_>) -> PyResult<[f64; 3]> {
        Ok(in_world!(&self.world.try_borrow(py)?.world, world => world.attachment_force(self.id).to_array()))
    }
}

impl PyWorld {
    pub(crate) fn from_world(world: AnyWorld, executor: Executor, instrument_names: Vec<String>) -> Self {
        let bodies = in_world!(&world, world => world.body_ids().count());
        Self {
            world,
            executor,
            descriptions: vec![None; bodies],
            instruments: instrument_names.into_iter().map(|name| (name, None)).collect(),
            attachments: Vec::new(),
            views: Views::default(),
            live: Vec::new(),
        }
    }

    /// The world, to be changed: not while another thread steps it (RuntimeError), nor while arrays look into it (BufferError).
    pub(crate) fn change<'py>(world: &Bound<'py, Self>) -> PyResult<PyRefMut<'py, Self>> {
        let world = world.try_borrow_mut()?;
        world.views.none_alive()?;
        Ok(world)
    }

    /// Makes steps, and asks for Ctrl-C now and then.
    fn make_steps(&mut self, py: Python<'_>, count: u64) -> PyResult<Option<StepReport>> {
        self.views.none_alive()?;
        let Self { world, executor, .. } = self;
        let (mut made, mut last) = (0, None);
        let mut outcome = Ok(());
        while made < count && outcome.is_ok() {
            let stretch: Result<(), StepError> = py.detach(|| {
                let begin = Instant::now();
                while made < count {
                    last = Some(in_world!(world, world => world.step_on(executor))?);
                    made += 1;
                    if begin.elapsed() > PATIENCE {
                        break;
                    }
                }
                Ok(())
            });
            outcome = stretch.or_raise();
            if outcome.is_ok() && made < count {
                outcome = py.check_signals();
            }
        }
        self.refresh(py)?;
        outcome.map(|()| last)
    }

    /// Brings the live arrays up to date.
    pub(crate) fn refresh(&self, py: Python<'_>) -> PyResult<()> {
        for (body, array) in self.live.iter().enumerate() {
            if let Some(array) = array {
                in_world!(&self.world, world => copy_into(array.bind(py), world.body(BodyId(body)))?);
            }
        }
        Ok(())
    }

    /// The array that follows a body's positions, a view that cannot be written to.
    pub(crate) fn live_positions<'py>(&mut self, py: Python<'py>, body: BodyId) -> PyResult<Bound<'py, PyAny>> {
        if self.live.len() <= body.0 {
            self.live.resize_with(body.0 + 1, || None);
        }
        let array = match &self.live[body.0] {
            Some(array) => array.clone_ref(py),
            None => {
                let array = in_world!(&self.world, world => {
                    vector_array(py, world.body(body).positions()).into_any().unbind()
                });
                self.live[body.0] = Some(array.clone_ref(py));
                array
            }
        };
        let view = array.bind(py).call_method0("view")?;
        view.getattr("flags")?.setattr("writeable", false)?;
        Ok(view)
    }

    fn add_description(&mut self, py: Python<'_>, description: &Description) -> PyResult<BodyId> {
        let id = py.detach(|| in_world!(&mut self.world, world => world.add(description.body()))).or_raise()?;
        self.descriptions.push(Some(description.clone()));
        Ok(id)
    }
}

fn copy_into<T: NumpyScalar>(array: &Bound<'_, PyAny>, body: &SimulatedBody<T>) -> PyResult<()> {
    let array = array.cast::<PyArray2<T>>()?;
    debug_assert_eq!(array.shape()[0], body.positions().len());
    let mut array = array.readwrite();
    for (row, place) in array.as_array_mut().outer_iter_mut().zip(body.positions()) {
        row.into_iter().zip(place.to_array()).for_each(|(number, component)| *number = component);
    }
    Ok(())
}

fn handle(slf: &Bound<'_, PyWorld>, id: BodyId) -> PyResult<PySimulatedBody> {
    let world = slf.try_borrow()?;
    let mesh = in_world!(&world.world, inner => {
        let described = world.descriptions.get(id.0).and_then(Option::as_ref);
        described.map_or_else(|| inner.body(id).mesh().clone().into(), |described| described.mesh.clone())
    });
    Ok(PySimulatedBody { world: slf.clone().unbind(), id, mesh })
}

#[pymethods]
impl PyWorld {
    /// An empty world: `gravity` [m/s²], `step` that one call of `step` advances [s], `integrator` (`Explicit`, `Implicit` or `QuasiStatic`),
    /// `precision` "double" or "single" (twice as fast), and how many `threads` a step of many cells may use.
    #[new]
    #[pyo3(signature = (*, gravity=[0.0, -9.81, 0.0], step=5e-3, integrator=None, precision="double", threads=1))]
    fn new(
        gravity: [f64; 3],
        step: f64,
        integrator: Option<&Bound<'_, PyAny>>,
        precision: &str,
        threads: usize,
    ) -> PyResult<Self> {
        let (integrator, solver) = self::integrator(integrator)?;
        let config = WorldConfig { gravity, step, integrator };
        let mut world = match choose("precision", precision, &[("single", true), ("double", false)])? {
            true => AnyWorld::Single(World::new(config).or_raise()?),
            false => AnyWorld::Double(World::new(config).or_raise()?),
        };
        if let Some(solver) = solver {
            in_world!(&mut world, world => world.set_static_solver(solver)).or_raise()?;
        }
        Ok(Self::from_world(world, Executor::threads(threads).or_raise()?, Vec::new()))
    }

    /// Adds a body, and gives it as it is simulated.
    fn add(slf: &Bound<'_, Self>, body: &PyBody) -> PyResult<PySimulatedBody> {
        let id = Self::change(slf)?.add_description(slf.py(), &body.0)?;
        handle(slf, id)
    }

    /// Bodies by name; where two have the same, the later one.
    #[getter]
    fn bodies<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let bodies = PyDict::new(slf.py());
        let ids: Vec<BodyId> = in_world!(&slf.try_borrow()?.world, world => world.body_ids().collect());
        for id in ids {
            let name = in_world!(&slf.try_borrow()?.world, world => world.body(id).name().to_owned());
            bodies.set_item(name, handle(slf, id)?)?;
        }
        Ok(bodies)
    }

    /// The body of this name.
    fn body(slf: &Bound<'_, Self>, name: &str) -> PyResult<PySimulatedBody> {
        let id =
            in_world!(&slf.try_borrow()?.world, world => world.body_ids().find(|&id| world.body(id).name() == name));
        id.map_or_else(|| Err(PyKeyError::new_err(format!("the world has no body `{name}`"))), |id| handle(slf, id))
    }

    /// Adds an instrument under a name.
    #[pyo3(signature = (instrument, name=None))]
    fn add_instrument(slf: &Bound<'_, Self>, instrument: &Bound<'_, PyAny>, name: Option<String>) -> PyResult<PyTool> {
        let id = {
            let (mut world, described) = (slf.try_borrow_mut()?, AnyInstrument::of(instrument)?);
            let id = described.add(&mut world.world)?;
            world.instruments.push((name.unwrap_or_else(|| format!("instrument-{}", id.0)), Some(described)));
            id
        };
        Ok(PyTool { world: slf.clone().unbind(), id })
    }

    /// Instruments by name.
    #[getter]
    fn instruments<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let instruments = PyDict::new(slf.py());
        let ids: Vec<InstrumentId> = in_world!(&slf.try_borrow()?.world, world => world.instrument_ids().collect());
        for id in ids {
            let name = slf.try_borrow()?.instruments[id.0].0.clone();
            instruments.set_item(name, PyTool { world: slf.clone().unbind(), id })?;
        }
        Ok(instruments)
    }

    /// Grows the nodes of a region of `body` to the surface of the body `to`, where both are now; best the finer one to the coarser.
    /// Explicit worlds only.
    fn attach(
        slf: &Bound<'_, Self>,
        body: &PySimulatedBody,
        region: &Bound<'_, PyAny>,
        to: &PySimulatedBody,
    ) -> PyResult<PyAttachment> {
        if !body.world.is(slf) || !to.world.is(slf) {
            return Err(PyValueError::new_err("both bodies must be bodies of this world"));
        }
        let attachment = Attachment { body: body.id, region: self::region(region)?, to: to.id };
        let mut world = Self::change(slf)?;
        let id = in_world!(&mut world.world, world => world.attach(attachment.clone())).or_raise()?;
        world.attachments.push(attachment);
        Ok(PyAttachment { world: slf.clone().unbind(), id })
    }

    /// Advances by one step; other threads run meanwhile. Raises `StepFailed` where that fails, and the world is as before.
    fn step(&mut self, py: Python<'_>) -> PyResult<PyStepReport> {
        self.views.none_alive()?;
        let Self { world, executor, .. } = self;
        let report = py.detach(|| in_world!(world, world => world.step_on(executor))).or_raise()?;
        if !self.live.is_empty() {
            self.refresh(py)?;
        }
        Ok(PyStepReport(report))
    }

    /// Advances by `count` steps in one go, and gives the report of the last; None for no step. Stops for Ctrl-C between two of
    /// them, and raises `StepFailed` after those that were made.
    fn steps(&mut self, py: Python<'_>, count: u64) -> PyResult<Option<PyStepReport>> {
        Ok(self.make_steps(py, count)?.map(PyStepReport))
    }

    /// Time [s].
    #[getter]
    fn time(&self) -> f64 {
        in_world!(&self.world, world => world.time())
    }

    /// Steps taken since the beginning.
    #[getter]
    fn step_count(&self) -> u64 {
        in_world!(&self.world, world => world.steps())
    }

    /// Time that one step advances [s].
    #[getter]
    fn step_length(&self) -> f64 {
        in_world!(&self.world, world => world.config().step)
    }

    /// Gravity [m/s²].
    #[getter]
    fn gravity(&self) -> [f64; 3] {
        in_world!(&self.world, world => world.config().gravity)
    }

    /// "single" or "double".
    #[getter]
    pub(crate) fn precision(&self) -> &'static str {
        match self.world {
            AnyWorld::Single(_) => "single",
            AnyWorld::Double(_) => "double",
        }
    }

    /// Copies the state.
    fn snapshot(&self, py: Python<'_>) -> PySnapshot {
        PySnapshot(py.detach(|| match &self.world {
            AnyWorld::Single(world) => AnySnapshot::Single(world.snapshot()),
            AnyWorld::Double(world) => AnySnapshot::Double(world.snapshot()),
        }))
    }

    /// Goes back to a snapshot of this world. Raises `WorldRefused` for one of a world with other bodies or instruments.
    fn restore(&mut self, py: Python<'_>, snapshot: &PySnapshot) -> PyResult<()> {
        self.views.none_alive()?;
        let world = &mut self.world;
        match (world, &snapshot.0) {
            (AnyWorld::Single(world), AnySnapshot::Single(snapshot)) => {
                py.detach(|| world.restore(snapshot)).or_raise()?
            }
            (AnyWorld::Double(world), AnySnapshot::Double(snapshot)) => {
                py.detach(|| world.restore(snapshot)).or_raise()?
            }
            _ => return Err(PyValueError::new_err("the snapshot is of a world in the other precision")),
        }
        self.refresh(py)
    }

    /// The snapshot that `Snapshot.to_bytes` made bytes of, for this world or one built from the same description.
    fn read_snapshot(&self, bytes: &[u8]) -> PyResult<PySnapshot> {
        Ok(PySnapshot(match &self.world {
            AnyWorld::Single(world) => AnySnapshot::Single(world.read_snapshot(bytes).or_raise()?),
            AnyWorld::Double(world) => AnySnapshot::Double(world.read_snapshot(bytes).or_raise()?),
        }))
    }

    /// How many arrays look into the engine's memory now (`SimulatedBody.view_positions`): the world stands still until there are none.
    #[getter]
    fn views(&self) -> usize {
        self.views.count()
    }

    /// The world as a scene file that lasts `duration` [s], for the command line and for `Scene.load`, that runs to the same bits: writes
    /// `name`.toml and a mesh file for each body into `folder`. Of a world that Python described, at its beginning. Raises ValueError for
    /// what a scene has no words for, such as another law or density in each cell, or tools that wait for a hand.
    #[pyo3(signature = (folder, *, duration, name="scene"))]
    fn write_scene(&self, folder: PathBuf, duration: f64, name: &str) -> PyResult<PathBuf> {
        let file = describe::scene(self, duration, &folder)?;
        let failed = |error: String| PyValueError::new_err(error);
        let file: SceneFile = serde_json::from_value(file).map_err(|error| failed(error.to_string()))?;
        let path = folder.join(format!("{name}.toml"));
        std::fs::write(&path, file.to_toml().map_err(|error| failed(error.to_string()))?)?;
        Ok(path)
    }

    fn __repr__(&self) -> String {
        let (bodies, time) = in_world!(&self.world, world => (world.body_ids().count(), world.time()));
        format!("<world of {bodies} bodies and {} instruments at {time} s>", self.instruments.len())
    }
}

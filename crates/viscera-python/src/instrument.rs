//! Instruments: what a user describes, and one in a world, along its path or led by a hand.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use viscera::curve::Curve;
use viscera::instrument::{Cautery, Grasper, Jaws, Mount, Path, Probe, Shaft, ToolInput, ToolPose, ToolState};
use viscera::world::InstrumentId;

use crate::error::OrRaise;
use crate::region::vector_curve;
use crate::report::PyInstrumentObservables;
use crate::world::{AnyWorld, PyWorld, in_world};

/// A place or a curve; the origin where none is given, for a tool that a hand leads.
fn path(given: Option<&Bound<'_, PyAny>>) -> PyResult<Path> {
    given.map_or_else(|| Ok(Curve::constant([0.0; 3].into())), vector_curve)
}

fn mount(direction: Option<&Bound<'_, PyAny>>, roll: f64, trocar: Option<[f64; 3]>) -> PyResult<Mount> {
    let direction = direction.map_or_else(|| Ok(Mount::default().direction), vector_curve)?;
    Ok(Mount { direction, roll, trocar: trocar.map(Into::into) })
}

/// (radius, length) [m].
fn shaft((radius, length): (f64, f64)) -> Shaft {
    Shaft { radius, length }
}

/// A round rod that pushes tissue and slides along it.
#[pyclass(frozen, name = "Probe", module = "viscera")]
pub(crate) struct PyProbe(Probe);

#[pymethods]
impl PyProbe {
    /// The `path` of its round tip's centre [m]: a place, a `Curve`, or points (time, place). `direction`: from handle to tip, along
    /// time; down by default. `roll` [rad]. `trocar`: a point [m] that the shaft always passes through. `shaft`: (radius,
    /// length) [m]. `friction`: its coefficient.
    #[new]
    #[pyo3(signature = (path=None, *, direction=None, roll=0.0, trocar=None, shaft=(2.5e-3, 0.3), friction=0.1))]
    fn new(
        path: Option<&Bound<'_, PyAny>>,
        direction: Option<&Bound<'_, PyAny>>,
        roll: f64,
        trocar: Option<[f64; 3]>,
        shaft: (f64, f64),
        friction: f64,
    ) -> PyResult<Self> {
        let (path, mount) = (self::path(path)?, self::mount(direction, roll, trocar)?);
        Ok(Self(Probe { path, mount, shaft: self::shaft(shaft), friction }))
    }
}

/// Jaws that hold what they close on.
#[pyclass(frozen, name = "Grasper", module = "viscera")]
pub(crate) struct PyGrasper(Grasper);

#[pymethods]
impl PyGrasper {
    /// The tip's `path` [m] as for `Probe`, the `radius` within which it holds nodes where it has no jaws [m], when the jaws `close` [s]
    /// (never by default: a hand closes them), and when they `open` again. `jaws`: (length, radius, opening) [m, m, rad], and `shaft`:
    /// (radius, length) [m], are what tissue touches; without them it touches nothing. Jaws hold what they sweep over when they close, and
    /// the cells that reach in between them. `grip`: force beyond which it slips [N].
    #[new]
    #[pyo3(signature = (path=None, *, radius=0.01, close=f64::INFINITY, open=None, direction=None, roll=0.0, trocar=None, jaws=None,
        shaft=None, friction=None, grip=f64::INFINITY))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        path: Option<&Bound<'_, PyAny>>,
        radius: f64,
        close: f64,
        open: Option<f64>,
        direction: Option<&Bound<'_, PyAny>>,
        roll: f64,
        trocar: Option<[f64; 3]>,
        jaws: Option<(f64, f64, f64)>,
        shaft: Option<(f64, f64)>,
        friction: Option<f64>,
        grip: f64,
    ) -> PyResult<Self> {
        let default = Grasper::default();
        Ok(Self(Grasper {
            path: self::path(path)?,
            mount: mount(direction, roll, trocar)?,
            radius,
            close,
            open,
            jaws: jaws.map(|(length, radius, opening)| Jaws { length, radius, opening }),
            shaft: shaft.map(self::shaft),
            friction: friction.unwrap_or(default.friction),
            grip,
        }))
    }
}

/// A hot hook that removes the tetrahedra that it touches.
#[pyclass(frozen, name = "Cautery", module = "viscera")]
pub(crate) struct PyCautery(Cautery);

#[pymethods]
impl PyCautery {
    /// The tip's `path` [m] as for `Probe`, how far it burns around (`radius` [m]), and when it is switched `on` and `off` [s] (never by
    /// default: a hand does). `power` [W]: infinite cuts at once, else tissue goes when it took `heat` [J/m³]. `shaft`: (radius,
    /// length) [m] that tissue touches.
    #[new]
    #[pyo3(signature = (path=None, *, radius=0.005, on=f64::INFINITY, off=f64::INFINITY, power=f64::INFINITY, heat=None,
        direction=None, roll=0.0, trocar=None, shaft=None, friction=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        path: Option<&Bound<'_, PyAny>>,
        radius: f64,
        on: f64,
        off: f64,
        power: f64,
        heat: Option<f64>,
        direction: Option<&Bound<'_, PyAny>>,
        roll: f64,
        trocar: Option<[f64; 3]>,
        shaft: Option<(f64, f64)>,
        friction: Option<f64>,
    ) -> PyResult<Self> {
        let default = Cautery::default();
        Ok(Self(Cautery {
            path: self::path(path)?,
            mount: mount(direction, roll, trocar)?,
            radius,
            on: if on.is_infinite() && off.is_infinite() { default.on } else { (on, off) },
            power,
            heat: heat.unwrap_or(default.heat),
            shaft: shaft.map(self::shaft),
            friction: friction.unwrap_or(default.friction),
        }))
    }
}

/// What was said about an instrument.
#[derive(Clone)]
pub(crate) enum AnyInstrument {
    Probe(Probe),
    Grasper(Grasper),
    Cautery(Cautery),
}

impl AnyInstrument {
    pub(crate) fn of(instrument: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(probe) = instrument.cast::<PyProbe>() {
            return Ok(Self::Probe(probe.get().0.clone()));
        }
        if let Ok(grasper) = instrument.cast::<PyGrasper>() {
            return Ok(Self::Grasper(grasper.get().0.clone()));
        }
        if let Ok(cautery) = instrument.cast::<PyCautery>() {
            return Ok(Self::Cautery(cautery.get().0.clone()));
        }
        Err(PyTypeError::new_err("an instrument is a Probe, a Grasper or a Cautery"))
    }

    fn mount_mut(&mut self) -> &mut Mount {
        match self {
            Self::Probe(probe) => &mut probe.mount,
            Self::Grasper(grasper) => &mut grasper.mount,
            Self::Cautery(cautery) => &mut cautery.mount,
        }
    }

    /// Adds it to a world.
    pub(crate) fn add(&self, world: &mut AnyWorld) -> PyResult<InstrumentId> {
        in_world!(world, world => match self.clone() {
            Self::Probe(probe) => world.add_instrument(probe),
            Self::Grasper(grasper) => world.add_instrument(grasper),
            Self::Cautery(cautery) => world.add_instrument(cautery),
        })
        .or_raise()
    }
}

/// A capsule: its two ends and its radius [m].
type Ends = ([f64; 3], [f64; 3], f64);

/// An instrument in a world.
#[pyclass(frozen, name = "Instrument", module = "viscera")]
pub(crate) struct PyTool {
    pub(crate) world: Py<PyWorld>,
    pub(crate) id: InstrumentId,
}

impl PyTool {
    fn state(&self, py: Python<'_>) -> PyResult<ToolState> {
        let world = self.world.try_borrow(py)?;
        let found = in_world!(&world.world, world => {
            world.instrument_ids().any(|id| id == self.id).then(|| *world.tool(self.id))
        });
        found.ok_or_else(|| PyValueError::new_err("the instrument was removed from its world"))
    }
}

#[pymethods]
impl PyTool {
    /// The name under which it was added.
    #[getter]
    fn name(&self, py: Python<'_>) -> PyResult<String> {
        Ok(self.world.try_borrow(py)?.instruments[self.id.0].0.clone())
    }

    /// "probe", "grasper", "cautery".
    #[getter]
    fn kind(&self, py: Python<'_>) -> PyResult<&'static str> {
        self.state(py)?;
        Ok(in_world!(&self.world.try_borrow(py)?.world, world => world.instrument(self.id).kind()))
    }

    /// Leads the tool by hand from now on, over its path: at the end of the next step its tip is at `tip` [m], pointing along
    /// `direction` (any length; down where none is given, and where it has a trocar that decides), turned by `roll` [rad], with the
    /// trigger from 0 (jaws open, current off) to 1. With a `speed` [m/s, > 0] it goes there no faster than that, in as many steps as it
    /// needs.
    #[pyo3(signature = (tip, *, direction=None, roll=0.0, trigger=0.0, speed=f64::INFINITY))]
    fn lead(
        &self,
        py: Python<'_>,
        tip: [f64; 3],
        direction: Option<[f64; 3]>,
        roll: f64,
        trigger: f64,
        speed: f64,
    ) -> PyResult<()> {
        let direction = direction.unwrap_or([0.0, -1.0, 0.0]).into();
        let pose = ToolPose { tip: tip.into(), direction, roll };
        let input = ToolInput { speed, ..ToolInput::new(pose, trigger) };
        in_world!(&mut self.world.try_borrow_mut(py)?.world, world => world.set_tool(self.id, input)).or_raise()
    }

    /// Lets it follow its path again.
    fn release(&self, py: Python<'_>) -> PyResult<()> {
        in_world!(&mut self.world.try_borrow_mut(py)?.world, world => world.release_tool(self.id)).or_raise()
    }

    /// The point that its shaft passes through [m], or None. Set, the shaft is led through it from the next step on, or let go; the tip
    /// stays where it is led.
    #[getter]
    fn trocar(&self, py: Python<'_>) -> PyResult<Option<[f64; 3]>> {
        Ok(self.state(py)?.trocar.map(|point| point.to_array()))
    }

    #[setter]
    fn set_trocar(&self, py: Python<'_>, trocar: Option<[f64; 3]>) -> PyResult<()> {
        let (mut world, trocar) = (self.world.try_borrow_mut(py)?, trocar.map(Into::into));
        in_world!(&mut world.world, world => world.set_trocar(self.id, trocar)).or_raise()?;
        // What is said about it, a scene says.
        if let Some(described) = &mut world.instruments[self.id.0].1 {
            described.mount_mut().trocar = trocar;
        }
        Ok(())
    }

    /// Takes it out of the world; it lets go of what it holds.
    fn remove(&self, py: Python<'_>) -> PyResult<()> {
        in_world!(&mut PyWorld::change(self.world.bind(py))?.world, world => world.remove_instrument(self.id))
            .or_raise()
    }

    /// Where its tip is [m].
    #[getter]
    fn tip(&self, py: Python<'_>) -> PyResult<[f64; 3]> {
        Ok(self.state(py)?.pose.tip.to_array())
    }

    /// Where it points, from handle to tip; of length 1.
    #[getter]
    fn direction(&self, py: Python<'_>) -> PyResult<[f64; 3]> {
        Ok(self.state(py)?.pose.direction.to_array())
    }

    /// How far it is turned about its direction [rad].
    #[getter]
    fn roll(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.pose.roll)
    }

    /// From 0 (jaws open, current off) to 1.
    #[getter]
    fn trigger(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.trigger)
    }

    /// Whether its jaws are closed, or its current is on.
    #[getter]
    fn is_closed(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.state(py)?.is_closed)
    }

    /// Nodes that it holds.
    #[getter]
    fn held_nodes(&self, py: Python<'_>) -> PyResult<u32> {
        Ok(self.state(py)?.held_nodes)
    }

    /// Points that touched at the end of the last step.
    #[getter]
    fn contacts(&self, py: Python<'_>) -> PyResult<u32> {
        Ok(self.state(py)?.contacts)
    }

    /// Force of the tool on the tissue, by contact and by what it holds: the mean over the last step [N]. A hand feels the opposite.
    #[getter]
    fn force(&self, py: Python<'_>) -> PyResult<[f64; 3]> {
        Ok(self.state(py)?.force().to_array())
    }

    /// Moment of that force about the tip [N m].
    #[getter]
    fn torque(&self, py: Python<'_>) -> PyResult<[f64; 3]> {
        Ok(self.state(py)?.torque().to_array())
    }

    /// Its rigid parts now: (from, to, radius) of each capsule [m].
    #[getter]
    fn capsules(&self, py: Python<'_>) -> PyResult<Vec<Ends>> {
        self.state(py)?;
        let capsules = in_world!(&self.world.try_borrow(py)?.world, world => world.tool_capsules(self.id).to_vec());
        Ok(capsules.into_iter().map(|part| (part.from.to_array(), part.to.to_array(), part.radius)).collect())
    }

    /// Measures the instrument now.
    fn observe(&self, py: Python<'_>) -> PyResult<PyInstrumentObservables> {
        self.state(py)?;
        let mut world = self.world.try_borrow_mut(py)?;
        Ok(PyInstrumentObservables(in_world!(&mut world.world, world => world.observe_instrument(self.id))))
    }

    /// The world.
    #[getter]
    fn world(&self, py: Python<'_>) -> Py<PyWorld> {
        self.world.clone_ref(py)
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyProbe>()?;
    module.add_class::<PyGrasper>()?;
    module.add_class::<PyCautery>()?;
    module.add_class::<PyTool>()
}

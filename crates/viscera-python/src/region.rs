//! Parts of a mesh, curves in time, and loads: what a body is held, moved and pulled by.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use viscera::body::{Actuator, ActuatorLine, Load, Muscle};
use viscera::curve::{Curve, CurveValue};
use viscera::math::Vec3;
use viscera::mesh::{Point, Region};

use crate::error::OrRaise;

/// A part of a mesh, named by what a user sees. Tests are on the rest shape. `|` joins regions, `&` intersects them.
#[pyclass(frozen, name = "Region", module = "viscera")]
pub(crate) struct PyRegion(pub(crate) Region);

/// A region, or the name of one: a group of the mesh, "all" or "surface".
pub(crate) fn region(given: &Bound<'_, PyAny>) -> PyResult<Region> {
    if let Ok(region) = given.cast::<PyRegion>() {
        return Ok(region.get().0.clone());
    }
    let name: String = given
        .extract()
        .map_err(|_| PyTypeError::new_err("a region is a Region, or the name of a group of the mesh"))?;
    Ok(match name.as_str() {
        "all" => Region::All,
        "surface" => Region::Surface,
        _ => Region::Named(name),
    })
}

#[pymethods]
impl PyRegion {
    /// Every node.
    #[staticmethod]
    fn all() -> Self {
        Self(Region::All)
    }

    /// Nodes of the outward surface.
    #[staticmethod]
    fn surface() -> Self {
        Self(Region::Surface)
    }

    /// A named region of the mesh.
    #[staticmethod]
    fn named(name: String) -> Self {
        Self(Region::Named(name))
    }

    /// Nodes by number, from 0.
    #[staticmethod]
    fn nodes(numbers: Vec<u32>) -> Self {
        Self(Region::Nodes(numbers))
    }

    /// The one node closest to a place [m].
    #[staticmethod]
    fn nearest(place: [f64; 3]) -> Self {
        Self(Region::nearest(place))
    }

    /// Nodes in a box with sides along the axes, borders included [m].
    #[staticmethod]
    fn cuboid(low: [f64; 3], high: [f64; 3]) -> Self {
        Self(Region::cuboid(low, high))
    }

    /// Nodes in a ball, border included [m].
    #[staticmethod]
    fn sphere(centre: [f64; 3], radius: f64) -> Self {
        Self(Region::sphere(centre, radius))
    }

    /// Nodes in a slab around a plane [m]; `thickness` 0 takes a millionth of the size of the mesh.
    #[staticmethod]
    #[pyo3(signature = (point, normal, thickness=0.0))]
    fn plane(point: [f64; 3], normal: [f64; 3], thickness: f64) -> Self {
        Self(Region::plane(point, normal, thickness))
    }

    /// Nodes on the side of a plane that its normal points to, border included [m].
    #[staticmethod]
    fn half_space(point: [f64; 3], normal: [f64; 3]) -> Self {
        Self(Region::HalfSpace { point: Point::from(point), normal: Point::from(normal) })
    }

    fn __or__(&self, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Region::Union(vec![self.0.clone(), region(other)?])))
    }

    fn __ror__(&self, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Region::Union(vec![region(other)?, self.0.clone()])))
    }

    fn __rand__(&self, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Region::Intersection(vec![region(other)?, self.0.clone()])))
    }

    fn __and__(&self, other: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Region::Intersection(vec![self.0.clone(), region(other)?])))
    }

    fn __repr__(&self) -> String {
        format!("<region {}>", self.0.describe())
    }
}

/// A value in time given at moments [s]; straight lines between them, held before the first and after the last. Values are numbers
/// or vectors of three.
#[pyclass(frozen, name = "Curve", module = "viscera")]
pub(crate) struct PyCurve(AnyCurve);

#[derive(Clone)]
enum AnyCurve {
    Number(Curve<f64>),
    Vector(Curve<Vec3<f64>>),
}

#[pymethods]
impl PyCurve {
    /// From points (time [s], value), times ascending.
    #[new]
    fn new(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(points) = points.extract::<Vec<(f64, f64)>>() {
            return Curve::piecewise_linear(points).or_raise().map(|curve| Self(AnyCurve::Number(curve)));
        }
        vector_points(points).map(|curve| Self(AnyCurve::Vector(curve)))
    }

    /// The value at `time` [s].
    fn at<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Bound<'py, PyAny>> {
        match &self.0 {
            AnyCurve::Number(curve) => Ok(curve.at(time).into_pyobject(py)?.into_any()),
            AnyCurve::Vector(curve) => Ok(curve.at(time).to_array().into_pyobject(py)?.into_any()),
        }
    }
}

fn vector_points(points: &Bound<'_, PyAny>) -> PyResult<Curve<Vec3<f64>>> {
    let points: Vec<(f64, [f64; 3])> = points.extract()?;
    Curve::piecewise_linear(points.into_iter().map(|(time, value)| (time, value.into())).collect()).or_raise()
}

fn finite<V: CurveValue>(value: V) -> PyResult<Curve<V>> {
    Curve::piecewise_linear(vec![(0.0, value)]).or_raise()
}

/// A number, a `Curve`, or points (time [s], number).
pub(crate) fn number_curve(given: &Bound<'_, PyAny>) -> PyResult<Curve<f64>> {
    match given.cast::<PyCurve>().map(|curve| &curve.get().0) {
        Ok(AnyCurve::Number(curve)) => return Ok(curve.clone()),
        Ok(AnyCurve::Vector(_)) => {
            return Err(PyTypeError::new_err("a curve of numbers is needed, and this is one of vectors"));
        }
        Err(_) => {}
    }
    match given.extract::<f64>() {
        Ok(value) => finite(value),
        Err(_) => Curve::piecewise_linear(given.extract::<Vec<(f64, f64)>>()?).or_raise(),
    }
}

/// A vector, a `Curve`, or points (time [s], vector).
pub(crate) fn vector_curve(given: &Bound<'_, PyAny>) -> PyResult<Curve<Vec3<f64>>> {
    match given.cast::<PyCurve>().map(|curve| &curve.get().0) {
        Ok(AnyCurve::Vector(curve)) => return Ok(curve.clone()),
        Ok(AnyCurve::Number(_)) => {
            return Err(PyTypeError::new_err("a curve of vectors is needed, and this is one of numbers"));
        }
        Err(_) => {}
    }
    match given.extract::<[f64; 3]>() {
        Ok(value) => finite(value.into()),
        Err(_) => vector_points(given),
    }
}

/// What pulls or presses on a body. Sizes are constant, or a `Curve` or list of points (time [s], value).
#[pyclass(frozen, name = "Load", module = "viscera")]
pub(crate) struct PyLoad(pub(crate) Load);

#[pymethods]
impl PyLoad {
    /// A force on a region [N], shared equally by its nodes.
    #[staticmethod]
    fn force(region: &Bound<'_, PyAny>, total: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Load::Force { region: self::region(region)?, total: vector_curve(total)? }))
    }

    /// A pressure on a part of the surface [Pa], positive inwards; it follows the surface.
    #[staticmethod]
    fn pressure(region: &Bound<'_, PyAny>, pressure: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Load::Pressure { region: self::region(region)?, pressure: number_curve(pressure)? }))
    }

    /// A force per rest area on a part of the surface [Pa], in a direction that stays.
    #[staticmethod]
    fn traction(region: &Bound<'_, PyAny>, traction: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Load::Traction { region: self::region(region)?, traction: vector_curve(traction)? }))
    }

    /// A field of one direction: force per rest volume of the cells in a region [N/m³].
    #[staticmethod]
    fn body_force(region: &Bound<'_, PyAny>, per_volume: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(Load::BodyForce { region: self::region(region)?, per_volume: vector_curve(per_volume)? }))
    }

    /// A field towards a place [m], that of a ball that attracts: `per_volume` [N/m³] at its `radius` [m], falling by the square of the
    /// distance outside and in proportion to it inside.
    #[staticmethod]
    #[pyo3(signature = (region, *, centre, radius, per_volume))]
    fn attraction(
        region: &Bound<'_, PyAny>,
        centre: [f64; 3],
        radius: f64,
        per_volume: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let per_volume = number_curve(per_volume)?;
        Ok(Self(Load::Attraction { region: self::region(region)?, centre, radius, per_volume }))
    }
}

/// A linear actuator: it pulls along a line with stiffness × (length now − `length` × length at rest) + tension. For every integrator.
#[pyclass(frozen, name = "Actuator", module = "viscera")]
pub(crate) struct PyActuator(pub(crate) Actuator);

fn curve_or(given: Option<&Bound<'_, PyAny>>, value: f64) -> PyResult<Curve<f64>> {
    given.map_or(Ok(Curve::constant(value)), number_curve)
}

#[pymethods]
impl PyActuator {
    /// Between the mean places of two regions, which share its pull. `stiffness` [N/m, ≥ 0]; `length`: the length at which it is slack,
    /// over that at rest; `force`: what it pulls with besides [N]. Both are numbers, `Curve`s or points (time [s], value).
    #[staticmethod]
    #[pyo3(signature = (start, end, *, stiffness=0.0, length=None, force=None))]
    fn between(
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        stiffness: f64,
        length: Option<&Bound<'_, PyAny>>,
        force: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let line = ActuatorLine::Between { from: region(start)?, to: region(end)? };
        Ok(Self(Actuator { line, stiffness, length: curve_or(length, 1.0)?, tension: curve_or(force, 0.0)? }))
    }

    /// In every cell of a region, along a direction at rest that goes with the tissue. `young`: Young's modulus along it [Pa, ≥ 0];
    /// `length`: the stretch at which it is slack; `stress`: what it pulls with besides [Pa of rest area].
    #[staticmethod]
    #[pyo3(signature = (region, direction, *, young=0.0, length=None, stress=None))]
    fn along(
        region: &Bound<'_, PyAny>,
        direction: [f64; 3],
        young: f64,
        length: Option<&Bound<'_, PyAny>>,
        stress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let line = ActuatorLine::Along { region: self::region(region)?, direction };
        let (length, tension) = (curve_or(length, 1.0)?, curve_or(stress, 0.0)?);
        Ok(Self(Actuator { line, stiffness: young, length, tension }))
    }

    fn __repr__(&self) -> String {
        match &self.0.line {
            ActuatorLine::Between { from, to } => {
                format!("<actuator from {} to {}: {:?} N/m>", from.describe(), to.describe(), self.0.stiffness)
            }
            ActuatorLine::Along { region, direction } => {
                format!("<actuators in {} along {direction:?}: {:?} Pa>", region.describe(), self.0.stiffness)
            }
        }
    }
}

/// A membrane of muscle in a body or on it: all faces of the mesh whose nodes lie in the region, whose edges shorten as it is activated.
/// Explicit steps only.
#[pyclass(frozen, name = "Muscle", module = "viscera")]
pub(crate) struct PyMuscle(pub(crate) Muscle);

#[pymethods]
impl PyMuscle {
    /// `stiffness`: Young's modulus times thickness [N/m, > 0]. `contraction`: the share of their length by which the edges shorten at
    /// full activation [≥ 0, < 1]. `activation`: from 0 to 1, a number, a `Curve` or points (time [s], activation).
    #[new]
    #[pyo3(signature = (region, *, stiffness, contraction, activation))]
    fn new(
        region: &Bound<'_, PyAny>,
        stiffness: f64,
        contraction: f64,
        activation: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let region = self::region(region)?;
        Ok(Self(Muscle { region, stiffness, contraction, activation: number_curve(activation)? }))
    }

    fn __repr__(&self) -> String {
        let Muscle { region, stiffness, contraction, .. } = &self.0;
        format!("<muscle of {}: {stiffness:?} N/m, contracts by {contraction:?}>", region.describe())
    }
}

//! Laws, with their parameters, and what they make of a deformation.

use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use viscera::material::{LawFamily, LawKind, LawVisitor, MaterialError, RestStiffness, Tissue, TissuePreset};
use viscera::math::Mat3;

use crate::arrays::{Numbers, list_array, matrices, matrix_array};
use crate::error::OrRaise;

/// Isotropic stiffness: the two Lamé parameters [Pa].
#[pyclass(frozen, from_py_object, module = "viscera")]
#[derive(Clone, Copy)]
pub(crate) struct Lame(viscera::material::Lame);

#[pymethods]
impl Lame {
    /// From λ [Pa, > −2μ/3] and μ [Pa, > 0].
    #[new]
    fn new(lambda_: f64, mu: f64) -> PyResult<Self> {
        viscera::material::Lame::new(lambda_, mu).or_raise().map(Self)
    }

    /// From Young's modulus [Pa, > 0] and Poisson's ratio [above −1, below 0.5].
    #[staticmethod]
    fn from_young_poisson(young: f64, poisson: f64) -> PyResult<Self> {
        viscera::material::Lame::from_young_poisson(young, poisson).or_raise().map(Self)
    }

    /// First Lamé parameter λ [Pa].
    #[getter]
    fn lambda_(&self) -> f64 {
        self.0.lambda
    }

    /// Shear modulus μ [Pa].
    #[getter]
    fn mu(&self) -> f64 {
        self.0.mu
    }

    /// Young's modulus [Pa].
    #[getter]
    fn young(&self) -> f64 {
        self.0.young()
    }

    /// Poisson's ratio.
    #[getter]
    fn poisson(&self) -> f64 {
        self.0.poisson()
    }

    fn __repr__(&self) -> String {
        format!("Lame(lambda_={:?}, mu={:?})", self.0.lambda, self.0.mu)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, pyo3::types::PyType>, (f64, f64)) {
        (slf.get_type(), (slf.get().0.lambda, slf.get().0.mu))
    }
}

/// A law with its parameters: how tissue stores energy when it is deformed. Made by its subclasses.
#[pyclass(frozen, subclass, module = "viscera")]
pub(crate) struct Law {
    pub(crate) kind: LawKind,
    pub(crate) values: Vec<f64>,
}

/// What is evaluated at a deformation gradient.
enum Question {
    Energy,
    Stress,
    Tangent,
}

struct Answer<'a> {
    values: &'a [f64],
    question: Question,
    gradient: Mat3<f64>,
    direction: Mat3<f64>,
}

impl LawVisitor for Answer<'_> {
    type Output = Mat3<f64>;

    fn visit<L: LawFamily>(self) -> Mat3<f64> {
        let law = L::from_values(self.values);
        match self.question {
            Question::Energy => Mat3::diagonal(law.energy(&self.gradient)),
            Question::Stress => law.stress(&self.gradient),
            Question::Tangent => law.tangent(&self.gradient, &self.direction),
        }
    }
}

struct Parameters;
impl LawVisitor for Parameters {
    type Output = &'static [viscera::material::Parameter];
    fn visit<L: LawFamily>(self) -> Self::Output {
        L::PARAMETERS
    }
}

struct AtRest<'a>(&'a [f64]);
impl LawVisitor for AtRest<'_> {
    type Output = RestStiffness;
    fn visit<L: LawFamily>(self) -> RestStiffness {
        L::from_values(self.0).at_rest()
    }
}

struct Example;
impl LawVisitor for Example {
    type Output = Law;
    fn visit<L: LawFamily>(self) -> Law {
        Law::of(L::example())
    }
}

struct UniformTissue<'a>(&'a [f64]);
impl LawVisitor for UniformTissue<'_> {
    type Output = Tissue;
    fn visit<L: LawFamily>(self) -> Tissue {
        Tissue::uniform(L::from_values(self.0))
    }
}

impl Law {
    pub(crate) fn of(law: impl LawFamily) -> Self {
        Self { values: law.values(), kind: law.into() }
    }

    pub(crate) fn tissue(&self) -> Tissue {
        self.kind.visit(UniformTissue(&self.values))
    }

    fn at(&self, question: Question, gradient: Mat3<f64>, direction: Mat3<f64>) -> Mat3<f64> {
        self.kind.visit(Answer { values: &self.values, question, gradient, direction })
    }
}

/// The names of a law's parameters, as scenes have them.
pub(crate) fn parameter_names(kind: LawKind) -> Vec<&'static str> {
    kind.visit(Parameters).iter().map(|parameter| parameter.name).collect()
}

#[pymethods]
impl Law {
    /// The law's name in scenes and messages.
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    /// Parameter values by name, SI.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for (name, value) in parameter_names(self.kind).into_iter().zip(&self.values) {
            parameters.set_item(name, value)?;
        }
        Ok(parameters)
    }

    /// A soft tissue of the law of this name, E = 5 kPa and ν = 0.4: what a menu offers first.
    #[staticmethod]
    fn example(kind: &str) -> PyResult<Self> {
        let known = LawKind::ALL.iter().find(|law| law.name() == kind);
        let names = || LawKind::ALL.iter().map(|law| law.name()).collect::<Vec<_>>().join(", ");
        known
            .map(|law| law.visit(Example))
            .ok_or_else(|| pyo3::exceptions::PyValueError::new_err(format!("no law `{kind}`: there are {}", names())))
    }

    /// Energy density ψ(F) [J/m³] at deformation gradients of shape (3, 3) or (n, 3, 3); shape (n,).
    fn energy<'py>(&self, py: Python<'py>, gradient: Numbers<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let energy = |f| self.at(Question::Energy, f, f).columns[0].x;
        Ok(list_array(py, matrices(&gradient, "gradient")?.into_iter().map(energy).collect()))
    }

    /// First Piola–Kirchhoff stress P = ∂ψ/∂F [Pa]; shape (n, 3, 3).
    fn stress<'py>(&self, py: Python<'py>, gradient: Numbers<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let stress = |f| self.at(Question::Stress, f, f);
        Ok(matrix_array(py, &matrices(&gradient, "gradient")?.into_iter().map(stress).collect::<Vec<_>>()))
    }

    /// Derivative of the stress along `direction` [Pa]; shape (n, 3, 3).
    fn tangent<'py>(
        &self,
        py: Python<'py>,
        gradient: Numbers<'py>,
        direction: Numbers<'py>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (gradients, directions) = (matrices(&gradient, "gradient")?, matrices(&direction, "direction")?);
        if gradients.len() != directions.len() {
            let message = "gradient and direction must have the same shape";
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let along = gradients.into_iter().zip(directions).map(|(f, df)| self.at(Question::Tangent, f, df));
        Ok(matrix_array(py, &along.collect::<Vec<_>>()))
    }

    fn __repr__(&self) -> String {
        let values = parameter_names(self.kind).into_iter().zip(&self.values);
        let list: Vec<_> = values.map(|(name, value)| format!("{name} = {value:?}")).collect();
        format!("<{}: {}>", self.kind.name(), list.join(", "))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().kind == self.kind && other.get().values == self.values)
    }
}

/// A class for a law of λ and μ alone.
macro_rules! isotropic {
    ($($law:ident, $doc:literal;)+) => { $(
        #[doc = $doc]
        #[pyclass(frozen, extends = Law, module = "viscera")]
        pub(crate) struct $law;

        #[pymethods]
        impl $law {
            /// From the Lamé parameters of small strains.
            #[new]
            fn new(lame: Lame) -> PyClassInitializer<Self> {
                PyClassInitializer::from(Law::of(viscera::material::$law::new(lame.0))).add_subclass(Self)
            }

            /// From Young's modulus [Pa, > 0] and Poisson's ratio [above −1, below 0.5] of small strains.
            #[staticmethod]
            fn from_young_poisson(py: Python<'_>, young: f64, poisson: f64) -> PyResult<Py<Self>> {
                let lame = Lame::from_young_poisson(young, poisson)?;
                Py::new(py, Self::new(lame))
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, pyo3::types::PyType>, (Lame,))> {
                let values = &slf.as_super().get().values;
                Ok((slf.get_type(), (Lame(viscera::material::Lame { lambda: values[0], mu: values[1] }),)))
            }
        }
    )+ };
}

isotropic! {
    LinearElastic, "Linear elasticity: for displacements that are small against the body.";
    StVenantKirchhoff, "St Venant–Kirchhoff: right under large rotations, for moderate strain.";
    NeoHookean, "Neo-Hookean, shape and volume apart: for large strain, and for nearly incompressible tissue.";
    StableNeoHookean, "Stable neo-Hookean: bears any strain, and turns back when it is inverted.";
}

/// A class for a law with fibres.
macro_rules! fibred {
    ($($law:ident, $doc:literal;)+) => { $(
        #[doc = $doc]
        #[pyclass(frozen, extends = Law, module = "viscera")]
        pub(crate) struct $law;

        #[pymethods]
        impl $law {
            /// A matrix with the Lamé parameters `transverse`, and fibres along `direction` (any length) with `longitudinal`
            /// ones.
            #[new]
            fn new(transverse: Lame, direction: [f64; 3], longitudinal: Lame) -> PyResult<PyClassInitializer<Self>> {
                let law = viscera::material::$law::new(transverse.0, direction, longitudinal.0).or_raise()?;
                Ok(PyClassInitializer::from(Law::of(law)).add_subclass(Self))
            }
        }
    )+ };
}

fibred! {
    TransverseLinear, "Linear elasticity, stiffer (or softer) along one direction.";
    TransverseStVenantKirchhoff, "St Venant–Kirchhoff, stiffer (or softer) along one direction.";
}

/// Every tissue that scenes can name, with its numbers and their sources, as JSON in SI; for one with fibres λ and μ of the matrix
/// between them, and how many times larger these are along them.
#[pyfunction]
pub(crate) fn tissue_presets() -> PyResult<String> {
    let entries = TissuePreset::ALL.iter().map(|preset| {
        let fibred = preset.matrix_and_factor().or_raise()?;
        let mut entry = serde_json::to_value(preset).map_err(|error| PyValueError::new_err(error.to_string()))?;
        entry["fibred"] = fibred.map(|(matrix, factor)| vec![matrix.lambda, matrix.mu, factor]).into();
        Ok(entry)
    });
    Ok(serde_json::Value::Array(entries.collect::<PyResult<_>>()?).to_string())
}

/// A law, the same in every cell or one for each.
#[pyclass(frozen, name = "Tissue", module = "viscera")]
pub(crate) struct PyTissue(pub(crate) Tissue);

struct PerCell<'a>(&'a [Vec<f64>]);
impl LawVisitor for PerCell<'_> {
    type Output = Result<Tissue, viscera::material::MaterialError>;
    fn visit<L: LawFamily>(self) -> Self::Output {
        Tissue::per_cell(&self.0.iter().map(|values| L::from_values(values)).collect::<Vec<_>>())
    }
}

#[pymethods]
impl PyTissue {
    /// The same law in every cell.
    #[staticmethod]
    fn uniform(law: PyRef<'_, Law>) -> Self {
        Self(law.tissue())
    }

    /// One law for each cell, all of one kind, in the order of the mesh's cells.
    #[staticmethod]
    fn per_cell(laws: Vec<PyRef<'_, Law>>) -> PyResult<Self> {
        let kind = laws.first().map_or(LawKind::LinearElastic, |law| law.kind);
        if let Some(other) = laws.iter().find(|law| law.kind != kind) {
            let message = format!("the laws of a body are of one kind, and here are `{kind}` and `{}`", other.kind);
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let values: Vec<_> = laws.iter().map(|law| law.values.clone()).collect();
        kind.visit(PerCell(&values)).or_raise().map(Self)
    }

    /// One law for each cell, by its parameters: the law's name, and an array of shape (cells, parameters) in the order of
    /// `Law.parameters`. Raises ValueError for the first cell whose values no tissue has.
    #[staticmethod]
    fn from_values(kind: &str, values: Numbers<'_>) -> PyResult<Self> {
        let law = Law::example(kind)?.kind;
        let view = values.as_array();
        let names = parameter_names(law);
        if view.ndim() != 2 || view.shape()[1] != names.len() {
            let message = format!("values must have shape (cells, {}): {}", names.len(), names.join(", "));
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let rows: Vec<Vec<f64>> = view.outer_iter().map(|row| row.iter().copied().collect()).collect();
        for (cell, row) in rows.iter().enumerate() {
            check(law, row).map_err(|reason| PyValueError::new_err(format!("values of cell {cell}: {reason}")))?;
        }
        law.visit(PerCell(&rows)).or_raise().map(Self)
    }

    /// The law's name in scenes and messages.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind().name()
    }

    /// Whether every cell has the same parameters.
    #[getter]
    fn is_uniform(&self) -> bool {
        self.0.is_uniform()
    }

    /// Parameter values of the law in a cell, in the order of `Law.parameters`; the same for every cell where the tissue is uniform.
    /// Raises IndexError for a cell that has no law.
    fn values<'py>(&self, py: Python<'py>, cell: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        // Tissues tell their number of laws by refusing meshes of another one.
        if self.0.is_uniform() {
            return Ok(list_array(py, self.0.values(0).to_vec()));
        }
        match self.0.check_count(usize::MAX) {
            Err(MaterialError::WrongCount { given, .. }) if cell >= given => {
                let last = given - 1;
                Err(PyIndexError::new_err(format!("there is no law for cell {cell}: they are numbered 0 to {last}")))
            }
            _ => Ok(list_array(py, self.0.values(cell).to_vec())),
        }
    }
}

/// Refuses what the constructors of laws refuse: parameters with which tissue would bear some load without resistance.
fn check(law: LawKind, values: &[f64]) -> Result<(), String> {
    for (parameter, value) in law.visit(Parameters).iter().zip(values) {
        if !value.is_finite() {
            return Err(format!("{} = {value} is no finite number", parameter.name));
        }
    }
    let rest = law.visit(AtRest(values));
    let lame = viscera::material::Lame::new(rest.lame.lambda, rest.lame.mu).map_err(|error| error.to_string())?;
    let length = rest.direction.norm();
    if (length - 1.0).abs() > 1e-6 {
        return Err(format!("the fibre direction has the length {length}: divide its components by it"));
    }
    if lame.young() + 2.0 * rest.fibre_stiffness <= 0.0 {
        return Err(format!(
            "fibre-stiffness = {} is out of range: it must be above -E/2 = {} Pa; make the fibres stiffer or the matrix softer",
            rest.fibre_stiffness,
            -0.5 * lame.young()
        ));
    }
    Ok(())
}

/// A tissue, or a law that holds everywhere.
pub(crate) fn tissue(given: &Bound<'_, PyAny>) -> PyResult<Tissue> {
    match given.cast::<PyTissue>() {
        Ok(tissue) => Ok(tissue.get().0.clone()),
        Err(_) => Ok(given.cast::<Law>()?.get().tissue()),
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Lame>()?;
    module.add_class::<Law>()?;
    module.add_class::<LinearElastic>()?;
    module.add_class::<StVenantKirchhoff>()?;
    module.add_class::<NeoHookean>()?;
    module.add_class::<StableNeoHookean>()?;
    module.add_class::<TransverseLinear>()?;
    module.add_class::<TransverseStVenantKirchhoff>()?;
    module.add_function(wrap_pyfunction!(tissue_presets, module)?)?;
    module.add_class::<PyTissue>()
}

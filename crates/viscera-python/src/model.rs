//! Force models: what a user chooses, and one alone, at positions of the caller's.

use std::sync::Arc;

use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::math::{Mat3, Scalar, Vec3};
use viscera::mesh::{GaussRule, Region, VolumeMesh};
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement, Tangent};
use viscera::model::{BlockSink, ForceModel, ModelRecipe, Precision, Scratch};

use crate::arrays::{Numbers, NumpyScalar, list_array, matrix_array, vector_array, vectors_of};
use crate::error::OrRaise;
use crate::law::tissue;
use crate::mesh::PyVolumeMesh;
use crate::region::PyRegion;

/// How a law and a mesh become forces. Made by its subclasses, which are named as in the engine.
#[pyclass(frozen, subclass, name = "Model", module = "viscera")]
pub(crate) struct PyModel(pub(crate) AnyModel);

/// A recipe of the engine, with its own settings.
#[derive(Clone, Debug)]
pub(crate) enum AnyModel {
    LinearTensorMass(viscera::model::LinearTensorMass),
    TensorMass(viscera::model::TensorMass, Option<f64>),
    /// With whether it is the one that a scene names.
    TotalLagrangian(viscera::model::TotalLagrangian, bool),
    NodallyIntegrated(viscera::model::NodallyIntegrated, Option<f64>),
    Corotational(viscera::model::Corotational, [Option<String>; 4]),
    StiffnessWarping(viscera::model::StiffnessWarping),
    MassSpring(viscera::model::MassSpring),
    ShapeMemory(viscera::model::ShapeMemory),
    Precomputed(viscera::model::Precomputed),
    Hybrid(viscera::model::Hybrid, Option<Region>),
}

impl AnyModel {
    pub(crate) fn recipe(&self) -> Box<dyn ModelRecipe> {
        match self.clone() {
            Self::LinearTensorMass(recipe) => Box::new(recipe),
            Self::TensorMass(recipe, _) => Box::new(recipe),
            Self::TotalLagrangian(recipe, _) => Box::new(recipe),
            Self::NodallyIntegrated(recipe, _) => Box::new(recipe),
            Self::Corotational(recipe, _) => Box::new(recipe),
            Self::StiffnessWarping(recipe) => Box::new(recipe),
            Self::MassSpring(recipe) => Box::new(recipe),
            Self::ShapeMemory(recipe) => Box::new(recipe),
            Self::Precomputed(recipe) => Box::new(recipe),
            Self::Hybrid(recipe, _) => Box::new(recipe),
        }
    }
}

#[pymethods]
impl PyModel {
    /// The model's name in scenes and messages.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.recipe().kind().info().name
    }

    /// What it is good for, in a sentence.
    #[getter]
    fn purpose(&self) -> &'static str {
        self.0.recipe().kind().info().purpose
    }

    /// The law's name.
    #[getter]
    fn law(&self) -> &'static str {
        self.0.recipe().tissue().kind().name()
    }

    fn __repr__(&self) -> String {
        format!("<model {} of {}>", self.kind(), self.law())
    }
}

/// A model class that takes a tissue and nothing else.
macro_rules! plain_model {
    ($($model:ident, $doc:literal;)+) => { $(
        #[doc = $doc]
        #[pyclass(frozen, extends = PyModel, module = "viscera")]
        pub(crate) struct $model;

        #[pymethods]
        impl $model {
            /// A model of `tissue`: a `Tissue`, or a law that holds everywhere.
            #[new]
            fn new(tissue: &Bound<'_, PyAny>) -> PyResult<PyClassInitializer<Self>> {
                let recipe = viscera::model::$model::new(self::tissue(tissue)?);
                Ok(PyClassInitializer::from(PyModel(AnyModel::$model(recipe))).add_subclass(Self))
            }
        }
    )+ };
}

plain_model! {
    LinearTensorMass, "Precomputed tensors of the linear law; tetrahedra.";
    Precomputed, "Responses of the linear law found beforehand (Cotin et al. 1999); rests at every step and cannot be cut.";
    StiffnessWarping, "The linear law turned at each node (Müller et al. 2002); tetrahedra. For comparison: its forces do not balance.";
    MassSpring, "Springs along the edges of the cells (van Gelder 1998). For comparison: Poisson's ratio is 1/4, and what is folded stays folded.";
    ShapeMemory, "Nodes that return to their place among their neighbours (Promayon et al. 1996); no law of matter.";
}

/// One region moves and can be cut, the rest follows by the law at rest, pre-computed (Cotin et al. 2000); every law.
#[pyclass(frozen, extends = PyModel, module = "viscera")]
pub(crate) struct Hybrid;

#[pymethods]
impl Hybrid {
    /// A model of `tissue`; every cell with a corner in the region `dynamic` moves, or all of it.
    #[new]
    #[pyo3(signature = (tissue, *, dynamic=None))]
    fn new(tissue: &Bound<'_, PyAny>, dynamic: Option<&Bound<'_, PyRegion>>) -> PyResult<PyClassInitializer<Self>> {
        let recipe = viscera::model::Hybrid::new(self::tissue(tissue)?);
        let dynamic = dynamic.map(|region| region.get().0.clone());
        let recipe = dynamic.clone().map_or(recipe.clone(), |region| recipe.dynamic(region));
        Ok(PyClassInitializer::from(PyModel(AnyModel::Hybrid(recipe, dynamic))).add_subclass(Self))
    }
}

/// Precomputed tensors of the non-linear law; tetrahedra.
#[pyclass(frozen, extends = PyModel, module = "viscera")]
pub(crate) struct TensorMass;

#[pymethods]
impl TensorMass {
    /// A model of `tissue`; with `adaptive`, nodes follow the linear law alone below that displacement [m].
    #[new]
    #[pyo3(signature = (tissue, *, adaptive=None))]
    fn new(tissue: &Bound<'_, PyAny>, adaptive: Option<f64>) -> PyResult<PyClassInitializer<Self>> {
        let recipe = viscera::model::TensorMass::new(self::tissue(tissue)?);
        let recipe = adaptive.map_or(recipe.clone(), |threshold| recipe.adaptive(threshold));
        Ok(PyClassInitializer::from(PyModel(AnyModel::TensorMass(recipe, adaptive))).add_subclass(Self))
    }
}

/// Stress from the deformation of each cell; every law, tetrahedra and hexahedra.
#[pyclass(frozen, extends = PyModel, module = "viscera")]
pub(crate) struct TotalLagrangian;

#[pymethods]
impl TotalLagrangian {
    /// A model of `tissue`. Hexahedra are integrated at `gauss`³ points, 2 or 3; `plain` computes F and P(F) in so many words where a
    /// faster form of the same law exists.
    #[new]
    #[pyo3(signature = (tissue, *, gauss=2, plain=false))]
    fn new(tissue: &Bound<'_, PyAny>, gauss: u32, plain: bool) -> PyResult<PyClassInitializer<Self>> {
        let rule = match gauss {
            2 => GaussRule::Two,
            3 => GaussRule::Three,
            _ => return Err(PyValueError::new_err(format!("gauss = {gauss}: there are 2 and 3 points along an edge"))),
        };
        let recipe = viscera::model::TotalLagrangian::new(self::tissue(tissue)?).gauss(rule);
        let recipe = if plain { recipe.plain() } else { recipe };
        Ok(PyClassInitializer::from(PyModel(AnyModel::TotalLagrangian(recipe, gauss == 2 && !plain)))
            .add_subclass(Self))
    }
}

/// Stress from the mean deformation at each node: does not lock, however close to incompressible; tetrahedra.
#[pyclass(frozen, extends = PyModel, module = "viscera")]
pub(crate) struct NodallyIntegrated;

#[pymethods]
impl NodallyIntegrated {
    /// A model of `tissue`; `stabilise` is the share of the shear modulus that stays in the cells [≥ 0, < 1], 0.01 by default.
    #[new]
    #[pyo3(signature = (tissue, *, stabilise=None))]
    fn new(tissue: &Bound<'_, PyAny>, stabilise: Option<f64>) -> PyResult<PyClassInitializer<Self>> {
        let recipe = viscera::model::NodallyIntegrated::new(self::tissue(tissue)?);
        let recipe = stabilise.map_or(recipe.clone(), |share| recipe.stabilise(share));
        Ok(PyClassInitializer::from(PyModel(AnyModel::NodallyIntegrated(recipe, stabilise))).add_subclass(Self))
    }
}

/// The linear law turned with each cell (Nesme et al. 2005); tetrahedra and hexahedra. Turns back when inverted.
#[pyclass(frozen, extends = PyModel, module = "viscera")]
pub(crate) struct Corotational;

pub(crate) fn choose<V: Copy>(name: &str, given: &str, known: &[(&str, V)]) -> PyResult<V> {
    known.iter().find(|(word, _)| *word == given).map(|(_, value)| *value).ok_or_else(|| {
        let words: Vec<_> = known.iter().map(|(word, _)| format!("`{word}`")).collect();
        PyValueError::new_err(format!("{name} = `{given}`: there are {}", words.join(", ")))
    })
}

#[pymethods]
impl Corotational {
    /// A model of `tissue`, with the words that scenes have: `rotation` polar (default), qr, svd; `strain_displacement` at-rest
    /// (default), updated; `volume` initial (default), current; `tangent` frozen (default), exact.
    #[new]
    #[pyo3(signature = (tissue, *, rotation=None, strain_displacement=None, volume=None, tangent=None))]
    fn new(
        tissue: &Bound<'_, PyAny>,
        rotation: Option<String>,
        strain_displacement: Option<String>,
        volume: Option<String>,
        tangent: Option<String>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let mut recipe = viscera::model::Corotational::new(self::tissue(tissue)?);
        if let Some(word) = &rotation {
            let known = [("polar", Rotation::Polar), ("qr", Rotation::Qr), ("svd", Rotation::Svd)];
            recipe = recipe.rotation(choose("rotation", word, &known)?);
        }
        if let Some(word) = &strain_displacement {
            let known = [("at-rest", StrainDisplacement::AtRest), ("updated", StrainDisplacement::Updated)];
            recipe = recipe.strain_displacement(choose("strain_displacement", word, &known)?);
        }
        if let Some(word) = &volume {
            let known = [("initial", IntegrationVolume::Initial), ("current", IntegrationVolume::Current)];
            recipe = recipe.volume(choose("volume", word, &known)?);
        }
        if let Some(word) = &tangent {
            let known = [("frozen", Tangent::Frozen), ("exact", Tangent::Exact)];
            recipe = recipe.tangent(choose("tangent", word, &known)?);
        }
        let words = [rotation, strain_displacement, volume, tangent];
        Ok(PyClassInitializer::from(PyModel(AnyModel::Corotational(recipe, words))).add_subclass(Self))
    }
}

/// Forces, their derivative and their energy at positions of your own: for a solver of your own.
#[pyclass(name = "ForceModel", module = "viscera")]
pub(crate) struct PyForceModel {
    mesh: Arc<VolumeMesh>,
    models: AnyForceModels,
}

enum AnyForceModels {
    Single(Vec<Box<dyn ForceModel<f32>>>, Scratch<f32>),
    Double(Vec<Box<dyn ForceModel<f64>>>, Scratch<f64>),
}

/// Does the same in whichever precision it is.
macro_rules! in_precision {
    ($models:expr, $list:ident, $scratch:ident => $work:expr) => {
        match $models {
            AnyForceModels::Single($list, $scratch) => $work,
            AnyForceModels::Double($list, $scratch) => $work,
        }
    };
}

/// Models, and memory for them to compute in.
type Built<T> = (Vec<Box<dyn ForceModel<T>>>, Scratch<T>);

fn build<T: Precision>(mesh: &VolumeMesh, recipe: &dyn ModelRecipe, keep_volume: f64) -> PyResult<Built<T>> {
    let mut models = vec![T::build_model(recipe, mesh).or_raise()?];
    match mesh {
        VolumeMesh::Tet(mesh) if keep_volume != 0.0 => {
            models.push(T::build_volume_penalty(mesh, keep_volume).or_raise()?);
        }
        VolumeMesh::Hex(_) if keep_volume != 0.0 => {
            return Err(PyValueError::new_err("keep_volume works on tetrahedra, and the mesh is made of hexahedra"));
        }
        _ => {}
    }
    let scratch = Scratch::for_models(mesh.nodes().len(), &models);
    Ok((models, scratch))
}

/// The blocks of a stiffness as they come.
#[derive(Default)]
pub(crate) struct Blocks {
    rows: Vec<u32>,
    columns: Vec<u32>,
    blocks: Vec<Mat3<f64>>,
}

impl Blocks {
    /// Those of all models at `x`.
    pub(crate) fn of<T: Scalar>(models: &[Box<dyn ForceModel<T>>], x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Self {
        let mut sink = Self::default();
        for model in models {
            model.linearize(x, scratch);
            model.add_blocks(x, scratch, &mut sink);
        }
        sink
    }

    pub(crate) fn arrays(self, py: Python<'_>) -> BlockArrays<'_> {
        (list_array(py, self.rows), list_array(py, self.columns), matrix_array(py, &self.blocks))
    }
}

impl<T: Scalar> BlockSink<T> for Blocks {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.rows.push(row);
        self.columns.push(column);
        self.blocks.push(block.cast());
    }
}

fn sum<T: NumpyScalar>(
    models: &[Box<dyn ForceModel<T>>],
    nodes: usize,
    mut add: impl FnMut(&dyn ForceModel<T>, &mut [Vec3<T>]),
) -> Vec<Vec3<T>> {
    let mut out = vec![Vec3::ZERO; nodes];
    models.iter().for_each(|model| add(model.as_ref(), &mut out));
    out
}

fn cast<T: NumpyScalar>(vectors: &[Vec3<f64>]) -> Vec<Vec3<T>> {
    vectors.iter().map(|v| v.cast()).collect()
}

/// Three arrays: rows, columns, blocks.
pub(crate) type BlockArrays<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray3<f64>>);

#[pymethods]
impl PyForceModel {
    /// The forces of `model` on `mesh`, with a volume-keeping stiffness κ [Pa, ≥ 0], in `precision` "single" or "double".
    #[new]
    #[pyo3(signature = (mesh, model, *, keep_volume=0.0, precision="double"))]
    fn new(mesh: &PyVolumeMesh, model: &PyModel, keep_volume: f64, precision: &str) -> PyResult<Self> {
        let recipe = model.0.recipe();
        let models = match choose("precision", precision, &[("single", true), ("double", false)])? {
            true => build(&mesh.mesh, recipe.as_ref(), keep_volume).map(|(m, s)| AnyForceModels::Single(m, s)),
            false => build(&mesh.mesh, recipe.as_ref(), keep_volume).map(|(m, s)| AnyForceModels::Double(m, s)),
        };
        Ok(Self { mesh: mesh.mesh.clone(), models: models? })
    }

    /// Internal forces +∂W/∂x [N] at positions `x` [m], both of shape (n, 3): what holds the nodes.
    fn forces<'py>(&mut self, py: Python<'py>, x: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        Ok(in_precision!(&mut self.models, models, scratch => {
            let x = cast(&x);
            let forces = py.detach(|| sum(models, x.len(), |model, out| model.add_forces(&x, scratch, out)));
            vector_array(py, &forces).into_any()
        }))
    }

    /// K(x) dx [N], the derivative of the internal forces at `x` [m] along `dx` [m]; all of shape (n, 3).
    fn product<'py>(&mut self, py: Python<'py>, x: Numbers<'py>, dx: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let nodes = self.mesh.nodes().len();
        let (x, dx) = (vectors_of(&x, "x", nodes)?, vectors_of(&dx, "dx", nodes)?);
        Ok(in_precision!(&mut self.models, models, scratch => {
            let (x, dx) = (cast(&x), cast(&dx));
            let product = py.detach(|| sum(models, nodes, |model, out| {
                model.linearize(&x, scratch);
                model.add_product(&x, &dx, scratch, out);
            }));
            vector_array(py, &product).into_any()
        }))
    }

    /// Stored energy W(x) [J].
    fn energy(&self, py: Python<'_>, x: Numbers<'_>) -> PyResult<f64> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        Ok(in_precision!(&self.models, models, _scratch => {
            let x = cast(&x);
            py.detach(|| models.iter().map(|model| model.energy(&x)).sum())
        }))
    }

    /// K(x) [N/m] as blocks of 3×3: their row nodes, column nodes (uint32) and values of shape (m, 3, 3). Blocks of the same two
    /// nodes add up. `stiffness` makes a matrix of scipy's of them.
    fn blocks<'py>(&mut self, py: Python<'py>, x: Numbers<'py>) -> PyResult<BlockArrays<'py>> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        let blocks = in_precision!(&mut self.models, models, scratch => Blocks::of(models, &cast(&x), scratch));
        Ok(blocks.arrays(py))
    }

    /// Takes cells out: their force, energy and stiffness are gone for good.
    fn remove(&mut self, cells: Vec<u32>) -> PyResult<()> {
        let count = self.mesh.cell_count();
        if let Some(cell) = cells.iter().find(|&&cell| cell as usize >= count) {
            return Err(PyValueError::new_err(format!(
                "there is no cell {cell}: cells are numbered 0 to {}",
                count - 1
            )));
        }
        in_precision!(&mut self.models, models, _scratch => models.iter_mut().for_each(|model| model.remove(&cells)));
        Ok(())
    }

    /// The mesh.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        crate::mesh::mesh_object(py, self.mesh.clone())
    }
}

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyModel>()?;
    module.add_class::<LinearTensorMass>()?;
    module.add_class::<TensorMass>()?;
    module.add_class::<TotalLagrangian>()?;
    module.add_class::<NodallyIntegrated>()?;
    module.add_class::<Corotational>()?;
    module.add_class::<StiffnessWarping>()?;
    module.add_class::<MassSpring>()?;
    module.add_class::<ShapeMemory>()?;
    module.add_class::<Precomputed>()?;
    module.add_class::<Hybrid>()?;
    module.add_class::<PyForceModel>()
}

//! A body in a world: its state as arrays, and what can be done to it.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use viscera::body::{NodeMotion, SimulatedBody};
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::math::{Mat3, Scalar, Vec3};
use viscera::mesh::VolumeMesh;
use viscera::model::Scratch;
use viscera::world::BodyId;

use crate::arrays::{Numbers, NumpyScalar, index_array, list_array, matrix_array, vector_array, vectors_of};
use crate::error::OrRaise;
use crate::integrator::{TOLERANCE, static_solver};
use crate::mesh::mesh_object;
use crate::model::{BlockArrays, Blocks};
use crate::report::{PyBodyObservables, PyKeptVolume, PyStaticReport};
use crate::view::{Of, view};
use crate::world::{PyWorld, in_world};

/// Corners of triangles, and whether a cut has laid each open.
type Surface<'py> = (Bound<'py, PyArray2<u32>>, Bound<'py, PyArray1<bool>>);

/// A body in a world.
///
/// Arrays of its state are copies, in the world's precision (float32 or float64), and keep their shape whatever is cut: nodes
/// and cells are never renumbered. `live_positions` follow the body, `view_positions` and `view_velocities` look into the engine's memory. Fields of cells that are removed are NaN; nodes that have lost all cells stay where they were.
#[pyclass(frozen, name = "SimulatedBody", module = "viscera")]
pub(crate) struct PySimulatedBody {
    pub(crate) world: Py<PyWorld>,
    pub(crate) id: BodyId,
    pub(crate) mesh: Arc<VolumeMesh>,
}

/// A number for each cell that is left, in any form.
fn each_cell<T: Scalar, V>(body: &SimulatedBody<T>, value: impl Fn(usize) -> V, gone: impl Fn() -> V) -> Vec<V> {
    let removed = &body.state().removed;
    (0..removed.len()).map(|cell| if removed[cell] { gone() } else { value(cell) }).collect()
}

fn nan() -> Mat3<f64> {
    Mat3::diagonal(1.0) * f64::NAN
}

/// σ = P Fᵀ / det F.
fn cauchy<T: Scalar>(body: &SimulatedBody<T>, cell: usize) -> Mat3<f64> {
    let gradient = body.deformation_gradient(cell);
    body.first_piola_stress(cell) * gradient.transpose() * (1.0 / gradient.determinant())
}

/// √(3/2 dev σ : dev σ).
fn von_mises(stress: &Mat3<f64>) -> f64 {
    let pressure = (stress.columns[0].x + stress.columns[1].y + stress.columns[2].z) / 3.0;
    let deviator = *stress - Mat3::diagonal(pressure);
    (1.5 * deviator.squared_norm()).sqrt()
}

impl PySimulatedBody {
    fn matrices<'py>(
        &self,
        py: Python<'py>,
        single: impl Fn(&SimulatedBody<f32>, usize) -> Mat3<f64>,
        double: impl Fn(&SimulatedBody<f64>, usize) -> Mat3<f64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let world = self.read(py)?;
        let matrices = match &world.world {
            crate::world::AnyWorld::Single(world) => {
                let body = world.body(self.id);
                each_cell(body, |cell| single(body, cell), nan)
            }
            crate::world::AnyWorld::Double(world) => {
                let body = world.body(self.id);
                each_cell(body, |cell| double(body, cell), nan)
            }
        };
        Ok(matrix_array(py, &matrices))
    }

    /// The world, to be read. Raises RuntimeError where another thread steps it.
    fn read<'a>(&'a self, py: Python<'a>) -> PyResult<PyRef<'a, PyWorld>> {
        Ok(self.world.try_borrow(py)?)
    }

    /// The world, for what computes and leaves its state as it is.
    fn compute<'a>(&'a self, py: Python<'a>) -> PyResult<PyRefMut<'a, PyWorld>> {
        Ok(self.world.try_borrow_mut(py)?)
    }

    /// The world, to be changed.
    fn change<'a>(&'a self, py: Python<'a>) -> PyResult<PyRefMut<'a, PyWorld>> {
        PyWorld::change(self.world.bind(py))
    }
}

/// A field of matrices, the same in both precisions.
macro_rules! matrix_field {
    ($self:ident, $py:ident, |$body:ident, $cell:ident| $value:expr) => {
        $self.matrices($py, |$body, $cell| $value, |$body, $cell| $value)
    };
}

fn cast<T: NumpyScalar>(vectors: &[Vec3<f64>]) -> Vec<Vec3<T>> {
    vectors.iter().map(|v| v.cast()).collect()
}

#[pymethods]
impl PySimulatedBody {
    /// The name by which messages call it.
    #[getter]
    fn name(&self, py: Python<'_>) -> PyResult<String> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).name().to_owned()))
    }

    /// The world.
    #[getter]
    fn world(&self, py: Python<'_>) -> Py<PyWorld> {
        self.world.clone_ref(py)
    }

    /// The rest shape.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        mesh_object(py, self.mesh.clone())
    }

    /// Name of the force model.
    #[getter]
    fn model(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).model().info().name))
    }

    /// Name of the law.
    #[getter]
    fn law(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).law()))
    }

    /// Positions of the nodes [m]; shape (n, 3). Setting them moves the nodes in the directions that are free.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(in_world!(&self.read(py)?.world, world => vector_array(py, world.body(self.id).positions()).into_any()))
    }

    #[setter]
    fn set_positions(&self, py: Python<'_>, positions: Numbers<'_>) -> PyResult<()> {
        let places = vectors_of(&positions, "positions", self.mesh.nodes().len())?;
        let mut world = self.change(py)?;
        in_world!(&mut world.world, world => world.body_mut(self.id).set_node_positions(&places));
        world.refresh(py)
    }

    /// Positions of the nodes [m] in an array that follows them from step to step, at the price of one copy in each; shape (n, 3), not
    /// to be written to. It outlives the world, and shows its last moment then. A cut leaves its shape as it is.
    #[getter]
    fn live_positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.compute(py)?.live_positions(py, self.id)
    }

    /// Positions of the nodes [m] where the engine has them, without a copy: an array of shape (n, 3), not to be written to. The world
    /// stands still as long as it, or a slice of it, is alive: what would change its state (a step, a cut, a snapshot put back, positions
    /// that are set) raises BufferError and changes nothing. It keeps the world alive. Nodes are never renumbered: an array that is
    /// asked for after a cut has the shape of the one before.
    fn view_positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(self.world.bind(py), self.id, Of::Positions)
    }

    /// Velocities of the nodes [m/s] where the engine has them; of shape (n, 3), under the rules of `view_positions`.
    fn view_velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view(self.world.bind(py), self.id, Of::Velocities)
    }

    /// Velocities of the nodes [m/s]; shape (n, 3). Setting them changes the directions that are free.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(in_world!(&self.read(py)?.world, world => vector_array(py, world.body(self.id).velocities()).into_any()))
    }

    #[setter]
    fn set_velocities(&self, py: Python<'_>, velocities: Numbers<'_>) -> PyResult<()> {
        let velocities = vectors_of(&velocities, "velocities", self.mesh.nodes().len())?;
        let mut world = self.change(py)?;
        in_world!(&mut world.world, world => world.body_mut(self.id).set_node_velocities(&velocities));
        Ok(())
    }

    /// Internal forces +∂W/∂x [N]; shape (n, 3). The force that the tissue exerts on its nodes is the negative.
    #[getter]
    fn internal_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut world = self.compute(py)?;
        Ok(in_world!(&mut world.world, world => vector_array(py, world.internal_forces(self.id)).into_any()))
    }

    /// Gravity and loads on the nodes [N]; shape (n, 3).
    #[getter]
    fn external_forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut world = self.compute(py)?;
        Ok(in_world!(&mut world.world, world => vector_array(py, world.external_forces(self.id)).into_any()))
    }

    /// Lumped masses of the nodes [kg]; shape (n,).
    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            list_array(py, world.body(self.id).state().masses.iter().map(|mass| mass.to_f64()).collect())
        }))
    }

    /// How each node moves: "free", "fixed", "prescribed", "guided", "held" by an instrument, "retired" by a cut, or "following" a boundary.
    #[getter]
    fn motions(&self, py: Python<'_>) -> PyResult<Vec<&'static str>> {
        let word = |motion: &NodeMotion| match motion {
            NodeMotion::Free => "free",
            NodeMotion::Fixed => "fixed",
            NodeMotion::Prescribed(_) => "prescribed",
            NodeMotion::Guided(_) => "guided",
            NodeMotion::Held(_) => "held",
            NodeMotion::Retired => "retired",
            NodeMotion::Following => "following",
        };
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).state().motions.iter().map(word).collect()))
    }

    /// Which cells are removed; shape (cells,), bool.
    #[getter]
    fn removed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            list_array(py, world.body(self.id).state().removed.clone())
        }))
    }

    /// How far each node is seared: 0 where tissue is fresh, 1 at the rim of a burnt cut; shape (n,).
    #[getter]
    fn seared<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            list_array(py, world.body(self.id).seared().iter().map(|&share| share.to_f64()).collect())
        }))
    }

    /// Cells that are not removed.
    #[getter]
    fn cell_count(&self, py: Python<'_>) -> PyResult<usize> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).cell_count()))
    }

    /// Largest distance of a node from its place at rest [m].
    #[getter]
    fn max_displacement(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).max_displacement()))
    }

    /// The longest stable sub-step of the explicit scheme at rest [s].
    #[getter]
    fn stable_step(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).stable_step()))
    }

    /// The current surface: triangles of shape (n, 3), uint32, counter-clockwise seen from outside, and whether a cut laid each open.
    fn surface<'py>(&self, py: Python<'py>) -> PyResult<Surface<'py>> {
        let surface = in_world!(&self.read(py)?.world, world => world.body(self.id).surface());
        let cut = list_array(py, surface.iter().map(|triangle| triangle.cut).collect());
        Ok((index_array(py, surface.iter().map(|triangle| triangle.nodes)), cut))
    }

    /// Measures the body now.
    fn observe(&self, py: Python<'_>) -> PyResult<PyBodyObservables> {
        let mut world = self.compute(py)?;
        Ok(PyBodyObservables(in_world!(&mut world.world, world => world.observe(self.id))))
    }

    /// The volumes that are kept exactly, in the order in which they were asked for.
    #[getter]
    fn kept_volumes(&self, py: Python<'_>) -> PyResult<Vec<PyKeptVolume>> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).kept_volumes().map(PyKeptVolume).collect()))
    }

    /// Removes cells by number; cells that are gone already are passed over. Gives how many went, dropped pieces included.
    fn remove_cells(&self, py: Python<'_>, cells: Vec<u32>) -> PyResult<usize> {
        let mut world = self.change(py)?;
        in_world!(&mut world.world, world => world.remove_cells(self.id, &cells)).or_raise()
    }

    /// Brings the body to rest under gravity, its loads and prescribed motions as they are now, by Newton's method with load steps.
    /// Time stands still. `tolerance`: residual relative to loads and reactions; `iterations`: the most for a share of the load;
    /// `first_step`: the first share that is tried; `smallest_step`: the least before giving up; `small_strain`: one linear solve
    /// with the stiffness at the start. `solver`: "direct" (sparse Cholesky) or "iterative" (conjugate gradients). Raises
    /// `StaticFailed`, and the body is in the last equilibrium that was found.
    #[pyo3(signature = (*, tolerance=1e-10, iterations=30, first_step=1.0, smallest_step=1.0/256.0, small_strain=false,
        solver="direct"))]
    #[allow(clippy::too_many_arguments)]
    fn settle(
        &self,
        py: Python<'_>,
        tolerance: f64,
        iterations: usize,
        first_step: f64,
        smallest_step: f64,
        small_strain: bool,
        solver: &str,
    ) -> PyResult<PyStaticReport> {
        let settings = QuasiStatic { tolerance, iterations, first_step, smallest_step, small_strain };
        let mut solver = static_solver(solver, TOLERANCE)?;
        let mut world = self.change(py)?;
        let inner = &mut world.world;
        let outcome =
            py.detach(|| in_world!(inner, world => world.settle(self.id, &settings, solver.as_mut()))).or_raise();
        world.refresh(py)?;
        outcome.map(PyStaticReport)
    }

    /// How it came to rest in the last step of a quasi-static world, or when it was settled. None where no equilibrium was sought, or the
    /// last was not found.
    #[getter]
    fn static_report(&self, py: Python<'_>) -> PyResult<Option<PyStaticReport>> {
        Ok(in_world!(&self.read(py)?.world, world => world.body(self.id).static_report().cloned()).map(PyStaticReport))
    }

    /// How the body answers small extra forces where it is: (K + `inertia` M)⁻¹ f in the free directions [m], for forces [N] of shape
    /// (n, 3), or several at once of shape (k, n, 3). With `inertia` = 0 it is a body at rest; with 1/dt² (+ damping/dt) [1/s²] a
    /// step of backward Euler. The gradients of equilibria and steps come from it, for one solve each.
    #[pyo3(signature = (forces, *, inertia=0.0, solver="direct"))]
    fn respond<'py>(
        &self,
        py: Python<'py>,
        forces: Numbers<'py>,
        inertia: f64,
        solver: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let nodes = self.mesh.nodes().len();
        let view = forces.as_array();
        let count = match view.shape() {
            [rows, 3] if *rows == nodes => 1,
            [count, rows, 3] if *rows == nodes => *count,
            shape => {
                let message = format!("forces must have shape ({nodes}, 3) or (k, {nodes}, 3), and have {shape:?}");
                return Err(PyValueError::new_err(message));
            }
        };
        let flat: Vec<f64> = view.iter().copied().collect();
        let vector = |v: &[f64]| Vec3::new(v[0], v[1], v[2]);
        let right: Vec<Vec<Vec3<f64>>> =
            (0..count).map(|k| flat[k * 3 * nodes..][..3 * nodes].chunks(3).map(vector).collect()).collect();
        let mut solver = static_solver(solver, TOLERANCE)?;
        let mut world = self.compute(py)?;
        let inner = &mut world.world;
        let answers = py
            .detach(|| in_world!(inner, world => world.respond(self.id, &right, inertia, solver.as_mut())))
            .or_raise()?;
        let all: Vec<Vec3<f64>> = answers.into_iter().flatten().collect();
        let shape = view.shape().to_vec();
        vector_array(py, &all).into_any().call_method1("reshape", (shape,))
    }

    /// Deformation gradients F, of hexahedra at their centres; shape (cells, 3, 3).
    fn deformation_gradient<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        matrix_field!(self, py, |body, cell| body.deformation_gradient(cell))
    }

    /// Green strains E = ½(FᵀF − I); shape (cells, 3, 3).
    fn green_strain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        matrix_field!(self, py, |body, cell| {
            let gradient = body.deformation_gradient(cell);
            (gradient.transpose() * gradient - Mat3::diagonal(1.0)) * 0.5
        })
    }

    /// First Piola–Kirchhoff stresses P [Pa] of the law; shape (cells, 3, 3). The volume-keeping force is no part of them.
    fn first_piola_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        matrix_field!(self, py, |body, cell| body.first_piola_stress(cell))
    }

    /// Second Piola–Kirchhoff stresses S = F⁻¹P [Pa] of the law; shape (cells, 3, 3).
    fn second_piola_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        matrix_field!(self, py, |body, cell| body.deformation_gradient(cell).inverse() * body.first_piola_stress(cell))
    }

    /// Cauchy stresses σ = P Fᵀ/det F [Pa] of the law; shape (cells, 3, 3).
    fn cauchy_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        matrix_field!(self, py, |body, cell| cauchy(body, cell))
    }

    /// Von Mises stresses √(3/2 dev σ : dev σ) [Pa] of the Cauchy stress; shape (cells,).
    fn von_mises_stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            let body = world.body(self.id);
            list_array(py, each_cell(body, |cell| von_mises(&cauchy(body, cell)), || f64::NAN))
        }))
    }

    /// V/V0 of every cell: 1 at rest, negative where a cell is turned inside out; shape (cells,).
    fn volume_ratio<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            let body = world.body(self.id);
            list_array(py, each_cell(body, |cell| body.volume_ratio(cell), || f64::NAN))
        }))
    }

    /// Equivalent strains √(⅔ dev E : dev E): the elongation in small uniaxial tension; shape (cells,).
    fn equivalent_strain<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(in_world!(&self.read(py)?.world, world => {
            let body = world.body(self.id);
            list_array(py, each_cell(body, |cell| body.equivalent_strain(cell), || f64::NAN))
        }))
    }

    /// Internal forces [N] that the body would have at positions `x` [m], with the cells that are left; shape (n, 3).
    fn forces_at<'py>(&self, py: Python<'py>, x: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        Ok(in_world!(&self.read(py)?.world, world => {
            let (models, x) = (&world.body(self.id).state().models, cast(&x));
            let mut forces = vec![Vec3::ZERO; x.len()];
            let mut scratch = Scratch::for_models(x.len(), models);
            py.detach(|| models.iter().for_each(|model| model.add_forces(&x, &mut scratch, &mut forces)));
            vector_array(py, &forces).into_any()
        }))
    }

    /// The derivative of `forces_at` at `x` [m] along `dx` [m]: K(x) dx [N]; shape (n, 3).
    fn product_at<'py>(&self, py: Python<'py>, x: Numbers<'py>, dx: Numbers<'py>) -> PyResult<Bound<'py, PyAny>> {
        let nodes = self.mesh.nodes().len();
        let (x, dx) = (vectors_of(&x, "x", nodes)?, vectors_of(&dx, "dx", nodes)?);
        Ok(in_world!(&self.read(py)?.world, world => {
            let (models, x, dx) = (&world.body(self.id).state().models, cast(&x), cast(&dx));
            let mut product = vec![Vec3::ZERO; x.len()];
            let mut scratch = Scratch::for_models(x.len(), models);
            py.detach(|| for model in models {
                model.linearize(&x, &mut scratch);
                model.add_product(&x, &dx, &mut scratch, &mut product);
            });
            vector_array(py, &product).into_any()
        }))
    }

    /// K(x) [N/m] with the cells that are left, as blocks of 3×3: row nodes, column nodes (uint32) and values of shape (m, 3, 3). Blocks of
    /// the same two nodes add up; `stiffness` makes a matrix of scipy's of them.
    fn blocks<'py>(&self, py: Python<'py>, x: Numbers<'py>) -> PyResult<BlockArrays<'py>> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        let blocks = in_world!(&self.read(py)?.world, world => {
            let (models, x) = (&world.body(self.id).state().models, cast(&x));
            let mut scratch = Scratch::for_models(x.len(), models);
            Blocks::of(models, &x, &mut scratch)
        });
        Ok(blocks.arrays(py))
    }

    /// Energy [J] that the body would store at positions `x` [m], with the cells that are left.
    fn energy_at(&self, py: Python<'_>, x: Numbers<'_>) -> PyResult<f64> {
        let x = vectors_of(&x, "x", self.mesh.nodes().len())?;
        Ok(in_world!(&self.read(py)?.world, world => {
            let (models, x) = (&world.body(self.id).state().models, cast(&x));
            models.iter().map(|model| model.energy(&x)).sum()
        }))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let world = self.read(py)?;
        let (name, cells) = in_world!(&world.world, world => {
            (world.body(self.id).name().to_owned(), world.body(self.id).cell_count())
        });
        Ok(format!("<body `{name}` of {cells} cells in a world>"))
    }
}

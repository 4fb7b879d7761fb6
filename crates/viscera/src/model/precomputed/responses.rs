use std::sync::atomic::{AtomicUsize, Ordering};

use super::{ResponsesError, Supports, linear_model};
use crate::executor::{Divide, Executor};
use crate::material::Tissue;
use crate::math::{Mat3, Vec3};
use crate::model::{ModelError, Scratch};
use crate::solver::{BlockMatrix, LinearSolver, SolverError, System};

/// How all nodes of a linear body answer a unit force on each handle, a free node of its surface: u_i = Σ_k C_ik f_k, with what is held
/// staying where it is.
///
/// 72 bytes for each node and handle: 1 400 nodes, of which 800 are handles, take 80 MB. Interior nodes are answered for as well,
/// because a body has them; answers for the surface alone would take half of that.
#[derive(Clone, PartialEq)]
pub struct Responses {
    pub(super) checksums: Checksums,
    pub(super) nodes: usize,
    /// The handles, ascending.
    pub(super) handles: Vec<u32>,
    /// C_ik [m/N], handle after handle, in each node after node.
    pub(super) columns: Vec<Mat3<f64>>,
}

/// Tell what the responses were computed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Checksums {
    pub(super) mesh: u32,
    pub(super) tissue: u32,
    pub(super) held: u32,
}

impl Checksums {
    fn of(tissue: &Tissue, supports: &Supports<'_>) -> Self {
        // How a tissue shows itself holds every modulus, down to the last digit.
        let tissue = crc32fast::hash(format!("{tissue:?}").as_bytes());
        Self { mesh: supports.mesh_checksum(), tissue, held: supports.held_checksum() }
    }
}

/// Sizes only: the numbers are millions.
impl std::fmt::Debug for Responses {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { checksums, nodes, handles, .. } = self;
        let mut shown = formatter.debug_struct("Responses");
        shown
            .field("checksums", checksums)
            .field("nodes", nodes)
            .field("handles", &handles.len())
            .finish_non_exhaustive()
    }
}

impl Responses {
    /// Computes the responses: one factorisation, and three solves for each handle, on the threads of `executor`; the bits do not depend on
    /// how many there are. `progress` is told after each handle how many are done, of how many.
    ///
    /// # Errors
    /// [`ResponsesError::NothingHolds`], [`ResponsesError::Solver`]; [`ModelError`] where the tissue is not linear.
    pub fn compute(
        tissue: &Tissue,
        supports: &Supports<'_>,
        solver: &mut dyn LinearSolver,
        executor: &Executor,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Self, ModelError> {
        let system = stiffness(tissue, supports)?;
        solver.analyse(&system);
        solver.factor(&system).map_err(|error| match error {
            SolverError::NotPositiveDefinite => ResponsesError::NothingHolds,
            other => ResponsesError::Solver(other),
        })?;
        let (nodes, handles) = (system.nodes(), supports.free_surface());
        let mut columns = vec![Mat3::ZERO; nodes * handles.len()];
        let (solver, done) = (&*solver, AtomicUsize::new(0));
        let work = |part: usize, Column { blocks, .. }: Column<'_>| {
            let handle = handles[part] as usize;
            let mut answer = vec![Vec3::ZERO; nodes];
            for (axis, unit) in Mat3::IDENTITY.columns.into_iter().enumerate() {
                answer.fill(Vec3::ZERO);
                answer[handle] = system.filters[handle].apply(unit);
                solver.solve(&system, &mut answer)?;
                blocks.iter_mut().zip(&answer).for_each(|(block, &u)| block.columns[axis] = u);
            }
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, handles.len());
            Ok(())
        };
        let data = Column { blocks: &mut columns, nodes };
        let outcome = executor.fold(handles.len(), data, &work, &|a: Result<(), SolverError>, b| a.and(b));
        outcome.unwrap_or(Ok(())).map_err(ResponsesError::Solver)?;
        Ok(Self { checksums: Checksums::of(tissue, supports), nodes, handles, columns })
    }

    /// Whether these are the responses of such a body.
    ///
    /// # Errors
    /// [`ResponsesError::Stale`], naming what differs.
    pub fn check(&self, tissue: &Tissue, supports: &Supports<'_>) -> Result<(), ResponsesError> {
        let (own, wanted) = (self.checksums, Checksums::of(tissue, supports));
        let pairs = [
            (own.mesh == wanted.mesh, "mesh"),
            (own.tissue == wanted.tissue, "tissue"),
            (own.held == wanted.held, "set of held nodes"),
        ];
        let stale = pairs.into_iter().find(|(same, _)| !same);
        stale.map_or(Ok(()), |(_, what)| Err(ResponsesError::Stale { what }))
    }

    /// The handles, ascending.
    pub fn handles(&self) -> &[u32] {
        &self.handles
    }

    /// The number of a node's handle; none for a node that has no responses.
    pub fn handle_of(&self, node: u32) -> Option<usize> {
        self.handles.binary_search(&node).ok()
    }

    /// How many nodes answer.
    pub fn node_count(&self) -> usize {
        self.nodes
    }

    /// Memory that the responses take [bytes].
    pub fn bytes(&self) -> usize {
        size_of_val(&self.columns[..]) + size_of_val(&self.handles[..])
    }

    /// C_ik: displacement of a node for a unit force on the handle of this number [m/N].
    pub fn response(&self, node: u32, handle: usize) -> Mat3<f64> {
        self.columns[handle * self.nodes + node as usize]
    }

    /// Adds the displacements [m] of all nodes for a force [N] on the handle of this number.
    pub fn displace(&self, handle: usize, force: Vec3<f64>, displacements: &mut [Vec3<f64>]) {
        let column = &self.columns[handle * self.nodes..][..self.nodes];
        displacements.iter_mut().zip(column).for_each(|(u, block)| *u += *block * force);
    }
}

/// K at rest, and what is held.
pub(crate) fn stiffness(tissue: &Tissue, supports: &Supports<'_>) -> Result<System, ModelError> {
    let (mesh, filters) = (supports.mesh, supports.filters.to_vec());
    let model = linear_model(tissue, mesh).build_double(mesh)?;
    let models = [model];
    let mut scratch = Scratch::for_models(mesh.nodes().len(), &models);
    let mut matrix = BlockMatrix::new(mesh, models[0].rings());
    models[0].linearize(mesh.nodes(), &mut scratch);
    models[0].add_blocks(mesh.nodes(), &mut scratch, &mut matrix);
    Ok(System { matrix, filters })
}

/// Columns of blocks; a part is the one of a handle.
struct Column<'a> {
    blocks: &'a mut [Mat3<f64>],
    nodes: usize,
}

impl Divide for Column<'_> {
    fn divide(self, parts: usize) -> (Self, Self) {
        let Self { blocks, nodes } = self;
        let (left, right) = blocks.split_at_mut(parts * nodes);
        (Self { blocks: left, nodes }, Self { blocks: right, nodes })
    }
}

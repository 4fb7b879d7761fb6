use super::tangent::StepMatrix;
use super::{Implicit, MatrixForm, Preconditioning};
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;
use crate::solver::{BlockJacobi, BlockMatrix, ConjugateGradient, Filter, FilteredNodes, Multigrid, Reach, among};

/// What an implicit step computes in; it means nothing between steps.
#[derive(Clone, Debug)]
pub struct ImplicitMemory<T> {
    /// Places at the beginning of the step [m].
    pub(super) start: Vec<Vec3<T>>,
    /// Velocities at the beginning of the step [m/s].
    pub(super) velocities: Vec<Vec3<T>>,
    /// External forces at the beginning of the step, where the scheme needs the accelerations there [N].
    pub(super) external: Vec<Vec3<T>>,
    /// δ, the displacement over the step as far as it is known [m].
    pub(super) increment: Vec<Vec3<T>>,
    /// δ̂ without forces; for driven nodes, where they have to go [m].
    pub(super) coast: Vec<Vec3<T>>,
    /// v̂ without forces [m/s].
    pub(super) coast_velocities: Vec<Vec3<T>>,
    /// What the forces lack to balance, R − F − C v − M a [N].
    pub(super) lack: Vec<Vec3<T>>,
    /// Correction of δ in one iteration [m].
    pub(super) correction: Vec<Vec3<T>>,
    /// What driven nodes still have to go [m]; of others it means nothing.
    pub(super) prescribed: Vec<Vec3<T>>,
    /// Memory for a nodal array: velocities that damp, places at the end.
    pub(super) nodal: Vec<Vec3<T>>,
    /// Memory for forces of damping [N].
    pub(super) damping: Vec<Vec3<T>>,
    /// Right-hand side of the linear system: what the forces lack, over the factor of the stiffness [N].
    pub(super) rhs: Vec<Vec3<T>>,
    pub(super) matrix: StepMatrix<T>,
    /// Forces that rounding of the positions makes [N].
    pub(super) rounding: f64,
    /// The least of them over the linear systems of the step [N].
    pub(super) least_rounding: f64,
    pub(super) filters: Vec<Filter<T>>,
    /// Nodes that were not free at the beginning of the step, in ascending order: the filters of all others are.
    pub(super) driven: Vec<u32>,
    /// Those of them that still are not.
    pub(super) filtered_nodes: FilteredNodes,
    pub(super) preconditioner: BlockJacobi<T>,
    pub(super) multigrid: Option<Multigrid<T>>,
    pub(super) conjugate_gradient: ConjugateGradient<T>,
    /// What the linear equations of nodes that jaws hold lack to balance [N].
    pub(super) reactions: Vec<Vec3<T>>,
    /// Whether the step was solved by these equations.
    pub(super) is_linear: bool,
    /// Whether the external forces were found in this step.
    pub(super) knows_external: bool,
    /// Forces with which jaws drag nodes that slip through them [N].
    pub(super) dragged: Vec<(u32, Vec3<T>)>,
    /// Residuals of Newton's iterations over the forces that balance.
    pub(super) history: Vec<f64>,
    /// What parts of a step gained from nobody in one of its last attempts, and the energy before them with the work of the loads since [J].
    pub(super) gain: (f64, f64),
}

impl<T: Scalar> ImplicitMemory<T> {
    /// Memory for a body of `mesh`, of models whose forces reach so far.
    pub fn new(mesh: &VolumeMesh, reach: Reach<'_>, settings: &Implicit) -> Self {
        let nodes = mesh.nodes().len();
        let zeros = || vec![Vec3::ZERO; nodes];
        Self {
            start: zeros(),
            velocities: zeros(),
            external: zeros(),
            increment: zeros(),
            coast: zeros(),
            coast_velocities: zeros(),
            lack: zeros(),
            rhs: zeros(),
            correction: zeros(),
            prescribed: zeros(),
            nodal: zeros(),
            damping: zeros(),
            matrix: StepMatrix {
                stiffness: T::ONE,
                masses: vec![T::ZERO; nodes],
                external_time: 0.0,
                external_share: 1.0,
                is_exact: false,
                assembled: (settings.matrix == MatrixForm::Assembled).then(|| BlockMatrix::new(mesh, reach)),
            },
            rounding: 0.0,
            least_rounding: 0.0,
            filters: vec![Filter::Free; nodes],
            driven: Vec::with_capacity(nodes),
            filtered_nodes: FilteredNodes::with_room(nodes),
            preconditioner: BlockJacobi::new(nodes),
            multigrid: (settings.preconditioner == Preconditioning::Multigrid).then(|| Multigrid::new(mesh, reach)),
            conjugate_gradient: ConjugateGradient::new(nodes, settings.stop(true).at_most()),
            reactions: zeros(),
            is_linear: false,
            knows_external: false,
            dragged: Vec::with_capacity(nodes),
            history: Vec::with_capacity(settings.newton.at_most(true) as usize + 1),
            gain: (0.0, 0.0),
        }
    }

    /// Lists which of the driven nodes are not free.
    pub(super) fn list_filtered(&mut self) {
        self.filtered_nodes.list(&self.filters, self.driven.iter().copied());
    }

    /// The driven ones among the `count` nodes from `first` on.
    pub(super) fn driven_among(&self, first: usize, count: usize) -> &[u32] {
        among(&self.driven, first, count)
    }

    /// Residuals of the last linear solve over their scale: at the start and after each iteration.
    pub fn linear_history(&self) -> &[f64] {
        self.conjugate_gradient.history()
    }

    /// Residuals of Newton's iterations in the last full step over the forces that balance: at the start and after each.
    pub fn newton_history(&self) -> &[f64] {
        &self.history
    }
}

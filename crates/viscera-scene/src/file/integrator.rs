use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the equations of motion are stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "integrator")]
pub struct IntegratorFile {
    /// Which integrator.
    pub kind: IntegratorName,
    /// How the non-linear equations of an implicit or quasi-static step are solved: "linearised", "full", or full with settings; by
    /// default linearised for `backward-euler` and full for the others. A linearised equilibrium is that of small strains, from rest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub newton: Option<NewtonFile>,
    /// When the conjugate gradient of an implicit step ends; by default at 1e-4 in at most 100 iterations where the step is
    /// linearised, at 1e-6 in at most 2000 where it is solved in full.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear: Option<LinearFile>,
    /// Whether an implicit step puts its matrix together: "matrix-free" (the default) or "assembled"; the motion is the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrix: Option<MatrixFile>,
    /// What makes the conjugate gradient of an implicit step fast: "block-jacobi" (the default) or "multigrid", which pays for stiff
    /// tissue, long steps and fine meshes; the motion is the same within the tolerance of `linear`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preconditioner: Option<PreconditionerFile>,
    /// What solves the linear systems of a quasi-static step: "iterative" (the default, which attached bodies need) or "direct".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solver: Option<SolverFile>,
    /// β of `newmark`, the share of the end in the position; by default 1/4, the average acceleration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 0.5))]
    pub beta: Option<f64>,
    /// γ of `newmark`, the share of the end in the velocity; by default 1/2, above which high frequencies are damped.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0.5, "maximum" = 1))]
    pub gamma: Option<f64>,
}

/// The integrators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IntegratorName {
    /// Central differences with lumped masses (INRIA RR-4028, eq. 11), in stable substeps.
    #[default]
    Explicit,
    /// Implicit, of first order; bears any step and damps what it cannot resolve.
    BackwardEuler,
    /// Implicit, of second order.
    Newmark,
    /// Implicit, of second order over two steps; damps high frequencies.
    Bdf2,
    /// Implicit, of second order; keeps energy and angular momentum of St Venant–Kirchhoff tissue.
    EnergyMomentum,
    /// From equilibrium to equilibrium, without inertia or damping: what a load or a motion does when it is put on slowly.
    QuasiStatic,
}

impl IntegratorName {
    /// As it stands in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Explicit => "explicit",
            Self::BackwardEuler => "backward-euler",
            Self::Newmark => "newmark",
            Self::Bdf2 => "bdf2",
            Self::EnergyMomentum => "energy-momentum",
            Self::QuasiStatic => "quasi-static",
        }
    }
}

/// How the non-linear equations of a step are solved.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum NewtonFile {
    /// One of the two ways.
    Named(NewtonName),
    /// In full, with these settings.
    Full(FullNewtonFile),
}

/// The two ways to solve the equations of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NewtonName {
    /// One linear solve for each step.
    Linearised,
    /// Newton's method with a line search.
    Full,
}

/// Newton's method with a line search.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "Newton's method")]
pub struct FullNewtonFile {
    /// Share of the forces to which they have to balance; by default 1e-8.
    #[serde(default = "one_in_a_hundred_million")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: f64,
    /// The most iterations; a step that needs more is made in parts, of which the shortest end the run, a share of the load of a quasi-static one
    /// is halved. By default 30.
    #[serde(default = "thirty")]
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub iterations: u32,
}

/// When the conjugate gradient ends. Give `iterations` for a fixed number, `tolerance` for as many as it takes, or both for
/// as many as it takes and no more than that.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(title = "linear solver")]
pub struct LinearFile {
    /// Share of the right-hand side to which the residual has to fall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub tolerance: Option<f64>,
    /// How many iterations; with a tolerance, the most, by default 2000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "maximum" = 1_000_000))]
    pub iterations: Option<u32>,
}

/// Whether the matrix is put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MatrixFile {
    /// Products element by element.
    MatrixFree,
    /// Rows of 3×3 blocks: worth it where a solve takes many iterations.
    Assembled,
}

/// What makes the conjugate gradient fast.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PreconditionerFile {
    /// The blocks on the diagonal: cheap; iterations grow with the number of cells along the body.
    BlockJacobi,
    /// Coarser and coarser lattices over the body: their number of iterations hardly grows with that of the cells.
    Multigrid,
}

/// What solves the linear systems of equilibria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SolverFile {
    /// Conjugate gradients on the assembled matrix, to 1e-12: little memory, for bodies of any size.
    Iterative,
    /// A Cholesky factorisation: sure to notice a body that is unstable, and faster where the stiffness is close to singular, as that of
    /// thin or nearly incompressible bodies.
    Direct,
}

fn one_in_a_hundred_million() -> f64 {
    1e-8
}

fn thirty() -> u32 {
    30
}

use crate::model::ModelKind;
use crate::solver::SolverError;

/// Why no equilibrium was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StaticError {
    /// A setting is out of range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        range: &'static str,
    },
    /// No node is fixed or prescribed, so the body floats.
    #[error("nothing holds body `{body}`: fix or prescribe some of its nodes; a free body has no equilibrium")]
    NothingHolds {
        /// Name of the body.
        body: String,
    },
    /// The model knows nothing that Newton's method could use.
    #[error("body `{body}`: equilibria are not for the model `{model}`: {advice}")]
    ModelHasNoEquilibrium {
        /// Name of the body.
        body: String,
        /// The model.
        model: ModelKind,
        /// Why, and what to do.
        advice: &'static str,
    },
    /// Newton's method knows nothing of what constraints and muscles do.
    #[error(
        "body `{body}` has {feature}, which equilibria do not know; let it come to rest in explicit steps, with damping"
    )]
    FeatureHasNoEquilibrium {
        /// Name of the body.
        body: String,
        /// What it has.
        feature: &'static str,
    },
    /// The load is beyond what the body can bear. It is left in the last equilibrium that was found.
    #[error(
        "body `{body}` ({law}) has an equilibrium at {:.1} % of the load and none was found at {:.1} %: {failure}; \
         its cell {cell} has {volume_ratio:.3} of its volume. Load it less, stiffen it, or take a law that bears more \
         compression, such as `stable-neo-hookean`", 100.0 * load_factor, 100.0 * failed_factor
    )]
    NoEquilibrium {
        /// Name of the body.
        body: String,
        /// Name of its law.
        law: &'static str,
        /// Share of the load at the last equilibrium: 0 is where the body was, 1 the whole load.
        load_factor: f64,
        /// The least share at which none was found.
        failed_factor: f64,
        /// What happened there.
        failure: StaticFailure,
        /// The cell that has lost most of its volume at the last equilibrium.
        cell: usize,
        /// Volume of that cell over that at rest.
        volume_ratio: f64,
    },
}

/// Why Newton's method gave up at a share of the load.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StaticFailure {
    /// The residual did not fall far enough.
    #[error("the residual is still {residual:.1e} of the loads after {iterations} iterations")]
    TooManyIterations {
        /// Residual over loads and reactions.
        residual: f64,
        /// Iterations made.
        iterations: usize,
    },
    /// No step along the direction of descent lowers the energy.
    #[error("no step lowers the energy any more, with a residual of {residual:.1e} of the loads")]
    NoDescent {
        /// Residual over loads and reactions.
        residual: f64,
    },
    /// The state that was found is an equilibrium, but not a stable one.
    #[error("the smallest pivot of the stiffness is negative: the body would snap through")]
    Unstable,
    /// The state that was found has cells turned inside out.
    #[error("cell {cell} turns inside out")]
    Inverted {
        /// The first of them.
        cell: usize,
    },
    /// The linear system could not be solved.
    #[error("{0}")]
    Solver(SolverError),
}

use crate::body::BodyError;
use crate::dynamics::quasi_static::StaticError;
use crate::instrument::InstrumentError;
use crate::model::ModelKind;

/// Why a world cannot be set up so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorldError {
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
    /// The fixed sub-step is too long for a body.
    #[error(
        "body `{body}` blows up at sub-steps of {substep:.3e} s: the longest stable one is {stable:.3e} s; take that, coarser cells, softer tissue, or automatic sub-steps"
    )]
    UnstableSubstep {
        /// Name of the body.
        body: String,
        /// What was asked for [s].
        substep: f64,
        /// What would do [s].
        stable: f64,
    },
    /// Explicit steps know no damping of the stiffness: it would cost them their long steps. Quasi-static ones know none at all.
    #[error(
        "body `{body}` has stiffness damping, which explicit and quasi-static steps do not know; take an implicit integrator, or damping by mass"
    )]
    StiffnessDampingNeedsImplicit {
        /// Name of the body.
        body: String,
    },
    /// The energy–momentum scheme needs a model that knows its forces between two places.
    #[error(
        "body `{body}`: the energy-momentum scheme does not work with the model `{model}` of the law `{law}`; take \
         `total-lagrangian` cells of St Venant-Kirchhoff tissue without `keep-volume`, or another scheme"
    )]
    NoMeanForces {
        /// Name of the body.
        body: String,
        /// Name of the model.
        model: &'static str,
        /// Name of the law.
        law: &'static str,
    },
    /// The model knows nothing that implicit steps could use.
    #[error("body `{body}`: implicit steps are not for the model `{model}`: {advice}")]
    ModelNeedsExplicit {
        /// Name of the body.
        body: String,
        /// The model.
        model: ModelKind,
        /// Why, and what to do.
        advice: &'static str,
    },
    /// Implicit steps know nothing of what constraints and muscles do.
    #[error("body `{body}` has {feature}, which implicit steps do not know; take the explicit integrator")]
    FeatureNeedsExplicit {
        /// Name of the body.
        body: String,
        /// What it has.
        feature: &'static str,
    },
    /// The model cannot lose cells.
    #[error("body `{body}`: the model `{model}` cannot be cut: {advice}")]
    ModelCannotBeCut {
        /// Name of the body.
        body: String,
        /// The model.
        model: ModelKind,
        /// Why, and what to do.
        advice: &'static str,
    },
    /// An instrument that removes cells, where no body can lose any.
    #[error("no body here can lose cells to a {kind}: {advice}")]
    NothingToCut {
        /// The kind of instrument.
        kind: &'static str,
        /// Why, and what to do.
        advice: &'static str,
    },
    /// What the energy–momentum scheme keeps, it keeps only if its equations are solved in full.
    #[error("the energy-momentum scheme keeps nothing when it is linearised: solve it in full, or take another scheme")]
    LinearisedEnergyMomentum,
    /// A cell of the part that is pre-computed.
    #[error("body `{body}`: cell {cell} is pre-computed and cannot be cut; let a larger region move")]
    PrecomputedCell {
        /// Name of the body.
        body: String,
        /// The cell.
        cell: u32,
    },
    /// A cell that the body does not have.
    #[error("body `{body}` has no cell {cell}: its cells are numbered 0 to {}", cells - 1)]
    MissingCell {
        /// Name of the body.
        body: String,
        /// The number.
        cell: u32,
        /// How many cells there are.
        cells: usize,
    },
    /// The multigrid of a body knows nothing of the bodies to which it is tied.
    #[error(
        "body `{body}` cannot be attached to `{to}` under multigrid, which knows one body each; take the preconditioner `block-jacobi`"
    )]
    AttachmentNeedsBlockJacobi {
        /// Name of the body that was to be attached.
        body: String,
        /// Name of the body to which.
        to: String,
    },
    /// The equations of bodies that are tied are solved by conjugate gradients that know the ties.
    #[error(
        "body `{body}` cannot be attached to `{to}` while a factorisation solves the equilibria, as it knows one body each; take the solver `iterative`"
    )]
    AttachmentNeedsIterative {
        /// Name of the body that was to be attached.
        body: String,
        /// Name of the body to which.
        to: String,
    },
    /// What is pre-computed does not feel the impulses that hold bodies together.
    #[error(
        "body `{body}` cannot be attached: nodes of the model `{model}` do not all move by forces; take one whose nodes do"
    )]
    AttachedToPrecomputed {
        /// Name of the body.
        body: String,
        /// The model.
        model: ModelKind,
    },
    /// Between equilibria nothing pushes tissue out of a tool's way.
    #[error(
        "tools with rigid parts or a bounded grip need tissue that moves, and quasi-static steps go from rest to rest; take an explicit or \
         implicit integrator, or a grasper with neither jaws nor shaft nor bound"
    )]
    ToolsNeedMotion,
    /// A body that is to be attached to itself.
    #[error("body `{body}` cannot be attached to itself; name two bodies")]
    AttachedToItself {
        /// Name of the body.
        body: String,
    },
    /// A node that is to be attached is nowhere near the other surface.
    #[error(
        "node {node} of body `{body}` is {distance:.3e} m from the surface of `{to}`, whose triangle there has edges of \
         {edge:.3e} m; attach a region that lies on it, or move the bodies together"
    )]
    TooFarToAttach {
        /// Name of the body that was to be attached.
        body: String,
        /// Name of the body to which.
        to: String,
        /// The node.
        node: u32,
        /// How far it is [m].
        distance: f64,
        /// Longest edge of the nearest triangle [m].
        edge: f64,
    },
    /// An instrument that is not there: it was taken out, or is of another world.
    #[error("there is no instrument {instrument}; it was taken out, or belongs to another world")]
    MissingInstrument {
        /// Its number.
        instrument: usize,
    },
    /// The snapshot is of a world with other bodies or instruments.
    #[error("the snapshot belongs to a world with other bodies or instruments; restore it there")]
    ForeignSnapshot,
    /// A world cannot go on from another one whose body has other nodes or cells.
    #[error(
        "body `{body}` has another mesh there: only bodies with the same nodes and cells can go on from one another"
    )]
    OtherMesh {
        /// Name of the body.
        body: String,
    },
    /// The body makes no sense.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The instrument makes no sense.
    #[error("instrument {0}")]
    Instrument(#[from] InstrumentError),
}

/// Why a step was not made. The world is as it was before.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Numbers left the range of the precision: loads too strong for the tissue, or cells turned inside out.
    #[error(
        "at {time:.4} s body `{body}` ({law}) leaves every bound near cell {cell}: its stretch before the step is {stretch:.3}; the step is undone. {advice}"
    )]
    Diverged {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: &'static str,
        /// The most deformed cell before the step.
        cell: usize,
        /// Largest length of one of its edges over that at rest.
        stretch: f64,
        /// What to do.
        advice: &'static str,
    },
    /// The tissue is so stiff, at rest or because it is deformed, that a step would need too many sub-steps.
    #[error(
        "at {time:.4} s body `{body}` ({law}) would need {substeps:.1e} sub-steps in one step of {step:.1e} s; cell {cell} is stretched {stretch:.3} times, most of all; the step is undone. {advice}"
    )]
    TooStiff {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: &'static str,
        /// The most deformed cell.
        cell: usize,
        /// Largest length of one of its edges over that at rest.
        stretch: f64,
        /// How many it would need.
        substeps: f64,
        /// Length of the step [s].
        step: f64,
        /// What to do.
        advice: &'static str,
    },
    /// A volume that is to be kept exactly cannot be.
    #[error(
        "at {time:.4} s the volume `{volume}` of body `{body}` cannot be kept: {error:.1e} of it is missing or too much; the step is undone. Let more of its nodes move freely, or take it apart from the volumes that share nodes with it"
    )]
    VolumeNotKept {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Name of the volume.
        volume: String,
        /// (V − V0)/V0 that is left.
        error: f64,
    },
    /// The equations of an implicit step were not solved in the iterations that were allowed, in 64 and more parts of it neither. Forces without a
    /// potential, of which there may be no solution, take linearised parts then and no error.
    #[error(
        "at {time:.4} s the step of body `{body}` ({law}) does not converge: after {iterations} iterations of Newton's \
         method {residual:.1e} of its forces are left; the step is undone. Take a shorter step, more iterations (of the \
         linear solver too), or the linearised step"
    )]
    NotConverged {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: &'static str,
        /// Iterations of Newton's method.
        iterations: u32,
        /// What is left of the forces, over those that balance.
        residual: f64,
    },
    /// Whatever was found gains energy from nobody, more than its scheme does, in 64 and more parts of the step too: solutions of the full equations,
    /// the linearised parts that stand in for those that have none, or linearised parts that gain nine times the energy before the step.
    #[error(
        "at {time:.4} s the step of body `{body}` ({law}) throws tissue across a hump of its energy, most of it near cell {cell}, \
         which is stretched {stretch:.3} times before the step: all ways that were found gain energy; the step is undone. Take a \
         shorter step, or {advice}, or let the tissue go from less far"
    )]
    GainedEnergy {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// Name of the law.
        law: &'static str,
        /// The most deformed cell before the step.
        cell: usize,
        /// Largest length of one of its edges over that at rest.
        stretch: f64,
        /// Settings that bear such a step.
        advice: &'static str,
    },
    /// There is no equilibrium to go on to, or none was found.
    #[error("at {time:.4} s {error}; the step is undone")]
    NoEquilibrium {
        /// Time at the beginning of the step [s].
        time: f64,
        /// What was found instead.
        error: StaticError,
    },
    /// The fixed sub-step has stopped being stable.
    #[error(
        "at {time:.4} s sub-steps of {substep:.3e} s are no longer stable for body `{body}`, which has stiffened: {stable:.3e} s would do; the step is undone. Take that, or automatic sub-steps"
    )]
    UnstableSubstep {
        /// Time at the beginning of the step [s].
        time: f64,
        /// Name of the body.
        body: String,
        /// What was asked for [s].
        substep: f64,
        /// What would do [s].
        stable: f64,
    },
}

//! Bodies: what a user describes ([`Body`]), and what a world simulates ([`SimulatedBody`]).

mod actuator;
mod boundary;
mod constrained;
mod deformation;
mod error;
mod external;
mod field;
mod followers;
mod guide;
mod influence;
mod internal;
mod load;
mod model_plan;
mod muscle;
mod placement;
mod removals;
mod simulated;
mod skin;
mod state;
mod static_answer;
mod static_report;
mod stress;
mod supports;

pub(crate) use actuator::Actuators;
pub use actuator::{Actuator, ActuatorLine};
pub use boundary::SurfaceTriangle;
pub use constrained::KeptVolumeNow;
pub use error::BodyError;
pub(crate) use external::ExternalStiffness;
pub(crate) use followers::Followers;
pub(crate) use guide::Guides;
pub(crate) use influence::Drivers;
pub(crate) use internal::find_forces;
pub use load::Load;
pub(crate) use load::{LoadError, NodalLoads};
pub(crate) use model_plan::{ModelPlan, Models};
pub use muscle::Muscle;
pub(crate) use muscle::Muscles;
pub use removals::Removals;
pub use simulated::SimulatedBody;
pub(crate) use simulated::free_directions;
pub use state::{BodyState, NodeMotion, PastState};
pub(crate) use state::{Driven, MotionBackup, Still};
pub(crate) use static_answer::StaticAnswer;
pub use static_report::{LoadStep, StaticReport};

use crate::curve::Curve;
use crate::math::Vec3;
use crate::mesh::{Region, VolumeMesh};
use crate::model::ModelRecipe;

/// A body to be added to a world: a mesh, its tissue, and what holds and pulls it.
///
/// ```
/// use viscera::body::Body;
/// use viscera::material::{StVenantKirchhoff, Tissue};
/// use viscera::mesh::{Region, TetMesh};
/// use viscera::model::TensorMass;
/// use viscera::world::{World, WorldConfig};
///
/// let mesh = TetMesh::box_grid([2, 2, 8], [0.1, 0.1, 0.4]); // m
/// let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(10e3, 0.45)?); // Pa
/// let mut world = World::<f64>::new(WorldConfig::default())?;
/// let bar = world.add(
///     Body::new(mesh, 1000.0 /* kg/m³ */)
///         .model(TensorMass::new(tissue))
///         .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0)),
/// )?;
/// world.step()?;
/// assert!(world.body(bar).max_displacement() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Body {
    pub(crate) name: String,
    pub(crate) mesh: VolumeMesh,
    /// Density [kg/m³]: one number, or one for each cell.
    pub(crate) density: Vec<f64>,
    pub(crate) model: Option<Box<dyn ModelRecipe>>,
    pub(crate) keep_volume: f64,
    pub(crate) damping: f64,
    pub(crate) stiffness_damping: f64,
    pub(crate) fixed: Vec<Region>,
    pub(crate) prescribed: Vec<(Region, Curve<Vec3<f64>>)>,
    pub(crate) guided: Vec<(Region, [f64; 3], Curve<f64>)>,
    pub(crate) loads: Vec<Load>,
    pub(crate) muscles: Vec<Muscle>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) exact_volumes: Vec<(String, Region)>,
    pub(crate) rigid: Vec<Region>,
    pub(crate) loose_pieces: LoosePieces,
}

/// What becomes of a piece that a cut has separated from everything that holds it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoosePieces {
    /// It goes on as a free body.
    #[default]
    Free,
    /// Its cells are removed.
    Drop,
}

impl Body {
    /// A body of `density` [kg/m³, > 0], undamped, unloaded and held by nothing.
    pub fn new(mesh: impl Into<VolumeMesh>, density: f64) -> Self {
        Self {
            name: "body".into(),
            mesh: mesh.into(),
            density: vec![density],
            model: None,
            keep_volume: 0.0,
            damping: 0.0,
            stiffness_damping: 0.0,
            fixed: Vec::new(),
            prescribed: Vec::new(),
            guided: Vec::new(),
            loads: Vec::new(),
            muscles: Vec::new(),
            actuators: Vec::new(),
            exact_volumes: Vec::new(),
            rigid: Vec::new(),
            loose_pieces: LoosePieces::default(),
        }
    }

    /// The name by which messages call it.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// One density for each cell [kg/m³, > 0].
    pub fn densities(mut self, densities: Vec<f64>) -> Self {
        self.density = densities;
        self
    }

    /// The force model. There is no default: a body without one is refused.
    pub fn model(mut self, recipe: impl ModelRecipe + 'static) -> Self {
        self.model = Some(Box::new(recipe));
        self
    }

    /// The force model, chosen while the program runs.
    pub fn boxed_model(mut self, recipe: Box<dyn ModelRecipe>) -> Self {
        self.model = Some(recipe);
        self
    }

    /// Stiffness of the volume-keeping force on each tetrahedron [Pa, ≥ 0]; 0, the default, is none.
    pub fn keep_volume(mut self, kappa: f64) -> Self {
        self.keep_volume = kappa;
        self
    }

    /// Damping rate [1/s, ≥ 0]: γ_i = rate · m_i; 0, the default, is none.
    pub fn damping(mut self, rate: f64) -> Self {
        self.damping = rate;
        self
    }

    /// Damping of the tissue's stiffness [s, ≥ 0]: α of Rayleigh's C = α K + β M, whose β is [`Body::damping`]. It damps a vibration
    /// of frequency ω at the ratio αω/2. 0, the default, is none. Implicit steps only.
    pub fn stiffness_damping(mut self, time: f64) -> Self {
        self.stiffness_damping = time;
        self
    }

    /// Holds the nodes of a region where they are.
    pub fn fix(mut self, region: Region) -> Self {
        self.fixed.push(region);
        self
    }

    /// Moves the nodes of a region: their displacement from rest [m] along time [s]. Where regions overlap, the last
    /// one counts; fixed regions count before prescribed ones.
    pub fn prescribe(mut self, region: Region, displacement: Curve<Vec3<f64>>) -> Self {
        self.prescribed.push((region, displacement));
        self
    }

    /// Lets the nodes of a region move across `normal` only: a symmetry plane, a roller. Where slides of several normals meet,
    /// nodes move along their line, or not at all.
    pub fn slide(self, region: Region, normal: [f64; 3]) -> Self {
        self.prescribe_along(region, normal, Curve::constant(0.0))
    }

    /// Moves the nodes of a region along `normal`: that part of their displacement from rest [m] along time [s]. Across it
    /// they follow the forces. Fixed and prescribed regions count before it.
    pub fn prescribe_along(mut self, region: Region, normal: [f64; 3], displacement: Curve<f64>) -> Self {
        self.guided.push((region, normal, displacement));
        self
    }

    /// Pulls or presses on a region.
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Adds a membrane of muscle. Explicit steps only.
    pub fn muscle(mut self, muscle: Muscle) -> Self {
        self.muscles.push(muscle);
        self
    }

    /// Adds a linear actuator between two regions, or along a direction in the cells of one. Not for models that are pre-computed.
    pub fn actuator(mut self, actuator: Actuator) -> Self {
        self.actuators.push(actuator);
        self
    }

    /// Keeps the common volume of the cells of a region to rounding, in every sub-step: what an incompressible filling would do,
    /// that flows freely inside. Messages and observables call it by `name`. A cut takes along the volume that its cells have at
    /// that moment. Explicit steps only.
    pub fn keep_volume_exactly(mut self, name: impl Into<String>, region: Region) -> Self {
        self.exact_volumes.push((name.into(), region));
        self
    }

    /// Lets the nodes of a region move as one rigid body, with their mass and its moments of inertia. They may be neither fixed,
    /// prescribed nor guided, in one part only, and not all in a line. What an instrument does to a node of it, it does to the
    /// whole. Explicit steps only.
    pub fn rigid(mut self, region: Region) -> Self {
        self.rigid.push(region);
        self
    }

    /// What becomes of pieces that a cut separates.
    pub fn loose_pieces(mut self, choice: LoosePieces) -> Self {
        self.loose_pieces = choice;
        self
    }
}

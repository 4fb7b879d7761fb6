//! Every force model of every law on both kinds of cells, and every integrator; which of them the engine refuses.

use viscera::body::{Body, BodyError};
use viscera::dynamics::implicit::{Implicit, Newton, Scheme};
use viscera::material::{Lame, LawFamily, LawKind, LawVisitor, Tissue};
use viscera::math::Mat3;
use viscera::mesh::VolumeMesh;
use viscera::model::{Claims, ModelError, ModelKind};
use viscera::solver::Stop;
use viscera::world::{Integrator, Substep, WorldError};

use crate::ValidationError;
use crate::setting::Cells;

/// A force model of a law on a kind of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Combination {
    /// The force model.
    pub model: ModelKind,
    /// The law.
    pub law: LawKind,
    pub(crate) cells: Cells,
}

impl Combination {
    /// All there are, those that the engine refuses included.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let laws = |model| LawKind::ALL.iter().map(move |&law| (model, law));
        let pairs = ModelKind::ALL.iter().flat_map(move |&model| laws(model));
        pairs.flat_map(|(model, law)| [Cells::Six, Cells::Hexahedra].map(|cells| Self { model, law, cells }))
    }

    /// Those that the registry says work, and whose bodies move.
    pub(super) fn able() -> impl Iterator<Item = Self> {
        Self::all().filter(|combination| combination.is_able() && combination.model.info().moves)
    }

    /// Whether the registry says that it works.
    pub fn is_able(self) -> bool {
        let info = self.model.info();
        info.laws.contains(&self.law) && (info.hexahedra || self.cells == Cells::Six)
    }

    pub(super) fn claims(self) -> Claims {
        self.model.claims(self.law, self.cells == Cells::Hexahedra)
    }

    /// Whether the forces have a potential, so that energy means something. That of shape memory jumps where neighbours are turned
    /// inside out.
    pub fn has_energy(self) -> bool {
        self.claims().conservative && self.model != ModelKind::ShapeMemory
    }

    pub(super) fn name(self) -> String {
        let cells = if self.cells == Cells::Hexahedra { ", hexahedra" } else { "" };
        format!("{} of {}{cells}", self.model, self.law)
    }

    /// Whether the tissue looks the same in a mirror: turned inside out, it is as content as before. So are springs.
    pub fn is_blind_to_reflections(self) -> bool {
        self.model == ModelKind::MassSpring || self.law.is_blind_to_reflections() && self.claims().objective
    }

    /// A body of tissue of this stiffness [Pa] and density [kg/m³], whatever the units.
    pub(super) fn body(self, mesh: VolumeMesh, stiffness: Stiffness, density: f64) -> Result<Body, ValidationError> {
        self.turned_body(mesh, stiffness, density, &Mat3::IDENTITY)
    }

    /// The same with the fibres turned.
    pub(super) fn turned_body(
        self,
        mesh: VolumeMesh,
        stiffness: Stiffness,
        density: f64,
        turn: &Mat3<f64>,
    ) -> Result<Body, ValidationError> {
        let tissue = stiffness.turned(self.law, turn)?;
        Ok(Body::new(mesh, density).boxed_model(self.model.recipe(tissue)))
    }
}

/// How stiff tissue is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stiffness {
    /// Young's modulus [Pa].
    pub(super) young: f64,
    /// Poisson's ratio.
    pub(super) poisson: f64,
}

impl Stiffness {
    /// Soft, and compressible enough for every element.
    pub(super) const SOFT: Self = Self { young: 10e3, poisson: 0.4 };

    /// Tissue of a law; fibres as stiff against the rest as those of the law's example.
    pub(super) fn of(self, law: LawKind) -> Result<Tissue, ValidationError> {
        self.turned(law, &Mat3::IDENTITY)
    }

    fn turned(self, law: LawKind, turn: &Mat3<f64>) -> Result<Tissue, ValidationError> {
        struct Stiff<'a> {
            lame: Lame,
            young: f64,
            turn: &'a Mat3<f64>,
        }
        impl LawVisitor for Stiff<'_> {
            type Output = Tissue;
            fn visit<L: LawFamily>(self) -> Tissue {
                let stiffer = self.young / L::example().at_rest().lame.young();
                let direction = *self.turn * L::example().at_rest().direction;
                let values = L::PARAMETERS.iter().zip(L::example().values()).map(|(parameter, value)| {
                    match (parameter.name, parameter.unit) {
                        ("lambda", _) => self.lame.lambda,
                        ("mu", _) => self.lame.mu,
                        ("direction-x", _) => direction.x,
                        ("direction-y", _) => direction.y,
                        ("direction-z", _) => direction.z,
                        (_, "Pa") => value * stiffer,
                        _ => value,
                    }
                });
                Tissue::uniform(L::from_values(&values.collect::<Vec<_>>()))
            }
        }
        let Self { young, poisson } = self;
        Ok(law.visit(Stiff { lame: Lame::from_young_poisson(young, poisson)?, young, turn }))
    }
}

/// An integrator and what to call it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    pub(super) integrator: Integrator,
}

impl Method {
    pub(super) const EXPLICIT: Self = Self { name: "explicit", integrator: Integrator::Explicit(Substep::Automatic) };

    /// Every integrator: explicit, and every implicit scheme, linearised and solved in full.
    pub(super) fn all() -> Vec<Self> {
        let linearised = |name, scheme| Self::implicit(name, scheme, Newton::Linearised);
        let full = |name, scheme| Self::implicit(name, scheme, Newton::Full { relative: 1e-8, at_most: 100 });
        let newmark = Scheme::AVERAGE_ACCELERATION;
        vec![
            Self::EXPLICIT,
            linearised("backward Euler, linearised", Scheme::BackwardEuler),
            full("backward Euler, full Newton", Scheme::BackwardEuler),
            linearised("Newmark, linearised", newmark),
            full("Newmark, full Newton", newmark),
            linearised("BDF2, linearised", Scheme::Bdf2),
            full("BDF2, full Newton", Scheme::Bdf2),
            linearised("energy–momentum, linearised", Scheme::EnergyMomentum),
            full("energy–momentum, full Newton", Scheme::EnergyMomentum),
        ]
    }

    fn implicit(name: &'static str, scheme: Scheme, newton: Newton) -> Self {
        let linear = Stop::Tolerance { relative: 1e-6, at_most: 100 };
        let settings = Implicit { scheme, newton, linear, ..Implicit::default() };
        Self { name, integrator: Integrator::Implicit(settings) }
    }

    fn implicit_settings(self) -> Option<Implicit> {
        match self.integrator {
            Integrator::Implicit(settings) => Some(settings),
            Integrator::Explicit(_) | Integrator::QuasiStatic(_) => None,
        }
    }

    /// Backward Euler whose equations are solved in full: never gains energy.
    pub fn never_gains(self) -> bool {
        self.implicit_settings()
            .is_some_and(|own| own.scheme == Scheme::BackwardEuler && own.newton != Newton::Linearised)
    }

    /// Linearised backward Euler: stays bounded.
    pub fn stays_bounded(self) -> bool {
        self.implicit_settings()
            .is_some_and(|own| own.scheme == Scheme::BackwardEuler && own.newton == Newton::Linearised)
    }
}

/// How the engine says that something does not work together: by an error of a type made for that.
pub(super) fn refusal(error: &ValidationError) -> Option<&'static str> {
    match error {
        ValidationError::World(WorldError::NoMeanForces { .. }) => Some("no mean forces"),
        ValidationError::World(WorldError::ModelNeedsExplicit { .. }) => Some("implicit steps not for the model"),
        ValidationError::World(WorldError::LinearisedEnergyMomentum) => Some("linearised energy–momentum"),
        ValidationError::World(WorldError::Body(BodyError::Model { source, .. })) => match source {
            ModelError::UnsupportedLaw { .. } => Some("law not supported"),
            ModelError::UnsupportedCells { .. } => Some("cells not supported"),
            _ => None,
        },
        _ => None,
    }
}

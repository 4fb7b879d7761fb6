//! The only list of force models.

use super::{
    Corotational, Hybrid, LinearTensorMass, MassSpring, ModelError, ModelRecipe, NodallyIntegrated, Precomputed,
    ShapeMemory, StiffnessWarping, TensorMass, TotalLagrangian,
};
use crate::material::{LawKind, Tissue};

/// What a user should know about a model before choosing it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelInfo {
    /// Name in scenes and messages.
    pub name: &'static str,
    /// What it is good for, in a sentence.
    pub purpose: &'static str,
    /// Whether it works on hexahedra too.
    pub hexahedra: bool,
    /// The laws that it computes.
    pub laws: &'static [LawKind],
    /// Whether its bodies move in time; those of the others rest at the end of every step, and something has to hold them.
    pub moves: bool,
    /// Why implicit steps and equilibria are not for it, and what to take instead; none where they are.
    pub no_implicit: Option<&'static str>,
    /// Why no cell can be cut out of it, and what to take instead; none where cells can.
    pub no_cutting: Option<&'static str>,
    /// What tools do not do to its bodies; none where they do all they can.
    pub tool_limits: Option<&'static str>,
}

/// What holds for a model of a law with its default settings; the conformance suites test all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claims {
    /// It is another text of the total-Lagrangian model of the law: same forces, products and energy.
    pub of_the_law: bool,
    /// Turning the body turns the forces and keeps the energy.
    pub objective: bool,
    /// Internal forces have no net force.
    pub force_free: bool,
    /// Internal forces have no net torque.
    pub torque_free: bool,
    /// Homogeneous deformation leaves inner nodes without force, whatever the mesh.
    pub passes_patch_test: bool,
    /// Forces are the gradient of the energy.
    pub conservative: bool,
    /// Products are the derivative of the forces.
    pub exact_products: bool,
}

impl Claims {
    /// What holds for a model that computes `law` and nothing else.
    pub fn of_law(law: LawKind) -> Self {
        let objective = law.is_objective();
        Self {
            of_the_law: true,
            objective,
            force_free: true,
            torque_free: objective,
            passes_patch_test: true,
            conservative: true,
            exact_products: true,
        }
    }
}

/// The claims of the models that compute their law and nothing else.
fn whatever_the_cells(law: LawKind, _hexahedra: bool) -> Claims {
    Claims::of_law(law)
}

/// The claims of nets of points that know Young's modulus alone: an energy, and no law of matter.
fn without_a_law(_law: LawKind, _hexahedra: bool) -> Claims {
    Claims {
        of_the_law: false,
        objective: true,
        force_free: true,
        torque_free: true,
        passes_patch_test: false,
        conservative: true,
        exact_products: true,
    }
}

macro_rules! models {
    ($($recipe:ident: $claims:expr),+ $(,)?) => {
        /// Every force model, by kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum ModelKind {
            $(
                #[doc = concat!("[`", stringify!($recipe), "`].")]
                $recipe,
            )+
        }

        impl ModelKind {
            /// Every model there is.
            pub const ALL: &'static [Self] = &[$(Self::$recipe),+];

            /// What it is.
            pub fn info(self) -> ModelInfo {
                match self {
                    $(Self::$recipe => $recipe::INFO,)+
                }
            }

            /// What holds for it when it computes `law`, on hexahedra or on tetrahedra.
            pub fn claims(self, law: LawKind, hexahedra: bool) -> Claims {
                match self {
                    $(Self::$recipe => $claims(law, hexahedra),)+
                }
            }

            /// The model with its default settings, for this tissue.
            pub fn recipe(self, tissue: Tissue) -> Box<dyn ModelRecipe> {
                match self {
                    $(Self::$recipe => Box::new($recipe::new(tissue)),)+
                }
            }
        }
    };
}

models!(
    LinearTensorMass: whatever_the_cells,
    TensorMass: whatever_the_cells,
    TotalLagrangian: whatever_the_cells,
    NodallyIntegrated: NodallyIntegrated::claims,
    Corotational: Corotational::claims,
    StiffnessWarping: StiffnessWarping::claims,
    MassSpring: without_a_law,
    ShapeMemory: without_a_law,
    Precomputed: whatever_the_cells,
    Hybrid: whatever_the_cells,
);

impl ModelKind {
    /// Refuses a law that it does not compute, with what to take instead.
    pub(super) fn check_law(self, law: LawKind, advice: &'static str) -> Result<(), ModelError> {
        if self.info().laws.contains(&law) {
            Ok(())
        } else {
            Err(ModelError::UnsupportedLaw { model: self, law, advice })
        }
    }
}

impl std::fmt::Display for ModelKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.info().name)
    }
}

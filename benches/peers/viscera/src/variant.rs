use serde_json::{Value, json};
use viscera::dynamics::implicit::Implicit;
use viscera::material::{LinearElastic, MaterialError, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::model::{Corotational, ModelRecipe, NodallyIntegrated, TotalLagrangian};
use viscera::solver::Stop;
use viscera::world::Integrator;
use viscera_peers_protocol::Case;

use crate::Reference;

/// Iterations of the conjugate gradient in an implicit step.
const ITERATIONS: u32 = 25;

/// A model and an integrator of ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// Total-Lagrangian St Venant–Kirchhoff, explicit.
    StVenantKirchhoff,
    /// Total-Lagrangian stable neo-Hookean, explicit.
    StableNeoHookean,
    /// Stable neo-Hookean, integrated at the nodes, explicit.
    NodallyIntegrated,
    /// Corotational, implicit.
    Corotational,
}

impl Variant {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::StVenantKirchhoff, Self::StableNeoHookean, Self::NodallyIntegrated, Self::Corotational];

    /// As the comparison calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::StVenantKirchhoff => "total-lagrangian St Venant-Kirchhoff",
            Self::StableNeoHookean => "total-lagrangian neo-Hookean",
            Self::NodallyIntegrated => "nodally-integrated neo-Hookean",
            Self::Corotational => "corotational",
        }
    }

    /// The static solution that it is compared with: the same law and element.
    pub fn reference(self) -> Reference {
        match self {
            Self::StVenantKirchhoff => Reference::StVenantKirchhoff,
            Self::StableNeoHookean => Reference::StableNeoHookean,
            Self::NodallyIntegrated => Reference::NodallyIntegrated,
            Self::Corotational => Reference::Corotational,
        }
    }

    pub(crate) fn about(self) -> Value {
        let (law, note) = match self {
            Self::StVenantKirchhoff => ("St Venant-Kirchhoff", ""),
            Self::StableNeoHookean => ("stable neo-Hookean", ""),
            Self::NodallyIntegrated => ("stable neo-Hookean", "tetrahedra that do not lock"),
            Self::Corotational => ("corotational", ""),
        };
        let implicit = self == Self::Corotational;
        let scheme = if implicit { format!("implicit, {ITERATIONS} iterations of CG") } else { "explicit".to_owned() };
        json!({
            "name": self.name(),
            "law": law,
            "scheme": scheme,
            "precision": "f32",
            "reference": self.reference().name(),
            "note": note,
            // Explicit steps are divided by the engine itself, as its bound of the highest frequency asks.
            "chooses_step": !implicit,
        })
    }

    pub(crate) fn recipe(self, case: &Case) -> Result<Box<dyn ModelRecipe>, MaterialError> {
        let (young, poisson) = (case.tissue.young, case.tissue.poisson);
        Ok(match self {
            Self::StVenantKirchhoff => {
                Box::new(TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(young, poisson)?)))
            }
            Self::StableNeoHookean => {
                Box::new(TotalLagrangian::new(Tissue::uniform(StableNeoHookean::from_young_poisson(young, poisson)?)))
            }
            Self::NodallyIntegrated => {
                Box::new(NodallyIntegrated::new(Tissue::uniform(StableNeoHookean::from_young_poisson(young, poisson)?)))
            }
            Self::Corotational => {
                Box::new(Corotational::new(Tissue::uniform(LinearElastic::from_young_poisson(young, poisson)?)))
            }
        })
    }

    pub(crate) fn integrator(self) -> Integrator {
        match self {
            Self::Corotational => {
                Integrator::Implicit(Implicit { linear: Stop::Iterations(ITERATIONS), ..Implicit::default() })
            }
            _ => Integrator::default(),
        }
    }
}

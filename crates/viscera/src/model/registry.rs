//! The only list of force models.

use super::{LinearTensorMass, ModelRecipe, TensorMass, TotalLagrangian};
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
}

macro_rules! models {
    ($($recipe:ident),+ $(,)?) => {
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

            /// The model with its default settings, for this tissue.
            pub fn recipe(self, tissue: Tissue) -> Box<dyn ModelRecipe> {
                match self {
                    $(Self::$recipe => Box::new($recipe::new(tissue)),)+
                }
            }
        }
    };
}

models!(LinearTensorMass, TensorMass, TotalLagrangian);

impl std::fmt::Display for ModelKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.info().name)
    }
}

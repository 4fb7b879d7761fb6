//! The only list of laws.

use serde::{Deserialize, Serialize};

use super::{
    LawFamily, LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, TransverseLinear,
    TransverseStVenantKirchhoff,
};
use crate::math::Mat3;

/// Something that is done for one law, whichever it is: the way from a [`LawKind`] back to its type.
pub trait LawVisitor {
    /// What comes of it.
    type Output;
    /// Does it for the law `L`.
    fn visit<L: LawFamily>(self) -> Self::Output;
}

macro_rules! laws {
    ($($law:ident),+ $(,)?) => {
        /// Every law, by kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum LawKind {
            $(
                #[doc = concat!("[`", stringify!($law), "`].")]
                $law,
            )+
        }

        impl LawKind {
            /// Every law there is.
            pub const ALL: &'static [Self] = &[$(Self::$law),+];

            /// Name in scenes and messages.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$law => <$law as LawFamily>::NAME,)+
                }
            }

            /// Does something for the type that this kind stands for.
            pub fn visit<V: LawVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$law => visitor.visit::<$law>(),)+
                }
            }
        }

        $(
            impl From<$law> for LawKind {
                fn from(_: $law) -> Self {
                    Self::$law
                }
            }
        )+
    };
}

laws!(LinearElastic, StVenantKirchhoff, TransverseLinear, TransverseStVenantKirchhoff, NeoHookean, StableNeoHookean,);

impl LawKind {
    /// The law that brings tissue back from every deformation, whatever was done to it.
    pub const TURNS_BACK: Self = Self::StableNeoHookean;

    /// Whether the law takes rotations for what they are: the energy of R F is that of F.
    pub fn is_objective(self) -> bool {
        struct IsObjective;
        impl LawVisitor for IsObjective {
            type Output = bool;
            fn visit<L: LawFamily>(self) -> bool {
                L::OBJECTIVE
            }
        }
        self.visit(IsObjective)
    }

    /// Whether the law cannot tell a cell from its mirror image: one that is turned inside out is as content as at rest, and
    /// stays so.
    pub fn is_blind_to_reflections(self) -> bool {
        struct OfMirrored;
        impl LawVisitor for OfMirrored {
            type Output = f64;
            fn visit<L: LawFamily>(self) -> f64 {
                L::example().energy(&Mat3::diagonal(-1.0))
            }
        }
        self.visit(OfMirrored) == 0.0
    }
}

impl std::fmt::Display for LawKind {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

//! What every law of λ and μ alone has in common: how it is made, and what the engine asks of it.

/// Makes a law family of a struct with the fields `lambda` and `mu`: its name, whether it is objective, and the strain in which
/// it is quadratic, if it is.
macro_rules! lame_law {
    ($law:ident, $name:literal, objective: $objective:literal, quadratic: $strain:expr) => {
        impl $law {
            /// From the Lamé parameters of small strains.
            pub fn new(lame: $crate::material::Lame) -> Self {
                Self { lambda: lame.lambda, mu: lame.mu }
            }

            /// From Young's modulus [Pa] and Poisson's ratio of small strains.
            ///
            /// # Errors
            /// As [`Lame::from_young_poisson`](crate::material::Lame::from_young_poisson).
            pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, $crate::material::MaterialError> {
                $crate::material::Lame::from_young_poisson(young, poisson).map(Self::new)
            }
        }

        impl $crate::material::LawFamily for $law {
            type At<R: $crate::math::Real> = $law<R>;

            const NAME: &'static str = $name;
            const PARAMETERS: &'static [$crate::material::Parameter] =
                &[$crate::material::Parameter::LAMBDA, $crate::material::Parameter::MU];
            const OBJECTIVE: bool = $objective;

            #[inline(always)]
            fn at<R: $crate::math::Real>(values: &[R]) -> $law<R> {
                $law { lambda: values[0], mu: values[1] }
            }

            fn from_values(values: &[f64]) -> Self {
                Self::at(values)
            }

            fn values(&self) -> Vec<f64> {
                vec![self.lambda, self.mu]
            }

            fn example() -> Self {
                Self::new($crate::material::Lame::EXAMPLE)
            }

            fn at_rest(&self) -> $crate::material::RestStiffness {
                let lame = $crate::material::Lame { lambda: self.lambda, mu: self.mu };
                $crate::material::RestStiffness::isotropic(lame)
            }

            fn quadratic(&self) -> Option<$crate::material::QuadraticLaw> {
                let strain: Option<$crate::material::StrainMeasure> = $strain;
                strain.map(|strain| $crate::material::QuadraticLaw { strain, stiffness: self.at_rest() })
            }
        }
    };
}
pub(super) use lame_law;

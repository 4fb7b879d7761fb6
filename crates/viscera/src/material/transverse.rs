//! One family of fibres in an isotropic matrix: transversely isotropic forms of the two quadratic laws.
//!
//! ψ = ψ_iso(E) + κ_a (a0·E a0)²,   κ_a = (λ_L − λ)/2 + μ_L − μ,   |a0| = 1
//! S = S_iso + 2κ_a (a0·E a0) a0 a0ᵀ
//!
//! with E Green's strain (St Venant–Kirchhoff) or the small strain (linear). λ_L, μ_L are the Lamé parameters along the
//! fibre.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 3; ICRA 2001.

use super::{
    Lame, Law, LawFamily, LinearElastic, MaterialError, Parameter, QuadraticLaw, RestStiffness, StVenantKirchhoff,
    StrainMeasure, green_strain, small_strain,
};
use crate::math::{Mat3, Real, Sym3, Vec3};

/// A fibre direction and what it adds to the stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibre<R = f64> {
    /// Unit direction a0 at rest.
    pub direction: Vec3<R>,
    /// κ_a [Pa]; negative for fibres softer than the matrix.
    pub stiffness: R,
}

impl Fibre {
    /// Oblique fibres, twice as stiff along themselves as [`Lame::EXAMPLE`] is: κ_a = E/2.
    const EXAMPLE: Self = Self { direction: Vec3::new(2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0), stiffness: 2.5e3 };

    /// Fibres along `direction` (any length but zero) with the Lamé parameters `longitudinal` along them, in a matrix
    /// with `transverse` ones.
    ///
    /// # Errors
    /// [`MaterialError::NoDirection`]; [`MaterialError::OutOfRange`] where fibres so soft would make the tissue unstable:
    /// the stiffness C + 2κ_a a0a0⊗a0a0 is positive as long as 1 + 2κ_a a0a0:C⁻¹:a0a0 = 1 + 2κ_a/E is.
    pub fn new(direction: [f64; 3], longitudinal: Lame, transverse: Lame) -> Result<Self, MaterialError> {
        let unit = Vec3::from(direction).normalized().ok_or(MaterialError::NoDirection { direction })?;
        let stiffness = 0.5 * (longitudinal.lambda - transverse.lambda) + longitudinal.mu - transverse.mu;
        let young = transverse.young();
        if young + 2.0 * stiffness <= 0.0 {
            return Err(MaterialError::OutOfRange {
                name: "fibre stiffness",
                value: stiffness,
                range: "above -E/2, half the matrix's Young's modulus [Pa]",
                hint: "; make the fibres stiffer or the matrix softer",
            });
        }
        Ok(Self { direction: unit, stiffness })
    }
}

impl<R: Real> Fibre<R> {
    #[inline(always)]
    fn stretch_strain(&self, strain: Sym3<R>) -> R {
        strain.quadratic(self.direction)
    }

    #[inline(always)]
    fn energy(&self, strain: Sym3<R>) -> R {
        self.stiffness * self.stretch_strain(strain).squared()
    }

    #[inline(always)]
    fn stress(&self, strain: Sym3<R>) -> Sym3<R> {
        Sym3::square(self.direction) * (self.stiffness * self.stretch_strain(strain)).double()
    }

    /// The bound of what fibres of 2κ_a = `stiffness` add, for one of the largest eigenvalue of C, `stretch`, and their strain: S = 2κ_a s a0 a0ᵀ,
    /// whose largest eigenvalue is 2κ_a s or nothing.
    #[inline(always)]
    pub(crate) fn bound_of(stiffness: R, stretch: R, strain: R) -> R {
        let zero = stiffness.zero_like();
        stretch.mul_add(stiffness.max(zero), (stiffness * strain).max(zero))
    }

    /// 2κ_a, where it stiffens.
    #[inline(always)]
    fn stiffness_bound(&self) -> R {
        self.stiffness.double().max(self.stiffness.zero_like())
    }

    #[inline(always)]
    fn at(values: &[R]) -> Self {
        Self { direction: Vec3::new(values[0], values[1], values[2]), stiffness: values[3] }
    }
}

const PARAMETERS: &[Parameter] = &[
    Parameter::LAMBDA,
    Parameter::MU,
    Parameter::DIRECTION[0],
    Parameter::DIRECTION[1],
    Parameter::DIRECTION[2],
    Parameter::FIBRE_STIFFNESS,
];

/// Linear elasticity with one family of fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransverseLinear<R = f64> {
    /// The matrix between the fibres.
    pub matrix: LinearElastic<R>,
    /// The fibres.
    pub fibre: Fibre<R>,
}

impl<R: Real> Law<R> for TransverseLinear<R> {
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        self.matrix.energy(f) + self.fibre.energy(small_strain(f))
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        self.matrix.stress(f) + self.fibre.stress(small_strain(f)).into()
    }

    #[inline(always)]
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        self.matrix.tangent(f, df) + self.fibre.stress(df.symmetric_part()).into()
    }

    #[inline(always)]
    fn stiffness_bound(&self, f: &Mat3<R>) -> R {
        self.matrix.stiffness_bound(f) + self.fibre.stiffness_bound()
    }
}

/// St Venant–Kirchhoff elasticity with one family of fibres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransverseStVenantKirchhoff<R = f64> {
    /// The matrix between the fibres.
    pub matrix: StVenantKirchhoff<R>,
    /// The fibres.
    pub fibre: Fibre<R>,
}

impl<R: Real> Law<R> for TransverseStVenantKirchhoff<R> {
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        self.matrix.energy(f) + self.fibre.energy(green_strain(f))
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        self.matrix.stress(f) + *f * self.fibre.stress(green_strain(f))
    }

    #[inline(always)]
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let d_strain = (f.transpose() * *df).symmetric_part();
        self.matrix.tangent(f, df) + *df * self.fibre.stress(green_strain(f)) + *f * self.fibre.stress(d_strain)
    }

    #[inline(always)]
    fn stiffness_bound(&self, f: &Mat3<R>) -> R {
        let stretch = f.gram().largest_eigenvalue_bound();
        let strain = green_strain(f).quadratic(self.fibre.direction);
        self.matrix.stiffness_bound(f) + Fibre::bound_of(self.fibre.stiffness.double(), stretch, strain)
    }
}

macro_rules! transverse_family {
    ($law:ident, $matrix:ident, $name:expr, $objective:expr, $strain:expr) => {
        impl LawFamily for $law {
            type At<R: Real> = $law<R>;

            const NAME: &'static str = $name;
            const PARAMETERS: &'static [Parameter] = PARAMETERS;
            const OBJECTIVE: bool = $objective;

            #[inline(always)]
            fn at<R: Real>(values: &[R]) -> $law<R> {
                $law { matrix: $matrix { lambda: values[0], mu: values[1] }, fibre: Fibre::at(&values[2..]) }
            }

            fn from_values(values: &[f64]) -> Self {
                Self::at(values)
            }

            fn values(&self) -> Vec<f64> {
                let [x, y, z] = self.fibre.direction.to_array();
                vec![self.matrix.lambda, self.matrix.mu, x, y, z, self.fibre.stiffness]
            }

            fn example() -> Self {
                Self { matrix: $matrix::example(), fibre: Fibre::EXAMPLE }
            }

            fn at_rest(&self) -> RestStiffness {
                RestStiffness {
                    lame: Lame { lambda: self.matrix.lambda, mu: self.matrix.mu },
                    direction: self.fibre.direction,
                    fibre_stiffness: self.fibre.stiffness,
                }
            }

            fn quadratic(&self) -> Option<QuadraticLaw> {
                Some(QuadraticLaw { strain: $strain, stiffness: self.at_rest() })
            }
        }

        impl $law {
            /// A matrix with the Lamé parameters `transverse` and fibres along `direction` with `longitudinal` ones.
            ///
            /// # Errors
            /// As [`Fibre::new`].
            pub fn new(transverse: Lame, direction: [f64; 3], longitudinal: Lame) -> Result<Self, MaterialError> {
                let fibre = Fibre::new(direction, longitudinal, transverse)?;
                Ok(Self { matrix: $matrix::new(transverse), fibre })
            }
        }
    };
}

transverse_family!(TransverseLinear, LinearElastic, "transverse-linear", false, StrainMeasure::Small);
transverse_family!(
    TransverseStVenantKirchhoff,
    StVenantKirchhoff,
    "transverse-st-venant-kirchhoff",
    true,
    StrainMeasure::Green
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fibres_as_stiff_as_the_matrix_change_nothing() {
        let lame = Lame::from_young_poisson(10e3, 0.4).unwrap();
        let fibre = Fibre::new([0.0, 2.0, 0.0], lame, lame).unwrap();
        assert_eq!(fibre.stiffness, 0.0);
        assert_eq!(fibre.direction, Vec3::new(0.0, 1.0, 0.0));
    }

    #[test]
    fn a_fibre_without_direction_is_refused() {
        let lame = Lame::from_young_poisson(10e3, 0.4).unwrap();
        let message = Fibre::new([0.0; 3], lame, lame).unwrap_err().to_string();
        assert_eq!(message, "the fibre direction (0, 0, 0) has no direction; give any vector that is not zero");
    }
}

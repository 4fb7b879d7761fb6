//! Linear elasticity: right for small displacements, and the yardstick for everything else.
//!
//! ψ(F) = λ/2 (tr ε)² + μ tr(ε²),   ε = ½(F + Fᵀ) − I
//! P(F) = λ tr(ε) I + 2μ ε
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 2.
//! Range: strains and rotations of a few per cent. A rotation of φ gives a false strain of 1 − cos φ, so a bent organ
//! swells: use [`StVenantKirchhoff`](super::StVenantKirchhoff) there.

use super::{Lame, Law, LawFamily, MaterialError, Parameter, QuadraticLaw, RestStiffness, StrainMeasure, small_strain};
use crate::math::{Mat3, Real, Sym3};

/// Parameters λ, μ [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic<R = f64> {
    /// First Lamé parameter λ [Pa], > −2μ/3.
    pub lambda: R,
    /// Shear modulus μ [Pa], > 0.
    pub mu: R,
}

impl LinearElastic {
    /// From the Lamé parameters.
    pub fn new(lame: Lame) -> Self {
        Self { lambda: lame.lambda, mu: lame.mu }
    }

    /// From Young's modulus [Pa] and Poisson's ratio.
    ///
    /// # Errors
    /// As [`Lame::from_young_poisson`].
    pub fn from_young_poisson(young: f64, poisson: f64) -> Result<Self, MaterialError> {
        Lame::from_young_poisson(young, poisson).map(Self::new)
    }
}

impl<R: Real> LinearElastic<R> {
    /// σ(ε) = λ tr(ε) I + 2μ ε.
    #[inline(always)]
    fn hooke(&self, strain: Sym3<R>) -> Sym3<R> {
        strain.mul_add(self.mu.double(), Sym3::diagonal(self.lambda * strain.trace()))
    }
}

impl<R: Real> Law<R> for LinearElastic<R> {
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        let strain = small_strain(f);
        (self.lambda * strain.trace().squared()).half() + self.mu * strain.squared_norm()
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        self.hooke(small_strain(f)).into()
    }

    #[inline(always)]
    fn tangent(&self, _f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        self.hooke(df.symmetric_part()).into()
    }

    #[inline(always)]
    fn stiffness_bound(&self, _f: &Mat3<R>) -> R {
        isotropic_bound(self.lambda, self.mu)
    }
}

/// Largest eigenvalue of Hooke's law: 3λ + 2μ for a change of volume, 2μ for a change of shape.
#[inline(always)]
pub(super) fn isotropic_bound<R: Real>(lambda: R, mu: R) -> R {
    (lambda * lambda.like(3.0)).max(lambda.zero_like()) + mu.double()
}

impl LawFamily for LinearElastic {
    type At<R: Real> = LinearElastic<R>;

    const NAME: &'static str = "linear";
    const PARAMETERS: &'static [Parameter] = &[Parameter::LAMBDA, Parameter::MU];
    const OBJECTIVE: bool = false;

    #[inline(always)]
    fn at<R: Real>(values: &[R]) -> LinearElastic<R> {
        LinearElastic { lambda: values[0], mu: values[1] }
    }

    fn from_values(values: &[f64]) -> Self {
        Self::at(values)
    }

    fn values(&self) -> Vec<f64> {
        vec![self.lambda, self.mu]
    }

    fn example() -> Self {
        Self::new(Lame::EXAMPLE)
    }

    fn at_rest(&self) -> RestStiffness {
        RestStiffness::isotropic(Lame { lambda: self.lambda, mu: self.mu })
    }

    fn quadratic(&self) -> Option<QuadraticLaw> {
        Some(QuadraticLaw { strain: StrainMeasure::Small, stiffness: self.at_rest() })
    }
}

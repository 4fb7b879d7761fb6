//! Linear elasticity: right for small displacements, and the yardstick for everything else.
//!
//! ψ(F) = λ/2 (tr ε)² + μ tr(ε²),   ε = ½(F + Fᵀ) − I
//! P(F) = λ tr(ε) I + 2μ ε
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 2.
//! Range: strains and rotations of a few per cent. A rotation of φ gives a false strain of 1 − cos φ, so a bent organ
//! swells: use [`StVenantKirchhoff`](super::StVenantKirchhoff) there.

use super::lame_law::lame_law;
use super::{Law, StrainMeasure, small_strain};
use crate::math::{Mat3, Real, Sym3};

/// Parameters λ, μ [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearElastic<R = f64> {
    /// First Lamé parameter λ [Pa], > −2μ/3.
    pub lambda: R,
    /// Shear modulus μ [Pa], > 0.
    pub mu: R,
}

lame_law!(LinearElastic, "linear", objective: false, quadratic: Some(StrainMeasure::Small));

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

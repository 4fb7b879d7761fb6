//! St Venant–Kirchhoff elasticity: the smallest law that is right under large rotations.
//!
//! ψ(F) = λ/2 (tr E)² + μ tr(E²),   E = ½(FᵀF − I)
//! P(F) = F S,   S = λ tr(E) I + 2μ E
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), eq. 6.
//! Range: moderate strain. Softens in compression (confined: unstable below a stretch of 1/√3) and cannot tell F from
//! its mirror image, so an inverted element stays inverted.

use super::lame_law::lame_law;
use super::linear::isotropic_bound;
use super::{Law, StrainMeasure, green_strain};
use crate::math::{Mat3, Real, Sym3};

/// Parameters λ, μ [Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StVenantKirchhoff<R = f64> {
    /// First Lamé parameter λ [Pa], > −2μ/3.
    pub lambda: R,
    /// Shear modulus μ [Pa], > 0.
    pub mu: R,
}

lame_law!(StVenantKirchhoff, "st-venant-kirchhoff", objective: true, quadratic: Some(StrainMeasure::Green));

impl<R: Real> StVenantKirchhoff<R> {
    /// Second Piola–Kirchhoff stress S(E), linear in E.
    #[inline(always)]
    fn second_stress(&self, strain: Sym3<R>) -> Sym3<R> {
        strain.mul_add(self.mu.double(), Sym3::diagonal(self.lambda * strain.trace()))
    }
}

impl<R: Real> Law<R> for StVenantKirchhoff<R> {
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        let strain = green_strain(f);
        (self.lambda * strain.trace().squared()).half() + self.mu * strain.squared_norm()
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        *f * self.second_stress(green_strain(f))
    }

    // dP = dF S + F dS with dE = sym(Fᵀ dF)
    #[inline(always)]
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let d_strain = (f.transpose() * *df).symmetric_part();
        *df * self.second_stress(green_strain(f)) + *f * self.second_stress(d_strain)
    }

    #[inline(always)]
    fn stiffness_bound(&self, f: &Mat3<R>) -> R {
        self.bound_of(f.gram().largest_eigenvalue_bound(), green_strain(f).trace(), self.mu.like(1.0))
    }
}

impl<R: Real> StVenantKirchhoff<R> {
    /// The bound of the stiffness for one of the largest eigenvalue of C, `stretch`, and tr E, all of them times `unit`.
    ///
    /// dF:dP = S:(dFᵀdF) + dE:C:dE with |dE| ≤ ‖F‖ |dF|, and S = λ tr E I + μ (C − I).
    #[inline(always)]
    pub(crate) fn bound_of(&self, stretch: R, trace: R, unit: R) -> R {
        let stress = self.lambda * trace + self.mu * (stretch - unit);
        stretch.mul_add(isotropic_bound(self.lambda, self.mu), stress.max(stress.zero_like()))
    }
}

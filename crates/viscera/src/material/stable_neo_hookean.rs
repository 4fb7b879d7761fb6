//! Stable neo-Hookean elasticity: rubber that survives being turned inside out.
//!
//! ψ(F) = μ'/2 (I_C − 3) − μ'/2 ln((I_C + 1)/4) − ¾μ' (J − 1) + λ'/2 (J − 1)²,   I_C = F:F,  J = det F
//! P(F) = μ' (1 − 1/(I_C + 1)) F + [λ' (J − 1) − ¾μ'] cof F
//! μ' = 4/3 μ,   λ' = λ + 5/6 μ
//!
//! which is the paper's μ'/2 (I_C − 3) + λ'/2 (J − α)² − μ'/2 ln(I_C + 1), α = 1 + ¾ μ'/λ', less its value at rest. The
//! primed parameters make small strains obey Hooke's law with λ and μ; users give those.
//!
//! Source: Smith, de Goes, Kim, Stable neo-Hookean flesh simulation, ACM TOG 37 (2018), eq. 14 and section 3.4.
//! Range: any deformation. Nothing is infinite at J = 0, and an inverted element is driven back; J = 1 is kept as well
//! as λ/μ asks for.

use super::Law;
use super::lame_law::lame_law;
use super::neo_hookean::{curvature_of_determinant, felt_square};
use crate::math::{Mat3, Real};

/// Parameters λ, μ [Pa] of small strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableNeoHookean<R = f64> {
    /// First Lamé parameter λ [Pa], > −2μ/3.
    pub lambda: R,
    /// Shear modulus μ [Pa], > 0.
    pub mu: R,
}

lame_law!(StableNeoHookean, "stable-neo-hookean", objective: true, quadratic: None);

impl<R: Real> StableNeoHookean<R> {
    /// λ' = λ + 5/6 μ and μ' = 4/3 μ [Pa], the parameters of the formulae.
    #[inline(always)]
    pub fn rescaled(&self) -> (R, R) {
        let mu = self.mu;
        (mu.mul_add(mu.like(5.0 / 6.0), self.lambda), mu * mu.like(4.0 / 3.0))
    }
}

impl<R: Real> Law<R> for StableNeoHookean<R> {
    // With H = F − I, q = H:H and J − 1 = tr H + k: ψ = μ' {⅜ q − ¾ k + ½[s − ln(1 + s)]} + λ'/2 (J − 1)²,
    // s = (I_C − 3)/4. The terms of first order are gone, which otherwise cancel and leave only roundings at small strain.
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        let (lambda, mu) = self.rescaled();
        let h = *f - f.identity_like();
        let (trace, square, cofactor) = (h.trace(), h.squared_norm(), h.cofactor());
        let beyond_trace = cofactor.trace() + h.columns[0].dot(cofactor.columns[0]);
        let s = (trace.double() + square) * square.like(0.25);
        let logarithm = (s - (s + s.like(1.0)).ln()).half();
        let shape = (square.half() - beyond_trace) * square.like(0.75) + logarithm;
        mu * shape + (lambda * (trace + beyond_trace).squared()).half()
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        let (lambda, mu) = self.rescaled();
        let one = mu.like(1.0);
        let cofactor = f.cofactor();
        let change = f.columns[0].dot(cofactor.columns[0]) - one;
        let shape = mu * (one - one / (f.squared_norm() + one));
        *f * shape + cofactor * (lambda * change - mu * mu.like(0.75))
    }

    #[inline(always)]
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let (lambda, mu) = self.rescaled();
        let one = mu.like(1.0);
        let cofactor = f.cofactor();
        let change = f.columns[0].dot(cofactor.columns[0]) - one;
        let share = one / (f.squared_norm() + one);
        *df * (mu * (one - share))
            + *f * (mu * share.squared() * f.contract(*df)).double()
            + cofactor * (lambda * cofactor.contract(*df))
            + f.cofactor_along(*df) * (lambda * change - mu * mu.like(0.75))
    }

    #[inline(always)]
    fn stiffness_bound(&self, f: &Mat3<R>) -> R {
        let cofactor = f.cofactor();
        let determinant = f.columns[0].dot(cofactor.columns[0]);
        Self::bound_of(self.rescaled(), f.squared_norm(), cofactor.squared_norm(), determinant)
    }
}

impl<R: Real> StableNeoHookean<R> {
    /// The bound of the stiffness for λ', μ', I_C = `square`, ‖cof F‖² = `area` and J.
    #[inline(always)]
    pub(crate) fn bound_of((lambda, mu): (R, R), square: R, area: R, determinant: R) -> R {
        let one = mu.like(1.0);
        let share = one / (square + one);
        let shape = mu * (one - share) + (mu * share.squared() * square).double();
        let pressure = lambda * (determinant - one) - mu * mu.like(0.75);
        lambda.mul_add(felt_square(area, determinant, square), shape)
            + curvature_of_determinant(pressure, determinant, square)
    }
}

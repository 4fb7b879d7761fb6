//! Neo-Hookean elasticity, shape and volume apart: the usual law of rubber and of nearly incompressible tissue.
//!
//! ψ(F) = μ/2 (g(J) I_C − 3) + κ/2 (J − 1)²,   g(J) = J^(−2/3),  κ = λ + 2/3 μ,  I_C = F:F,  J = det F
//! P(F) = μ g F + [μ/2 g' I_C + κ (J − 1)] cof F
//!
//! Below J = 0.3 g is continued by its parabola at 0.3, so that energy, stress and stiffness stay continuous and finite,
//! and an inverted element is driven back.
//!
//! Source: Bonet, Wood, Nonlinear continuum mechanics for finite element analysis (2008), section 6.5.
//! Range: J > 0.3 exactly as printed; beyond, see above.

use super::Law;
use super::lame_law::lame_law;
use crate::math::{Mat3, Real};

/// Where the parabola takes over: three tenths of the volume is beyond any tissue, and g'' has grown to 28 times its
/// value at rest only.
const SMALLEST_VOLUME: f64 = 0.3;

/// Parameters λ, μ [Pa] of small strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeoHookean<R = f64> {
    /// First Lamé parameter λ [Pa], > −2μ/3.
    pub lambda: R,
    /// Shear modulus μ [Pa], > 0.
    pub mu: R,
}

lame_law!(NeoHookean, "neo-hookean", objective: true, quadratic: None);

/// What the law needs at an F.
struct At<R> {
    square: R,
    cofactor: Mat3<R>,
    determinant: R,
    /// g, g', g''.
    shape: [R; 3],
    /// ∂ψ/∂J at constant I_C.
    pressure: R,
    /// The same with μ g added, which vanishes at rest without a rounding.
    excess_pressure: R,
    /// F − cof F, which vanishes at rest without a rounding.
    difference: Mat3<R>,
}

impl<R: Real> NeoHookean<R> {
    /// κ = λ + 2/3 μ [Pa].
    #[inline(always)]
    fn bulk(&self) -> R {
        self.mu.mul_add(self.mu.like(2.0 / 3.0), self.lambda)
    }

    // With H = F − I and f = −3/2 g', which is g/J above the parabola: g F − f I_C/3 cof F =
    // g (F − cof F) + [f (J − I_C/3) + (g − f J)] cof F, whose terms of order H⁰ are gone one by one. They would leave only
    // roundings at small strain.
    #[inline(always)]
    fn at_deformation(&self, f: &Mat3<R>) -> At<R> {
        let one = self.mu.like(1.0);
        let h = *f - f.identity_like();
        let (trace, minors) = (h.trace(), h.cofactor());
        let change = trace + (minors.trace() + h.columns[0].dot(minors.columns[0]));
        let excess = trace.double() + h.squared_norm();
        let kept_change = change.max(one.like(SMALLEST_VOLUME - 1.0));
        let (kept, below) = (kept_change + one, change - kept_change);
        let inverse = one / kept;
        let g = one / kept.cbrt().squared();
        let curvature = g * inverse.squared() * one.like(10.0 / 9.0);
        let fall = g * inverse - curvature * below * one.like(1.5);
        let at_kept = g * inverse * one.like(-2.0 / 3.0);
        let parabola = curvature.half().mul_add(below, at_kept) * below;
        let beyond = parabola + curvature * below * kept * one.like(1.5);
        let shape = [g + parabola, fall * one.like(-2.0 / 3.0), curvature];
        let third = one.like(1.0 / 3.0);
        let excess_pressure = self.bulk() * change + self.mu * (fall * (kept_change - excess * third) + beyond);
        At {
            square: excess + one.like(3.0),
            cofactor: f.cofactor(),
            determinant: change + one,
            shape,
            pressure: excess_pressure - self.mu * shape[0],
            excess_pressure,
            difference: h + h.transpose() - f.identity_like() * trace - minors,
        }
    }
}

impl<R: Real> Law<R> for NeoHookean<R> {
    // With H = F − I, I_C − 3 = 2 tr H + H:H and J − 1 = tr H + tr cof H + det H. With the cube root r of J,
    // g − 1 = −(r − 1)(r + 1)/r² and r − 1 = (J − 1)/(r² + r + 1). So g I_C − 3 = g (I_C − 3) + 3 (g − 1) keeps its digits
    // at small strain.
    #[inline(always)]
    fn energy(&self, f: &Mat3<R>) -> R {
        let one = self.mu.like(1.0);
        let h = *f - f.identity_like();
        let (trace, cofactor) = (h.trace(), h.cofactor());
        let excess = trace.double() + h.squared_norm();
        let change = trace + (cofactor.trace() + h.columns[0].dot(cofactor.columns[0]));
        let kept = change.max(one.like(SMALLEST_VOLUME - 1.0));
        let (below, volume) = (change - kept, kept + one);
        let root = volume.cbrt();
        let g = one / root.squared();
        let beyond_one = -(kept / (root.squared() + root + one)) * (root + one) * g;
        let slope = g / volume * one.like(-2.0 / 3.0);
        let curvature = g / volume.squared() * one.like(10.0 / 9.0);
        let parabola = curvature.half().mul_add(below, slope) * below;
        let shape = (g + parabola) * excess + (beyond_one + parabola) * one.like(3.0);
        (self.mu * shape + self.bulk() * change.squared()).half()
    }

    #[inline(always)]
    fn stress(&self, f: &Mat3<R>) -> Mat3<R> {
        let At { cofactor, shape: [g, ..], excess_pressure, difference, .. } = self.at_deformation(f);
        difference * (self.mu * g) + cofactor * excess_pressure
    }

    #[inline(always)]
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let At { square, cofactor, shape: [g, slope, curvature], pressure, .. } = self.at_deformation(f);
        let d_determinant = cofactor.contract(*df);
        let d_pressure = (self.mu * curvature * square).half() + self.bulk();
        *df * (self.mu * g)
            + *f * (self.mu * slope * d_determinant)
            + cofactor * (d_pressure * d_determinant + self.mu * slope * f.contract(*df))
            + f.cofactor_along(*df) * pressure
    }

    // The terms with F and cof F: A (c:dF)² + 2B (F:dF)(c:dF), whose largest eigenvalue is that of a 2×2 matrix, with
    // F:c = 3J. For c:c stands what cells feel of it.
    #[inline(always)]
    fn stiffness_bound(&self, f: &Mat3<R>) -> R {
        let At { square, cofactor, determinant, shape: [g, slope, curvature], pressure, .. } = self.at_deformation(f);
        let (a, b) = ((self.mu * curvature * square).half() + self.bulk(), self.mu * slope);
        let area = felt_square(cofactor.squared_norm(), determinant, square);
        let trace = a * area + b * determinant * a.like(6.0);
        let apart = (square * area - (determinant * a.like(3.0)).squared()).max(a.zero_like());
        let largest = (trace + (trace.squared() + (b.squared() * apart) * a.like(4.0)).sqrt()).half();
        self.mu.mul_add(g, largest.max(a.zero_like())) + curvature_of_determinant(pressure, determinant, square)
    }
}

/// 3 (⅓ Σσ⁸)^¼ of the stretches σ of cof F, for c:c = Σσ²: as much at rest and more elsewhere, because a cell feels up
/// to three times the square of the largest stretch. Of c:c = `area`, J = `determinant` and I_C = `square`.
///
/// The squares σ² are the roots of t³ − e₁ t² + e₂ t − e₃ with e₁ = c:c, e₂ = J² I_C, e₃ = J⁴, and the sum of their fourth powers is
/// e₁⁴ − 4 e₁² e₂ + 2 e₂² + 4 e₁ e₃ (Newton), to 36 roundings where they are equal and fewer elsewhere; it is never below e₁⁴/27.
#[inline(always)]
pub(super) fn felt_square<R: Real>(area: R, determinant: R, square: R) -> R {
    let (e1, volume) = (area, determinant.squared());
    let (e2, e3) = (volume * square, volume.squared());
    let leading = e1.squared();
    let eighth_powers = leading * (leading - e2 * e1.like(4.0)) + (e2.squared() + (e1 * e3).double()).double();
    let least = leading.squared() * e1.like(1.0 / 27.0);
    eighth_powers.max(least).sqrt().sqrt() * area.like(3.0_f64.powf(0.75))
}

/// Upper bound of p dF : ∂cof F/∂F : dF over |dF| = 1, for J = `determinant` and I_C = `square`.
///
/// With the stretches σ_i the eigenvalues of ∂cof F/∂F are ±σ_i and the roots of e³ − I_C e − 2J = 0. They add up to
/// zero, so none exceeds 2/√3 |F| in size, and for J > 0 none lies below −|F|.
#[inline(always)]
pub(super) fn curvature_of_determinant<R: Real>(pressure: R, determinant: R, square: R) -> R {
    let zero = square.zero_like();
    let most = square.like(2.0 / 3.0_f64.sqrt());
    let upright = R::select(determinant.less_than(zero), most, square.like(1.0));
    pressure.abs() * R::select(pressure.less_than(zero), upright, most) * square.sqrt()
}

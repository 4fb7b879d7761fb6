//! The stiffness tensors of one tetrahedron: tensors B, vectors C and scalars D.
//!
//! With α the gradients of the shape functions, q_j = a0·α_j and V the rest volume (which the papers leave out):
//!
//! B_jk   = V { λ/2 α_j α_kᵀ + μ/2 [α_k α_jᵀ + (α_j·α_k) I] + κ_a q_j q_k a0 a0ᵀ }
//! C_jkl  = V { λ/2 α_j (α_k·α_l) + μ/2 [α_l (α_j·α_k) + α_k (α_j·α_l)] + κ_a q_j q_k q_l a0 }
//! D_jklm = V { λ/8 (α_j·α_k)(α_l·α_m) + μ/4 (α_j·α_m)(α_k·α_l) + κ_a/4 q_j q_k q_l q_m }
//!
//! Symmetries: B_jkᵀ = B_kj;  C_jkl = C_jlk;  D_jklm = D_kjml = D_lmjk = D_mlkj, and no more.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), eqs. 7–9; ICRA 2001; with the factor V.

use super::super::tet_loop::RestTet;
use crate::material::RestStiffness;
use crate::math::{Mat3, Vec3};

/// Everything that B, C and D are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TetTensors {
    alpha: [Vec3<f64>; 4],
    /// α_j·α_k.
    dots: [[f64; 4]; 4],
    /// q_j = a0·α_j.
    along: [f64; 4],
    direction: Vec3<f64>,
    /// Vλ, Vμ, Vκ_a.
    lambda: f64,
    mu: f64,
    kappa: f64,
}

impl TetTensors {
    pub(crate) fn new(rest: &RestTet, stiffness: &RestStiffness) -> Self {
        let alpha = rest.gradients();
        Self {
            alpha,
            dots: alpha.map(|a| alpha.map(|b| a.dot(b))),
            along: alpha.map(|a| a.dot(stiffness.direction)),
            direction: stiffness.direction,
            lambda: rest.volume * stiffness.lame.lambda,
            mu: rest.volume * stiffness.lame.mu,
            kappa: rest.volume * stiffness.fibre_stiffness,
        }
    }

    /// B_jk [N/m].
    #[inline(always)]
    pub(crate) fn b(&self, j: usize, k: usize) -> Mat3<f64> {
        let [a, b] = [self.alpha[j], self.alpha[k]];
        a.outer(b) * (0.5 * self.lambda)
            + b.outer(a) * (0.5 * self.mu)
            + Mat3::diagonal(0.5 * self.mu * self.dots[j][k])
            + self.direction.outer(self.direction) * (self.kappa * self.along[j] * self.along[k])
    }

    /// C_jkl [N/m²].
    #[inline(always)]
    pub(crate) fn c(&self, j: usize, k: usize, l: usize) -> Vec3<f64> {
        self.alpha[j] * (0.5 * self.lambda * self.dots[k][l])
            + self.alpha[l] * (0.5 * self.mu * self.dots[j][k])
            + self.alpha[k] * (0.5 * self.mu * self.dots[j][l])
            + self.direction * (self.kappa * self.along[j] * self.along[k] * self.along[l])
    }

    /// D_jklm [N/m³].
    #[inline(always)]
    pub(crate) fn d(&self, j: usize, k: usize, l: usize, m: usize) -> f64 {
        0.125 * self.lambda * self.dots[j][k] * self.dots[l][m]
            + 0.25 * self.mu * self.dots[j][m] * self.dots[k][l]
            + 0.25 * self.kappa * self.along[j] * self.along[k] * self.along[l] * self.along[m]
    }
}

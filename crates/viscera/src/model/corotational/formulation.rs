use super::hooke::Hooke;
use crate::math::rotation::{polar, polar_along, qr, svd};
use crate::math::{Dual, Mat3, Real, Sym3, Vec3};

/// How the rotation of an element is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rotation {
    /// J = R S: the nearest rotation, with the axis of the smallest stretch flipped where the element is inverted.
    #[default]
    Polar,
    /// Gram–Schmidt on the edges 01 and 02, third axis by cross product: cheapest, depends on the order of the corners.
    Qr,
    /// J = U Σ Vᵀ with two rotations (Irving et al. 2004): the rotation of `Polar` by another way, and at another price.
    Svd,
}

/// Over which shape displacements are differentiated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StrainDisplacement {
    /// The rest shape: B is computed once.
    #[default]
    AtRest,
    /// The current shape, turned back: B is computed anew in every step.
    Updated,
}

/// The volume over which the stress is integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntegrationVolume {
    /// That at rest; with an updated B, also in its factor 1/6V.
    #[default]
    Initial,
    /// The size |V| of the current one, with an updated B no less than a hundredth of that at rest.
    Current,
}

/// What a product with the stiffness is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangent {
    /// R K Rᵀ, the rotation held: symmetric, never negative, as cheap as linear elasticity, and 15 % off at a strain of
    /// 30 %: right for an implicit step, of linear convergence in Newton's method.
    #[default]
    Frozen,
    /// The derivative of the forces, the rotation's own included; not symmetric where no energy is behind them.
    Exact,
}

/// Least |det F| by which an updated B with the current volume divides.
pub(super) const SMALLEST_VOLUME_RATIO: f64 = 0.01;

/// A row and column of the table of variants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Formulation {
    pub(super) rotation: Rotation,
    pub(super) strain: StrainDisplacement,
    pub(super) volume: IntegrationVolume,
    pub(super) tangent: Tangent,
}

/// What an element makes of F and R before the law is asked.
///
/// With G = RᵀF, in the frame of the rest shape:
///
/// * B at rest: ε = sym G − I, and forces R σ(ε) α V0
/// * B updated: x_l = Rᵀx, ∇_{x_l} u_l = I − G⁻¹, and forces R σ(ε) α(x_l) V with V α(x_l) = V0 cof(G) α. With 1/6V0 in
///   place of 1/6V the strain is ε0 = sym((G − I) cof(G)ᵀ) = det(G) ε: nothing divides, and for the current volume the
///   whole force is divided by |det G|.
///
/// So every variant is P = s R σ(ε) A and forces V0 P α, with its own ε, A = I or cof G, and s = 1, |J| or 1/|J|.
struct Local<R> {
    strain: Sym3<R>,
    transport: Mat3<R>,
    scale: R,
}

impl Formulation {
    /// R(F).
    #[inline(always)]
    pub(super) fn rotation<R: Real>(self, f: &Mat3<R>) -> Mat3<R> {
        match self.rotation {
            Rotation::Polar => polar(f),
            Rotation::Qr => qr(f),
            Rotation::Svd => svd(f).rotation(),
        }
    }

    /// The derivative of R(F) along `df`; nothing where the rotation is held.
    #[inline(always)]
    pub(super) fn rotation_along<R: Real>(self, f: &Mat3<R>, r: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        match (self.tangent, self.rotation) {
            (Tangent::Frozen, _) => Mat3::diagonal(f.columns[0].x.zero_like()),
            (Tangent::Exact, Rotation::Polar | Rotation::Svd) => polar_along(f, r, df),
            (Tangent::Exact, Rotation::Qr) => derivative(&qr(&Mat3::with_derivative(f, df))),
        }
    }

    #[inline(always)]
    fn local<R: Real>(self, g: &Mat3<R>) -> Local<R> {
        let (one, identity) = (g.columns[0].x.like(1.0), g.identity_like());
        let cofactor = g.cofactor();
        let volume_ratio = g.columns[0].dot(cofactor.columns[0]).abs();
        let current = self.volume == IntegrationVolume::Current;
        match self.strain {
            StrainDisplacement::AtRest => Local {
                strain: (*g - identity).symmetric_part(),
                transport: identity,
                scale: if current { volume_ratio } else { one },
            },
            StrainDisplacement::Updated => Local {
                strain: ((*g - identity) * cofactor.transpose()).symmetric_part(),
                transport: cofactor,
                scale: if current { one / volume_ratio.max(one.like(SMALLEST_VOLUME_RATIO)) } else { one },
            },
        }
    }

    /// P = s R σ(ε) A [Pa]; nodal forces are V0 P α.
    #[inline(always)]
    pub(super) fn stress<R: Real>(self, hooke: &Hooke<R>, r: &Mat3<R>, f: &Mat3<R>) -> Mat3<R> {
        let Local { strain, transport, scale } = self.local(&(r.transpose() * *f));
        let turned = *r * (hooke.stress(strain) * scale);
        match self.strain {
            StrainDisplacement::AtRest => turned,
            StrainDisplacement::Updated => turned * transport,
        }
    }

    /// What a product makes of `df` and `dr` at F and R [Pa].
    #[inline(always)]
    pub(super) fn stress_along<R: Real>(
        self,
        hooke: &Hooke<R>,
        (r, dr): (&Mat3<R>, &Mat3<R>),
        (f, df): (&Mat3<R>, &Mat3<R>),
    ) -> Mat3<R> {
        match self.tangent {
            Tangent::Frozen => {
                let Local { transport, scale, .. } = self.local(&(r.transpose() * *f));
                let dg = r.transpose() * *df;
                match self.strain {
                    StrainDisplacement::AtRest => *r * (hooke.stress(dg.symmetric_part()) * scale),
                    StrainDisplacement::Updated => {
                        let d_strain = (dg * transport.transpose()).symmetric_part();
                        *r * (hooke.stress(d_strain) * scale) * transport
                    }
                }
            }
            Tangent::Exact => {
                let (r, f) = (Mat3::with_derivative(r, dr), Mat3::with_derivative(f, df));
                derivative(&self.stress(&hooke.constant(), &r, &f))
            }
        }
    }

    /// Whether the forces are linear in the frame that turns with the cell: those of B and V at rest are.
    pub(super) fn is_linear_in_its_frame(self) -> bool {
        self.strain == StrainDisplacement::AtRest && self.volume == IntegrationVolume::Initial
    }

    /// Whether the forces of an isotropic law are the gradient of [`Formulation::energy`].
    pub(super) fn has_potential(self) -> bool {
        self.is_linear_in_its_frame() && self.rotation != Rotation::Qr
    }

    /// R A and s: with g = √(s V0) R A α, the frozen product is Σ_j [R C Rᵀ : sym(dx_j g_jᵀ)] g_i, with the law C turned by
    /// R: what linear elasticity costs.
    #[inline(always)]
    pub(super) fn transport<R: Real>(self, r: &Mat3<R>, f: &Mat3<R>) -> (Mat3<R>, R) {
        let Local { transport, scale, .. } = self.local(&(r.transpose() * *f));
        match self.strain {
            StrainDisplacement::AtRest => (*r, scale),
            StrainDisplacement::Updated => (*r * transport, scale),
        }
    }

    /// s ½ ε:σ(ε) [J/m³]: what the element stores by its own strain.
    #[inline(always)]
    pub(super) fn energy<R: Real>(self, hooke: &Hooke<R>, r: &Mat3<R>, f: &Mat3<R>) -> R {
        let Local { strain, scale, .. } = self.local(&(r.transpose() * *f));
        hooke.energy(strain) * scale
    }
}

#[inline(always)]
fn derivative<R: Real>(a: &Mat3<Dual<R>>) -> Mat3<R> {
    let column = |i: usize| Vec3::from(a.columns[i].to_array().map(|entry| entry.derivative));
    Mat3::from_columns(column(0), column(1), column(2))
}

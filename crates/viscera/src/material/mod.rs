//! Laws: how tissue stores energy when it is deformed. One law is one file; `registry.rs` is the only list of them.
//!
//! Adding a law: a file with a struct of parameters generic over [`Real`], [`Law`] and [`LawFamily`] for it (`lame_law!` where λ
//! and μ are all), and one line in the registry. Conformance tests, scenes and force models follow from there.

mod error;
mod lame;
mod lame_law;
mod linear;
mod neo_hookean;
mod parameter;
mod preset;
mod registry;
mod st_venant_kirchhoff;
mod stable_neo_hookean;
mod tissue;
mod transverse;

pub use error::MaterialError;
pub use lame::Lame;
pub use linear::LinearElastic;
pub use neo_hookean::NeoHookean;
pub use parameter::{Parameter, ParameterRange};
pub use preset::{Evidence, FibrePreset, Measured, TissuePreset};
pub use registry::{LawKind, LawVisitor};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stable_neo_hookean::StableNeoHookean;
pub use tissue::Tissue;
pub use transverse::{Fibre, TransverseLinear, TransverseStVenantKirchhoff};

use crate::math::{Mat3, Real, Sym3, Vec3};

/// A hyperelastic law: an energy density ψ(F) and its derivatives, in SI units per rest volume.
///
/// `F` is the deformation gradient ∂x/∂X. Everything must be finite for every finite `F`, inverted ones included.
pub trait Law<R: Real>: Copy {
    /// Energy density ψ(F) [J/m³].
    fn energy(&self, f: &Mat3<R>) -> R;
    /// First Piola–Kirchhoff stress P = ∂ψ/∂F [Pa].
    fn stress(&self, f: &Mat3<R>) -> Mat3<R>;
    /// Directional derivative ∂P/∂F : dF [Pa].
    fn tangent(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R>;
    /// Upper bound of dF : ∂P/∂F : dF over all |dF| = 1 [Pa]: how stiff the tissue is at `F`, for the stable time step.
    fn stiffness_bound(&self, f: &Mat3<R>) -> R;
}

/// A law as a family over all kinds of numbers, with what the engine needs to know about it.
pub trait LawFamily: Law<f64> + Into<LawKind> + PartialEq + std::fmt::Debug + Send + Sync + 'static {
    /// The same law over `R`.
    type At<R: Real>: Law<R>;

    /// Name in scenes and messages.
    const NAME: &'static str;
    /// The parameters, in the order of [`LawFamily::values`].
    const PARAMETERS: &'static [Parameter];
    /// Whether ψ(QF) = ψ(F) for every rotation Q; a law that is not objective holds for small rotations only.
    const OBJECTIVE: bool;

    /// The law with these parameter values.
    fn at<R: Real>(values: &[R]) -> Self::At<R>;
    /// The law in double precision with these parameter values, the inverse of [`LawFamily::values`].
    fn from_values(values: &[f64]) -> Self;
    /// The parameter values of this law.
    fn values(&self) -> Vec<f64>;
    /// A soft tissue of this law: what a menu offers first, and what the conformance suites are run with. Every parameter
    /// has a value at which its part of the energy can be felt.
    fn example() -> Self;
    /// Stiffness at rest: λ, μ and, for fibred laws, direction and κ_a.
    fn at_rest(&self) -> RestStiffness;
    /// The same as [`LawFamily::at_rest`], if ψ is quadratic in the strain (small or Green's): what tensor-mass needs.
    fn quadratic(&self) -> Option<QuadraticLaw>;
}

/// The strain in which a quadratic law is quadratic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainMeasure {
    /// ε = ½(∇u + ∇uᵀ).
    Small,
    /// E = ½(FᵀF − I).
    Green,
}

/// ψ = λ/2 (tr E)² + μ tr(E²) + κ_a (a0·E a0)² in one of two strains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraticLaw {
    /// The strain.
    pub strain: StrainMeasure,
    /// The coefficients.
    pub stiffness: RestStiffness,
}

/// λ, μ and one fibre direction: the second derivatives of ψ at F = I.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestStiffness {
    /// Isotropic part.
    pub lame: Lame,
    /// Unit fibre direction a0; any unit vector where κ_a = 0.
    pub direction: Vec3<f64>,
    /// κ_a = (λ_L − λ)/2 + μ_L − μ [Pa]; 0 for an isotropic law.
    pub fibre_stiffness: f64,
}

impl RestStiffness {
    /// A stiffness without fibres.
    pub fn isotropic(lame: Lame) -> Self {
        Self { lame, direction: Vec3::new(1.0, 0.0, 0.0), fibre_stiffness: 0.0 }
    }

    /// Largest modulus that a plane wave can meet at rest: λ + 2μ + 2κ_a⁺ [Pa]. Its speed is √(modulus/ρ).
    pub fn wave_modulus(&self) -> f64 {
        self.lame.lambda + 2.0 * self.lame.mu + 2.0 * self.fibre_stiffness.max(0.0)
    }
}

/// Green's strain E = ½(FᵀF − I).
#[inline(always)]
pub fn green_strain<R: Real>(f: &Mat3<R>) -> Sym3<R> {
    let one = f.columns[0].x.like(1.0);
    (f.gram() - Sym3::diagonal(one)) * one.half()
}

/// Small strain ε = ½(F + Fᵀ) − I.
#[inline(always)]
pub fn small_strain<R: Real>(f: &Mat3<R>) -> Sym3<R> {
    f.symmetric_part() - Sym3::diagonal(f.columns[0].x.like(1.0))
}

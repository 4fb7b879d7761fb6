use crate::material::RestStiffness;
use crate::math::{Dual, Mat3, Real, Sym3, Vec3};

/// Hooke's law with or without fibres: σ(ε) = λ tr ε I + 2μ ε + 2κ_a (a0·ε a0) a0 a0ᵀ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hooke<R> {
    pub(super) lambda: R,
    pub(super) mu: R,
    /// Direction a0 and 2κ_a.
    pub(super) fibre: Option<(Vec3<R>, R)>,
}

/// Numbers of an isotropic law, and of one with fibres.
pub(super) const ISOTROPIC: usize = 2;
pub(super) const FIBRED: usize = 6;

impl Hooke<f64> {
    /// The law of a cell, with its fibres turned by `turn`.
    pub(super) fn numbers(stiffness: &RestStiffness, direction: Vec3<f64>, fibred: bool) -> Vec<f64> {
        let mut numbers = vec![stiffness.lame.lambda, stiffness.lame.mu];
        if fibred {
            numbers.extend(direction.to_array());
            numbers.push(2.0 * stiffness.fibre_stiffness);
        }
        numbers
    }
}

impl<R: Real> Hooke<R> {
    /// From as many numbers as [`Hooke::numbers`] gives.
    #[inline(always)]
    pub(super) fn at(numbers: &[R], fibred: bool) -> Self {
        let fibre = if fibred { Some((Vec3::new(numbers[2], numbers[3], numbers[4]), numbers[5])) } else { None };
        Self { lambda: numbers[0], mu: numbers[1], fibre }
    }

    /// σ(ε) [Pa].
    #[inline(always)]
    pub(super) fn stress(&self, strain: Sym3<R>) -> Sym3<R> {
        let matrix = strain.mul_add(self.mu.double(), Sym3::diagonal(self.lambda * strain.trace()));
        match self.fibre {
            Some((direction, stiffness)) => {
                Sym3::square(direction).mul_add(stiffness * strain.quadratic(direction), matrix)
            }
            None => matrix,
        }
    }

    /// ½ ε:σ(ε) [J/m³].
    #[inline(always)]
    pub(super) fn energy(&self, strain: Sym3<R>) -> R {
        self.stress(strain).contract(strain).half()
    }

    /// The block K_pq [N/m] of the corners with the gradients `p` and `q`, both times the root of the volume: the force
    /// σ(sym(b qᵀ)) p is K_pq b for every displacement b.
    #[inline(always)]
    pub(super) fn block(&self, p: Vec3<R>, q: Vec3<R>) -> Mat3<R> {
        let matrix = p.outer(q) * self.lambda + q.outer(p) * self.mu + Mat3::diagonal(self.mu * p.dot(q));
        match self.fibre {
            Some((direction, stiffness)) => {
                let along = stiffness * direction.dot(p) * direction.dot(q);
                matrix + direction.outer(direction * along)
            }
            None => matrix,
        }
    }

    /// The block K_pp of a corner, which is symmetric.
    #[inline(always)]
    pub(super) fn own_block(&self, p: Vec3<R>) -> Sym3<R> {
        let matrix = Sym3::square(p).mul_add(self.lambda + self.mu, Sym3::diagonal(self.mu * p.squared_norm()));
        match self.fibre {
            Some((direction, stiffness)) => {
                Sym3::square(direction).mul_add(stiffness * direction.dot(p).squared(), matrix)
            }
            None => matrix,
        }
    }

    /// The same law for dual numbers.
    #[inline(always)]
    pub(super) fn constant(&self) -> Hooke<Dual<R>> {
        let vector = |v: Vec3<R>| Vec3::new(Dual::constant(v.x), Dual::constant(v.y), Dual::constant(v.z));
        Hooke {
            lambda: Dual::constant(self.lambda),
            mu: Dual::constant(self.mu),
            fibre: self.fibre.map(|(direction, stiffness)| (vector(direction), Dual::constant(stiffness))),
        }
    }
}

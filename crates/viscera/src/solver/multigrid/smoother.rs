//! Chebyshev polynomials of D⁻¹A, D being the blocks on the diagonal: what is left of an error whose eigenvalue lies between the
//! highest one and [`SPAN`] times less is small, and no error grows. So the smoother, and the whole cycle, are symmetric and
//! positive definite, even for a matrix that is not.
//!
//! Source: Adams, Brezina, Hu, Tuminaro, Parallel multigrid smoothing: polynomial versus Gauss–Seidel (2003); the recursion is
//! that of Saad, Iterative methods for sparse linear systems (2003), algorithm 12.1.

use crate::executor::Executor;
use crate::math::{Scalar, Vec3};
use crate::solver::dot;

/// Highest over lowest eigenvalue of the errors that a smoother is for. From 15 to 30 it is all the same; 10 takes a tenth more iterations.
const SPAN: f64 = 20.0;
/// Iterations that find the highest eigenvalue.
pub(super) const LANCZOS: usize = 6;
/// What they may have missed: after six they were at most 10 % below what 32 found.
const MARGIN: f64 = 1.15;
/// What is taken where they find nothing: as many as a tetrahedron has corners, which bounds it for cells that resist.
const CORNERS: f64 = 4.0;

/// What a smoother works on.
pub(super) trait Smoothed<T: Scalar> {
    /// Writes A x to `out`.
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]);
    /// Writes D⁻¹ r to `out`.
    fn scale(&mut self, residual: &[Vec3<T>], out: &mut [Vec3<T>]);
}

/// Arrays for one level.
#[derive(Clone, Debug)]
pub(super) struct Vectors<T> {
    /// The residual b − A x, followed along.
    pub(super) residual: Vec<Vec3<T>>,
    pub(super) direction: Vec<Vec3<T>>,
    pub(super) product: Vec<Vec3<T>>,
}

impl<T: Scalar> Vectors<T> {
    pub(super) fn new(nodes: usize) -> Self {
        let zeros = || vec![Vec3::ZERO; nodes];
        Self { residual: zeros(), direction: zeros(), product: zeros() }
    }

    /// r − A p, p being the direction.
    pub(super) fn follow(&mut self, level: &mut impl Smoothed<T>) {
        level.apply(&self.direction, &mut self.product);
        for (residual, &product) in self.residual.iter_mut().zip(&self.product) {
            *residual -= product;
        }
    }
}

/// The polynomial of one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chebyshev {
    degree: u32,
    highest: f64,
}

impl Chebyshev {
    pub(super) fn new(degree: u32) -> Self {
        Self { degree, highest: CORNERS }
    }

    /// Moves `x` towards the solution, and the residual along; but for the last step where nobody asks for it.
    pub(super) fn smooth<T: Scalar>(
        &self,
        level: &mut impl Smoothed<T>,
        vectors: &mut Vectors<T>,
        x: &mut [Vec3<T>],
        residual_is_needed: bool,
    ) {
        let lowest = self.highest / SPAN;
        let (middle, half) = (0.5 * (self.highest + lowest), 0.5 * (self.highest - lowest));
        let mut before = half / middle;
        for step in 0..self.degree {
            level.scale(&vectors.residual, &mut vectors.product);
            let (keep, add) = if step == 0 {
                (0.0, 1.0 / middle)
            } else {
                let next = 1.0 / (2.0 * middle / half - before);
                let factors = (next * before, 2.0 * next / half);
                before = next;
                factors
            };
            let (keep, add) = (T::from_f64(keep), T::from_f64(add));
            for node in 0..x.len() {
                // The direction means nothing before the first step.
                let kept = if step == 0 { Vec3::ZERO } else { vectors.direction[node] * keep };
                vectors.direction[node] = vectors.product[node].mul_add(add, kept);
                x[node] += vectors.direction[node];
            }
            if residual_is_needed || step + 1 < self.degree {
                vectors.follow(level);
            }
        }
    }

    /// Finds the highest eigenvalue of D⁻¹A by Lanczos's method, in the form that the conjugate gradient gives it, from a residual
    /// without order in it; `x` is memory.
    pub(super) fn find_highest<T: Scalar>(
        &mut self,
        level: &mut impl Smoothed<T>,
        vectors: &mut Vectors<T>,
        x: &mut [Vec3<T>],
    ) {
        // A start among the vectors A D⁻¹ w has no part in held directions.
        for (node, direction) in vectors.residual.iter_mut().enumerate() {
            *direction = disorder(node as u32);
        }
        level.scale(&vectors.residual, x);
        level.apply(x, &mut vectors.residual);
        let mut tridiagonal = Tridiagonal::default();
        let (mut rho, mut length, mut weight) = (0.0, 0.0, 0.0);
        for step in 0..LANCZOS {
            level.scale(&vectors.residual, x);
            let next = dot(&Executor::serial(), &vectors.residual, x);
            if step > 0 {
                weight = next / rho;
            }
            rho = next;
            for (direction, &scaled) in vectors.direction.iter_mut().zip(&*x) {
                *direction = if step == 0 { scaled } else { direction.mul_add(T::from_f64(weight), scaled) };
            }
            level.apply(&vectors.direction, &mut vectors.product);
            let curvature = dot(&Executor::serial(), &vectors.direction, &vectors.product);
            // Negated, so that NaN ends it too.
            if !(curvature > 0.0 && rho > 0.0) {
                break;
            }
            let before = length;
            length = rho / curvature;
            tridiagonal.push(before, length, weight);
            for (residual, &product) in vectors.residual.iter_mut().zip(&vectors.product) {
                *residual = product.mul_add(T::from_f64(-length), *residual);
            }
        }
        let highest = MARGIN * tridiagonal.highest();
        self.highest = if highest.is_finite() && highest > 0.0 { highest } else { CORNERS };
    }
}

/// Three numbers between −1 and 1 without order from node to node.
fn disorder<T: Scalar>(node: u32) -> Vec3<T> {
    // Steele, Lea, Flood, Fast splittable pseudorandom number generators (2014): the finaliser of SplitMix64.
    let number = |axis: u64| {
        let mut bits = (u64::from(node) * 3 + axis + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        T::from_f64(((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    Vec3::new(number(0), number(1), number(2))
}

/// The matrix of Lanczos's method.
#[derive(Clone, Copy, Debug, Default)]
struct Tridiagonal {
    size: usize,
    diagonal: [f64; LANCZOS],
    /// Squares of the entries beside the diagonal.
    beside: [f64; LANCZOS],
}

impl Tridiagonal {
    /// From the lengths of this step and the one before, and the weight of the last direction in this one.
    fn push(&mut self, before: f64, length: f64, weight: f64) {
        let (own, beside) = if self.size == 0 { (0.0, 0.0) } else { (weight / before, weight / (before * before)) };
        self.diagonal[self.size] = 1.0 / length + own;
        self.beside[self.size] = beside;
        self.size += 1;
    }

    /// The highest eigenvalue, by bisection: above it every pivot of λ I − T is positive.
    fn highest(&self) -> f64 {
        let bound = |i: usize| {
            let next = if i + 1 < self.size { self.beside[i + 1] } else { 0.0 };
            self.diagonal[i] + self.beside[i].sqrt() + next.sqrt()
        };
        let (mut low, mut high) = (0.0, (0..self.size).map(bound).fold(0.0, f64::max));
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            let mut pivot = f64::INFINITY;
            let above = (0..self.size).all(|i| {
                pivot = middle - self.diagonal[i] - self.beside[i] / pivot;
                pivot > 0.0
            });
            if above { high = middle } else { low = middle }
        }
        high
    }
}

//! The modified conjugate gradient: some directions of some nodes are prescribed, and stay so exactly.
//!
//! With filters S and prescribed values z, it solves S (b − A x) = 0 among the x with (I − S) x = (I − S) z. It starts at
//! x = S·guess + (I − S) z, and every residual and direction is filtered.
//!
//! Source: Baraff, Witkin (1998), section 5.2; with the start and the scale of Ascher, Boxerman, On the modified conjugate
//! gradient method in cloth simulation (2003).

use super::{Filtered, LinearOperator, Preconditioner, Size, Start, Stride, Turn};
use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, node_blocks};
use crate::math::{Scalar, Vec3};

/// When the iteration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// After this many iterations [≥ 1]: the same time for every step.
    Iterations(u32),
    /// When the residual, in the norm of the matrix's own inverse blocks on the diagonal, is below `relative` times that of b and
    /// A x at the start: the same for every preconditioner.
    Tolerance {
        /// Share [> 0, < 1].
        relative: f64,
        /// The most iterations [≥ 1].
        at_most: u32,
    },
}

impl Stop {
    /// The most iterations.
    pub fn at_most(self) -> u32 {
        match self {
            Self::Iterations(count) | Self::Tolerance { at_most: count, .. } => count,
        }
    }

    /// Whether a solve that ended so did what was asked for.
    pub fn accepts(self, ending: Ending) -> bool {
        matches!(self, Self::Iterations(_)) || ending == Ending::Converged
    }

    fn relative(self) -> f64 {
        match self {
            Self::Iterations(_) => 0.0,
            Self::Tolerance { relative, .. } => relative,
        }
    }
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// At the tolerance, or at a residual of zero.
    Converged,
    /// At the last iteration that was allowed.
    Exhausted,
    /// At a direction p along which the matrix is not positive, p·A p ≤ 0: tissue that buckles or softens. The solution
    /// is that of the directions before, along which it was; if there was none, a step along p as long as the masses
    /// alone allow.
    NegativeCurvature,
}

/// What a solve did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveReport {
    /// Products with the matrix, without the one at the start.
    pub iterations: u32,
    /// Residual at the end over its scale, in the norm of [`Stop::Tolerance`].
    pub residual: f64,
    /// How it ended.
    pub ending: Ending,
}

/// Memory for solves of one size. Nothing is allocated later.
#[derive(Clone, Debug)]
pub struct ConjugateGradient<T> {
    residual: Vec<Vec3<T>>,
    direction: Vec<Vec3<T>>,
    product: Vec<Vec3<T>>,
    history: Vec<f64>,
}

/// What a solve is about, apart from the matrix and its preconditioner.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, T> {
    /// Right-hand side b.
    pub rhs: &'a [Vec3<T>],
    /// Filters S.
    pub filtered: Filtered<'a, T>,
    /// Prescribed values z.
    pub prescribed: &'a [Vec3<T>],
    /// A positive lower bound of the matrix, one number for each node: its part that comes from the masses.
    pub masses: &'a [T],
    /// Who computes.
    pub executor: &'a Executor,
}

impl<T: Scalar> ConjugateGradient<T> {
    /// Memory for `nodes` nodes and up to `iterations` iterations.
    pub fn new(nodes: usize, iterations: u32) -> Self {
        let zeros = || vec![Vec3::ZERO; nodes];
        let history = Vec::with_capacity(iterations as usize + 1);
        Self { residual: zeros(), direction: zeros(), product: zeros(), history }
    }

    /// Residuals of the last solve over their scale: at the start and after each iteration.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    /// Takes over the residuals of a solve in which this one had its part.
    pub(crate) fn note_history_of(&mut self, other: &Self) {
        self.history.clone_from(&other.history);
    }

    /// Solves for `x`, which holds the guess. Iterations beyond those that memory was asked for are not made.
    pub fn solve(
        &mut self,
        matrix: &mut impl LinearOperator<T>,
        preconditioner: &mut impl Preconditioner<T>,
        problem: &Problem<'_, T>,
        stop: Stop,
        x: &mut [Vec3<T>],
    ) -> SolveReport {
        let executor = problem.executor;
        self.history.clear();
        let (mut size, scale) = self.start(matrix, preconditioner, problem, x);
        let goal = stop.relative() * scale;
        self.note(size.squared_norm, scale);
        let mut weight = None;
        let mut ending = Ending::Exhausted;
        let mut iterations = 0;
        let at_most = stop.at_most().min((self.history.capacity() as u32).saturating_sub(1));
        while iterations < at_most {
            if size.squared_norm.sqrt() <= goal || size.corrected <= 0.0 {
                ending = Ending::Converged;
                break;
            }
            let (Self { residual, direction, product, .. }, filtered) = (&mut *self, problem.filtered);
            let curvature = matrix.apply_along(Turn { weight, direction, product, filtered }, executor);
            iterations += 1;
            if curvature.is_nan() || curvature <= 0.0 {
                if iterations == 1 {
                    self.step_against_masses(matrix, problem, size.corrected, x);
                }
                ending = Ending::NegativeCurvature;
                break;
            }
            let length = T::from_f64(size.corrected / curvature);
            let stride = Stride { length, direction, x, residual, product, filtered };
            let next = preconditioner.stride(matrix, stride, executor);
            weight = Some(T::from_f64(next.corrected / size.corrected));
            size = next;
            self.note(size.squared_norm, scale);
        }
        if ending == Ending::Exhausted && size.squared_norm.sqrt() <= goal {
            ending = Ending::Converged;
        }
        SolveReport { iterations, residual: self.history.last().copied().unwrap_or(0.0), ending }
    }

    /// Puts x to S·guess + (I − S) z and the residual to S (b − A x); gives its size and the scale of residuals.
    fn start(
        &mut self,
        matrix: &mut impl LinearOperator<T>,
        preconditioner: &mut impl Preconditioner<T>,
        problem: &Problem<'_, T>,
        x: &mut [Vec3<T>],
    ) -> (Size, f64) {
        let executor = problem.executor;
        let (Self { residual, direction, product, .. }, filtered) = (self, problem.filtered);
        let data = (NodeBlocks(x), NodeBlocks(&mut *product));
        executor.each(node_blocks(data.0.0.len()), data, &|block, (NodeBlocks(x), NodeBlocks(product))| {
            filtered.merge(block * NODE_BLOCK, x, problem.prescribed);
            product.copy_from_slice(x);
        });
        matrix.apply_along(Turn { weight: None, direction, product, filtered }, executor);
        preconditioner.start(matrix, Start { rhs: problem.rhs, direction, product, residual, filtered }, executor)
    }

    /// x + p ρ/(p·M p): the step along the first direction if the masses were the whole matrix.
    fn step_against_masses(
        &mut self,
        matrix: &impl LinearOperator<T>,
        problem: &Problem<'_, T>,
        rho: f64,
        x: &mut [Vec3<T>],
    ) {
        let blocks = self.direction.chunks_mut(NODE_BLOCK).zip(self.product.chunks_mut(NODE_BLOCK));
        blocks.enumerate().for_each(|(block, (p, q))| matrix.finish(block, p, q));
        let along = self.direction.iter().zip(problem.masses);
        let inertia: f64 = along.map(|(p, &mass)| (p.squared_norm() * mass).to_f64()).sum();
        if inertia > 0.0 {
            let length = T::from_f64(rho / inertia);
            for (x, &direction) in x.iter_mut().zip(&self.direction) {
                *x = direction.mul_add(length, *x);
            }
        }
    }

    fn note(&mut self, square: f64, scale: f64) {
        self.history.push(if scale > 0.0 { square.max(0.0).sqrt() / scale } else { 0.0 });
    }
}

use super::galerkin::Coarsening;
use super::level_matrix::LevelMatrix;
use super::skyline::Skyline;
use super::smoother::{Chebyshev, Smoothed, Vectors};
use crate::math::{Mat3, Scalar, Vec3};
use crate::solver::block_jacobi::positive_inverse;

/// A lattice, its matrix, and what corrects on it.
#[derive(Clone, Debug)]
pub(super) struct Level<T> {
    pub(super) matrix: LevelMatrix<T>,
    /// Inverses of the blocks on the diagonal.
    inverses: Vec<Mat3<T>>,
    smoother: Chebyshev,
    /// Its residual is the right-hand side when a cycle begins.
    pub(super) vectors: Vectors<T>,
    /// The correction when it ends.
    pub(super) x: Vec<Vec3<T>>,
    next: Next,
}

/// What a level leaves its error to.
#[derive(Clone, Debug)]
enum Next {
    Coarser(Coarsening),
    Direct(Skyline),
}

struct Diagonal<'a, T> {
    matrix: &'a LevelMatrix<T>,
    inverses: &'a [Mat3<T>],
}

impl<T: Scalar> Smoothed<T> for Diagonal<'_, T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        self.matrix.apply(x, out);
    }

    fn scale(&mut self, residual: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for ((out, &residual), inverse) in out.iter_mut().zip(residual).zip(self.inverses) {
            *out = *inverse * residual;
        }
    }
}

impl<T: Scalar> Level<T> {
    /// A level that corrects by smoothing and the next.
    pub(super) fn smoothed(matrix: LevelMatrix<T>, coarsening: Coarsening, degree: u32) -> Self {
        Self::new(matrix, Next::Coarser(coarsening), degree)
    }

    /// The last level, which is solved.
    pub(super) fn direct(matrix: LevelMatrix<T>) -> Self {
        let skyline = Skyline::new(&matrix);
        Self::new(matrix, Next::Direct(skyline), 0)
    }

    fn new(matrix: LevelMatrix<T>, next: Next, degree: u32) -> Self {
        let nodes = matrix.rows();
        Self {
            matrix,
            inverses: vec![Mat3::ZERO; nodes],
            smoother: Chebyshev::new(degree),
            vectors: Vectors::new(nodes),
            x: vec![Vec3::ZERO; nodes],
            next,
        }
    }

    /// Prepares for the matrix as it is now, and makes that of the next level.
    pub(super) fn set_up(&mut self, coarser: Option<&mut Self>) {
        match (&mut self.next, coarser) {
            (Next::Coarser(coarsening), Some(coarser)) => {
                coarsening.restrict_matrix(&self.matrix, &mut coarser.matrix);
                for (node, inverse) in self.inverses.iter_mut().enumerate() {
                    *inverse = inverted(&self.matrix.blocks[self.matrix.index(node as u32, node as u32) as usize]);
                }
                let mut diagonal = Diagonal { matrix: &self.matrix, inverses: &self.inverses };
                self.smoother.find_highest(&mut diagonal, &mut self.vectors, &mut self.x);
            }
            (Next::Direct(skyline), _) => skyline.factor(&self.matrix),
            (Next::Coarser(_), None) => {}
        }
    }
}

/// The correction of the first of these levels for the right-hand side in its residual, into its x, by so many `rounds` on it. All
/// below it make two (a W-cycle): with one, a liver of 171 000 tetrahedra took 26 iterations where it takes 19, for a
/// hundredth of the time.
pub(super) fn correct<T: Scalar>(levels: &mut [Level<T>], rounds: u32) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    match &mut level.next {
        Next::Direct(skyline) => skyline.solve(&level.vectors.residual, &mut level.x),
        Next::Coarser(coarsening) => {
            let mut diagonal = Diagonal { matrix: &level.matrix, inverses: &level.inverses };
            level.x.fill(Vec3::ZERO);
            for round in 1..=rounds {
                level.smoother.smooth(&mut diagonal, &mut level.vectors, &mut level.x, true);
                coarsening.restrict(&level.vectors.residual, &mut coarser[0].vectors.residual);
                correct(coarser, 2);
                coarsening.prolong(&coarser[0].x, &mut level.vectors.direction);
                level.x.iter_mut().zip(&level.vectors.direction).for_each(|(x, &correction)| *x += correction);
                level.vectors.follow(&mut diagonal);
                level.smoother.smooth(&mut diagonal, &mut level.vectors, &mut level.x, round < rounds);
            }
        }
    }
}

/// The inverse of a block on the diagonal; where that is not positive, of a multiple of the identity that is as large, and zero
/// where there is nothing.
fn inverted<T: Scalar>(block: &Mat3<T>) -> Mat3<T> {
    let (inverse, is_positive) = positive_inverse(block.symmetric_part());
    if is_positive {
        return Mat3::from(inverse);
    }
    let size = block.squared_norm().sqrt();
    if size > T::ZERO { Mat3::diagonal(T::ONE / size) } else { Mat3::ZERO }
}

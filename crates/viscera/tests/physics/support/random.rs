//! Random numbers that are the same in every run (splitmix64).

use super::{Matrix, Vector};

pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Uniform below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }

    pub(crate) fn vector(&mut self) -> Vector {
        Vector::new(self.signed(), self.signed(), self.signed())
    }

    pub(crate) fn vectors(&mut self, count: usize, length: f64) -> Vec<Vector> {
        (0..count).map(|_| self.vector() * length).collect()
    }

    pub(crate) fn matrix(&mut self) -> Matrix {
        Matrix::from_columns(self.vector(), self.vector(), self.vector())
    }

    /// I plus a random matrix with entries up to `size`: a deformation gradient.
    pub(crate) fn deformation(&mut self, size: f64) -> Matrix {
        Matrix::IDENTITY + self.matrix() * size
    }

    /// A rotation of any angle about any axis.
    pub(crate) fn rotation(&mut self) -> Matrix {
        let first = self.vector().normalized().unwrap();
        let third = first.cross(self.vector()).normalized().unwrap();
        Matrix::from_columns(first, third.cross(first), third)
    }

    /// The numbers below `count` in random order.
    pub(crate) fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }
}

//! Multigrid: what couples near is corrected on the mesh, what couples far on coarser and coarser lattices that cover it, so
//! that the number of iterations does not grow with the number of cells.
//!
//! A cycle smooths by a Chebyshev polynomial of D⁻¹A, restricts what is left of the residual to the first lattice, corrects there
//! in the same way, and on those below it twice, interpolates and smooths again. Coarse matrices are Wᵀ A W, from the cells that are there and as they
//! are deformed; products on the mesh stay free of a matrix. The lattices are laid over the rest shape, where moving and
//! straining a body as a whole are among their functions; turning it is too, for as long as it is not bent within a cell
//! of the lattice. Where cells were removed they are laid anew: as far as tissue does not reach across a cut, nor does a lattice.
//!
//! With E = I − p(D⁻¹A) D⁻¹A, the error that smoothing leaves, and a coarse correction C = W B W ᵀ, the cycle is
//! (I − E²) A⁻¹ + E C Eᵀ; no error grows under E, and B is not negative, so that it is symmetric and positive definite for every
//! symmetric A: under held directions, for loose pieces, and where tissue softens.
//!
//! Source: Briggs, Henson, McCormick, A multigrid tutorial (2000), chapters 3 and 10.

mod galerkin;
mod lattice;
mod level;
mod level_matrix;
mod skyline;
mod smoother;

use self::galerkin::{Coarsening, FineBlocks};
use self::lattice::{Interpolation, Lattice};
use self::level::{Level, correct};
use self::smoother::{Chebyshev, Smoothed, Vectors};
use super::block_matrix::pattern;
use super::{BlockJacobi, Filter, LinearOperator, Preconditioner, Size, dot};
use crate::executor::Executor;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::VolumeMesh;
use crate::solver::{BlockSink, Reach};

/// A lattice of at most so many nodes is solved directly.
const DIRECT: usize = 100;
/// Degree of the polynomial on the mesh. One takes as long with half as many iterations again, three takes longer.
const DEGREE: u32 = 2;
/// Degree of those on the lattices, where products cost little: two takes as long with up to a fifth more iterations, most where tissue is cut.
const DEGREE_ON_LATTICES: u32 = 3;

/// Lattices over a body as it is cut, and what a cycle knows about a matrix beside the blocks on its diagonal.
#[derive(Clone, Debug)]
pub struct Multigrid<T> {
    interpolation: Interpolation<T>,
    blocks: FineBlocks<T>,
    smoother: Chebyshev,
    vectors: Vectors<T>,
    /// Memory for one more nodal array.
    nodal: Vec<Vec3<T>>,
    levels: Vec<Level<T>>,
    /// The cells that were removed when the lattices were laid.
    removed: Vec<bool>,
}

impl<T: Scalar> Multigrid<T> {
    /// Memory for a body of `mesh`, of models whose forces reach so far. Nothing is allocated later, but by [`Multigrid::follow`].
    pub fn new<'a>(mesh: &VolumeMesh, reach: impl Into<Reach<'a>>) -> Self {
        Self::over(mesh, reach.into(), &vec![false; mesh.cell_count()])
    }

    /// Lays the lattices anew if other cells are `removed` than when that was done last.
    pub fn follow<'a>(&mut self, mesh: &VolumeMesh, reach: impl Into<Reach<'a>>, removed: &[bool]) {
        if self.removed != removed {
            *self = Self::over(mesh, reach.into(), removed);
        }
    }

    fn over(mesh: &VolumeMesh, reach: Reach<'_>, removed: &[bool]) -> Self {
        let neighbours = pattern(mesh, reach, removed);
        let (mut lattice, interpolation) = Lattice::over(mesh, &neighbours);
        let (blocks, mut matrix) = FineBlocks::new(&neighbours, &interpolation, lattice.len());
        let mut levels = Vec::new();
        while lattice.len() > DIRECT {
            let (coarse, parents) = lattice.coarser(&matrix);
            let (coarsening, next) = Coarsening::new(&matrix, parents, coarse.len());
            levels.push(Level::smoothed(matrix, coarsening, DEGREE_ON_LATTICES));
            (lattice, matrix) = (coarse, next);
        }
        levels.push(Level::direct(matrix));
        let nodes = mesh.nodes().len();
        let (smoother, vectors) = (Chebyshev::new(DEGREE), Vectors::new(nodes));
        let (nodal, removed) = (vec![Vec3::ZERO; nodes], removed.to_vec());
        Self { interpolation, blocks, smoother, vectors, nodal, levels, removed }
    }

    /// Clears the blocks of the stiffness K before new ones are added.
    pub fn clear(&mut self) {
        self.blocks.clear();
    }

    /// Prepares for the matrix A = K + `masses` I [kg/s²], from the blocks of K that were added, products with A, and the
    /// inverse blocks on A's diagonal. Takes as long as a dozen products; adding the blocks, three times that.
    pub fn set_up<'a>(
        &'a mut self,
        matrix: &mut dyn LinearOperator<T>,
        diagonal: &'a mut BlockJacobi<T>,
        filters: &[Filter<T>],
        masses: &[T],
        executor: &Executor,
    ) -> Cycle<'a, T> {
        self.blocks.restrict(&self.interpolation, filters, masses, &mut self.levels[0].matrix);
        for number in 0..self.levels.len() {
            let (own, coarser) = self.levels.split_at_mut(number + 1);
            own[number].set_up(coarser.first_mut());
        }
        let mut mesh = Mesh { matrix, diagonal, filters, executor };
        self.smoother.find_highest(&mut mesh, &mut self.vectors, &mut self.nodal);
        Cycle { multigrid: self, diagonal }
    }
}

impl<T: Scalar> BlockSink<T> for Multigrid<T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.blocks.add(row, column, block);
    }
}

/// The mesh itself as a level.
struct Mesh<'a, T: Scalar> {
    matrix: &'a mut dyn LinearOperator<T>,
    diagonal: &'a mut BlockJacobi<T>,
    filters: &'a [Filter<T>],
    executor: &'a Executor,
}

impl<T: Scalar> Smoothed<T> for Mesh<'_, T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        self.matrix.apply(x, out);
        out.iter_mut().zip(self.filters).for_each(|(out, filter)| *out = filter.apply(*out));
    }

    fn scale(&mut self, residual: &[Vec3<T>], out: &mut [Vec3<T>]) {
        self.diagonal.apply(self.matrix, self.filters, residual, out, self.executor);
    }
}

/// One cycle as a preconditioner, for the matrix that it was set up for.
#[derive(Debug)]
pub struct Cycle<'a, T> {
    multigrid: &'a mut Multigrid<T>,
    diagonal: &'a mut BlockJacobi<T>,
}

impl<T: Scalar> Preconditioner<T> for Cycle<'_, T> {
    fn apply(
        &mut self,
        matrix: &mut dyn LinearOperator<T>,
        filters: &[Filter<T>],
        residual: &[Vec3<T>],
        corrected: &mut [Vec3<T>],
        executor: &Executor,
    ) -> Size {
        let Multigrid { interpolation, smoother, vectors, levels, .. } = &mut *self.multigrid;
        let mut mesh = Mesh { matrix, diagonal: self.diagonal, filters, executor };
        // What rounding leaves of a residual in held directions, small beside the reactions there, is large beside a residual that
        // is nearly gone, and the lattices would take it for a load: solves to 1e-13 never came to an end.
        for (node, own) in vectors.residual.iter_mut().enumerate() {
            *own = filters[node].apply(residual[node]);
        }
        let squared_norm = mesh.diagonal.squared_norm(&vectors.residual, executor);
        corrected.fill(Vec3::ZERO);
        smoother.smooth(&mut mesh, vectors, corrected, true);
        interpolation.restrict(&vectors.residual, &mut levels[0].vectors.residual);
        correct(levels, 1);
        interpolation.prolong(&levels[0].x, &mut vectors.direction);
        for (node, corrected) in corrected.iter_mut().enumerate() {
            vectors.direction[node] = filters[node].apply(vectors.direction[node]);
            *corrected += vectors.direction[node];
        }
        vectors.follow(&mut mesh);
        smoother.smooth(&mut mesh, vectors, corrected, false);
        let work = dot(executor, residual, corrected);
        if work > 0.0 {
            return Size { corrected: work, squared_norm };
        }
        // Lanczos's method can miss a highest eigenvalue that stands alone. Then the blocks on the diagonal have to do.
        self.diagonal.apply(matrix, filters, residual, corrected, executor)
    }

    fn squared_norm(&self, residual: &[Vec3<T>], executor: &Executor) -> f64 {
        self.diagonal.squared_norm(residual, executor)
    }
}

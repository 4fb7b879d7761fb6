use super::vectors::{combine_into, dot_of};
use super::{Filter, Filtered, LinearOperator, Preconditioner, Size, Start, Stride};
use crate::executor::{Executor, NODE_BLOCK, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Sym3, Vec3, dispatch, dispatch_level};
use crate::solver::BlockSink;

/// Block-Jacobi preconditioner: the inverses of the 3×3 blocks on the diagonal, one for each node.
#[derive(Clone, Debug, Default)]
pub struct BlockJacobi<T> {
    /// The blocks of K that are added one by one.
    blocks: Vec<Mat3<T>>,
    /// Traces of the blocks of K that were inverted.
    traces: Vec<T>,
    /// Inverses of the blocks of the matrix: xx, yy, zz, xy, xz, yz of all nodes. One array for each, and the compiler makes
    /// whole registers of a plain loop (five times faster than blocks of eight nodes, measured).
    inverses: [Vec<T>; 6],
}

/// A block whose determinant is below this share of that of a ball of the same trace counts as singular.
const SINGULAR: f64 = 1e-6;

impl<T: Scalar> BlockJacobi<T> {
    /// Memory for `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        let inverses = std::array::from_fn(|_| vec![T::ZERO; nodes]);
        Self { blocks: vec![Mat3::ZERO; nodes], traces: vec![T::ZERO; nodes], inverses }
    }

    /// Clears the blocks before new ones are added.
    pub fn clear(&mut self) {
        self.blocks.fill(Mat3::ZERO);
    }

    /// The blocks of K.
    pub fn blocks_mut(&mut self) -> &mut [Mat3<T>] {
        &mut self.blocks
    }

    /// Inverts the blocks K + `masses` I [kg/s²]. Where that is not positive definite (tissue under compression), the mass alone
    /// stands in: a preconditioner has to be positive definite, whatever the matrix is.
    ///
    /// The `filters` go into the inverses, S P⁻¹ S, so that nothing across them counts.
    pub fn invert(&mut self, masses: &[T], filters: Filtered<'_, T>, executor: &Executor) {
        let blocks = std::mem::take(&mut self.blocks);
        let find = |block: usize, found: &mut [Sym3<T>]| {
            let added = &blocks[block * NODE_BLOCK..];
            found.iter_mut().zip(added).for_each(|(found, block)| *found = block.symmetric_part());
        };
        self.invert_found(&find, masses, filters, executor);
        self.blocks = blocks;
    }

    /// The same with the blocks of K that `find` writes, for a block of nodes as loops over nodes divide them, and none that were added.
    pub(crate) fn invert_found(
        &mut self,
        find: &(impl Fn(usize, &mut [Sym3<T>]) + Sync),
        masses: &[T],
        filters: Filtered<'_, T>,
        executor: &Executor,
    ) {
        let [xx, yy, zz, xy, xz, yz] = self.inverses.each_mut().map(|numbers| NodeBlocks(numbers.as_mut_slice()));
        let data = (((xx, yy), (zz, xy)), ((xz, yz), NodeBlocks(&mut self.traces[..])));
        let work = |number: usize, (((xx, yy), (zz, xy)), ((xz, yz), NodeBlocks(traces))): Inverting<'_, T>| {
            let nodes = number * NODE_BLOCK..number * NODE_BLOCK + traces.len();
            let mut blocks = [Sym3::diagonal(T::ZERO); NODE_BLOCK];
            let blocks = &mut blocks[..nodes.len()];
            find(number, blocks);
            let mut inverses = [xx.0, yy.0, zz.0, xy.0, xz.0, yz.0];
            dispatch!(dispatch_level(), _simd => invert_block(blocks, &masses[nodes.clone()], traces, &mut inverses));
            for node in filters.nodes(nodes.start, nodes.len()) {
                let (filter, node) = (&filters.filters[node], node - nodes.start);
                let [xx, yy, zz, xy, xz, yz] = inverses.each_ref().map(|numbers| numbers[node]);
                let filtered = filtered(Sym3 { xx, yy, zz, xy, xz, yz }, filter);
                put(filtered, node, &mut inverses);
            }
        };
        executor.each(node_blocks(masses.len()), data, &work);
    }

    /// Traces of the blocks of K that were inverted last.
    pub(crate) fn traces(&self) -> &[T] {
        &self.traces
    }

    /// Takes the inverses of another one, times `factor`, as those of the nodes from `start` on.
    pub(crate) fn take(&mut self, start: usize, other: &Self, factor: T) {
        for (own, other) in self.inverses.iter_mut().zip(&other.inverses) {
            own[start..start + other.len()].iter_mut().zip(other).for_each(|(own, &other)| *own = other * factor);
        }
    }

    /// P⁻¹ of a node.
    pub(crate) fn inverse(&self, node: usize) -> Mat3<T> {
        let [xx, yy, zz, xy, xz, yz] = self.inverses.each_ref().map(|numbers| numbers[node]);
        Mat3::from(Sym3 { xx, yy, zz, xy, xz, yz })
    }

    /// P⁻¹ r of a block of nodes into `corrected`, and r·P⁻¹ r.
    #[inline(always)]
    fn apply_to_block(&self, block: usize, residual: &[Vec3<T>], corrected: &mut [Vec3<T>]) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.inverses.each_ref().map(|numbers| &numbers[block * NODE_BLOCK..]);
        let diagonal = xx.iter().zip(yy).zip(zz);
        let apart = xy.iter().zip(xz).zip(yz);
        for (((z, &r), ((&xx, &yy), &zz)), ((&xy, &xz), &yz)) in
            corrected.iter_mut().zip(residual).zip(diagonal).zip(apart)
        {
            *z = Vec3::new(
                xx * r.x + xy * r.y + xz * r.z,
                xy * r.x + yy * r.y + yz * r.z,
                xz * r.x + yz * r.y + zz * r.z,
            );
        }
        dot_of(residual, corrected)
    }
}

impl<T: Scalar> Preconditioner<T> for BlockJacobi<T> {
    fn apply(
        &mut self,
        _matrix: &mut dyn LinearOperator<T>,
        _filters: &[Filter<T>],
        residual: &[Vec3<T>],
        corrected: &mut [Vec3<T>],
        executor: &Executor,
    ) -> Size {
        let (this, blocks) = (&*self, node_blocks(residual.len()));
        let work = |block, (ReadBlocks(r), NodeBlocks(z)): (ReadBlocks<'_, Vec3<T>>, NodeBlocks<'_, Vec3<T>>)| dispatch!(dispatch_level(), _simd => this.apply_to_block(block, r, z));
        let square = executor.fold(blocks, (ReadBlocks(residual), NodeBlocks(corrected)), &work, &|a, b| a + b);
        let square = square.unwrap_or(0.0);
        Size { corrected: square, squared_norm: square }
    }

    fn start(&mut self, matrix: &mut dyn LinearOperator<T>, start: Start<'_, T>, executor: &Executor) -> (Size, f64) {
        let Start { rhs, direction, product, residual, filtered } = start;
        let (this, matrix, blocks) = (&*self, &*matrix, node_blocks(rhs.len()));
        let data = ((NodeBlocks(residual), ReadBlocks(rhs)), (NodeBlocks(product), NodeBlocks(direction)));
        let work = |block, ((NodeBlocks(r), ReadBlocks(b)), (NodeBlocks(q), NodeBlocks(p))): Starting<'_, T>| {
            matrix.finish(block, p, q);
            filtered.apply(block * NODE_BLOCK, q);
            r.copy_from_slice(b);
            filtered.apply(block * NODE_BLOCK, r);
            let squares = dispatch!(dispatch_level(), _simd => {
                // The direction means nothing before the first turn.
                let of_rhs = this.apply_to_block(block, r, p);
                let of_product = this.apply_to_block(block, q, p);
                combine_into(r, T::ONE, -T::ONE, q);
                [of_rhs, of_product, this.apply_to_block(block, r, q)]
            });
            filtered.apply_to_sliding(block * NODE_BLOCK, q);
            squares
        };
        let squares = executor.fold(blocks, data, &work, &|a, b| std::array::from_fn(|i| a[i] + b[i]));
        let [of_rhs, of_product, square] = squares.unwrap_or_default();
        (Size { corrected: square, squared_norm: square }, of_rhs.sqrt() + of_product.sqrt())
    }

    fn stride(&mut self, matrix: &mut dyn LinearOperator<T>, stride: Stride<'_, T>, executor: &Executor) -> Size {
        let Stride { length, direction, x, residual, product, filtered } = stride;
        let (this, matrix, blocks) = (&*self, &*matrix, node_blocks(residual.len()));
        let data = ((NodeBlocks(x), NodeBlocks(residual)), (NodeBlocks(product), NodeBlocks(direction)));
        let work = |block, ((NodeBlocks(x), NodeBlocks(r)), (NodeBlocks(q), NodeBlocks(p))): Striding<'_, T>| {
            matrix.finish(block, p, q);
            // Held nodes have zeros in P⁻¹, and nobody reads the residual that reactions leave there.
            filtered.apply_to_sliding(block * NODE_BLOCK, q);
            let square = dispatch!(dispatch_level(), _simd => {
                combine_into(x, T::ONE, length, p);
                combine_into(r, T::ONE, -length, q);
                this.apply_to_block(block, r, q)
            });
            filtered.apply_to_sliding(block * NODE_BLOCK, q);
            square
        };
        let square = executor.fold(blocks, data, &work, &|a, b| a + b).unwrap_or(0.0);
        Size { corrected: square, squared_norm: square }
    }

    fn squared_norm(&self, residual: &[Vec3<T>], executor: &Executor) -> f64 {
        let work = |block: usize, ReadBlocks(r): ReadBlocks<'_, Vec3<T>>| {
            let mut corrected = [Vec3::ZERO; NODE_BLOCK];
            dispatch!(dispatch_level(), _simd => self.apply_to_block(block, r, &mut corrected[..r.len()]))
        };
        executor.fold(node_blocks(residual.len()), ReadBlocks(residual), &work, &|a, b| a + b).unwrap_or(0.0)
    }
}

/// r, b, q and p of a [`Start`].
type Starting<'a, T> =
    ((NodeBlocks<'a, Vec3<T>>, ReadBlocks<'a, Vec3<T>>), (NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>));

/// x, r, q and p of a [`Stride`].
type Striding<'a, T> =
    ((NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>), (NodeBlocks<'a, Vec3<T>>, NodeBlocks<'a, Vec3<T>>));

/// The inverses' six numbers, and the traces.
type Inverting<'a, T> = (
    ((NodeBlocks<'a, T>, NodeBlocks<'a, T>), (NodeBlocks<'a, T>, NodeBlocks<'a, T>)),
    ((NodeBlocks<'a, T>, NodeBlocks<'a, T>), NodeBlocks<'a, T>),
);

/// (K + m I)⁻¹, or 1/m where that is not positive definite. The compiler makes whole registers of the second loop, but not of
/// one that reads the blocks as well.
#[inline(always)]
fn invert_block<T: Scalar>(blocks: &[Sym3<T>], masses: &[T], traces: &mut [T], inverses: &mut [&mut [T]; 6]) {
    for (node, ((&block, &mass), trace)) in blocks.iter().zip(masses).zip(traces).enumerate() {
        *trace = block.trace();
        put(block + Sym3::diagonal(mass), node, inverses);
    }
    let [xx, yy, zz, xy, xz, yz] = inverses.each_mut().map(|numbers| numbers.iter_mut());
    for ((((((xx, yy), zz), xy), xz), yz), &mass) in xx.zip(yy).zip(zz).zip(xy).zip(xz).zip(yz).zip(masses) {
        let (inverse, is_positive) = positive_inverse(Sym3 { xx: *xx, yy: *yy, zz: *zz, xy: *xy, xz: *xz, yz: *yz });
        let alone = if mass > T::ZERO { T::ONE / mass } else { T::ONE };
        let or = |inverse: T, alone: T| if is_positive { inverse } else { alone };
        (*xx, *yy, *zz) = (or(inverse.xx, alone), or(inverse.yy, alone), or(inverse.zz, alone));
        (*xy, *xz, *yz) = (or(inverse.xy, T::ZERO), or(inverse.xz, T::ZERO), or(inverse.yz, T::ZERO));
    }
}

#[inline(always)]
fn put<T: Copy>(block: Sym3<T>, node: usize, numbers: &mut [&mut [T]; 6]) {
    let Sym3 { xx, yy, zz, xy, xz, yz } = block;
    for (numbers, number) in numbers.iter_mut().zip([xx, yy, zz, xy, xz, yz]) {
        numbers[node] = number;
    }
}

/// S A S.
fn filtered<T: Scalar>(block: Sym3<T>, filter: &Filter<T>) -> Sym3<T> {
    let columns = |block: Mat3<T>| Mat3 { columns: block.columns.map(|column| filter.apply(column)) };
    columns(columns(Mat3::from(block)).transpose()).symmetric_part()
}

/// A⁻¹, and whether A is positive definite: without, it means nothing. Sylvester's criterion, with a margin to singularity that is relative to the
/// block's own size.
#[inline(always)]
pub(super) fn positive_inverse<T: Scalar>(block: Sym3<T>) -> (Sym3<T>, bool) {
    let (size, margin) = (block.trace() / T::from_f64(3.0), T::from_f64(SINGULAR));
    let unit = block * (T::ONE / size);
    let cofactor = unit.cofactor();
    let determinant = unit.xx * cofactor.xx + unit.xy * cofactor.xy + unit.xz * cofactor.xz;
    let is_positive = (size > T::ZERO) & (unit.xx > margin) & (cofactor.zz > margin) & (determinant > margin);
    (cofactor * (T::ONE / (size * determinant)), is_positive)
}

impl<T: Scalar> BlockSink<T> for BlockJacobi<T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        if row == column {
            self.blocks[row as usize] += block;
        }
    }

    fn keeps_diagonal_only(&self) -> bool {
        true
    }
}

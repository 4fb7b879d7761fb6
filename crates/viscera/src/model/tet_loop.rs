//! The loop over tetrahedra that models share: a kernel with its constants, along the fans of all patches.

use std::marker::PhantomData;
use std::sync::Arc;

use super::block_sink::add_tet_blocks;
use super::block_table::BlockTable;
use super::lane_vector;
use super::patch::{Diagonal, Element, Measure, Measured, Patches, Shared, TetFans};
use super::{BlockSink, ModelError, Scratch};
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Sym3, Vec3};
use crate::mesh::{MeshError, TetMesh};
use crate::solver::Turn;

/// The most constants that a kernel may keep for an element.
pub(crate) const MAX_CONSTANTS: usize = 24;

/// The numbers that a kernel keeps for an element.
pub(crate) trait TetConstants: Clone + Send + Sync + 'static {
    /// How many there are, at most [`MAX_CONSTANTS`].
    const CONSTANTS: usize;

    /// Switches an element off for good.
    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize);
}

/// What happens within one tetrahedron, as a function of its edge matrix D = [x1−x0, x2−x0, x3−x0].
pub(crate) trait TetKernel: TetConstants {
    /// Energy W(D) [J].
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R;
    /// Internal forces [f1 f2 f3] = ∂W/∂D [N]; that on corner 0 is minus their sum.
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R>;
    /// Whether [`TetKernel::forces_in_fan`] makes use of what tetrahedra share.
    const IS_SHARING: bool = false;
    /// [`TetKernel::forces`] with what the tetrahedra of a fan share.
    #[inline(always)]
    fn forces_in_fan<R: Real>(constants: &[R], d: &Mat3<R>, _shared: &Shared<R>) -> Mat3<R> {
        Self::forces(constants, d)
    }
    /// Whether [`TetKernel::mean_forces`] keeps energy.
    const KEEPS_ENERGY: bool = false;
    /// Forces between the edge matrices `from` and `to`; those in the middle, unless the kernel knows better.
    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        Self::forces(constants, &((*from + *to) * from.columns[0].x.like(0.5)))
    }
    /// Derivative of [`TetKernel::forces`] along `dd`.
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R>;
    /// Whether [`TetKernel::diagonal`] is written out.
    const HAS_DIAGONAL: bool = false;
    /// The blocks of the stiffness on the diagonal, of corners 0 to 3; three products each, unless the kernel knows better.
    #[inline(always)]
    fn diagonal<R: Real>(constants: &[R], d: &Mat3<R>) -> [Sym3<R>; 4] {
        let zero = d.columns[0].x.zero_like();
        let mut blocks = [Sym3::diagonal(zero); 4];
        for corner in 0..4 {
            let mut block = Mat3::diagonal(zero);
            for axis in 0..3 {
                let mut edges = [Vec3::splat(zero); 3];
                for edge in 0..3 {
                    if corner == 0 {
                        edges[edge][axis] = zero.like(-1.0);
                    } else if corner == edge + 1 {
                        edges[edge][axis] = zero.like(1.0);
                    }
                }
                let [f1, f2, f3] = Self::product(constants, d, &Mat3 { columns: edges }).columns;
                block.columns[axis] = if corner == 0 { -(f1 + f2 + f3) } else { [f1, f2, f3][corner - 1] };
            }
            blocks[corner] = block.symmetric_part();
        }
        blocks
    }
}

/// A number that tells something about a tetrahedron, as a function of its edge matrix.
pub(crate) trait TetMeasure: TetConstants {
    /// The number.
    fn measure<R: Real>(constants: &[R], d: &Mat3<R>) -> R;
}

/// A tetrahedron at rest, in double precision: what constants are computed from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RestTet {
    /// Which cell it is.
    pub(crate) cell: usize,
    /// Dm⁻¹, the inverse of the edge matrix; its rows are the gradients of the shape functions 1, 2, 3 [1/m].
    pub(crate) inverse: Mat3<f64>,
    /// Volume [m³], > 0 for a cell in its own order.
    pub(crate) volume: f64,
}

impl RestTet {
    /// The tetrahedron `cell` of `mesh`.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] where the volume is not positive, or no larger than rounding makes that of four corners
    /// in a plane: ε |x| h², with h the longest edge.
    pub(crate) fn new(mesh: &TetMesh, cell: usize) -> Result<Self, MeshError> {
        let rest = Self::measure(mesh, cell);
        let reach = mesh.corners(cell).map(|corner| corner.norm()).into_iter().fold(0.0, f64::max);
        let edge = mesh.edge_matrix(cell).columns.map(|edge| edge.squared_norm()).into_iter().fold(0.0, f64::max);
        if rest.volume > 4.0 * f64::EPSILON * reach * edge && rest.inverse.is_finite() {
            Ok(rest)
        } else {
            Err(MeshError::Degenerate { cell, corners: mesh.cells[cell].to_vec() })
        }
    }

    /// The same for a cell that is known to have a volume.
    pub(crate) fn measure(mesh: &TetMesh, cell: usize) -> Self {
        let edges = mesh.edge_matrix(cell);
        Self { cell, inverse: edges.inverse(), volume: edges.determinant() / 6.0 }
    }

    /// A cell of the mesh with its corners in another order. Where that is an odd permutation, the volume is negative.
    pub(crate) fn turned(mesh: &TetMesh, cell: usize, corners: [u32; 4]) -> Self {
        let edges = edge_matrix(&mesh.nodes, corners);
        Self { cell, inverse: edges.inverse(), volume: edges.determinant() / 6.0 }
    }

    /// Gradients α_0..α_3 of the shape functions [1/m].
    pub(crate) fn gradients(&self) -> [Vec3<f64>; 4] {
        let [a, b, c] = self.inverse.transpose().columns;
        [-(a + b + c), a, b, c]
    }
}

/// Tetrahedra in fans, with the constants of the kernel `K`.
#[derive(Clone, Debug)]
pub(crate) struct TetLoop<T: Scalar, K> {
    order: Arc<TetFans>,
    constants: BlockTable<T>,
    kernel: PhantomData<K>,
}

impl<T: Scalar, K: TetConstants> TetLoop<T, K> {
    /// All tetrahedra of `mesh`, with constants made by `constants`. For padding the tetrahedron at rest may be mirrored and
    /// its volume be negative; what is made of that is switched off.
    pub(crate) fn new(mesh: &TetMesh, constants: impl Fn(&RestTet) -> Vec<f64>) -> Result<Self, ModelError> {
        let order = tet_fans::<T>(mesh)?;
        let mut table = BlockTable::new(T::LANES, order.row_count(), K::CONSTANTS, T::ZERO);
        for tet in order.tetrahedra() {
            let rest = RestTet::turned(mesh, tet.cell, tet.corners);
            table.set_row(tet.row, constants(&rest).into_iter().map(T::from_f64));
            if tet.is_padding {
                K::deactivate(&mut table, tet.row);
            }
        }
        Ok(Self { order: Arc::new(order), constants: table, kernel: PhantomData })
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        self.order.bytes() + self.constants.bytes()
    }

    /// Rows that the loop sums in.
    pub(crate) fn sum_rows(&self) -> usize {
        self.order.sum_rows()
    }

    pub(crate) fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            K::deactivate(&mut self.constants, self.order.row(cell));
        }
    }

    /// The constants of the tetrahedra of a slot.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, part: Part<S>, slot: usize) -> [T::Lanes<S>; MAX_CONSTANTS] {
        let block = self.constants.block_of(T::LANES, K::CONSTANTS, slot);
        let mut constants = [T::Lanes::<S>::splat(part.simd, T::ZERO); MAX_CONSTANTS];
        for column in 0..K::CONSTANTS {
            constants[column] = T::Lanes::<S>::load(part, &block[column * T::LANES..]);
        }
        constants
    }

    /// Asks for those of a slot that a loop will come to, if there is one.
    #[inline(always)]
    pub(super) fn prefetch(&self, slot: usize) {
        self.constants.prefetch(T::LANES, K::CONSTANTS, slot);
    }

    /// One of them.
    #[inline(always)]
    pub(super) fn column<S: Simd>(&self, part: Part<S>, slot: usize, column: usize) -> T::Lanes<S> {
        let block = self.constants.block_of(T::LANES, K::CONSTANTS, slot);
        T::Lanes::<S>::load(part, &block[column * T::LANES..])
    }

    /// The constants of one tetrahedron.
    fn constants_of<U: Scalar>(&self, row: usize) -> [U; MAX_CONSTANTS] {
        let mut constants = [U::ZERO; MAX_CONSTANTS];
        for (column, constant) in constants[..K::CONSTANTS].iter_mut().enumerate() {
            *constant = U::from_f64(self.constants.get(row, column).to_f64());
        }
        constants
    }
}

/// The order of the tetrahedra of `mesh`, all of which have a volume.
pub(crate) fn tet_fans<T: Scalar>(mesh: &TetMesh) -> Result<TetFans, ModelError> {
    mesh.check_indices()?;
    for cell in 0..mesh.cells.len() {
        RestTet::new(mesh, cell)?;
    }
    Ok(TetFans::new(mesh, T::LANES))
}

impl<T: Scalar, K: TetMeasure> TetLoop<T, K> {
    /// The largest measure of all tetrahedra, and 0 if there is none above.
    pub(crate) fn largest(&self, x: &[Vec3<T>], scratch: &Scratch<T>) -> T {
        self.order.largest(x, self, &scratch.executor)
    }
}

impl<T: Scalar, K: TetMeasure> Measure<T> for TetLoop<T, K> {
    #[inline(always)]
    fn measure<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> T::Lanes<S> {
        K::measure(&self.load(part, slot)[..K::CONSTANTS], edges)
    }
}

/// Forces of a loop, their derivative, and the forces between two places.
struct Forces<'a, T: Scalar, K>(&'a TetLoop<T, K>);
struct Product<'a, T: Scalar, K>(&'a TetLoop<T, K>);
struct Mean<'a, T: Scalar, K>(&'a TetLoop<T, K>);

impl<T: Scalar, K: TetKernel> Element<T, 1> for Forces<'_, T, K> {
    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.0.prefetch(slot);
    }

    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        K::forces(&self.0.load(part, slot)[..K::CONSTANTS], &edges[0])
    }

    const IS_SHARING: bool = K::IS_SHARING;

    #[inline(always)]
    fn forces_in_fan<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        edges: &[Mat3<T::Lanes<S>>; 1],
        shared: &Shared<T::Lanes<S>>,
    ) -> Mat3<T::Lanes<S>> {
        K::forces_in_fan(&self.0.load(part, slot)[..K::CONSTANTS], &edges[0], shared)
    }
}

impl<T: Scalar, K: TetKernel> Element<T, 2> for Product<'_, T, K> {
    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 2]) -> Mat3<T::Lanes<S>> {
        K::product(&self.0.load(part, slot)[..K::CONSTANTS], &edges[0], &edges[1])
    }
}

impl<T: Scalar, K: TetKernel> Element<T, 2> for Mean<'_, T, K> {
    const IS_WIDE: bool = false;

    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 2]) -> Mat3<T::Lanes<S>> {
        K::mean_forces(&self.0.load(part, slot)[..K::CONSTANTS], &edges[0], &edges[1])
    }
}

impl<T: Scalar, K: TetKernel> Diagonal<T> for TetLoop<T, K> {
    const IS_WIDE: bool = K::HAS_DIAGONAL;

    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        TetLoop::prefetch(self, slot);
    }

    #[inline(always)]
    fn blocks<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> [Sym3<T::Lanes<S>>; 4] {
        K::diagonal(&self.load(part, slot)[..K::CONSTANTS], edges)
    }
}

impl<T: Scalar, K: TetKernel> TetLoop<T, K> {
    pub(crate) fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.order.add([x], &Forces(self), scratch.sums(self.sum_rows()).0, out);
    }

    pub(crate) fn sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> &Patches {
        self.order.sum([x], &Forces(self), scratch.sums(self.sum_rows()).0)
    }

    /// The same, and the largest of what is measured on the way.
    pub(super) fn sum_forces_and_measure(
        &self,
        x: &[Vec3<T>],
        element: &impl Measured<T>,
        scratch: &mut Scratch<T>,
    ) -> (&Patches, f64) {
        let (patches, largest) = self.order.sum_and_find_largest(x, element, scratch.sums(self.sum_rows()).0);
        (patches, largest.to_f64())
    }

    pub(crate) fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.order.add([x, dx], &Product(self), scratch.sums(self.sum_rows()).0, out);
    }

    pub(crate) fn sum_product(
        &self,
        x: &[Vec3<T>],
        turn: &Turn<'_, T>,
        masses: &[T],
        scratch: &mut Scratch<T>,
    ) -> (&Patches, f64) {
        self.order.sum_product(x, (turn, masses), &Product(self), scratch.sums(self.sum_rows()).0)
    }

    pub(crate) fn add_mean_forces(
        &self,
        from: &[Vec3<T>],
        to: &[Vec3<T>],
        scratch: &mut Scratch<T>,
        out: &mut [Vec3<T>],
    ) {
        self.order.add([from, to], &Mean(self), scratch.sums(self.sum_rows()).0, out);
    }

    pub(crate) fn add_blocks(&self, x: &[Vec3<T>], sink: &mut dyn BlockSink<T>) {
        for tet in self.order.tetrahedra().filter(|tet| !tet.is_padding) {
            let constants = self.constants_of::<T>(tet.row);
            let d = edge_matrix(x, tet.corners);
            add_tet_blocks(tet.corners, sink, |dd| K::product(&constants[..K::CONSTANTS], &d, dd));
        }
    }

    pub(crate) fn sum_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> &Patches {
        self.order.sum_diagonal(x, self, scratch.sums(self.sum_rows()).0)
    }

    /// Sum of the energies [J], element by element in double precision.
    pub(crate) fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let there = self.order.tetrahedra().filter(|tet| !tet.is_padding);
        there
            .map(|tet| {
                let constants = self.constants_of::<f64>(tet.row);
                let [a, b, c, d] = tet.corners.map(|node| x[node as usize].cast::<f64>());
                K::energy(&constants[..K::CONSTANTS], &Mat3::from_columns(b - a, c - a, d - a))
            })
            .sum()
    }
}

/// [x1−x0, x2−x0, x3−x0] of a tetrahedron.
pub(crate) fn edge_matrix<R: Real>(x: &[Vec3<R>], corners: [u32; 4]) -> Mat3<R> {
    let [a, b, c, d] = corners;
    let at = |node: u32| x[node as usize];
    Mat3::from_columns(at(b) - at(a), at(c) - at(a), at(d) - at(a))
}

/// Places of one corner of a batch; `nodes` holds the corners of the block, corner after corner.
#[inline(always)]
pub(crate) fn gather_corner<T: Scalar, S: Simd>(
    part: Part<S>,
    x: &[[T; 4]],
    nodes: &[u32],
    corner: usize,
) -> Vec3<T::Lanes<S>> {
    let nodes = part.of::<T, T::Lanes<S>, _>(&nodes[corner * T::LANES..(corner + 1) * T::LANES]);
    let [x, y, z, _] = T::Lanes::<S>::gather(part.simd, x, nodes);
    Vec3::new(x, y, z)
}

/// Adds the forces on the corners of a batch, half by half.
#[inline(always)]
pub(crate) fn scatter_corners<T: Scalar, S: Simd, const CORNERS: usize>(
    part: Part<S>,
    forces: &[Vec3<T::Lanes<S>>; CORNERS],
    nodes: &[u32],
    out: &mut [[T; 4]],
) {
    let mut kept = [lane_vector::nothing(); CORNERS];
    for corner in 0..CORNERS {
        lane_vector::keep(part.simd, forces[corner], &mut kept[corner]);
    }
    for half in part.halves::<T>() {
        for corner in 0..CORNERS {
            let force = lane_vector::take_up::<T, S, T::Half<S>>(half, &kept[corner]);
            let nodes = half.of::<T, T::Half<S>, _>(&nodes[corner * T::LANES..(corner + 1) * T::LANES]);
            T::Half::<S>::scatter_add(force.to_array(), nodes, out);
        }
    }
}

//! The loop over tetrahedra that models share: gather corners into lanes, apply a kernel, scatter forces.

use std::marker::PhantomData;

use fearless_simd::{Simd, dispatch};

use super::block_sink::{add_block_column, unit_displacement};
use super::block_table::BlockTable;
use super::{BlockSink, ModelError, Scratch};
use crate::math::{Lanes, MAX_LANES, Mat3, Real, Scalar, Vec3, dispatch_level};
use crate::mesh::{MeshError, TetMesh};

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
    /// Whether [`TetKernel::mean_forces`] keeps energy.
    const KEEPS_ENERGY: bool = false;
    /// Forces between the edge matrices `from` and `to`; those in the middle, unless the kernel knows better.
    #[inline(always)]
    fn mean_forces<R: Real>(constants: &[R], from: &Mat3<R>, to: &Mat3<R>) -> Mat3<R> {
        Self::forces(constants, &((*from + *to) * from.columns[0].x.like(0.5)))
    }
    /// Derivative of [`TetKernel::forces`] along `dd`.
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R>;
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
    /// Volume [m³], > 0.
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

    /// Gradients α_0..α_3 of the shape functions [1/m].
    pub(crate) fn gradients(&self) -> [Vec3<f64>; 4] {
        let [a, b, c] = self.inverse.transpose().columns;
        [-(a + b + c), a, b, c]
    }
}

/// Tetrahedra in batches of lanes, with the constants of the kernel `K`.
#[derive(Clone, Debug)]
pub(crate) struct TetLoop<T: Scalar, K> {
    corners: BlockTable<u32>,
    constants: BlockTable<T>,
    kernel: PhantomData<K>,
}

impl<T: Scalar, K: TetConstants> TetLoop<T, K> {
    /// All tetrahedra of `mesh`, with constants made by `constants`.
    pub(crate) fn new(mesh: &TetMesh, constants: impl Fn(&RestTet) -> Vec<f64>) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let cells = mesh.cells.len();
        let mut tets = Self {
            corners: BlockTable::new(T::LANES, cells, 4, 0),
            constants: BlockTable::new(T::LANES, cells, K::CONSTANTS, T::ZERO),
            kernel: PhantomData,
        };
        for row in 0..tets.corners.padded_rows() {
            // Padding repeats the last cell, switched off: its deformation is as harmless as that of a real one.
            let cell = row.min(cells - 1);
            let rest = RestTet::new(mesh, cell)?;
            tets.corners.set_row(row, mesh.cells[cell]);
            tets.constants.set_row(row, constants(&rest).into_iter().map(T::from_f64));
            if row >= cells {
                K::deactivate(&mut tets.constants, row);
            }
        }
        Ok(tets)
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        self.corners.bytes() + self.constants.bytes()
    }

    pub(crate) fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            K::deactivate(&mut self.constants, cell as usize);
        }
    }
}

impl<T: Scalar, K: TetMeasure> TetLoop<T, K> {
    /// The largest measure of all tetrahedra, and 0 if there is none above.
    pub(crate) fn largest(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> T {
        scratch.start(x);
        dispatch!(dispatch_level(), simd => self.largest_with(simd, &scratch.nodal))
    }

    #[inline(always)]
    fn largest_with<S: Simd>(&self, simd: S, x: &[[T; 4]]) -> T {
        let mut largest = T::Lanes::<S>::splat(simd, T::ZERO);
        for (nodes, constants) in self.corners.blocks().zip(self.constants.blocks()) {
            let constants = load_constants::<T, S, K>(simd, constants);
            largest = largest.max(K::measure(&constants[..K::CONSTANTS], &gather_edges(simd, x, nodes)));
        }
        let mut lanes = [T::ZERO; MAX_LANES];
        largest.store(&mut lanes);
        lanes.into_iter().fold(T::ZERO, Real::max)
    }
}

impl<T: Scalar, K: TetKernel> TetLoop<T, K> {
    pub(crate) fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let Scratch { nodal, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_forces_with(simd, nodal, forces));
        scratch.finish(out);
    }

    #[inline(always)]
    fn add_forces_with<S: Simd>(&self, simd: S, x: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, constants) in self.corners.blocks().zip(self.constants.blocks()) {
            let constants = load_constants::<T, S, K>(simd, constants);
            let d = gather_edges(simd, x, nodes);
            scatter_forces(simd, K::forces(&constants[..K::CONSTANTS], &d), nodes, out);
        }
    }

    pub(crate) fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        let Scratch { nodal, direction, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_product_with(simd, nodal, direction, forces));
        scratch.finish(out);
    }

    #[inline(always)]
    fn add_product_with<S: Simd>(&self, simd: S, x: &[[T; 4]], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, constants) in self.corners.blocks().zip(self.constants.blocks()) {
            let constants = load_constants::<T, S, K>(simd, constants);
            let (d, dd) = (gather_edges(simd, x, nodes), gather_edges(simd, dx, nodes));
            scatter_forces(simd, K::product(&constants[..K::CONSTANTS], &d, &dd), nodes, out);
        }
    }

    pub(crate) fn add_mean_forces(
        &self,
        from: &[Vec3<T>],
        to: &[Vec3<T>],
        scratch: &mut Scratch<T>,
        out: &mut [Vec3<T>],
    ) {
        scratch.start(from);
        scratch.start_direction(to);
        let Scratch { nodal, direction, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_mean_forces_with(simd, nodal, direction, forces));
        scratch.finish(out);
    }

    #[inline(always)]
    fn add_mean_forces_with<S: Simd>(&self, simd: S, from: &[[T; 4]], to: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, constants) in self.corners.blocks().zip(self.constants.blocks()) {
            let constants = load_constants::<T, S, K>(simd, constants);
            let (from, to) = (gather_edges(simd, from, nodes), gather_edges(simd, to, nodes));
            scatter_forces(simd, K::mean_forces(&constants[..K::CONSTANTS], &from, &to), nodes, out);
        }
    }

    pub(crate) fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        scratch.start(x);
        dispatch!(dispatch_level(), simd => self.add_blocks_with(simd, &scratch.nodal, sink));
    }

    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, x: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        for (block, (nodes, constants)) in self.corners.blocks().zip(self.constants.blocks()).enumerate() {
            let constants = load_constants::<T, S, K>(simd, constants);
            let d = gather_edges(simd, x, nodes);
            for corner in 0..4 {
                let mut columns = [[Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); 4]; 3];
                for axis in 0..3 {
                    let [a, b, c, d_corner] = unit_displacement::<T, S, 4>(simd, corner, axis);
                    let dd = Mat3::from_columns(b - a, c - a, d_corner - a);
                    let [f1, f2, f3] = K::product(&constants[..K::CONSTANTS], &d, &dd).columns;
                    columns[axis] = [-(f1 + f2 + f3), f1, f2, f3];
                }
                add_block_column::<T, S, 4>(&columns, nodes, corner, self.corners.rows() - block * T::LANES, sink);
            }
        }
    }

    /// Sum of the energies [J], element by element in double precision.
    pub(crate) fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let mut constants = [0.0; MAX_CONSTANTS];
        (0..self.corners.rows())
            .map(|row| {
                for (column, constant) in constants[..K::CONSTANTS].iter_mut().enumerate() {
                    *constant = self.constants.get(row, column).to_f64();
                }
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| x[self.corners.get(row, i) as usize].cast::<f64>());
                K::energy(&constants[..K::CONSTANTS], &Mat3::from_columns(b - a, c - a, d - a))
            })
            .sum()
    }
}

#[inline(always)]
fn load_constants<T: Scalar, S: Simd, K: TetConstants>(simd: S, block: &[T]) -> [T::Lanes<S>; MAX_CONSTANTS] {
    let mut constants = [T::Lanes::<S>::splat(simd, T::ZERO); MAX_CONSTANTS];
    for column in 0..K::CONSTANTS {
        constants[column] = T::Lanes::<S>::load(simd, &block[column * T::LANES..]);
    }
    constants
}

/// Edge matrices of a batch; `nodes` holds the four corners, corner after corner.
#[inline(always)]
pub(crate) fn gather_edges<T: Scalar, S: Simd>(simd: S, x: &[[T; 4]], nodes: &[u32]) -> Mat3<T::Lanes<S>> {
    let origin = gather_corner(simd, x, nodes, 0);
    Mat3::from_columns(
        gather_corner(simd, x, nodes, 1) - origin,
        gather_corner(simd, x, nodes, 2) - origin,
        gather_corner(simd, x, nodes, 3) - origin,
    )
}

/// Places of one corner of a batch; `nodes` holds the corners of the batch, corner after corner.
#[inline(always)]
pub(crate) fn gather_corner<T: Scalar, S: Simd>(
    simd: S,
    x: &[[T; 4]],
    nodes: &[u32],
    corner: usize,
) -> Vec3<T::Lanes<S>> {
    let [x, y, z, _] = T::Lanes::<S>::gather(simd, x, &nodes[corner * T::LANES..(corner + 1) * T::LANES]);
    Vec3::new(x, y, z)
}

/// Adds a force on one corner of a batch.
#[inline(always)]
pub(crate) fn scatter_corner<T: Scalar, S: Simd>(
    force: Vec3<T::Lanes<S>>,
    nodes: &[u32],
    corner: usize,
    out: &mut [[T; 4]],
) {
    T::Lanes::<S>::scatter_add(force.to_array(), &nodes[corner * T::LANES..(corner + 1) * T::LANES], out);
}

#[inline(always)]
pub(crate) fn scatter_forces<T: Scalar, S: Simd>(
    _simd: S,
    forces: Mat3<T::Lanes<S>>,
    nodes: &[u32],
    out: &mut [[T; 4]],
) {
    let [f1, f2, f3] = forces.columns;
    scatter_corner::<T, S>(-(f1 + f2 + f3), nodes, 0, out);
    scatter_corner::<T, S>(f1, nodes, 1, out);
    scatter_corner::<T, S>(f2, nodes, 2, out);
    scatter_corner::<T, S>(f3, nodes, 3, out);
}

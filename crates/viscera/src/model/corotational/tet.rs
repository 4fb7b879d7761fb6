//! Corotational tetrahedra in batches of lanes.

use fearless_simd::{Simd, dispatch};

use super::Corotational;
use super::formulation::{Formulation, Rotation, Tangent};
use super::hooke::{FIBRED, Hooke, ISOTROPIC};
use super::lane_vector::{load, store};
use crate::material::Tissue;
use crate::math::rotation::qr;
use crate::math::{Lanes, Mat3, Real, Scalar, Sym3, Vec3, dispatch_level};
use crate::mesh::TetMesh;
use crate::model::block_sink::{BlockSink, add_block, add_block_column, unit_displacement};
use crate::model::block_table::BlockTable;
use crate::model::tet_loop::{RestTet, gather_edges, scatter_forces};
use crate::model::{ForceModel, ModelError, Scratch};

/// Columns before those of the law: Dm⁻¹ by columns, V0.
const SHAPE: usize = 10;
const VOLUME: usize = 9;
/// The most columns.
const MOST: usize = SHAPE + FIBRED;

/// Columns of a linearized element: three rotated gradients, and the turned fibre direction where there is one.
const GRADIENTS: usize = 9;
const MOST_LINEARIZED: usize = GRADIENTS + 3;

/// Corotational tetrahedra. For QR the rest shape is turned so that its own edges 01 and 02 lie along its first axes:
/// what Gram–Schmidt finds in F then is Q Q0ᵀ, and nothing is left to do for Q0.
#[derive(Clone, Debug)]
pub(super) struct CorotationalTets<T: Scalar> {
    corners: BlockTable<u32>,
    constants: BlockTable<T>,
    formulation: Formulation,
    fibred: bool,
}

/// The numbers of a batch.
struct Batch<R> {
    inverse: Mat3<R>,
    volume: R,
    hooke: Hooke<R>,
}

/// The law of a batch, and √(s V) R A α of the corners 1, 2, 3.
struct Turned<R> {
    hooke: Hooke<R>,
    gradients: Mat3<R>,
}

impl<R: Real> Batch<R> {
    #[inline(always)]
    fn at(c: &[R; MOST], fibred: bool) -> Self {
        let column = |i: usize| Vec3::new(c[3 * i], c[3 * i + 1], c[3 * i + 2]);
        Self {
            inverse: Mat3::from_columns(column(0), column(1), column(2)),
            volume: c[VOLUME],
            hooke: Hooke::at(&c[SHAPE..], fibred),
        }
    }
}

impl<T: Scalar> CorotationalTets<T> {
    pub(super) fn new(mesh: &TetMesh, tissue: &Tissue, formulation: Formulation) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let cells = mesh.cells.len();
        let fibred = super::has_fibres(tissue);
        let columns = SHAPE + if fibred { FIBRED } else { ISOTROPIC };
        let mut tets = Self {
            corners: BlockTable::new(T::LANES, cells, 4, 0),
            constants: BlockTable::new(T::LANES, cells, columns, T::ZERO),
            formulation,
            fibred,
        };
        for row in 0..tets.corners.padded_rows() {
            // padding repeats the last cell, without volume
            let cell = row.min(cells - 1);
            let rest = RestTet::new(mesh, cell)?;
            let frame = match formulation.rotation {
                Rotation::Qr => qr(&mesh.edge_matrix(cell)),
                Rotation::Polar | Rotation::Svd => Mat3::IDENTITY,
            };
            let stiffness = tissue.at_rest(cell);
            let law = Hooke::numbers(&stiffness, frame.transpose_mul(stiffness.direction), fibred);
            let shape = (rest.inverse * frame).columns.into_iter().flat_map(Vec3::to_array);
            let numbers = shape.chain([if row < cells { rest.volume } else { 0.0 }]).chain(law);
            tets.corners.set_row(row, mesh.cells[cell]);
            tets.constants.set_row(row, numbers.map(T::from_f64));
        }
        Ok(tets)
    }

    fn columns(&self) -> usize {
        SHAPE + if self.fibred { FIBRED } else { ISOTROPIC }
    }

    fn linearized_columns(&self) -> usize {
        if self.fibred { MOST_LINEARIZED } else { GRADIENTS }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, block: &[T]) -> Batch<T::Lanes<S>> {
        let mut numbers = [T::Lanes::<S>::splat(simd, T::ZERO); MOST];
        for column in 0..self.columns() {
            numbers[column] = T::Lanes::<S>::load(simd, &block[column * T::LANES..]);
        }
        Batch::at(&numbers, self.fibred)
    }

    #[inline(always)]
    fn add_forces_with<S: Simd>(&self, simd: S, x: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, block) in self.corners.blocks().zip(self.constants.blocks()) {
            let Batch { inverse, volume, hooke } = self.load(simd, block);
            let f = gather_edges(simd, x, nodes) * inverse;
            let stress = self.formulation.stress(&hooke, &self.formulation.rotation(&f), &f);
            scatter_forces(simd, stress * volume * inverse.transpose(), nodes, out);
        }
    }

    #[inline(always)]
    fn add_product_with<S: Simd>(&self, simd: S, x: &[[T; 4]], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, block) in self.corners.blocks().zip(self.constants.blocks()) {
            let Batch { inverse, volume, hooke } = self.load(simd, block);
            let f = gather_edges(simd, x, nodes) * inverse;
            let df = gather_edges(simd, dx, nodes) * inverse;
            let r = self.formulation.rotation(&f);
            let dr = self.formulation.rotation_along(&f, &r, &df);
            let stress = self.formulation.stress_along(&hooke, (&r, &dr), (&f, &df));
            scatter_forces(simd, stress * volume * inverse.transpose(), nodes, out);
        }
    }

    #[inline(always)]
    fn linearize_with<S: Simd>(&self, simd: S, x: &[[T; 4]], linearization: &mut [T]) {
        let rows = linearization.chunks_exact_mut(self.linearized_columns() * T::LANES);
        for ((nodes, block), row) in self.corners.blocks().zip(self.constants.blocks()).zip(rows) {
            let Batch { inverse, volume, hooke } = self.load(simd, block);
            let f = gather_edges(simd, x, nodes) * inverse;
            let r = self.formulation.rotation(&f);
            let (transport, scale) = self.formulation.transport(&r, &f);
            let gradients = transport * inverse.transpose() * (volume * scale).sqrt();
            for i in 0..3 {
                store(gradients.columns[i], &mut row[3 * i * T::LANES..]);
            }
            if let Some((direction, _)) = hooke.fibre {
                store(r * direction, &mut row[GRADIENTS * T::LANES..]);
            }
        }
    }

    /// 129 flops for an isotropic law: 9 for dD, 54 for dD gᵀ, 15 for the stress, 45 for its products, 6 for corner 0.
    #[inline(always)]
    fn add_linearized_product_with<S: Simd>(&self, simd: S, linearization: &[T], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        let rows = linearization.chunks_exact(self.linearized_columns() * T::LANES);
        for ((nodes, block), row) in self.corners.blocks().zip(self.constants.blocks()).zip(rows) {
            let Turned { hooke, gradients } = self.load_linearized(simd, block, row);
            let strain = (gather_edges(simd, dx, nodes) * gradients.transpose()).symmetric_part();
            scatter_forces(simd, times(hooke.stress(strain), &gradients), nodes, out);
        }
    }

    #[inline(always)]
    fn load_linearized<S: Simd>(&self, simd: S, block: &[T], row: &[T]) -> Turned<T::Lanes<S>> {
        let number = |column: usize| T::Lanes::<S>::load(simd, &block[column * T::LANES..]);
        let gradients = Mat3::from_columns(load(simd, row, 0), load(simd, row, 3), load(simd, row, 6));
        let fibre = if self.fibred { Some((load(simd, row, GRADIENTS), number(SHAPE + 5))) } else { None };
        Turned { hooke: Hooke { lambda: number(SHAPE), mu: number(SHAPE + 1), fibre }, gradients }
    }

    #[inline(always)]
    fn add_linearized_blocks_with<S: Simd>(&self, simd: S, linearization: &[T], sink: &mut dyn BlockSink<T>) {
        let rows = linearization.chunks_exact(self.linearized_columns() * T::LANES);
        for (batch, ((nodes, block), row)) in self.corners.blocks().zip(self.constants.blocks()).zip(rows).enumerate() {
            let elements = self.corners.rows() - batch * T::LANES;
            let Turned { hooke, gradients } = self.load_linearized(simd, block, row);
            let [b, c, d] = gradients.columns;
            let gradients = [-(b + c + d), b, c, d];
            for q in 0..4 {
                for p in 0..4 {
                    if p == q || !sink.keeps_diagonal_only() {
                        add_block::<T, S>(&hooke.block(gradients[p], gradients[q]), nodes, [p, q], elements, sink);
                    }
                }
            }
        }
    }

    /// The blocks of the exact tangent, column by column.
    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, x: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        for (batch, (nodes, block)) in self.corners.blocks().zip(self.constants.blocks()).enumerate() {
            let Batch { inverse, volume, hooke } = self.load(simd, block);
            let f = gather_edges(simd, x, nodes) * inverse;
            let r = self.formulation.rotation(&f);
            for corner in 0..4 {
                let mut columns = [[Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); 4]; 3];
                for axis in 0..3 {
                    let [a, b, c, d] = unit_displacement::<T, S, 4>(simd, corner, axis);
                    let df = Mat3::from_columns(b - a, c - a, d - a) * inverse;
                    let dr = self.formulation.rotation_along(&f, &r, &df);
                    let stress = self.formulation.stress_along(&hooke, (&r, &dr), (&f, &df));
                    let [f1, f2, f3] = (stress * volume * inverse.transpose()).columns;
                    columns[axis] = [-(f1 + f2 + f3), f1, f2, f3];
                }
                add_block_column::<T, S, 4>(&columns, nodes, corner, self.corners.rows() - batch * T::LANES, sink);
            }
        }
    }

    /// The numbers of one element in double precision.
    fn numbers(&self, row: usize) -> Batch<f64> {
        let mut numbers = [0.0; MOST];
        for (column, number) in numbers.iter_mut().enumerate().take(self.columns()) {
            *number = self.constants.get(row, column).to_f64();
        }
        Batch::at(&numbers, self.fibred)
    }
}

/// S A for a symmetric S.
#[inline(always)]
fn times<R: Real>(s: Sym3<R>, a: &Mat3<R>) -> Mat3<R> {
    Mat3::from(s) * *a
}

impl<T: Scalar> ForceModel<T> for CorotationalTets<T> {
    fn name(&self) -> &'static str {
        Corotational::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let Scratch { nodal, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_forces_with(simd, nodal, forces));
        scratch.finish(out);
    }

    fn linearization_len(&self) -> usize {
        match self.formulation.tangent {
            Tangent::Frozen => self.corners.padded_rows() * self.linearized_columns(),
            Tangent::Exact => 0,
        }
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        if self.formulation.tangent == Tangent::Frozen {
            scratch.start(x);
            let (nodal, linearization) = scratch.start_linearization(self.linearization_len());
            dispatch!(dispatch_level(), simd => self.linearize_with(simd, nodal, linearization));
        }
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start_direction(dx);
        if scratch.is_linearized {
            scratch.clear_forces();
            let Scratch { direction, forces, linearization, .. } = scratch;
            dispatch!(dispatch_level(), simd => self.add_linearized_product_with(simd, linearization, direction, forces));
        } else {
            scratch.start(x);
            let Scratch { nodal, direction, forces, .. } = scratch;
            dispatch!(dispatch_level(), simd => self.add_product_with(simd, nodal, direction, forces));
        }
        scratch.finish(out);
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        match self.formulation.tangent {
            Tangent::Frozen => {
                let was_linearized = scratch.is_linearized;
                if !was_linearized {
                    self.linearize(x, scratch);
                }
                let linearization = &scratch.linearization;
                dispatch!(dispatch_level(), simd => self.add_linearized_blocks_with(simd, linearization, sink));
                scratch.is_linearized = was_linearized;
            }
            Tangent::Exact => {
                scratch.start(x);
                dispatch!(dispatch_level(), simd => self.add_blocks_with(simd, &scratch.nodal, sink));
            }
        }
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        (0..self.corners.rows())
            .map(|row| {
                let Batch { inverse, volume, hooke } = self.numbers(row);
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| x[self.corners.get(row, i) as usize].cast::<f64>());
                let f = Mat3::from_columns(b - a, c - a, d - a) * inverse;
                volume * self.formulation.energy(&hooke, &self.formulation.rotation(&f), &f)
            })
            .sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            *self.constants.get_mut(cell as usize, VOLUME) = T::ZERO;
        }
    }

    fn bytes(&self) -> usize {
        self.corners.bytes() + self.constants.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

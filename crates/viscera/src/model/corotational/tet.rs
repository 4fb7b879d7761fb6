//! Corotational tetrahedra in batches of lanes.

use std::sync::Arc;

use fearless_simd::Simd;

use super::Corotational;
use super::formulation::{Formulation, Rotation, Tangent};
use super::hooke::{FIBRED, Hooke, ISOTROPIC};
use super::lane_vector::{load, store};
use crate::material::Tissue;
use crate::math::rotation::qr;
use crate::math::{Lanes, Mat3, Real, Scalar, Sym3, Vec3};
use crate::mesh::TetMesh;
use crate::model::BlockSink;
use crate::model::block_sink::{DiagonalSink, add_tet_blocks};
use crate::model::block_table::BlockTable;
use crate::model::patch::{Diagonal, Element, Record, TetFans};
use crate::model::tet_loop::{RestTet, edge_matrix, tet_fans};
use crate::model::{ForceModel, Inertia, ModelError, Patches, Scratch};

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
    order: Arc<TetFans>,
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
        let order = tet_fans::<T>(mesh)?;
        let fibred = super::has_fibres(tissue);
        let columns = SHAPE + if fibred { FIBRED } else { ISOTROPIC };
        let mut constants = BlockTable::new(T::LANES, order.row_count(), columns, T::ZERO);
        for tet in order.tetrahedra() {
            let rest = RestTet::turned(mesh, tet.cell, tet.corners);
            let frame = match formulation.rotation {
                Rotation::Qr => qr(&mesh.edge_matrix(tet.cell)),
                Rotation::Polar | Rotation::Svd => Mat3::IDENTITY,
            };
            let stiffness = tissue.at_rest(tet.cell);
            let law = Hooke::numbers(&stiffness, frame.transpose_mul(stiffness.direction), fibred);
            let shape = (rest.inverse * frame).columns.into_iter().flat_map(Vec3::to_array);
            let numbers = shape.chain([if tet.is_padding { 0.0 } else { rest.volume }]).chain(law);
            constants.set_row(tet.row, numbers.map(T::from_f64));
        }
        Ok(Self { order: Arc::new(order), constants, formulation, fibred })
    }

    fn columns(&self) -> usize {
        SHAPE + if self.fibred { FIBRED } else { ISOTROPIC }
    }

    fn linearized_columns(&self) -> usize {
        if self.fibred { MOST_LINEARIZED } else { GRADIENTS }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, slot: usize) -> Batch<T::Lanes<S>> {
        let block = self.constants.block(slot);
        let mut numbers = [T::Lanes::<S>::splat(simd, T::ZERO); MOST];
        for column in 0..self.columns() {
            numbers[column] = T::Lanes::<S>::load(simd, &block[column * T::LANES..]);
        }
        Batch::at(&numbers, self.fibred)
    }

    /// The blocks of the tangent with the rotations held.
    fn add_linearized_blocks(&self, linearization: &[T], sink: &mut dyn BlockSink<T>) {
        let columns = self.linearized_columns();
        for tet in self.order.tetrahedra().filter(|tet| !tet.is_padding) {
            let (slot, lane) = (tet.row / T::LANES, tet.row % T::LANES);
            let number = |column: usize| linearization[(slot * columns + column) * T::LANES + lane];
            let vector = |column: usize| Vec3::new(number(column), number(column + 1), number(column + 2));
            let constant = |column: usize| self.constants.get(tet.row, SHAPE + column);
            let fibre = self.fibred.then(|| (vector(GRADIENTS), constant(5)));
            let hooke = Hooke { lambda: constant(0), mu: constant(1), fibre };
            let [b, c, d] = [vector(0), vector(3), vector(6)];
            let gradients = [-(b + c + d), b, c, d];
            for q in 0..4 {
                for p in 0..4 {
                    if p == q || !sink.keeps_diagonal_only() {
                        sink.add(tet.corners[p], tet.corners[q], hooke.block(gradients[p], gradients[q]));
                    }
                }
            }
        }
    }

    /// The blocks of the exact tangent, column by column.
    fn add_exact_blocks(&self, x: &[Vec3<T>], sink: &mut dyn BlockSink<T>) {
        for tet in self.order.tetrahedra().filter(|tet| !tet.is_padding) {
            let Batch { inverse, volume, hooke } = self.numbers::<T>(tet.row);
            let f = edge_matrix(x, tet.corners) * inverse;
            let r = self.formulation.rotation(&f);
            add_tet_blocks(tet.corners, sink, |dd| {
                let df = *dd * inverse;
                let dr = self.formulation.rotation_along(&f, &r, &df);
                self.formulation.stress_along(&hooke, (&r, &dr), (&f, &df)) * volume * inverse.transpose()
            });
        }
    }

    /// The derivative of the forces, that of the rotations as the formulation has it.
    fn derivative(&self) -> Derivative<'_, T> {
        Derivative { tets: self, formulation: self.formulation }
    }

    /// The numbers of one element.
    fn numbers<U: Scalar>(&self, row: usize) -> Batch<U> {
        let mut numbers = [U::ZERO; MOST];
        for (column, number) in numbers.iter_mut().enumerate().take(self.columns()) {
            *number = U::from_f64(self.constants.get(row, column).to_f64());
        }
        Batch::at(&numbers, self.fibred)
    }
}

/// Forces.
struct Forces<'a, T: Scalar>(&'a CorotationalTets<T>);
/// What a formulation says of the derivative of the forces.
struct Derivative<'a, T: Scalar> {
    tets: &'a CorotationalTets<T>,
    formulation: Formulation,
}
/// The derivative with the rotations held, from turned gradients.
struct FrozenProduct<'a, T: Scalar> {
    tets: &'a CorotationalTets<T>,
    linearization: &'a [T],
}
/// Forces from turned gradients: with those of a body at rest, √V I, taken off, D gᵀ is √V (F Rᵀ − I), the strain in the turned
/// frame.
struct FrozenForces<'a, T: Scalar>(FrozenProduct<'a, T>);
/// Turns the gradients.
struct Turning<'a, T: Scalar>(&'a CorotationalTets<T>);

impl<T: Scalar> Element<T, 1> for Forces<'_, T> {
    #[inline(always)]
    fn forces<S: Simd>(&self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let Batch { inverse, volume, hooke } = self.0.load(simd, slot);
        let f = edges[0] * inverse;
        let stress = self.0.formulation.stress(&hooke, &self.0.formulation.rotation(&f), &f);
        stress * volume * inverse.transpose()
    }
}

impl<T: Scalar> Element<T, 2> for Derivative<'_, T> {
    #[inline(always)]
    fn forces<S: Simd>(&self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 2]) -> Mat3<T::Lanes<S>> {
        let (Batch { inverse, volume, hooke }, formulation) = (self.tets.load(simd, slot), self.formulation);
        let (f, df) = (edges[0] * inverse, edges[1] * inverse);
        let r = formulation.rotation(&f);
        let dr = formulation.rotation_along(&f, &r, &df);
        let stress = formulation.stress_along(&hooke, (&r, &dr), (&f, &df));
        stress * volume * inverse.transpose()
    }
}

impl<T: Scalar> FrozenProduct<'_, T> {
    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, slot: usize) -> Turned<T::Lanes<S>> {
        let block = self.tets.constants.block(slot);
        let columns = self.tets.linearized_columns() * T::LANES;
        let row = &self.linearization[slot * columns..(slot + 1) * columns];
        let number = |column: usize| T::Lanes::<S>::load(simd, &block[column * T::LANES..]);
        let gradients = Mat3::from_columns(load(simd, row, 0), load(simd, row, 3), load(simd, row, 6));
        let fibre = if self.tets.fibred { Some((load(simd, row, GRADIENTS), number(SHAPE + 5))) } else { None };
        Turned { hooke: Hooke { lambda: number(SHAPE), mu: number(SHAPE + 1), fibre }, gradients }
    }
}

// 129 flops for an isotropic law: 9 for dD, 54 for dD gᵀ, 15 for the stress, 45 for its products, 6 for corner 0.
impl<T: Scalar> Element<T, 1> for FrozenProduct<'_, T> {
    #[inline(always)]
    fn forces<S: Simd>(&self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let Turned { hooke, gradients } = self.load(simd, slot);
        let strain = (edges[0] * gradients.transpose()).symmetric_part();
        times(hooke.stress(strain), &gradients)
    }
}

impl<T: Scalar> Element<T, 1> for FrozenForces<'_, T> {
    #[inline(always)]
    fn forces<S: Simd>(&self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let Turned { hooke, gradients } = self.0.load(simd, slot);
        let volume = T::Lanes::<S>::load(simd, &self.0.tets.constants.block(slot)[VOLUME * T::LANES..]);
        let strain = (edges[0] * gradients.transpose()).symmetric_part() - Sym3::diagonal(volume.sqrt());
        times(hooke.stress(strain), &gradients)
    }
}

impl<T: Scalar> Diagonal<T> for FrozenProduct<'_, T> {
    #[inline(always)]
    fn blocks<S: Simd>(&self, simd: S, slot: usize, _edges: &Mat3<T::Lanes<S>>) -> [Sym3<T::Lanes<S>>; 4] {
        let Turned { hooke, gradients } = self.load(simd, slot);
        let [b, c, d] = gradients.columns;
        let block = |gradient| hooke.block(gradient, gradient).symmetric_part();
        [block(-(b + c + d)), block(b), block(c), block(d)]
    }
}

impl<T: Scalar> Record<T> for Turning<'_, T> {
    fn columns(&self) -> usize {
        self.0.linearized_columns()
    }

    #[inline(always)]
    fn record<S: Simd>(&self, simd: S, slot: usize, edges: &Mat3<T::Lanes<S>>, row: &mut [T]) {
        let (Batch { inverse, volume, hooke }, formulation) = (self.0.load(simd, slot), &self.0.formulation);
        let f = *edges * inverse;
        let r = formulation.rotation(&f);
        let (transport, scale) = formulation.transport(&r, &f);
        let gradients = transport * inverse.transpose() * (volume * scale).sqrt();
        for i in 0..3 {
            store(gradients.columns[i], &mut row[3 * i * T::LANES..]);
        }
        if let Some((direction, _)) = hooke.fibre {
            store(r * direction, &mut row[GRADIENTS * T::LANES..]);
        }
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
        self.order.add([x], &Forces(self), scratch.sums(self.sum_rows()).0, out);
    }

    fn sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(self.order.sum([x], &Forces(self), scratch.sums(self.sum_rows()).0))
    }

    fn add_forces_linearized(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        if scratch.is_linearized && self.formulation.is_linear_in_its_frame() {
            let (sums, linearization) = scratch.sums(self.sum_rows());
            self.order.add([x], &FrozenForces(FrozenProduct { tets: self, linearization }), sums, out);
        } else {
            self.add_forces(x, scratch, out);
        }
    }

    fn linearization_len(&self) -> usize {
        match self.formulation.tangent {
            Tangent::Frozen => self.order.row_count() * self.linearized_columns(),
            Tangent::Exact => 0,
        }
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        if self.formulation.tangent == Tangent::Frozen {
            let (executor, _, linearization) = scratch.start_linearization(self.linearization_len());
            self.order.record(x, &Turning(self), executor, linearization);
        }
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let is_linearized = scratch.is_linearized;
        let (sums, linearization) = scratch.sums(self.sum_rows());
        if is_linearized {
            self.order.add([dx], &FrozenProduct { tets: self, linearization }, sums, out);
        } else {
            self.order.add([x, dx], &self.derivative(), sums, out);
        }
    }

    fn add_exact_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let formulation = Formulation { tangent: Tangent::Exact, ..self.formulation };
        self.order.add([x, dx], &Derivative { tets: self, formulation }, scratch.sums(self.sum_rows()).0, out);
    }

    fn product_with_masses(
        &self,
        x: &[Vec3<T>],
        dx: &[Vec3<T>],
        inertia: &Inertia<'_, T>,
        scratch: &mut Scratch<T>,
        out: &mut [Vec3<T>],
    ) -> f64 {
        let is_linearized = scratch.is_linearized;
        let (sums, linearization) = scratch.sums(self.sum_rows());
        if is_linearized {
            let element = FrozenProduct { tets: self, linearization };
            self.order.product_with_masses([dx], &element, sums, (dx, inertia), out)
        } else {
            self.order.product_with_masses([x, dx], &self.derivative(), sums, (dx, inertia), out)
        }
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        match self.formulation.tangent {
            Tangent::Frozen => {
                let was_linearized = scratch.is_linearized;
                if !was_linearized {
                    self.linearize(x, scratch);
                }
                self.add_linearized_blocks(&scratch.linearization, sink);
                scratch.is_linearized = was_linearized;
            }
            Tangent::Exact => self.add_exact_blocks(x, sink),
        }
    }

    fn add_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Mat3<T>]) {
        if scratch.is_linearized {
            let (sums, linearization) = scratch.sums(self.sum_rows());
            self.order.add_diagonal(x, &FrozenProduct { tets: self, linearization }, sums, out);
        } else {
            self.add_blocks(x, scratch, &mut DiagonalSink(out));
        }
    }

    fn has_potential(&self) -> bool {
        !self.fibred && self.formulation.has_potential()
    }

    /// Where the two smallest stretches of a cell turned inside out are as large, its rotation jumps.
    fn has_creases(&self) -> bool {
        true
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let there = self.order.tetrahedra().filter(|tet| !tet.is_padding);
        there
            .map(|tet| {
                let Batch { inverse, volume, hooke } = self.numbers::<f64>(tet.row);
                let [a, b, c, d] = tet.corners.map(|node| x[node as usize].cast::<f64>());
                let f = Mat3::from_columns(b - a, c - a, d - a) * inverse;
                volume * self.formulation.energy(&hooke, &self.formulation.rotation(&f), &f)
            })
            .sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            *self.constants.get_mut(self.order.row(cell), VOLUME) = T::ZERO;
        }
    }

    fn sum_rows(&self) -> usize {
        self.order.sum_rows()
    }

    fn bytes(&self) -> usize {
        self.order.bytes() + self.constants.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

//! Corotational tetrahedra in batches of lanes.

use std::sync::Arc;

use super::Corotational;
use super::formulation::{Formulation, Rotation, Tangent};
use super::hooke::Hooke;
use super::turned::{self, FIBRE, FIBRE_RATIO, FrozenProduct, RATIO, Turned};
use crate::material::Tissue;
use crate::math::rotation::qr;
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Vec3};
use crate::mesh::TetMesh;
use crate::model::BlockSink;
use crate::model::block_sink::add_tet_blocks;
use crate::model::block_table::BlockTable;
use crate::model::patch::{Deformed, Element, Record, TetFans};
use crate::model::tet_loop::{RestTet, edge_matrix, tet_fans};
use crate::model::{ForceModel, ModelError, Patches, Scratch};
use crate::solver::Turn;

/// Columns: Dm⁻¹ by columns, √(V0 μ), λ/μ, and where there are fibres their direction and 2κ/μ. With the root and the quotients of them found
/// once, turned gradients take neither.
const ROOT: usize = 9;
const RATIO_AT_REST: usize = 10;
const FIBRE_AT_REST: usize = 11;
const ISOTROPIC: usize = 11;
const FIBRED: usize = 15;

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
    /// √(V0 μ).
    root: R,
    /// The law over μ.
    hooke: Hooke<R>,
}

impl<R: Real> Batch<R> {
    #[inline(always)]
    fn at(c: &[R; FIBRED], fibred: bool) -> Self {
        let vector = |i: usize| Vec3::new(c[i], c[i + 1], c[i + 2]);
        Self {
            inverse: Mat3::from_columns(vector(0), vector(3), vector(6)),
            root: c[ROOT],
            hooke: Hooke {
                lambda: c[RATIO_AT_REST],
                mu: c[ROOT].like(1.0),
                fibre: if fibred { Some((vector(FIBRE_AT_REST), c[FIBRED - 1])) } else { None },
            },
        }
    }

    /// Forces of the stress P/μ.
    #[inline(always)]
    fn forces(&self, stress: Mat3<R>) -> Mat3<R> {
        stress * self.root.squared() * self.inverse.transpose()
    }
}

/// How many columns there are.
fn columns(fibred: bool) -> usize {
    if fibred { FIBRED } else { ISOTROPIC }
}

impl<T: Scalar> CorotationalTets<T> {
    pub(super) fn new(mesh: &TetMesh, tissue: &Tissue, formulation: Formulation) -> Result<Self, ModelError> {
        let order = tet_fans::<T>(mesh)?;
        let fibred = super::has_fibres(tissue);
        let mut constants = BlockTable::new(T::LANES, order.row_count(), columns(fibred), T::ZERO);
        for tet in order.tetrahedra() {
            let rest = RestTet::turned(mesh, tet.cell, tet.corners);
            let frame = match formulation.rotation {
                Rotation::Qr => qr(&mesh.edge_matrix(tet.cell)),
                Rotation::Polar | Rotation::Svd => Mat3::IDENTITY,
            };
            let stiffness = tissue.at_rest(tet.cell);
            let (lame, direction) = (stiffness.lame, frame.transpose_mul(stiffness.direction).to_array());
            let shape = (rest.inverse * frame).columns.into_iter().flat_map(Vec3::to_array);
            let root = if tet.is_padding { 0.0 } else { (rest.volume * lame.mu).sqrt() };
            let fibre = direction.into_iter().chain([2.0 * stiffness.fibre_stiffness / lame.mu]);
            let numbers = shape.chain([root, lame.lambda / lame.mu]).chain(fibre);
            constants.set_row(tet.row, numbers.take(columns(fibred)).map(T::from_f64));
        }
        Ok(Self { order: Arc::new(order), constants, formulation, fibred })
    }

    fn linearized_columns(&self) -> usize {
        turned::columns(self.fibred)
    }

    #[inline(always)]
    fn load<S: Simd, const PLAIN: bool>(&self, part: Part<S>, slot: usize) -> Batch<T::Lanes<S>> {
        let fibred = !PLAIN && self.fibred;
        let block = self.constants.block_of(T::LANES, columns(fibred), slot);
        let mut numbers = [T::Lanes::<S>::splat(part.simd, T::ZERO); FIBRED];
        for column in 0..columns(fibred) {
            numbers[column] = T::Lanes::<S>::load(part, &block[column * T::LANES..]);
        }
        Batch::at(&numbers, fibred)
    }

    /// How elements are formulated, which the compiler knows of plain ones.
    #[inline(always)]
    fn formulation<const PLAIN: bool>(&self) -> Formulation {
        if PLAIN { Formulation::default() } else { self.formulation }
    }

    /// Whether elements are as they are by default, and without fibres.
    fn is_plain(&self) -> bool {
        !self.fibred && self.formulation == Formulation::default()
    }

    /// The blocks of the tangent with the rotations held.
    fn add_linearized_blocks(&self, linearization: &[T], sink: &mut dyn BlockSink<T>) {
        let columns = self.linearized_columns();
        for tet in self.order.tetrahedra().filter(|tet| !tet.is_padding) {
            let (slot, lane) = (tet.row / T::LANES, tet.row % T::LANES);
            let number = |column: usize| linearization[(slot * columns + column) * T::LANES + lane];
            let vector = |column: usize| Vec3::new(number(column), number(column + 1), number(column + 2));
            let fibre = self.fibred.then(|| (vector(FIBRE), number(FIBRE_RATIO)));
            let hooke = Hooke { lambda: number(RATIO), mu: T::ONE, fibre };
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
            let batch = self.numbers::<T>(tet.row);
            let f = edge_matrix(x, tet.corners) * batch.inverse;
            let r = self.formulation.rotation(&f);
            add_tet_blocks(tet.corners, sink, |dd| {
                let df = *dd * batch.inverse;
                let dr = self.formulation.rotation_along(&f, &r, &df);
                batch.forces(self.formulation.stress_along(&batch.hooke, (&r, &dr), (&f, &df)))
            });
        }
    }

    fn sum(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> &Patches {
        let sums = scratch.sums(self.sum_rows()).0;
        if self.is_plain() {
            self.order.sum([x], &Forces::<T, true>(self), sums)
        } else {
            self.order.sum([x], &Forces::<T, false>(self), sums)
        }
    }

    /// Keeps turned gradients in the scratch, and sums the forces there.
    fn turn(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> &Patches {
        let (sums, linearization) = scratch.sums_and_linearization(self.sum_rows(), self.linearization_len());
        let patches = if self.is_plain() {
            self.order.record_and_sum(x, &Turning::<T, true>(self), sums, linearization)
        } else {
            self.order.record_and_sum(x, &Turning::<T, false>(self), sums, linearization)
        };
        scratch.is_linearized = true;
        patches
    }

    /// The derivative of the forces, that of the rotations as the formulation has it.
    fn derivative(&self) -> Derivative<'_, T> {
        Derivative { tets: self, formulation: self.formulation }
    }

    /// The numbers of one element.
    fn numbers<U: Scalar>(&self, row: usize) -> Batch<U> {
        let mut numbers = [U::ZERO; FIBRED];
        for (column, number) in numbers.iter_mut().enumerate().take(columns(self.fibred)) {
            *number = U::from_f64(self.constants.get(row, column).to_f64());
        }
        Batch::at(&numbers, self.fibred)
    }
}

/// Forces. Plain elements have kernels of their own, here and below: with all formulations in one, registers do not suffice, and it took a
/// quarter longer.
struct Forces<'a, T: Scalar, const PLAIN: bool>(&'a CorotationalTets<T>);
/// What a formulation says of the derivative of the forces.
struct Derivative<'a, T: Scalar> {
    tets: &'a CorotationalTets<T>,
    formulation: Formulation,
}
/// Turns the gradients, and finds the forces by them.
struct Turning<'a, T: Scalar, const PLAIN: bool>(&'a CorotationalTets<T>);

impl<T: Scalar, const PLAIN: bool> Element<T, 1> for Forces<'_, T, PLAIN> {
    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let (batch, formulation) = (self.0.load::<S, PLAIN>(part, slot), self.0.formulation::<PLAIN>());
        let f = edges[0] * batch.inverse;
        batch.forces(formulation.stress(&batch.hooke, &formulation.rotation(&f), &f))
    }
}

impl<T: Scalar> Element<T, 2> for Derivative<'_, T> {
    #[inline(always)]
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; 2]) -> Mat3<T::Lanes<S>> {
        let (batch, formulation) = (self.tets.load::<S, false>(part, slot), self.formulation);
        let (f, df) = (edges[0] * batch.inverse, edges[1] * batch.inverse);
        let r = formulation.rotation(&f);
        let dr = formulation.rotation_along(&f, &r, &df);
        batch.forces(formulation.stress_along(&batch.hooke, (&r, &dr), (&f, &df)))
    }
}

impl<T: Scalar, const PLAIN: bool> Record<T> for Turning<'_, T, PLAIN> {
    fn columns(&self) -> usize {
        self.0.linearized_columns()
    }

    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.0.constants.prefetch(T::LANES, columns(self.0.fibred), slot);
    }

    #[inline(always)]
    fn deformation<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> Mat3<T::Lanes<S>> {
        *edges * self.0.load::<S, PLAIN>(part, slot).inverse
    }

    #[inline(always)]
    fn rotation<S: Simd>(&self, f: &Mat3<T::Lanes<S>>) -> Mat3<T::Lanes<S>> {
        self.0.formulation::<PLAIN>().rotation(f)
    }

    // With the gradients of a body at rest, D gᵀ is √(V μ) F Rᵀ: what it is above √(V μ) I is strain, in the turned frame.
    #[inline(always)]
    fn record<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        &Deformed { edges, f, r }: &Deformed<T::Lanes<S>>,
        row: &mut [T],
    ) -> Mat3<T::Lanes<S>> {
        let (batch, formulation) = (self.0.load::<S, PLAIN>(part, slot), self.0.formulation::<PLAIN>());
        let (transport, scale) = formulation.transport(&r, &f);
        let root = if PLAIN { batch.root } else { batch.root * scale.sqrt() };
        let turned = Turned {
            gradients: transport * batch.inverse.transpose() * root,
            ratio: batch.hooke.lambda,
            fibre: batch.hooke.fibre.map(|(direction, stiffness)| (r * direction, stiffness)),
        };
        turned.store::<T, S>(part, row);
        if formulation.is_linear_in_its_frame() {
            turned.forces(&(edges * turned.gradients.transpose() - Mat3::diagonal(root)))
        } else {
            batch.forces(formulation.stress(&batch.hooke, &r, &f))
        }
    }
}

impl<T: Scalar> ForceModel<T> for CorotationalTets<T> {
    fn name(&self) -> &'static str {
        Corotational::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let patches = self.sum(x, scratch);
        scratch.add_sums(patches, out);
    }

    fn sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(self.sum(x, scratch))
    }

    fn linearization_len(&self) -> usize {
        match self.formulation.tangent {
            Tangent::Frozen => self.order.row_count() * self.linearized_columns(),
            Tangent::Exact => 0,
        }
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        if self.formulation.tangent == Tangent::Frozen {
            self.turn(x, scratch);
        }
    }

    fn linearize_and_sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(match self.formulation.tangent {
            Tangent::Frozen => self.turn(x, scratch),
            Tangent::Exact => self.sum(x, scratch),
        })
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let is_linearized = scratch.is_linearized;
        let (sums, linearization) = scratch.sums(self.sum_rows());
        match (is_linearized, self.fibred) {
            (false, _) => self.order.add([x, dx], &self.derivative(), sums, out),
            (true, false) => self.order.add([dx], &FrozenProduct::<T, false>(linearization), sums, out),
            (true, true) => self.order.add([dx], &FrozenProduct::<T, true>(linearization), sums, out),
        }
    }

    fn add_exact_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        let formulation = Formulation { tangent: Tangent::Exact, ..self.formulation };
        self.order.add([x, dx], &Derivative { tets: self, formulation }, scratch.sums(self.sum_rows()).0, out);
    }

    fn sum_product(
        &self,
        x: &[Vec3<T>],
        turn: &Turn<'_, T>,
        masses: &[T],
        scratch: &mut Scratch<T>,
    ) -> Option<(&Patches, f64)> {
        let is_linearized = scratch.is_linearized;
        let (sums, linearization) = scratch.sums(self.sum_rows());
        let along = (turn, masses);
        Some(match (is_linearized, self.fibred) {
            (false, _) => self.order.sum_product(x, along, &self.derivative(), sums),
            (true, false) => self.order.sum_product(x, along, &FrozenProduct::<T, false>(linearization), sums),
            (true, true) => self.order.sum_product(x, along, &FrozenProduct::<T, true>(linearization), sums),
        })
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

    fn sum_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        if !scratch.is_linearized {
            return None;
        }
        let (sums, linearization) = scratch.sums(self.sum_rows());
        Some(if self.fibred {
            self.order.sum_diagonal(x, &FrozenProduct::<T, true>(linearization), sums)
        } else {
            self.order.sum_diagonal(x, &FrozenProduct::<T, false>(linearization), sums)
        })
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
                let Batch { inverse, root, hooke } = self.numbers::<f64>(tet.row);
                let [a, b, c, d] = tet.corners.map(|node| x[node as usize].cast::<f64>());
                let f = Mat3::from_columns(b - a, c - a, d - a) * inverse;
                root.squared() * self.formulation.energy(&hooke, &self.formulation.rotation(&f), &f)
            })
            .sum()
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            *self.constants.get_mut(self.order.row(cell), ROOT) = T::ZERO;
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

//! Corotational hexahedra in batches of lanes: one rotation for each, 2×2×2 points.

use std::ops::Range;
use std::sync::Arc;

use super::Corotational;
use super::formulation::{Formulation, Rotation, Tangent};
use super::hex_linearized::LINEARIZED;
use super::hooke::{FIBRED, Hooke, ISOTROPIC};
use crate::material::Tissue;
use crate::math::rotation::qr;
use crate::math::{Lanes, Mat3, Part, Scalar, Simd, Vec3, baseline, dispatch, dispatch_level};
use crate::mesh::{GaussRule, HexMesh};
use crate::model::BlockSink;
use crate::model::block_sink::{add_block_column, unit_displacement};
use crate::model::block_table::BlockTable;
use crate::model::sections::{SectionScratch, Sections};
use crate::model::tet_loop::scatter_corners;
use crate::model::total_lagrangian::hex::{POINT, deformation, gather_corners, load_gradients};
use crate::model::{ForceModel, ModelError, Scratch};

/// Gauss points of a cell.
pub(super) const POINTS: usize = 8;
/// Gradients at the centre: three numbers for each corner.
const CENTRE: usize = 24;

/// Corotational hexahedra. R is that of the mean edges, J = F at the centre. For QR the gradients are those of the rest
/// shape turned so that its own mean edges 1 and 2 lie along its first axes, as with tetrahedra.
#[derive(Clone, Debug)]
pub(super) struct CorotationalHexes<T: Scalar> {
    pub(super) corners: BlockTable<u32>,
    pub(super) sections: Arc<Sections>,
    /// Gradients at the centre.
    pub(super) centres: BlockTable<T>,
    /// Gradients and volume of each Gauss point.
    pub(super) points: BlockTable<T>,
    pub(super) law: BlockTable<T>,
    pub(super) formulation: Formulation,
    fibred: bool,
}

impl<T: Scalar> CorotationalHexes<T> {
    pub(super) fn new(mesh: &HexMesh, tissue: &Tissue, formulation: Formulation) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let cells = mesh.cells.len();
        let fibred = super::has_fibres(tissue);
        let mut hexes = Self {
            corners: BlockTable::new(T::LANES, cells, 8, 0),
            sections: Arc::default(),
            centres: BlockTable::new(T::LANES, cells, CENTRE, T::ZERO),
            points: BlockTable::new(T::LANES, cells, POINTS * POINT, T::ZERO),
            law: BlockTable::new(T::LANES, cells, if fibred { FIBRED } else { ISOTROPIC }, T::ZERO),
            formulation,
            fibred,
        };
        for row in 0..hexes.corners.padded_rows() {
            // padding repeats the last cell, without volume
            let cell = row.min(cells - 1);
            let points = mesh.gauss_points(cell, GaussRule::Two)?;
            let centre = mesh.centre_gradients(cell)?;
            let frame = match formulation.rotation {
                Rotation::Qr => qr(&mesh.mean_edges(cell)),
                Rotation::Polar | Rotation::Svd => Mat3::IDENTITY,
            };
            let turned = |gradients: [Vec3<f64>; 8]| gradients.map(|gradient| frame.transpose_mul(gradient).to_array());
            let there = if row < cells { 1.0 } else { 0.0 };
            let numbers = points
                .iter()
                .flat_map(|point| turned(point.gradients).into_iter().flatten().chain([there * point.volume]));
            let stiffness = tissue.at_rest(cell);
            let law = Hooke::numbers(&stiffness, frame.transpose_mul(stiffness.direction), fibred);
            hexes.corners.set_row(row, mesh.cells[cell]);
            hexes.centres.set_row(row, turned(centre).into_iter().flatten().map(T::from_f64));
            hexes.points.set_row(row, numbers.map(T::from_f64));
            hexes.law.set_row(row, law.into_iter().map(T::from_f64));
        }
        hexes.sections = Arc::new(Sections::of_table(mesh.nodes.len(), &hexes.corners));
        Ok(hexes)
    }

    #[inline(always)]
    pub(super) fn load_law<S: Simd>(&self, part: Part<S>, block: &[T]) -> Hooke<T::Lanes<S>> {
        let mut numbers = [T::Lanes::<S>::splat(part.simd, T::ZERO); FIBRED];
        for column in 0..if self.fibred { FIBRED } else { ISOTROPIC } {
            numbers[column] = T::Lanes::<S>::load(part, &block[column * T::LANES..]);
        }
        Hooke::at(&numbers, self.fibred)
    }

    /// The batch of these corners at `x`.
    #[inline(always)]
    fn load<S: Simd>(&self, part: Part<S>, x: &[[T; 4]], nodes: &[u32], centre: &[T], law: &[T]) -> Batch<T::Lanes<S>> {
        let place = gather_corners(part, x, nodes);
        let centre = load_gradients::<T, S>(part, centre);
        let mean = deformation(&place, &centre);
        let r = self.formulation.rotation(&mean);
        Batch { hooke: self.load_law(part, law), place, centre, mean, r }
    }

    /// Forces on the corners, or with `PRODUCT` their derivative along `direction`.
    #[inline(always)]
    fn element_forces<S: Simd, const PRODUCT: bool>(
        &self,
        part: Part<S>,
        formulation: Formulation,
        batch: &Batch<T::Lanes<S>>,
        points: &[T],
        direction: &[Vec3<T::Lanes<S>>; 8],
    ) -> [Vec3<T::Lanes<S>>; 8] {
        let Batch { hooke, place, centre, mean, r } = batch;
        let dr = if PRODUCT { formulation.rotation_along(mean, r, &deformation(direction, centre)) } else { *r };
        let mut forces = [Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO)); 8];
        for point in points.chunks_exact(POINT * T::LANES) {
            let gradients = load_gradients::<T, S>(part, point);
            let f = deformation(place, &gradients);
            let stress = if PRODUCT {
                formulation.stress_along(hooke, (r, &dr), (&f, &deformation(direction, &gradients)))
            } else {
                formulation.stress(hooke, r, &f)
            };
            let stress = stress * T::Lanes::<S>::load(part, &point[24 * T::LANES..]);
            for corner in 0..8 {
                forces[corner] += stress * gradients[corner];
            }
        }
        forces
    }

    /// Adds the forces, or with `PRODUCT` their derivative along `dx`.
    #[inline(always)]
    fn add_with<S: Simd, const PRODUCT: bool>(
        &self,
        simd: S,
        formulation: Formulation,
        [x, dx]: [&[[T; 4]]; 2],
        batches: Range<usize>,
        out: &mut [[T; 4]],
    ) {
        for number in batches {
            let nodes = self.corners.block(number);
            for part in Part::all::<T>(simd) {
                let batch = self.load(part, x, nodes, self.centres.block(number), self.law.block(number));
                let direction = if PRODUCT { gather_corners(part, dx, nodes) } else { batch.place };
                let forces =
                    self.element_forces::<S, PRODUCT>(part, formulation, &batch, self.points.block(number), &direction);
                self.scatter::<S>(part, &forces, number, out);
            }
        }
    }

    fn add<const PRODUCT: bool>(&self, formulation: Formulation, scratch: &mut Scratch<T>) {
        let SectionScratch { nodal, direction, mut sums, .. } = scratch.sections(self.sections.sum_rows());
        self.sections.add(&mut sums, &|batches, rows| {
            dispatch!(dispatch_level(), simd => self.add_with::<_, PRODUCT>(simd, formulation, [nodal, direction], batches, rows));
        });
    }

    /// Adds the forces of a batch to the rows of its section.
    #[inline(always)]
    pub(super) fn scatter<S: Simd>(
        &self,
        part: Part<S>,
        forces: &[Vec3<T::Lanes<S>>; 8],
        batch: usize,
        out: &mut [[T; 4]],
    ) {
        let rows = self.sections.rows(batch * 8 * T::LANES..(batch + 1) * 8 * T::LANES);
        scatter_corners::<T, S, 8>(part, forces, rows, out);
    }

    /// The blocks of the exact tangent, column by column.
    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, x: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        let tables = self.corners.blocks().zip(self.centres.blocks()).zip(self.points.blocks()).zip(self.law.blocks());
        for (number, (((nodes, centre), points), law)) in tables.enumerate() {
            let elements = self.corners.rows() - number * T::LANES;
            for part in Part::all::<T>(simd) {
                let batch = self.load(part, x, nodes, centre, law);
                for corner in 0..8 {
                    let mut columns = [batch.place; 3];
                    for axis in 0..3 {
                        let unit = unit_displacement::<T, S, 8>(simd, corner, axis);
                        columns[axis] = self.element_forces::<S, true>(part, self.formulation, &batch, points, &unit);
                    }
                    add_block_column::<T, S, 8>(part, &columns, nodes, corner, elements, sink);
                }
            }
        }
    }
}

/// A batch of elements: law, corners, gradients and F at the centre, rotation.
struct Batch<R> {
    hooke: Hooke<R>,
    place: [Vec3<R>; 8],
    centre: [Vec3<R>; 8],
    mean: Mat3<R>,
    r: Mat3<R>,
}

impl<T: Scalar> ForceModel<T> for CorotationalHexes<T> {
    fn name(&self) -> &'static str {
        Corotational::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        self.add::<false>(self.formulation, scratch);
        scratch.finish(out);
    }

    fn linearization_len(&self) -> usize {
        match self.formulation.tangent {
            Tangent::Frozen => self.corners.padded_rows() * LINEARIZED,
            Tangent::Exact => 0,
        }
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        if self.formulation.tangent == Tangent::Frozen {
            scratch.start(x);
            let (executor, nodal, linearization) = scratch.start_linearization(self.linearization_len());
            self.sections.each(executor, linearization, LINEARIZED * T::LANES, &|batches, rows| {
                dispatch!(dispatch_level(), simd => self.linearize_with(simd, nodal, batches, rows));
            });
        }
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start_direction(dx);
        if scratch.is_linearized {
            scratch.clear_forces();
            let SectionScratch { direction, linearization, mut sums, .. } = scratch.sections(self.sections.sum_rows());
            self.sections.add(&mut sums, &|batches, rows| {
                dispatch!(dispatch_level(), simd => {
                    self.add_linearized_product_with(simd, linearization, direction, batches, rows);
                });
            });
        } else {
            scratch.start(x);
            self.add::<true>(self.formulation, scratch);
        }
        scratch.finish(out);
    }

    fn add_exact_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        self.add::<true>(Formulation { tangent: Tangent::Exact, ..self.formulation }, scratch);
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
                self.add_linearized_blocks_with(baseline(), linearization, sink);
                scratch.is_linearized = was_linearized;
            }
            Tangent::Exact => {
                scratch.start(x);
                self.add_blocks_with(baseline(), &scratch.nodal, sink);
            }
        }
    }

    fn has_potential(&self) -> bool {
        false
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let mut total = 0.0;
        for row in 0..self.corners.rows() {
            let mut law = [0.0; FIBRED];
            for column in 0..if self.fibred { FIBRED } else { ISOTROPIC } {
                law[column] = self.law.get(row, column).to_f64();
            }
            let hooke = Hooke::at(&law, self.fibred);
            let corners = std::array::from_fn(|a| x[self.corners.get(row, a) as usize].cast::<f64>());
            let gradients = |table: &BlockTable<T>, start: usize| -> [Vec3<f64>; 8] {
                let number = |i: usize| table.get(row, start + i).to_f64();
                std::array::from_fn(|a| Vec3::new(number(3 * a), number(3 * a + 1), number(3 * a + 2)))
            };
            let r = self.formulation.rotation(&deformation(&corners, &gradients(&self.centres, 0)));
            for point in 0..POINTS {
                let f = deformation(&corners, &gradients(&self.points, point * POINT));
                let volume = self.points.get(row, point * POINT + 24).to_f64();
                total += volume * self.formulation.energy(&hooke, &r, &f);
            }
        }
        total
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            for point in 0..POINTS {
                *self.points.get_mut(cell as usize, point * POINT + 24) = T::ZERO;
            }
        }
    }

    fn sum_rows(&self) -> usize {
        self.sections.sum_rows()
    }

    fn bytes(&self) -> usize {
        self.corners.bytes() + self.sections.bytes() + self.centres.bytes() + self.points.bytes() + self.law.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

//! Hexahedra with eight corners: trilinear shape functions, Gauss points, any law.
//!
//! F(ξ) = Σ_a x_a ∇N_a(ξ)ᵀ,   f_a = Σ_q w_q det J_q P(F_q) ∇N_a(ξ_q), with gradients over the rest shape.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use super::super::block_sink::{add_block_column, unit_displacement};
use super::super::block_table::BlockTable;
use super::super::sections::{SectionScratch, Sections};
use super::super::tet_loop::{gather_corner, scatter_corners};
use super::super::{BlockSink, ForceModel, MeanForces, ModelError, Scratch};
use super::{TotalLagrangian, hex_mean};
use crate::material::{Law, LawFamily, Tissue};
use crate::math::{Lanes, Mat3, Part, Scalar, Simd, Vec3, baseline, dispatch, dispatch_level};
use crate::mesh::{GaussRule, HexMesh};

/// Numbers stored for a Gauss point: eight gradients and a volume.
pub(in crate::model) const POINT: usize = 25;

/// Hexahedra in batches of lanes, of the law `L`.
#[derive(Debug)]
pub(super) struct HexLoop<T: Scalar, L> {
    pub(super) corners: BlockTable<u32>,
    pub(super) sections: Arc<Sections>,
    pub(super) points: BlockTable<T>,
    pub(super) parameters: BlockTable<T>,
    point_count: usize,
    law: PhantomData<L>,
}

impl<T: Scalar, L> Clone for HexLoop<T, L> {
    fn clone(&self) -> Self {
        Self {
            corners: self.corners.clone(),
            sections: Arc::clone(&self.sections),
            points: self.points.clone(),
            parameters: self.parameters.clone(),
            point_count: self.point_count,
            law: PhantomData,
        }
    }
}

impl<T: Scalar, L: LawFamily> HexLoop<T, L> {
    pub(super) fn new(mesh: &HexMesh, tissue: &Tissue, rule: GaussRule) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let cells = mesh.cells.len();
        let point_count = rule.point_count();
        let mut hexes = Self {
            corners: BlockTable::new(T::LANES, cells, 8, 0),
            sections: Arc::default(),
            points: BlockTable::new(T::LANES, cells, point_count * POINT, T::ZERO),
            parameters: BlockTable::new(T::LANES, cells, L::PARAMETERS.len(), T::ZERO),
            point_count,
            law: PhantomData,
        };
        for row in 0..hexes.corners.padded_rows() {
            let cell = row.min(cells - 1);
            hexes.corners.set_row(row, mesh.cells[cell]);
            hexes.parameters.set_row(row, tissue.values(cell).iter().map(|&value| T::from_f64(value)));
            let points = mesh.gauss_points(cell, rule)?;
            let numbers = points
                .iter()
                .flat_map(|point| point.gradients.into_iter().flat_map(Vec3::to_array).chain([point.volume]));
            hexes.points.set_row(row, numbers.map(T::from_f64));
            if row >= cells {
                hexes.deactivate(row);
            }
        }
        hexes.sections = Arc::new(Sections::of_table(mesh.nodes.len(), &hexes.corners));
        Ok(hexes)
    }

    fn deactivate(&mut self, row: usize) {
        for point in 0..self.point_count {
            *self.points.get_mut(row, point * POINT + 24) = T::ZERO;
        }
    }

    /// Adds the forces at `x`, or with `TANGENT` their derivative along `dx`.
    #[inline(always)]
    fn add_with<S: Simd, const TANGENT: bool>(
        &self,
        simd: S,
        [x, dx]: [&[[T; 4]]; 2],
        batches: Range<usize>,
        out: &mut [[T; 4]],
    ) {
        for batch in batches {
            let (nodes, points) = (self.corners.block(batch), self.points.block(batch));
            let rows = self.sections.rows(batch * 8 * T::LANES..(batch + 1) * 8 * T::LANES);
            for part in Part::all::<T>(simd) {
                let parameters = load_parameters::<T, S, L>(part, self.parameters.block(batch));
                let place = gather_corners(part, x, nodes);
                let direction = if TANGENT { gather_corners(part, dx, nodes) } else { place };
                let forces = element_forces::<T, S, L, TANGENT>(part, &parameters, points, &place, &direction);
                scatter_corners::<T, S, 8>(part, &forces, rows, out);
            }
        }
    }

    fn add<const TANGENT: bool>(&self, scratch: &mut Scratch<T>) {
        let SectionScratch { nodal, direction, mut sums, .. } = scratch.sections(self.sections.sum_rows());
        self.sections.add(&mut sums, &|batches, rows| {
            dispatch!(dispatch_level(), simd => self.add_with::<_, TANGENT>(simd, [nodal, direction], batches, rows));
        });
    }

    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, x: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        let blocks = self.corners.blocks().zip(self.points.blocks()).zip(self.parameters.blocks());
        for (block, ((nodes, points), parameters)) in blocks.enumerate() {
            let elements = self.corners.rows() - block * T::LANES;
            for part in Part::all::<T>(simd) {
                let parameters = load_parameters::<T, S, L>(part, parameters);
                let place = gather_corners(part, x, nodes);
                for corner in 0..8 {
                    let mut columns = [place; 3];
                    for axis in 0..3 {
                        let unit = unit_displacement::<T, S, 8>(simd, corner, axis);
                        columns[axis] = element_forces::<T, S, L, true>(part, &parameters, points, &place, &unit);
                    }
                    add_block_column::<T, S, 8>(part, &columns, nodes, corner, elements, sink);
                }
            }
        }
    }
}

/// The most parameters of a law.
const MAX_PARAMETERS: usize = 8;

#[inline(always)]
pub(super) fn load_parameters<T: Scalar, S: Simd, L: LawFamily>(
    part: Part<S>,
    block: &[T],
) -> [T::Lanes<S>; MAX_PARAMETERS] {
    let mut parameters = [T::Lanes::<S>::splat(part.simd, T::ZERO); MAX_PARAMETERS];
    for column in 0..L::PARAMETERS.len() {
        parameters[column] = T::Lanes::<S>::load(part, &block[column * T::LANES..]);
    }
    parameters
}

/// Forces on the corners, or with `TANGENT` their derivative along `direction`.
#[inline(always)]
fn element_forces<T: Scalar, S: Simd, L: LawFamily, const TANGENT: bool>(
    part: Part<S>,
    parameters: &[T::Lanes<S>; MAX_PARAMETERS],
    points: &[T],
    place: &[Vec3<T::Lanes<S>>; 8],
    direction: &[Vec3<T::Lanes<S>>; 8],
) -> [Vec3<T::Lanes<S>>; 8] {
    let law = L::at(&parameters[..L::PARAMETERS.len()]);
    let mut forces = [Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO)); 8];
    for point in points.chunks_exact(POINT * T::LANES) {
        let gradients = load_gradients::<T, S>(part, point);
        let f = deformation(place, &gradients);
        let stress = if TANGENT { law.tangent(&f, &deformation(direction, &gradients)) } else { law.stress(&f) };
        let stress = stress * T::Lanes::<S>::load(part, &point[24 * T::LANES..]);
        for corner in 0..8 {
            forces[corner] += stress * gradients[corner];
        }
    }
    forces
}

#[inline(always)]
pub(in crate::model) fn gather_corners<T: Scalar, S: Simd>(
    part: Part<S>,
    x: &[[T; 4]],
    nodes: &[u32],
) -> [Vec3<T::Lanes<S>>; 8] {
    let mut corners = [Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO)); 8];
    for corner in 0..8 {
        corners[corner] = gather_corner(part, x, nodes, corner);
    }
    corners
}

#[inline(always)]
pub(in crate::model) fn load_gradients<T: Scalar, S: Simd>(part: Part<S>, point: &[T]) -> [Vec3<T::Lanes<S>>; 8] {
    let mut gradients = [Vec3::splat(T::Lanes::<S>::splat(part.simd, T::ZERO)); 8];
    for corner in 0..8 {
        for axis in 0..3 {
            gradients[corner][axis] = T::Lanes::<S>::load(part, &point[(3 * corner + axis) * T::LANES..]);
        }
    }
    gradients
}

#[inline(always)]
pub(in crate::model) fn deformation<R: crate::math::Real>(corners: &[Vec3<R>; 8], gradients: &[Vec3<R>; 8]) -> Mat3<R> {
    let mut f = corners[0].outer(gradients[0]);
    for corner in 1..8 {
        f += corners[corner].outer(gradients[corner]);
    }
    f
}

impl<T: Scalar, L: LawFamily> ForceModel<T> for HexLoop<T, L> {
    fn name(&self) -> &'static str {
        TotalLagrangian::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        self.add::<false>(scratch);
        scratch.finish(out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        self.add::<true>(scratch);
        scratch.finish(out);
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        scratch.start(x);
        self.add_blocks_with(baseline(), &scratch.nodal, sink);
    }

    fn mean_forces(&self) -> Option<&dyn MeanForces<T>> {
        hex_mean::keeps_energy::<L>().then_some(self)
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let mut total = 0.0;
        for row in 0..self.corners.rows() {
            let mut values = [0.0; MAX_PARAMETERS];
            for column in 0..L::PARAMETERS.len() {
                values[column] = self.parameters.get(row, column).to_f64();
            }
            let law = L::at(&values[..L::PARAMETERS.len()]);
            let corners = std::array::from_fn(|a| x[self.corners.get(row, a) as usize].cast::<f64>());
            for point in 0..self.point_count {
                let number = |i: usize| self.points.get(row, point * POINT + i).to_f64();
                let gradients: [Vec3<f64>; 8] =
                    std::array::from_fn(|a| Vec3::new(number(3 * a), number(3 * a + 1), number(3 * a + 2)));
                total += number(24) * law.energy(&deformation(&corners, &gradients));
            }
        }
        total
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            self.deactivate(cell as usize);
        }
    }

    fn sum_rows(&self) -> usize {
        self.sections.sum_rows()
    }

    fn bytes(&self) -> usize {
        self.corners.bytes() + self.sections.bytes() + self.points.bytes() + self.parameters.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

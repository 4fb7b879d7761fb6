//! The loop over one kind of entity: gather displacements into lanes, apply the entity's force, scatter.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use super::entity::{Corner, Entity, MAX_COLUMNS};
use super::tensors::TetTensors;
use crate::math::{Dual, Lanes, Part, Real, Scalar, Simd, Vec3, baseline, dispatch, dispatch_level, prefetch};
use crate::model::BlockSink;
use crate::model::block_sink::{add_block_column, unit_displacement};
use crate::model::block_table::BlockTable;
use crate::model::sections::{SectionSums, Sections};
use crate::model::tet_loop::scatter_corners;

/// All entities of one kind, with the sums of the tensors of the tetrahedra that touch them.
#[derive(Debug)]
pub(crate) struct EntityLoop<T: Scalar, E, const NODES: usize> {
    nodes: BlockTable<u32>,
    sections: Arc<Sections>,
    stored: BlockTable<T>,
    /// How many tetrahedra still touch each entity.
    uses: Vec<u32>,
    entity: PhantomData<E>,
}

impl<T: Scalar, E, const NODES: usize> Clone for EntityLoop<T, E, NODES> {
    fn clone(&self) -> Self {
        Self {
            nodes: self.nodes.clone(),
            sections: Arc::clone(&self.sections),
            stored: self.stored.clone(),
            uses: self.uses.clone(),
            entity: PhantomData,
        }
    }
}

/// Adds up tables in double precision before they are stored in the precision of play.
pub(crate) struct Assembly<E, const NODES: usize> {
    nodes: Vec<[u32; NODES]>,
    sums: Vec<f64>,
    uses: Vec<u32>,
    entity: PhantomData<E>,
}

impl<E: Entity<NODES>, const NODES: usize> Assembly<E, NODES> {
    pub(super) fn new(nodes: Vec<[u32; NODES]>) -> Self {
        let count = nodes.len();
        Self { nodes, sums: vec![0.0; count * E::COLUMNS], uses: vec![0; count], entity: PhantomData }
    }

    /// Adds a tetrahedron to the entity whose corners are its local corners `at`.
    pub(super) fn add(&mut self, entity: usize, tensors: &TetTensors, at: [usize; NODES]) {
        let sums = &mut self.sums[entity * E::COLUMNS..(entity + 1) * E::COLUMNS];
        for (sum, value) in sums.iter_mut().zip(E::stored(tensors, at)) {
            *sum += value;
        }
        self.uses[entity] += 1;
    }

    /// The loop over the entities, in a body of `mesh_nodes` nodes.
    pub(super) fn finish<T: Scalar>(self, mesh_nodes: usize) -> EntityLoop<T, E, NODES> {
        let count = self.nodes.len();
        let mut nodes = BlockTable::new(T::LANES, count, NODES, 0);
        let mut stored = BlockTable::new(T::LANES, count, E::COLUMNS, T::ZERO);
        for (entity, corners) in self.nodes.into_iter().enumerate() {
            let row = row(entity, count, T::LANES);
            let sums = &self.sums[entity * E::COLUMNS..(entity + 1) * E::COLUMNS];
            nodes.set_row(row, corners);
            stored.set_row(row, sums.iter().map(|&v| T::from_f64(v)));
        }
        let sections = Arc::new(Sections::of_table(mesh_nodes, &nodes));
        EntityLoop { nodes, sections, stored, uses: self.uses, entity: PhantomData }
    }
}

impl<T: Scalar, E: Entity<NODES>, const NODES: usize> EntityLoop<T, E, NODES> {
    fn row_of(&self, entity: usize) -> usize {
        row(entity, self.stored.rows(), T::LANES)
    }

    /// Size of the stored numbers [bytes].
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.bytes() + self.sections.bytes() + self.stored.bytes()
    }

    /// Rows that the loop sums in.
    pub(crate) fn sum_rows(&self) -> usize {
        self.sections.sum_rows()
    }

    /// Numbers stored for an entity, for comparisons in tests.
    #[cfg(test)]
    pub(super) fn row(&self, entity: usize) -> impl Iterator<Item = T> + '_ {
        let row = self.row_of(entity);
        (0..E::COLUMNS).map(move |column| self.stored.get(row, column))
    }

    /// Takes a tetrahedron off the entity. The last one leaves exact zeros behind, not rounding errors.
    pub(crate) fn subtract(&mut self, entity: usize, tensors: &TetTensors, at: [usize; NODES]) {
        self.uses[entity] -= 1;
        let row = self.row_of(entity);
        let (block, lane) = (self.stored.block_of_mut(T::LANES, E::COLUMNS, row / T::LANES), row % T::LANES);
        if self.uses[entity] == 0 {
            (0..E::COLUMNS).for_each(|column| block[column * T::LANES + lane] = T::ZERO);
        } else {
            let values = E::stored(tensors, at);
            for column in 0..E::COLUMNS {
                let stored = &mut block[column * T::LANES + lane];
                *stored = T::from_f64(stored.to_f64() - values[column]);
            }
        }
    }

    /// Adds the forces at the displacements and weights in `nodal`.
    ///
    /// `ADAPTIVE` tells that weights may be 0: a batch whose corners are all linear is spared the non-linear part.
    pub(crate) fn add_forces<const ADAPTIVE: bool>(&self, nodal: &[[T; 4]], sums: &mut SectionSums<'_, T>) {
        self.sections.add(sums, &|batches, rows| {
            dispatch!(dispatch_level(), simd => self.add_forces_with::<_, ADAPTIVE>(simd, nodal, batches, rows));
        });
    }

    #[inline(always)]
    fn add_forces_with<S: Simd, const ADAPTIVE: bool>(
        &self,
        simd: S,
        nodal: &[[T; 4]],
        batches: Range<usize>,
        out: &mut [[T; 4]],
    ) {
        for batch in batches {
            self.prefetch(batch + AHEAD);
            let (nodes, stored) = self.block(batch);
            for part in Part::all::<T>(simd) {
                let corners = gather_corners::<T, S, NODES>(part, nodal, nodes);
                let c = load_columns::<T, S>(part, stored, E::COLUMNS);
                let linear = E::linear(&c, &corners);
                let all_linear = ADAPTIVE && Self::are_linear(part, nodes, nodal);
                let nonlinear = if all_linear { None } else { E::nonlinear(&c, &corners) };
                let mut forces = linear.unwrap_or([Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); NODES]);
                if let Some(nonlinear) = nonlinear {
                    for node in 0..NODES {
                        forces[node] = if ADAPTIVE {
                            nonlinear[node].mul_add(corners[node].weight, forces[node])
                        } else {
                            forces[node] + nonlinear[node]
                        };
                    }
                } else if linear.is_none() {
                    continue;
                }
                scatter_corners::<T, S, NODES>(part, &forces, self.rows(batch), out);
            }
        }
    }

    /// Whether all corners of a batch are linear.
    #[inline(always)]
    fn are_linear<S: Simd>(part: Part<S>, nodes: &[u32], nodal: &[[T; 4]]) -> bool {
        let own = |nodes| part.of::<T, T::Lanes<S>, _>(nodes).iter();
        nodes.chunks_exact(T::LANES).flat_map(own).all(|&node| nodal[node as usize][3] == T::ZERO)
    }

    /// Nodes and stored numbers of a batch.
    #[inline(always)]
    fn block(&self, batch: usize) -> (&[u32], &[T]) {
        (self.nodes.block_of(T::LANES, NODES, batch), self.stored.block_of(T::LANES, E::COLUMNS, batch))
    }

    /// Asks for what a batch reads that the loop will come to.
    #[inline(always)]
    fn prefetch(&self, batch: usize) {
        if batch < self.stored.rows() / T::LANES {
            let (nodes, stored) = self.block(batch);
            prefetch(stored);
            prefetch(nodes);
            prefetch(self.rows(batch));
        }
    }

    /// Where a batch sums.
    #[inline(always)]
    fn rows(&self, batch: usize) -> &[u32] {
        self.sections.rows(batch * NODES * T::LANES..(batch + 1) * NODES * T::LANES)
    }

    /// Adds the derivative of the forces along the displacements in `direction`, weights held.
    pub(crate) fn add_product(&self, nodal: &[[T; 4]], direction: &[[T; 4]], sums: &mut SectionSums<'_, T>) {
        self.sections.add(sums, &|batches, rows| {
            dispatch!(dispatch_level(), simd => self.add_product_with(simd, [nodal, direction], batches, rows));
        });
    }

    #[inline(always)]
    fn add_product_with<S: Simd>(
        &self,
        simd: S,
        [nodal, direction]: [&[[T; 4]]; 2],
        batches: Range<usize>,
        out: &mut [[T; 4]],
    ) {
        for batch in batches {
            let (nodes, stored) = self.block(batch);
            for part in Part::all::<T>(simd) {
                let at = gather_corners::<T, S, NODES>(part, nodal, nodes);
                let along = gather_corners::<T, S, NODES>(part, direction, nodes);
                let c = load_columns::<T, S>(part, stored, E::COLUMNS);
                let forces = forces_along::<_, E, NODES>(&c, &at, &along);
                scatter_corners::<T, S, NODES>(part, &forces, self.rows(batch), out);
            }
        }
    }

    /// Gives the blocks of the derivative of the forces, weights held.
    pub(crate) fn add_blocks(&self, nodal: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        self.add_blocks_with(baseline(), nodal, sink);
    }

    #[inline(always)]
    fn add_blocks_with<S: Simd>(&self, simd: S, nodal: &[[T; 4]], sink: &mut dyn BlockSink<T>) {
        for (block, (nodes, stored)) in self.nodes.blocks().zip(self.stored.blocks()).enumerate() {
            let elements = self.nodes.rows() - block * T::LANES;
            for part in Part::all::<T>(simd) {
                let at = gather_corners::<T, S, NODES>(part, nodal, nodes);
                let c = load_columns::<T, S>(part, stored, E::COLUMNS);
                for corner in 0..NODES {
                    let mut columns = [[Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO)); NODES]; 3];
                    for axis in 0..3 {
                        let mut along = at;
                        let unit = unit_displacement::<T, S, NODES>(simd, corner, axis);
                        for node in 0..NODES {
                            along[node].u = unit[node];
                        }
                        columns[axis] = forces_along::<_, E, NODES>(&c, &at, &along);
                    }
                    add_block_column::<T, S, NODES>(part, &columns, nodes, corner, elements, sink);
                }
            }
        }
    }

    /// Energy of the full law [J], in double precision.
    ///
    /// W(u) = ∫₀¹ u·F(s u) ds; the integrand is a cubic in s, so two Gauss points are exact.
    pub(crate) fn energy(&self, displacement: impl Fn(u32) -> Vec3<f64>) -> f64 {
        const OFFSET: f64 = 0.288_675_134_594_812_9; // 1/(2√3)
        let mut c = [0.0; MAX_COLUMNS];
        let mut total = 0.0;
        for row in 0..self.nodes.rows() {
            for (column, value) in c[..E::COLUMNS].iter_mut().enumerate() {
                *value = self.stored.get(row, column).to_f64();
            }
            let u: [Vec3<f64>; NODES] = std::array::from_fn(|i| displacement(self.nodes.get(row, i)));
            for s in [0.5 - OFFSET, 0.5 + OFFSET] {
                let corners = u.map(|u| Corner { u: u * s, weight: 1.0 });
                for forces in [E::linear(&c, &corners), E::nonlinear(&c, &corners)].into_iter().flatten() {
                    total += (0..NODES).map(|node| 0.5 * u[node].dot(forces[node])).sum::<f64>();
                }
            }
        }
        total
    }
}

/// How many batches a loop looks ahead.
const AHEAD: usize = 4;

/// How many batches share out as many times their lanes of entities that follow each other.
const APART: usize = 16;

/// The row of an entity, one of `count`: the lanes of a batch take entities that are [`APART`] from each other. Neighbours share nodes, and of
/// the sums of a batch on one node each waits for the one before: with neighbours as lanes forces took a sixth longer. Farther apart,
/// batches of an adaptive body would seldom be linear as a whole.
fn row(entity: usize, count: usize, lanes: usize) -> usize {
    let start = entity - entity % (APART * lanes);
    let batches = APART.min((count - start) / lanes);
    let place = entity - start;
    if place < batches * lanes { start + place % batches * lanes + place / batches } else { entity }
}

#[inline(always)]
fn load_columns<T: Scalar, S: Simd>(part: Part<S>, block: &[T], columns: usize) -> [T::Lanes<S>; MAX_COLUMNS] {
    let mut c = [T::Lanes::<S>::splat(part.simd, T::ZERO); MAX_COLUMNS];
    for column in 0..columns {
        c[column] = T::Lanes::<S>::load(part, &block[column * T::LANES..]);
    }
    c
}

#[inline(always)]
fn gather_corners<T: Scalar, S: Simd, const NODES: usize>(
    part: Part<S>,
    nodal: &[[T; 4]],
    nodes: &[u32],
) -> [Corner<T::Lanes<S>>; NODES] {
    let zero = T::Lanes::<S>::splat(part.simd, T::ZERO);
    let mut corners = [Corner { u: Vec3::splat(zero), weight: zero }; NODES];
    for node in 0..NODES {
        let at = part.of::<T, T::Lanes<S>, _>(&nodes[node * T::LANES..(node + 1) * T::LANES]);
        let [x, y, z, weight] = T::Lanes::<S>::gather(part.simd, nodal, at);
        corners[node] = Corner { u: Vec3::new(x, y, z), weight };
    }
    corners
}

/// Derivative of the forces at `at` along the displacements `along`.
#[inline(always)]
fn forces_along<R: Real, E: Entity<NODES>, const NODES: usize>(
    c: &[R; MAX_COLUMNS],
    at: &[Corner<R>; NODES],
    along: &[Corner<R>; NODES],
) -> [Vec3<R>; NODES] {
    let corners = dual_corners(at, along);
    let mut constants = [Dual::constant(c[0]); MAX_COLUMNS];
    for column in 0..E::COLUMNS {
        constants[column] = Dual::constant(c[column]);
    }
    let mut forces = E::linear(c, along).unwrap_or([Vec3::splat(c[0].zero_like()); NODES]);
    if let Some(nonlinear) = E::nonlinear(&constants, &corners) {
        for node in 0..NODES {
            let [x, y, z] = nonlinear[node].to_array().map(|component| component.derivative);
            forces[node] = Vec3::new(x, y, z).mul_add(at[node].weight, forces[node]);
        }
    }
    forces
}

#[inline(always)]
fn dual_corners<R: Real, const NODES: usize>(
    at: &[Corner<R>; NODES],
    along: &[Corner<R>; NODES],
) -> [Corner<Dual<R>>; NODES] {
    let zero = Dual::constant(at[0].weight.zero_like());
    let mut corners = [Corner { u: Vec3::splat(zero), weight: zero }; NODES];
    for node in 0..NODES {
        let (u, du) = (at[node].u, along[node].u);
        corners[node] = Corner {
            u: Vec3::new(Dual::new(u.x, du.x), Dual::new(u.y, du.y), Dual::new(u.z, du.z)),
            weight: Dual::constant(at[node].weight),
        };
    }
    corners
}

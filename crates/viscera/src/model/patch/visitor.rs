//! What loops do along the fans of a patch: add up forces or blocks, keep numbers, look for the largest.

use super::element::{Deformed, Diagonal, Element, Measure, Measured, Record, Shared};
use super::fan::LONGEST;
use super::{PATCH_NODES, PatchPairs, PatchRows};
use crate::math::{Lanes, Mat3, Part, Real, Scalar, Simd, Sym3, Vec3, prefetch};
use crate::model::lane_vector::{self, Kept, take_up};

/// Whoever is led along the fans, a batch at a time.
pub(super) trait Visitor<T: Scalar, S: Simd, const FIELDS: usize> {
    /// Whether it asks for what tetrahedra share.
    const IS_SHARING: bool = false;
    /// The tetrahedra of a slot, in this `place` of their fans.
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        place: usize,
        edges: &[Mat3<T::Lanes<S>>; FIELDS],
        shared: &Shared<T::Lanes<S>>,
    );
    /// All tetrahedra of the batch have been visited.
    #[inline(always)]
    fn end(&mut self, _part: Part<S>, _nodes: &BatchNodes<'_>) {}
}

/// Nodes of a batch of fans, for all lanes each.
pub(super) struct BatchNodes<'a> {
    /// Where the axis begins.
    pub(super) origin: &'a [u32],
    /// Where it ends.
    pub(super) end: &'a [u32],
    /// Corner 2 of the tetrahedra, place by place.
    pub(super) ring: &'a [u32],
    /// Corner 3 of the last.
    pub(super) last: &'a [u32],
    /// Whether that is the first of the ring.
    pub(super) is_closed: bool,
    /// How many lanes have fans of their own.
    pub(super) fans: usize,
    /// Whether the halves share no node.
    pub(super) is_apart: bool,
}

impl BatchNodes<'_> {
    /// Whether a part is added up at once: where it is a half, or its halves share no node.
    #[inline(always)]
    fn adds_up_at_once<T: Scalar, S: Simd>(&self) -> bool {
        T::Lanes::<S>::COUNT == T::Half::<S>::COUNT || self.is_apart
    }

    /// The halves of a part that have fans of their own.
    #[inline(always)]
    fn halves<T: Scalar, S: Simd>(&self, part: Part<S>) -> impl Iterator<Item = Part<S>> {
        part.halves::<T>().take_while(|half| half.start::<T, T::Half<S>>() < self.fans)
    }
}

/// How many slots a loop looks ahead: with four, a million tetrahedra take a sixth longer.
const AHEAD: usize = 12;

/// Adds up forces: those on the axis over the whole fan, those on a node of the ring over the two cells that share it.
pub(super) struct Scatter<'a, T: Scalar, E> {
    pub(super) element: &'a E,
    pub(super) sums: &'a mut PatchRows<T>,
    /// The forces of a batch.
    pub(super) forces: KeptVectors<T, 3>,
}

impl<T: Scalar, S: Simd, E: Element<T, FIELDS>, const FIELDS: usize> Visitor<T, S, FIELDS> for Scatter<'_, T, E> {
    const IS_SHARING: bool = E::IS_SHARING;

    #[inline(always)]
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        place: usize,
        edges: &[Mat3<T::Lanes<S>>; FIELDS],
        shared: &Shared<T::Lanes<S>>,
    ) {
        if part.is_first() {
            self.element.prefetch(slot + AHEAD);
        }
        keep::<T, S>(part.simd, self.element.forces_in_fan(part, slot, edges, shared), &mut self.forces[place]);
    }

    #[inline(always)]
    fn end(&mut self, part: Part<S>, nodes: &BatchNodes<'_>) {
        add_up_batch(&self.forces, part, nodes, self.sums);
    }
}

/// The same, and looks for the largest of what is measured on the way.
pub(super) struct ScatterAndMeasure<'a, T: Scalar, S: Simd, E> {
    pub(super) element: &'a E,
    pub(super) sums: &'a mut PatchRows<T>,
    /// The tetrahedra of a batch: its first slot, and how many there are.
    pub(super) batch: (usize, usize),
    pub(super) invariants: [[T::Lanes<S>; 3]; LONGEST],
    pub(super) forces: KeptVectors<T, 3>,
    pub(super) largest: T::Lanes<S>,
}

impl<T: Scalar, S: Simd, E: Measured<T>> Visitor<T, S, 1> for ScatterAndMeasure<'_, T, S, E> {
    const IS_SHARING: bool = E::IS_SHARING;

    #[inline(always)]
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        place: usize,
        edges: &[Mat3<T::Lanes<S>>; 1],
        shared: &Shared<T::Lanes<S>>,
    ) {
        if part.is_first() {
            self.element.prefetch(slot + AHEAD);
        }
        self.batch = (slot - place, place + 1);
        let (forces, invariants) = self.element.forces_and_invariants(part, slot, &edges[0], shared);
        self.invariants[place] = invariants;
        keep::<T, S>(part.simd, forces, &mut self.forces[place]);
    }

    #[inline(always)]
    fn end(&mut self, part: Part<S>, nodes: &BatchNodes<'_>) {
        let (slot, length) = self.batch;
        let mut largest = self.largest;
        for (number, invariants) in self.invariants[..length].iter().enumerate() {
            largest = largest.max(self.element.measure(part, slot + number, invariants));
        }
        self.largest = largest;
        add_up_batch(&self.forces, part, nodes, self.sums);
    }
}

/// Vectors of the tetrahedra of a batch, on their way to be added up.
pub(super) type KeptVectors<T, const VECTORS: usize> = [[Kept<T>; VECTORS]; LONGEST];

#[inline(always)]
fn keep<T: Scalar, S: Simd>(simd: S, forces: Mat3<T::Lanes<S>>, kept: &mut [Kept<T>; 3]) {
    for corner in 0..3 {
        lane_vector::keep(simd, forces.columns[corner], &mut kept[corner]);
    }
}

/// Adds up the forces of a batch: at once where its halves share no node, half by half otherwise; so sums are the same on every processor.
#[inline(always)]
fn add_up_batch<T: Scalar, S: Simd>(
    forces: &KeptVectors<T, 3>,
    part: Part<S>,
    nodes: &BatchNodes<'_>,
    sums: &mut PatchRows<T>,
) {
    if nodes.adds_up_at_once::<T, S>() {
        add_up::<T, S, T::Lanes<S>>(forces, part, nodes, sums);
    } else {
        for half in nodes.halves::<T, S>(part) {
            add_up::<T, S, T::Half<S>>(forces, half, nodes, sums);
        }
    }
}

#[inline(always)]
fn forces_of<T: Scalar, S: Simd, R: Lanes<T, S>>(part: Part<S>, kept: &[Kept<T>; 3]) -> [Vec3<R>; 3] {
    [take_up(part, &kept[0]), take_up(part, &kept[1]), take_up(part, &kept[2])]
}

/// Adds up the forces of a batch, or of half of one.
#[inline(always)]
fn add_up<T: Scalar, S: Simd, R: Lanes<T, S>>(
    forces: &KeptVectors<T, 3>,
    part: Part<S>,
    nodes: &BatchNodes<'_>,
    sums: &mut PatchRows<T>,
) {
    // `ring` sums up the forces on the ring: what is left to make them all zero acts on the origin. `carried` is what the last tetrahedron
    // exerts on the node that it shares with the next, and `kept` waits where the ring will close.
    let [mut end, kept, mut carried]: [Vec3<R>; 3] = forces_of(part, &forces[0]);
    let mut ring = kept;
    if !nodes.is_closed {
        add(part, kept, &nodes.ring[..T::LANES], sums);
    }
    for (forces, from) in forces[1..].iter().zip(nodes.ring[T::LANES..].chunks_exact(T::LANES)) {
        let [on_end, on_ring, next] = forces_of(part, forces);
        let on_ring = carried + on_ring;
        end += on_end;
        ring += on_ring;
        carried = next;
        add(part, on_ring, from, sums);
    }
    add(part, if nodes.is_closed { kept + carried } else { carried }, nodes.last, sums);
    add(part, end, nodes.end, sums);
    add(part, -(ring + carried + end), nodes.origin, sums);
}

/// Writes rows, slot by slot, and adds up forces.
pub(super) struct Keep<'a, T: Scalar, S: Simd, R> {
    pub(super) record: &'a R,
    pub(super) values: &'a mut [T],
    /// The slot that `values` begin with, and how many there are of each.
    pub(super) first: usize,
    pub(super) block: usize,
    pub(super) sums: &'a mut PatchRows<T>,
    /// The tetrahedra of a batch: its first slot, and how many there are.
    pub(super) batch: (usize, usize),
    pub(super) places: [Deformed<T::Lanes<S>>; LONGEST],
    pub(super) forces: KeptVectors<T, 3>,
}

impl<T: Scalar, S: Simd, R: Record<T>> Keep<'_, T, S, R> {
    /// What is read of a slot, and what will be written: a line is fetched before a part of it is overwritten.
    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.record.prefetch(slot);
        let start = (slot - self.first) * self.block;
        if let Some(block) = self.values.get(start..start + self.block) {
            prefetch(block);
        }
    }
}

impl<T: Scalar, S: Simd, R: Record<T>> Visitor<T, S, 1> for Keep<'_, T, S, R> {
    #[inline(always)]
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        place: usize,
        edges: &[Mat3<T::Lanes<S>>; 1],
        _shared: &Shared<T::Lanes<S>>,
    ) {
        if part.is_first() {
            self.prefetch(slot + AHEAD);
        }
        self.batch = (slot - place, place + 1);
        self.places[place].edges = edges[0];
        self.places[place].f = self.record.deformation(part, slot, &edges[0]);
    }

    #[inline(always)]
    fn end(&mut self, part: Part<S>, nodes: &BatchNodes<'_>) {
        let (slot, length) = self.batch;
        for place in &mut self.places[..length] {
            place.r = self.record.rotation::<S>(&place.f);
        }
        let values = self.values[(slot - self.first) * self.block..].chunks_exact_mut(self.block);
        for (number, (place, values)) in self.places[..length].iter().zip(values).enumerate() {
            keep::<T, S>(part.simd, self.record.record(part, slot + number, place, values), &mut self.forces[number]);
        }
        add_up_batch(&self.forces, part, nodes, self.sums);
    }
}

/// Adds up blocks as [`Scatter`] does forces, but that those of the origin do not follow from the others.
pub(super) struct ScatterBlocks<'a, T: Scalar, E> {
    pub(super) element: &'a E,
    pub(super) sums: &'a mut PatchPairs<T>,
    /// The blocks of a batch, two vectors each.
    pub(super) blocks: KeptVectors<T, 8>,
}

impl<T: Scalar, S: Simd, E: Diagonal<T>> Visitor<T, S, 1> for ScatterBlocks<'_, T, E> {
    #[inline(always)]
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        place: usize,
        edges: &[Mat3<T::Lanes<S>>; 1],
        _shared: &Shared<T::Lanes<S>>,
    ) {
        if part.is_first() {
            self.element.prefetch(slot + AHEAD);
        }
        let blocks = self.element.blocks(part, slot, &edges[0]);
        let kept = &mut self.blocks[place];
        for corner in 0..4 {
            let Sym3 { xx, yy, zz, xy, xz, yz } = blocks[corner];
            lane_vector::keep(part.simd, Vec3::new(xx, yy, zz), &mut kept[2 * corner]);
            lane_vector::keep(part.simd, Vec3::new(xy, xz, yz), &mut kept[2 * corner + 1]);
        }
    }

    #[inline(always)]
    fn end(&mut self, part: Part<S>, nodes: &BatchNodes<'_>) {
        if nodes.adds_up_at_once::<T, S>() {
            add_up_blocks::<T, S, T::Lanes<S>>(&self.blocks, part, nodes, self.sums);
        } else {
            for half in nodes.halves::<T, S>(part) {
                add_up_blocks::<T, S, T::Half<S>>(&self.blocks, half, nodes, self.sums);
            }
        }
    }
}

/// Adds up the blocks of a batch, or of half of one.
#[inline(always)]
fn add_up_blocks<T: Scalar, S: Simd, R: Lanes<T, S>>(
    blocks: &KeptVectors<T, 8>,
    part: Part<S>,
    nodes: &BatchNodes<'_>,
    sums: &mut PatchPairs<T>,
) {
    let [mut origin, mut end, kept, mut carried]: [LaneBlock<R>; 4] = LaneBlock::of_all(part, &blocks[0]);
    if !nodes.is_closed {
        kept.add(part, &nodes.ring[..T::LANES], sums);
    }
    for (blocks, from) in blocks[1..].iter().zip(nodes.ring[T::LANES..].chunks_exact(T::LANES)) {
        let [on_origin, on_end, on_ring, next] = LaneBlock::of_all(part, blocks);
        origin = origin.plus(on_origin);
        end = end.plus(on_end);
        carried.plus(on_ring).add(part, from, sums);
        carried = next;
    }
    let last = if nodes.is_closed { kept.plus(carried) } else { carried };
    last.add(part, nodes.last, sums);
    end.add(part, nodes.end, sums);
    origin.add(part, nodes.origin, sums);
}

/// A block in each lane: xx, yy, zz, then xy, xz, yz.
#[derive(Clone, Copy)]
struct LaneBlock<R>([Vec3<R>; 2]);

impl<R: Real> LaneBlock<R> {
    /// Those of the four corners.
    #[inline(always)]
    fn of_all<T: Scalar, S: Simd>(part: Part<S>, kept: &[Kept<T>; 8]) -> [Self; 4]
    where
        R: Lanes<T, S>,
    {
        [Self::of(part, kept, 0), Self::of(part, kept, 1), Self::of(part, kept, 2), Self::of(part, kept, 3)]
    }

    #[inline(always)]
    fn of<T: Scalar, S: Simd>(part: Part<S>, kept: &[Kept<T>; 8], corner: usize) -> Self
    where
        R: Lanes<T, S>,
    {
        Self([take_up(part, &kept[2 * corner]), take_up(part, &kept[2 * corner + 1])])
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }

    #[inline(always)]
    fn add<T: Scalar, S: Simd>(self, part: Part<S>, nodes: &[u32], sums: &mut PatchPairs<T>)
    where
        R: Lanes<T, S>,
    {
        let (starts, [first, second]) = (starts::<T, S, R>(part, nodes), self.0.map(Vec3::to_array));
        let rows = sums.as_flattened_mut();
        R::scatter_add_from(
            first,
            #[inline(always)]
            |lane| 2 * starts(lane),
            rows,
        );
        R::scatter_add_from(
            second,
            #[inline(always)]
            |lane| 2 * starts(lane) + 4,
            rows,
        );
    }
}

/// Keeps the largest number.
pub(super) struct Largest<'a, M, V> {
    pub(super) measure: &'a M,
    pub(super) value: V,
}

impl<T: Scalar, S: Simd, M: Measure<T>> Visitor<T, S, 1> for Largest<'_, M, T::Lanes<S>> {
    #[inline(always)]
    fn tetrahedron(
        &mut self,
        part: Part<S>,
        slot: usize,
        _place: usize,
        edges: &[Mat3<T::Lanes<S>>; 1],
        _shared: &Shared<T::Lanes<S>>,
    ) {
        self.value = self.value.max(self.measure.measure(part, slot, &edges[0]));
    }
}

/// Where the rows of the nodes of all lanes begin, modulo the size of a patch: the compiler sees that they are good.
#[inline(always)]
pub(super) fn starts<T: Scalar, S: Simd, L: Lanes<T, S>>(
    part: Part<S>,
    nodes: &[u32],
) -> impl Fn(usize) -> usize + Copy {
    let nodes = part.of::<T, L, _>(nodes);
    #[inline(always)]
    move |lane| nodes[lane] as usize % (4 * PATCH_NODES) / 4 * 4
}

#[inline(always)]
fn add<T: Scalar, S: Simd, R: Lanes<T, S>>(part: Part<S>, force: Vec3<R>, nodes: &[u32], sums: &mut PatchRows<T>) {
    R::scatter_add_from(force.to_array(), starts::<T, S, R>(part, nodes), sums.as_flattened_mut());
}

//! What loops do along the fans of a patch: add up forces or blocks, keep numbers, look for the largest.

use fearless_simd::Simd;

use super::element::{Deformed, Diagonal, Element, Measure, Record};
use super::fan::LONGEST;
use super::{PATCH_NODES, PatchRows};
use crate::math::{Lanes, MAX_LANES, Mat3, Real, Scalar, Sym3, Vec3};

/// Whoever is led along the fans, a batch at a time.
pub(super) trait Visitor<T: Scalar, S: Simd, const FIELDS: usize> {
    /// The tetrahedra of a slot, in this `place` of their fans.
    fn tetrahedron(&mut self, simd: S, slot: usize, place: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS]);
    /// All tetrahedra of the batch have been visited.
    #[inline(always)]
    fn end(&mut self, _nodes: &BatchNodes<'_>) {}
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
}

/// How many slots a loop looks ahead.
const AHEAD: usize = 4;

/// Who knows the forces of the tetrahedra of a slot.
pub(super) trait Forces<T: Scalar, S: Simd, const FIELDS: usize> {
    /// Those on the corners 1, 2, 3.
    fn forces(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS]) -> Mat3<T::Lanes<S>>;
}

impl<T: Scalar, S: Simd, E: Element<T, FIELDS>, const FIELDS: usize> Forces<T, S, FIELDS> for &E {
    #[inline(always)]
    fn forces(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS]) -> Mat3<T::Lanes<S>> {
        self.prefetch(slot + AHEAD);
        (**self).forces(simd, slot, edges)
    }
}

/// Forces of an element, and the largest of what is measured of it.
pub(super) struct Measuring<'a, E, M, V> {
    pub(super) element: &'a E,
    pub(super) measure: &'a M,
    pub(super) largest: V,
}

impl<T: Scalar, S: Simd, E: Element<T, 1>, M: Measure<T>> Forces<T, S, 1> for &mut Measuring<'_, E, M, T::Lanes<S>> {
    #[inline(always)]
    fn forces(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        self.largest = self.largest.max(self.measure.measure(simd, slot, &edges[0]));
        self.element.forces(simd, slot, edges)
    }
}

/// Adds up forces: those on the axis over the whole fan, those on a node of the ring over the two cells that share it.
pub(super) struct Scatter<'a, T: Scalar, S: Simd, F> {
    pub(super) element: F,
    pub(super) sums: &'a mut PatchRows<T>,
    /// The forces of a batch.
    pub(super) forces: [Mat3<T::Lanes<S>>; LONGEST],
}

impl<T: Scalar, S: Simd, F: Forces<T, S, FIELDS>, const FIELDS: usize> Visitor<T, S, FIELDS> for Scatter<'_, T, S, F> {
    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, place: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS]) {
        self.forces[place] = self.element.forces(simd, slot, edges);
    }

    #[inline(always)]
    fn end(&mut self, nodes: &BatchNodes<'_>) {
        add_up(&self.forces, nodes, self.sums);
    }
}

/// Adds up the forces of a batch.
#[inline(always)]
fn add_up<T: Scalar, S: Simd, L: Lanes<T, S>>(
    forces: &[Mat3<L>; LONGEST],
    nodes: &BatchNodes<'_>,
    sums: &mut PatchRows<T>,
) {
    // `ring` sums up the forces on the ring: what is left to make them all zero acts on the origin. `carried` is what the last tetrahedron
    // exerts on the node that it shares with the next, and `kept` waits where the ring will close.
    let [mut end, kept, mut carried] = forces[0].columns;
    let mut ring = kept;
    if !nodes.is_closed {
        add(kept, &nodes.ring[..T::LANES], sums);
    }
    for (forces, from) in forces.iter().zip(nodes.ring.chunks_exact(T::LANES)).skip(1) {
        let [on_end, on_ring, next] = forces.columns;
        let on_ring = carried + on_ring;
        end += on_end;
        ring += on_ring;
        carried = next;
        add(on_ring, from, sums);
    }
    add(if nodes.is_closed { kept + carried } else { carried }, nodes.last, sums);
    add(end, nodes.end, sums);
    add(-(ring + carried + end), nodes.origin, sums);
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
    pub(super) simd: S,
}

impl<T: Scalar, S: Simd, R: Record<T>> Visitor<T, S, 1> for Keep<'_, T, S, R> {
    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, place: usize, edges: &[Mat3<T::Lanes<S>>; 1]) {
        self.batch = (slot - place, place + 1);
        self.places[place].edges = edges[0];
        self.places[place].f = self.record.deformation(simd, slot, &edges[0]);
    }

    #[inline(always)]
    fn end(&mut self, nodes: &BatchNodes<'_>) {
        let (slot, length) = self.batch;
        for place in &mut self.places[..length] {
            place.r = self.record.rotation::<S>(&place.f);
        }
        let mut forces = [self.places[0].edges; LONGEST];
        let values = self.values[(slot - self.first) * self.block..].chunks_exact_mut(self.block);
        for (number, ((forces, place), values)) in forces.iter_mut().zip(&self.places[..length]).zip(values).enumerate()
        {
            *forces = self.record.record(self.simd, slot + number, place, values);
        }
        add_up(&forces, nodes, self.sums);
    }
}

/// Adds up blocks as [`Scatter`] does forces, but that those of the origin do not follow from the others.
pub(super) struct ScatterBlocks<'a, T: Scalar, S: Simd, E> {
    pub(super) element: &'a E,
    pub(super) sums: &'a mut [PatchRows<T>; 2],
    /// The blocks of a batch.
    pub(super) blocks: [[Sym3<T::Lanes<S>>; 4]; LONGEST],
}

impl<T: Scalar, S: Simd, E: Diagonal<T>> Visitor<T, S, 1> for ScatterBlocks<'_, T, S, E> {
    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, place: usize, edges: &[Mat3<T::Lanes<S>>; 1]) {
        self.blocks[place] = self.element.blocks(simd, slot, &edges[0]);
    }

    #[inline(always)]
    fn end(&mut self, nodes: &BatchNodes<'_>) {
        let [mut origin, mut end, kept, mut carried] = self.blocks[0];
        if !nodes.is_closed {
            add_block(kept, &nodes.ring[..T::LANES], self.sums);
        }
        for (blocks, from) in self.blocks.iter().zip(nodes.ring.chunks_exact(T::LANES)).skip(1) {
            let [on_origin, on_end, on_ring, next] = *blocks;
            origin = origin + on_origin;
            end = end + on_end;
            add_block(carried + on_ring, from, self.sums);
            carried = next;
        }
        add_block(if nodes.is_closed { kept + carried } else { carried }, nodes.last, self.sums);
        add_block(end, nodes.end, self.sums);
        add_block(origin, nodes.origin, self.sums);
    }
}

#[inline(always)]
fn add_block<T: Scalar, S: Simd, L: Lanes<T, S>>(block: Sym3<L>, nodes: &[u32], sums: &mut [PatchRows<T>; 2]) {
    add(Vec3::new(block.xx, block.yy, block.zz), nodes, &mut sums[0]);
    add(Vec3::new(block.xy, block.xz, block.yz), nodes, &mut sums[1]);
}

/// Keeps the largest number.
pub(super) struct Largest<'a, M, V> {
    pub(super) measure: &'a M,
    pub(super) value: V,
}

impl<T: Scalar, S: Simd, M: Measure<T>> Visitor<T, S, 1> for Largest<'_, M, T::Lanes<S>> {
    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, _place: usize, edges: &[Mat3<T::Lanes<S>>; 1]) {
        self.value = self.value.max(self.measure.measure(simd, slot, &edges[0]));
    }
}

/// Numbers of the nodes of all lanes, modulo the size of a patch: the compiler sees that they are good.
#[inline(always)]
pub(super) fn indices(nodes: &[u32], lanes: usize) -> [u32; MAX_LANES] {
    let mut indices = [0; MAX_LANES];
    for lane in 0..lanes {
        indices[lane] = nodes[lane] % PATCH_NODES as u32;
    }
    indices
}

#[inline(always)]
fn add<T: Scalar, S: Simd, L: Lanes<T, S>>(force: Vec3<L>, nodes: &[u32], sums: &mut PatchRows<T>) {
    let indices = indices(nodes, T::LANES);
    L::scatter_add(force.to_array(), &indices[..T::LANES], sums);
}

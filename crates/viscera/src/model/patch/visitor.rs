//! What loops do along the fans of a patch: add up forces or blocks, keep numbers, look for the largest.

use fearless_simd::Simd;

use super::element::{Diagonal, Element, Measure, Record};
use super::{PATCH_NODES, PatchRows};
use crate::math::{Lanes, MAX_LANES, Mat3, Real, Scalar, Sym3, Vec3};

/// Whoever is led along the fans.
pub(super) trait Visitor<T: Scalar, S: Simd, const FIELDS: usize> {
    /// A batch of fans begins.
    #[inline(always)]
    fn begin(&mut self) {}
    /// The tetrahedra of a slot; corner 2 are the nodes `from` of the ring, none at the node where the ring will close.
    fn tetrahedron(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS], from: Option<&[u32]>);
    /// The batch has ended: nodes of its axis, and those where the ring ends or has closed.
    #[inline(always)]
    fn end(&mut self, _origin: &[u32], _end: &[u32], _last: &[u32]) {}
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

/// Writes rows, slot by slot.
pub(super) struct Keep<'a, T, R> {
    pub(super) record: &'a R,
    pub(super) values: &'a mut [T],
    pub(super) first: usize,
    pub(super) block: usize,
}

impl<T: Scalar, S: Simd, R: Record<T>> Forces<T, S, 1> for Keep<'_, T, R> {
    #[inline(always)]
    fn forces(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1]) -> Mat3<T::Lanes<S>> {
        let start = (slot - self.first) * self.block;
        self.record.record(simd, slot, &edges[0], &mut self.values[start..start + self.block])
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
    pub(super) simd: S,
    pub(super) element: F,
    pub(super) sums: &'a mut PatchRows<T>,
    /// Force on the end of the axis.
    pub(super) end: Vec3<T::Lanes<S>>,
    /// Sum of the forces on the ring: what is left to make them all zero acts on the origin.
    pub(super) ring: Vec3<T::Lanes<S>>,
    /// What the last tetrahedron exerts on the node of the ring that it shares with the next.
    pub(super) carried: Vec3<T::Lanes<S>>,
    /// The force on the node where the ring will close.
    pub(super) kept: Vec3<T::Lanes<S>>,
}

impl<T: Scalar, S: Simd, F: Forces<T, S, FIELDS>, const FIELDS: usize> Visitor<T, S, FIELDS> for Scatter<'_, T, S, F> {
    #[inline(always)]
    fn begin(&mut self) {
        let zero = Vec3::splat(T::Lanes::<S>::splat(self.simd, T::ZERO));
        (self.end, self.ring, self.carried, self.kept) = (zero, zero, zero, zero);
    }

    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS], from: Option<&[u32]>) {
        let [end, ring, next] = self.element.forces(simd, slot, edges).columns;
        let ring = self.carried + ring;
        self.end += end;
        self.ring += ring;
        self.carried = next;
        match from {
            Some(from) => add(ring, from, self.sums),
            None => self.kept = ring,
        }
    }

    #[inline(always)]
    fn end(&mut self, origin: &[u32], end: &[u32], last: &[u32]) {
        add(self.kept + self.carried, last, self.sums);
        add(self.end, end, self.sums);
        add(-(self.ring + self.carried + self.end), origin, self.sums);
    }
}

/// Adds up blocks as [`Scatter`] does forces, but that those of the origin do not follow from the others.
pub(super) struct ScatterBlocks<'a, T: Scalar, S: Simd, E> {
    pub(super) simd: S,
    pub(super) element: &'a E,
    pub(super) sums: &'a mut [PatchRows<T>; 2],
    pub(super) origin: Sym3<T::Lanes<S>>,
    pub(super) end: Sym3<T::Lanes<S>>,
    pub(super) carried: Sym3<T::Lanes<S>>,
    pub(super) kept: Sym3<T::Lanes<S>>,
}

impl<T: Scalar, S: Simd, E: Diagonal<T>> Visitor<T, S, 1> for ScatterBlocks<'_, T, S, E> {
    #[inline(always)]
    fn begin(&mut self) {
        let zero = Sym3::diagonal(T::Lanes::<S>::splat(self.simd, T::ZERO));
        (self.origin, self.end, self.carried, self.kept) = (zero, zero, zero, zero);
    }

    #[inline(always)]
    fn tetrahedron(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1], from: Option<&[u32]>) {
        let [origin, end, ring, next] = self.element.blocks(simd, slot, &edges[0]);
        self.origin = self.origin + origin;
        self.end = self.end + end;
        match from {
            Some(from) => add_block(self.carried + ring, from, self.sums),
            None => self.kept = ring,
        }
        self.carried = next;
    }

    #[inline(always)]
    fn end(&mut self, origin: &[u32], end: &[u32], last: &[u32]) {
        add_block(self.kept + self.carried, last, self.sums);
        add_block(self.end, end, self.sums);
        add_block(self.origin, origin, self.sums);
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
    fn tetrahedron(&mut self, simd: S, slot: usize, edges: &[Mat3<T::Lanes<S>>; 1], _from: Option<&[u32]>) {
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

//! What loops over tetrahedra ask of those who know them, slot by slot.

use crate::math::{Mat3, Part, Real, Scalar, Simd, Sym3, Vec3};

/// What a loop makes of tetrahedra at which the lanes are, as a function of their edges in some nodal arrays.
pub(crate) trait Element<T: Scalar, const FIELDS: usize>: Sync {
    /// Whether it is worth compiling for each instruction set.
    const IS_WIDE: bool = true;
    /// Asks for the numbers of a slot that the loop will come to, if there is one.
    fn prefetch(&self, _slot: usize) {}
    /// Forces on the corners 1, 2, 3 of the tetrahedra of a slot; that on corner 0 is minus their sum.
    fn forces<S: Simd>(&self, part: Part<S>, slot: usize, edges: &[Mat3<T::Lanes<S>>; FIELDS]) -> Mat3<T::Lanes<S>>;
    /// Whether [`Element::forces_in_fan`] makes use of what tetrahedra share.
    const IS_SHARING: bool = false;
    /// The same with what the tetrahedra of a fan share, in the first of the arrays.
    #[inline(always)]
    fn forces_in_fan<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        edges: &[Mat3<T::Lanes<S>>; FIELDS],
        _shared: &Shared<T::Lanes<S>>,
    ) -> Mat3<T::Lanes<S>> {
        self.forces(part, slot, edges)
    }
}

/// What the tetrahedra of a fan share: with the edges x (the axis), y and z of one, x is that of all, and z is y of the next.
#[derive(Clone, Copy)]
pub(crate) struct Shared<R> {
    /// |x|².
    pub(crate) axis_square: R,
    /// x × y.
    pub(crate) from: Vec3<R>,
    /// x × z.
    pub(crate) to: Vec3<R>,
}

impl<R: Real> Shared<R> {
    /// That of the edges of one tetrahedron.
    #[inline(always)]
    pub(crate) fn of(edges: &Mat3<R>) -> Self {
        let [x, y, z] = edges.columns;
        Self { axis_square: x.squared_norm(), from: x.cross(y), to: x.cross(z) }
    }
}

/// Blocks on the diagonal of a stiffness, as a function of the edges.
pub(crate) trait Diagonal<T: Scalar>: Sync {
    /// Whether blocks depend on the edges.
    const IS_OF_EDGES: bool = true;
    /// Whether it is worth compiling for each instruction set.
    const IS_WIDE: bool = true;
    /// As [`Element::prefetch`].
    fn prefetch(&self, _slot: usize) {}
    /// The blocks of the four corners of the tetrahedra of a slot.
    fn blocks<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> [Sym3<T::Lanes<S>>; 4];
}

/// What a loop keeps of tetrahedra, as a function of their edges, and what it finds of their forces on the way.
///
/// It is asked in three steps, each of all tetrahedra of a batch before the next: one after the other, a tetrahedron is a chain of operations that wait
/// for one another, longer than processors look ahead.
pub(crate) trait Record<T: Scalar>: Sync {
    /// How many numbers it keeps of each.
    fn columns(&self) -> usize;
    /// As [`Element::prefetch`].
    fn prefetch(&self, slot: usize);
    /// The deformation gradients F of the tetrahedra of a slot.
    fn deformation<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> Mat3<T::Lanes<S>>;
    /// Their rotations R.
    fn rotation<S: Simd>(&self, f: &Mat3<T::Lanes<S>>) -> Mat3<T::Lanes<S>>;
    /// Writes the block of rows of a slot; gives the forces on the corners 1, 2, 3.
    fn record<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        place: &Deformed<T::Lanes<S>>,
        block: &mut [T],
    ) -> Mat3<T::Lanes<S>>;
}

/// Tetrahedra that are deformed.
#[derive(Clone, Copy)]
pub(crate) struct Deformed<R> {
    /// Edges D.
    pub(crate) edges: Mat3<R>,
    /// Deformation gradients F.
    pub(crate) f: Mat3<R>,
    /// Rotations R of F.
    pub(crate) r: Mat3<R>,
}

/// Forces on the corners 1, 2, 3 of tetrahedra, and three numbers of each.
pub(crate) type ForcesAndInvariants<R> = (Mat3<R>, [R; 3]);

/// Forces of tetrahedra, and a number of each that comes from three others which are found on the way of the forces.
///
/// It is asked for the number of all tetrahedra of a batch after their forces: with a root at the end of a chain of thirty operations, processors do
/// not look far enough ahead to do anything else meanwhile.
pub(crate) trait Measured<T: Scalar>: Sync {
    /// As [`Element::IS_SHARING`].
    const IS_SHARING: bool;
    /// As [`Element::prefetch`].
    fn prefetch(&self, slot: usize);
    /// Those of the tetrahedra of a slot.
    fn forces_and_invariants<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        edges: &Mat3<T::Lanes<S>>,
        shared: &Shared<T::Lanes<S>>,
    ) -> ForcesAndInvariants<T::Lanes<S>>;
    /// The number that comes from the three.
    fn measure<S: Simd>(&self, part: Part<S>, slot: usize, invariants: &[T::Lanes<S>; 3]) -> T::Lanes<S>;
}

/// A number of tetrahedra, as a function of their edges.
pub(crate) trait Measure<T: Scalar>: Sync {
    /// The number of each tetrahedron of a slot.
    fn measure<S: Simd>(&self, part: Part<S>, slot: usize, edges: &Mat3<T::Lanes<S>>) -> T::Lanes<S>;
}

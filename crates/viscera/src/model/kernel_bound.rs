//! The bound of the highest frequency of tetrahedra whose kernel knows how stiff the law is: from the kernel's own constants, and for a third of
//! the price on the way of the forces.

use std::any::Any;
use std::marker::PhantomData;

use super::block_table::BlockTable;
use super::frequency::{FrequencyBound, squared_frequency_of_tet};
use super::patch::{ForcesAndInvariants, Measured, Shared};
use super::tet_loop::{MAX_CONSTANTS, RestTet, TetConstants, TetKernel, TetLoop, TetMeasure};
use super::{ModelError, Patches, Scratch};
use crate::material::LawFamily;
use crate::math::{Mat3, Part, Real, Scalar, Simd, Vec3};
use crate::mesh::TetMesh;

/// A kernel that knows how stiff its law is.
pub(super) trait BoundedKernel: TetKernel {
    /// How many numbers of a tetrahedron the bound needs that forces do not.
    const BOUND_CONSTANTS: usize = 0;
    /// Those numbers.
    fn bound_constants(_rest: &RestTet) -> Vec<f64> {
        Vec::new()
    }
    /// Numbers of a deformed tetrahedron that tell how stiff it is; zeros where the kernel needs fewer.
    fn invariants<R: Real>(constants: &[R], d: &Mat3<R>) -> [R; 3];
    /// The law's [`stiffness_bound`](crate::material::Law::stiffness_bound) as a function of those, times anything that does not change with them.
    fn stiffness_bound<R: Real>(constants: &[R], bound_constants: &[R], invariants: &[R; 3]) -> R;
}

/// Constants: those of the kernel, those of its bound, then ω² at rest over the kernel's bound at rest.
#[derive(Debug)]
pub(super) struct KernelBound<K>(PhantomData<K>);

impl<K> Clone for KernelBound<K> {
    fn clone(&self) -> Self {
        Self(PhantomData)
    }
}

impl<K: BoundedKernel> TetConstants for KernelBound<K> {
    const CONSTANTS: usize = K::CONSTANTS + K::BOUND_CONSTANTS + 1;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, Self::CONSTANTS - 1) = T::ZERO;
    }
}

impl<K: BoundedKernel> TetMeasure for KernelBound<K> {
    #[inline(always)]
    fn measure<R: Real>(c: &[R], d: &Mat3<R>) -> R {
        let (of_kernel, of_bound) = c.split_at(K::CONSTANTS);
        let (&factor, of_bound) = of_bound.split_last().expect("the factor is the last");
        factor * K::stiffness_bound(of_kernel, of_bound, &K::invariants(of_kernel, d))
    }
}

/// The bound for tetrahedra of the law and the constants that `of_cell` gives, and of this `density` [kg/m³].
pub(super) fn kernel_bound<T: Scalar, K: BoundedKernel, L: LawFamily>(
    mesh: &TetMesh,
    density: impl Fn(usize) -> f64,
    of_cell: impl Fn(&RestTet) -> (L, Vec<f64>),
) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
    let bound = TetLoop::<T, KernelBound<K>>::new(mesh, |rest| {
        let (law, mut constants) = of_cell(rest);
        let corner_mass = density(rest.cell) * rest.volume / 4.0;
        let at_rest = squared_frequency_of_tet(&law, rest, corner_mass);
        let invariants = K::invariants(&constants, &rest.inverse.inverse());
        let of_bound = K::bound_constants(rest);
        let factor = at_rest / K::stiffness_bound(&constants, &of_bound, &invariants);
        constants.extend(of_bound);
        constants.push(factor);
        constants
    })?;
    Ok(Box::new(bound))
}

impl<T: Scalar, K: BoundedKernel> FrequencyBound<T> for TetLoop<T, KernelBound<K>> {
    fn squared_frequency(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> f64 {
        self.largest(x, scratch).to_f64()
    }

    fn remove(&mut self, cells: &[u32]) {
        TetLoop::remove(self, cells);
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }

    fn sum_forces<'a>(&self, tets: &'a dyn Any, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<(&'a Patches, f64)> {
        let tets = tets.downcast_ref::<TetLoop<T, K>>()?;
        Some(tets.sum_forces_and_measure(x, &Along { tets, bound: self }, scratch))
    }
}

/// Forces, and the bound by their constants.
struct Along<'a, T: Scalar, K> {
    tets: &'a TetLoop<T, K>,
    bound: &'a TetLoop<T, KernelBound<K>>,
}

impl<T: Scalar, K: BoundedKernel> Measured<T> for Along<'_, T, K> {
    const IS_SHARING: bool = K::IS_SHARING;

    #[inline(always)]
    fn prefetch(&self, slot: usize) {
        self.tets.prefetch(slot);
    }

    // Of constants that are loaded once, so that the compiler finds what both have in common.
    #[inline(always)]
    fn forces_and_invariants<S: Simd>(
        &self,
        part: Part<S>,
        slot: usize,
        edges: &Mat3<T::Lanes<S>>,
        shared: &Shared<T::Lanes<S>>,
    ) -> ForcesAndInvariants<T::Lanes<S>> {
        let constants = self.tets.load(part, slot);
        let constants = &constants[..K::CONSTANTS];
        (K::forces_in_fan(constants, edges, shared), K::invariants(constants, edges))
    }

    #[inline(always)]
    fn measure<S: Simd>(&self, part: Part<S>, slot: usize, invariants: &[T::Lanes<S>; 3]) -> T::Lanes<S> {
        let constants = self.tets.load(part, slot);
        let mut of_bound = [constants[0]; MAX_CONSTANTS];
        for (number, constant) in of_bound[..=K::BOUND_CONSTANTS].iter_mut().enumerate() {
            *constant = self.bound.column(part, slot, K::CONSTANTS + number);
        }
        of_bound[K::BOUND_CONSTANTS]
            * K::stiffness_bound(&constants[..K::CONSTANTS], &of_bound[..K::BOUND_CONSTANTS], invariants)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::material::{Lame, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseStVenantKirchhoff};
    use crate::math::Vec3;
    use crate::mesh::{TetMesh, VolumeMesh};
    use crate::model::{ModelRecipe, Scratch, TotalLagrangian};

    /// The bound is that of the law at F, whether it is found alone or on the way of the forces, of tissue that is sheared, pressed and turned
    /// inside out, and after a cut.
    #[test]
    fn kernels_bound_the_frequency_as_their_laws_do() {
        let (soft, stiff) =
            (Lame::from_young_poisson(5e3, 0.45).unwrap(), Lame::from_young_poisson(40e3, 0.3).unwrap());
        let tissues = [
            Tissue::uniform(StVenantKirchhoff::new(soft)),
            Tissue::uniform(TransverseStVenantKirchhoff::new(soft, [0.6, 0.0, 0.8], stiff).unwrap()),
            Tissue::uniform(StableNeoHookean::new(soft)),
        ];
        let mesh = VolumeMesh::from(TetMesh::box_grid([9, 8, 10], [0.1, 0.1, 0.2]));
        let shear = |x: Vec3<f64>| Vec3::new(x.x + 0.4 * x.z, 1.3 * x.y, 0.8 * x.z + 2.0 * x.x * x.y);
        let press = |x: Vec3<f64>| Vec3::new(x.x, x.y, 0.1 * x.z + 0.01 * x.x);
        let mirror = |x: Vec3<f64>| Vec3::new(-x.x, x.y, x.z * (1.0 + x.x));
        let shapes: [fn(Vec3<f64>) -> Vec3<f64>; 3] = [shear, press, mirror];
        for tissue in tissues {
            let recipe = TotalLagrangian::new(tissue);
            let mut bound = recipe.bound_double(&mesh, &[1000.0], 0.0).unwrap();
            let mut of_law = recipe.clone().plain().bound_double(&mesh, &[1000.0], 0.0).unwrap();
            let mut model = recipe.build_double(&mesh).unwrap();
            for cut in [0, 100] {
                let cells: Vec<u32> = (0..cut).collect();
                bound.remove(&cells);
                of_law.remove(&cells);
                model.remove(&cells);
                for shape in shapes {
                    let x: Vec<Vec3<f64>> = mesh.nodes().iter().map(|&x| shape(x)).collect();
                    let mut scratch = Scratch::new(x.len());
                    let alone = bound.squared_frequency(&x, &mut scratch);
                    assert_relative_eq!(alone, of_law.squared_frequency(&x, &mut scratch), max_relative = 1e-9);
                    let (patches, along) = model.sum_forces_and_bound(&x, bound.as_ref(), &mut scratch).unwrap();
                    assert_relative_eq!(along, alone, max_relative = 1e-12);
                    let (mut forces, mut expected) = (vec![Vec3::ZERO; x.len()], vec![Vec3::ZERO; x.len()]);
                    scratch.write_sums(patches, &mut forces);
                    model.add_forces(&x, &mut scratch, &mut expected);
                    assert!(forces.iter().zip(&expected).all(|(&a, &b)| (a - b).norm() <= 1e-12 * b.norm().max(1.0)));
                    assert!(model.sum_forces_and_bound(&x, of_law.as_ref(), &mut scratch).is_none());
                }
            }
        }
    }
}

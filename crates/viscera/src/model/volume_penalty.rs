//! The force that keeps the volume of each tetrahedron, in its consistent form.
//!
//! δ = (V − V0)/V0,   W = κ V0 |δ|³/3,   force on node p: f_p = (κ/3) δ|δ| n_p = −∂W/∂x_p
//!
//! n_p is the outward area vector of the current face opposite to p, so that ∂V/∂x_p = −n_p/3. The square leaves no
//! stiffness at δ = 0: it damps large volume errors and does not make the tissue incompressible. As printed, the force
//! has no sign.
//!
//! Source: Picinbono, Delingette, Ayache, INRIA RR-4028 (2000), section 4, made the gradient of an energy.

use super::block_table::BlockTable;
use super::tet_loop::{TetConstants, TetKernel, TetLoop};
use super::{BlockSink, ForceModel, ModelError, Patches, Scratch};
use crate::math::{Mat3, Real, Scalar, Vec3};
use crate::mesh::TetMesh;

/// Volume penalty on every tetrahedron of a body.
#[derive(Clone, Debug)]
pub struct VolumePenalty<T: Scalar> {
    tets: TetLoop<T, VolumeKernel>,
}

impl<T: Scalar> VolumePenalty<T> {
    /// Penalty of stiffness `kappa` κ [Pa, ≥ 0] on `mesh`.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for a negative or infinite κ, [`ModelError::Mesh`] for a cell without volume.
    pub fn new(mesh: &TetMesh, kappa: f64) -> Result<Self, ModelError> {
        if !(kappa.is_finite() && kappa >= 0.0) {
            return Err(ModelError::OutOfRange { name: "keep-volume", value: kappa, range: "zero or positive [Pa]" });
        }
        Ok(Self { tets: TetLoop::new(mesh, |rest| vec![kappa * rest.volume, 1.0 / (6.0 * rest.volume)])? })
    }
}

/// Constants: κ V0 and 1/(6 V0).
#[derive(Clone, Debug)]
struct VolumeKernel;

impl VolumeKernel {
    /// δ and the gradient of 6V with respect to the three edges.
    #[inline(always)]
    fn relative_change<R: Real>(constants: &[R], d: &Mat3<R>) -> (R, Mat3<R>) {
        let gradient = d.cofactor();
        let six_volumes = d.columns[0].dot(gradient.columns[0]);
        (six_volumes.mul_add(constants[1], constants[1].like(-1.0)), gradient)
    }
}

impl TetConstants for VolumeKernel {
    const CONSTANTS: usize = 2;

    fn deactivate<T: Scalar>(constants: &mut BlockTable<T>, row: usize) {
        *constants.get_mut(row, 0) = T::ZERO;
    }
}

impl TetKernel for VolumeKernel {
    #[inline(always)]
    fn energy<R: Real>(constants: &[R], d: &Mat3<R>) -> R {
        let (delta, _) = Self::relative_change(constants, d);
        constants[0] * delta.abs() * delta.squared() * delta.like(1.0 / 3.0)
    }

    // ∂W/∂D = κ V0 δ|δ| · cof D/(6 V0)
    #[inline(always)]
    fn forces<R: Real>(constants: &[R], d: &Mat3<R>) -> Mat3<R> {
        let (delta, gradient) = Self::relative_change(constants, d);
        gradient * (constants[0] * delta * delta.abs() * constants[1])
    }

    #[inline(always)]
    fn product<R: Real>(constants: &[R], d: &Mat3<R>, dd: &Mat3<R>) -> Mat3<R> {
        let (delta, gradient) = Self::relative_change(constants, d);
        let d_delta = gradient.contract(*dd) * constants[1];
        let [a, b, c] = d.columns;
        let [da, db, dc] = dd.columns;
        let d_gradient =
            Mat3::from_columns(db.cross(c) + b.cross(dc), dc.cross(a) + c.cross(da), da.cross(b) + a.cross(db));
        let scale = constants[0] * constants[1];
        gradient * (scale * delta.abs() * d_delta).double() + d_gradient * (scale * delta * delta.abs())
    }
}

impl<T: Scalar> ForceModel<T> for VolumePenalty<T> {
    fn name(&self) -> &'static str {
        "volume-penalty"
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_forces(x, scratch, out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_product(x, dx, scratch, out);
    }

    fn add_blocks(&self, x: &[Vec3<T>], _scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.tets.add_blocks(x, sink);
    }

    fn sum_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        Some(self.tets.sum_diagonal(x, scratch))
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        self.tets.energy(x)
    }

    fn remove(&mut self, cells: &[u32]) {
        self.tets.remove(cells);
    }

    fn sum_rows(&self) -> usize {
        self.tets.sum_rows()
    }

    fn bytes(&self) -> usize {
        self.tets.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

use crate::contact::Contacts;
use crate::math::{Scalar, Vec3};
use crate::model::{ForceModel, Scratch};
use crate::solver::{BlockMatrix, LinearOperator, scale_and_add_masses};
use crate::stage::{Stage, Stages};

/// The matrix of an implicit step: masses on the diagonal, a multiple of the stiffness, and the springs of contacts.
pub(super) struct Tangent<'a, T: Scalar> {
    pub(super) models: &'a [Box<dyn ForceModel<T>>],
    pub(super) positions: &'a [Vec3<T>],
    pub(super) scratch: &'a mut Scratch<T>,
    /// K, where it is assembled.
    pub(super) assembled: Option<&'a mut BlockMatrix<T>>,
    pub(super) masses: &'a [T],
    /// Springs that the assembled matrix does not have.
    pub(super) contacts: &'a Contacts,
    pub(super) stiffness: T,
    pub(super) stages: Stages<'a>,
}

impl<T: Scalar> LinearOperator<T> for Tangent<'_, T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        match &mut self.assembled {
            Some(matrix) => self.stages.run(Stage::Products("assembled-matrix"), || matrix.apply(x, out)),
            None => {
                out.fill(Vec3::ZERO);
                for model in self.models {
                    self.stages.run(Stage::Products(model.name()), || {
                        model.add_product(self.positions, x, self.scratch, out);
                    });
                }
            }
        }
        scale_and_add_masses(&self.scratch.executor, out, self.stiffness, self.masses, x);
        if self.assembled.is_none() {
            self.contacts.add_product(x, out);
        }
    }
}

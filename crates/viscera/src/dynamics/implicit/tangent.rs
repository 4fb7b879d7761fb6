use super::memory::ImplicitMemory;
use crate::body::{ExternalStiffness, SimulatedBody};
use crate::contact::Contacts;
use crate::executor::Executor;
use crate::math::{Scalar, Vec3};
use crate::model::{ForceModel, Inertia, Scratch};
use crate::solver::{BlockMatrix, Filtered, LinearOperator, add_weighted, dot, set_weighted};
use crate::stage::{Stage, Stages};

/// The matrix of an implicit step over the factor of the stiffness: K, masses on the diagonal, and the springs of contacts.
pub(super) struct Tangent<'a, T: Scalar> {
    pub(super) models: &'a [Box<dyn ForceModel<T>>],
    pub(super) positions: &'a [Vec3<T>],
    pub(super) scratch: &'a mut Scratch<T>,
    /// K, where it is assembled.
    pub(super) assembled: Option<&'a mut BlockMatrix<T>>,
    /// Stiffness that the assembled matrix does not have.
    pub(super) external: ExternalStiffness<'a, T>,
    pub(super) masses: &'a [T],
    /// Springs that the assembled matrix does not have, and one over the factor of the stiffness.
    pub(super) contacts: (&'a Contacts, f64),
    pub(super) stages: Stages<'a>,
}

impl<'a, T: Scalar> Tangent<'a, T> {
    /// That of a body whose system is put together.
    pub(super) fn of(body: &'a mut SimulatedBody<T>, memory: &'a mut ImplicitMemory<T>, stages: Stages<'a>) -> Self {
        let (time, factor) = memory.external;
        Self {
            external: ExternalStiffness { loads: &body.loads, actuators: &body.actuators, time, factor },
            models: &body.state.models,
            positions: &body.state.positions,
            scratch: &mut body.scratch,
            assembled: memory.matrix.as_mut(),
            masses: &memory.masses,
            contacts: (&body.contacts, 1.0 / memory.stiffness.to_f64()),
            stages,
        }
    }
}

impl<T: Scalar> LinearOperator<T> for Tangent<'_, T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        let (masses, models) = (self.masses, self.models);
        if let Some(matrix) = &mut self.assembled {
            self.stages.run(Stage::Products("assembled-matrix"), || matrix.apply(x, out));
            add_weighted(&self.scratch.executor, out, masses, x);
            self.external.add_product(self.positions, x, out);
            return;
        }
        set_weighted(&self.scratch.executor, out, masses, x);
        for model in models {
            self.stages.run(Stage::Products(model.name()), || {
                model.add_product(self.positions, x, self.scratch, out);
            });
        }
        self.external.add_product(self.positions, x, out);
        let (contacts, scale) = self.contacts;
        contacts.add_product(scale, x, out);
    }

    fn apply_along(
        &mut self,
        x: &[Vec3<T>],
        filtered: &Filtered<'_, T>,
        executor: &Executor,
        out: &mut [Vec3<T>],
    ) -> f64 {
        match self.models {
            [model] if self.assembled.is_none() && self.contacts.0.is_empty() && self.external.is_empty() => {
                let inertia = Inertia { masses: self.masses, filtered: *filtered };
                self.stages.run(Stage::Products(model.name()), || {
                    model.product_with_masses(self.positions, x, &inertia, self.scratch, out)
                })
            }
            _ => {
                self.apply(x, out);
                filtered.apply(0, out);
                dot(executor, x, out)
            }
        }
    }
}

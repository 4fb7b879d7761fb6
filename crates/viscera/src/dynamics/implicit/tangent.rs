use crate::body::{Actuators, ExternalStiffness, NodalLoads, SimulatedBody};
use crate::contact::Contacts;
use crate::executor::Executor;
use crate::math::{Scalar, Vec3};
use crate::model::{ForceModel, Patches, Scratch};
use crate::solver::{BlockMatrix, LinearOperator, Turn, add_weighted, dot, set_weighted, turn_block};
use crate::stage::{Stage, Stages};

/// What an implicit step knows of its matrix, which is divided by the factor of the stiffness.
#[derive(Clone, Debug)]
pub(super) struct StepMatrix<T> {
    /// The factor of the stiffness.
    pub(super) stiffness: T,
    /// The masses' part, over that factor [kg/s²].
    pub(super) masses: Vec<T>,
    /// When actuators and fields have the stiffness that counts [s].
    pub(super) external_time: f64,
    /// How much that stiffness counts beside that of the tissue.
    pub(super) external_share: f64,
    /// K, where it is assembled.
    pub(super) assembled: Option<BlockMatrix<T>>,
    /// Whether products are those of the derivative of the forces itself; the assembled matrix and preconditioners know it not.
    pub(super) is_exact: bool,
}

impl<T: Scalar> StepMatrix<T> {
    /// The stiffness of fields and actuators.
    pub(super) fn external<'a>(
        &self,
        loads: &'a NodalLoads<T>,
        actuators: &'a Actuators<T>,
    ) -> ExternalStiffness<'a, T> {
        ExternalStiffness { loads, actuators, time: self.external_time, factor: self.external_share }
    }
}

/// The matrix of an implicit step over the factor of the stiffness: K, masses on the diagonal, and the springs of contacts.
pub(super) struct Tangent<'a, T: Scalar> {
    pub(super) models: &'a [Box<dyn ForceModel<T>>],
    pub(super) positions: &'a [Vec3<T>],
    pub(super) scratch: &'a mut Scratch<T>,
    /// K, where it is assembled.
    pub(super) assembled: Option<&'a mut BlockMatrix<T>>,
    is_exact: bool,
    /// Stiffness that the assembled matrix does not have.
    pub(super) external: ExternalStiffness<'a, T>,
    pub(super) masses: &'a [T],
    /// Springs that the assembled matrix does not have, and one over the factor of the stiffness.
    pub(super) contacts: (&'a Contacts, f64),
    pub(super) stages: Stages<'a>,
    /// Where the copies of nodes are on which a product was summed that is to be finished, and the weight of its direction.
    unfinished: Option<(&'a Patches, Option<T>)>,
}

impl<'a, T: Scalar> Tangent<'a, T> {
    /// That of a body whose system is put together.
    pub(super) fn of(body: &'a mut SimulatedBody<T>, matrix: &'a mut StepMatrix<T>, stages: Stages<'a>) -> Self {
        Self {
            external: matrix.external(&body.loads, &body.actuators),
            models: &body.state.models,
            positions: &body.state.positions,
            scratch: &mut body.scratch,
            assembled: matrix.assembled.as_mut().filter(|_| !matrix.is_exact),
            is_exact: matrix.is_exact,
            masses: &matrix.masses,
            contacts: (&body.contacts, 1.0 / matrix.stiffness.to_f64()),
            stages,
            unfinished: None,
        }
    }
}

impl<T: Scalar> Tangent<'_, T> {
    /// Whether it is that of the models and masses alone, as models have it.
    fn is_plain(&self) -> bool {
        self.assembled.is_none() && !self.is_exact && self.contacts.0.is_empty() && self.external.is_empty()
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
                if self.is_exact {
                    model.add_exact_product(self.positions, x, self.scratch, out);
                } else {
                    model.add_product(self.positions, x, self.scratch, out);
                }
            });
        }
        self.external.add_product(self.positions, x, out);
        let (contacts, scale) = self.contacts;
        contacts.add_product(scale, x, out);
    }

    fn apply_along(&mut self, mut turn: Turn<'_, T>, executor: &Executor) -> f64 {
        self.unfinished = None;
        if let ([model], true) = (self.models, self.is_plain()) {
            let sums = self.stages.run(Stage::Products(model.name()), || {
                model.sum_product(self.positions, &turn, self.masses, self.scratch)
            });
            if let Some((patches, curvature)) = sums {
                self.unfinished = Some((patches, turn.weight));
                return curvature;
            }
        }
        turn.make(executor);
        let Turn { direction, product, filtered, .. } = turn;
        self.apply(direction, product);
        filtered.apply(0, product);
        dot(executor, direction, product)
    }

    fn finish(&self, block: usize, direction: &mut [Vec3<T>], product: &mut [Vec3<T>]) {
        if let Some((patches, weight)) = self.unfinished {
            turn_block(weight, direction, product);
            self.scratch.write_sums_of_block(patches, block, product);
        }
    }
}

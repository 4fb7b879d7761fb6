use super::SimulatedBody;
use crate::math::{Scalar, Vec3};
use crate::model::{ForceModel, Patches, Scratch};
use crate::stage::{Stage, Stages};

impl<T: Scalar> SimulatedBody<T> {
    /// Brings the internal forces up to date with positions and cells.
    pub(crate) fn update_internal_forces(&mut self, stages: Stages) {
        let (state, scratch) = (&mut self.state, &mut self.scratch);
        if std::mem::replace(&mut state.forces_are_current, true) {
            return;
        }
        self.is_linearized = false;
        let out = &mut state.internal_forces;
        if let Some((model, patches)) = find_forces(&state.models, &state.positions, scratch, out, stages) {
            stages.run(Stage::Forces(model.name()), || scratch.write_sums(patches, out));
        }
    }

    /// The same, and the bound of the highest frequency where the model finds it on the way.
    pub(crate) fn update_forces_and_bound(&mut self, stages: Stages) {
        let (state, scratch) = (&mut self.state, &mut self.scratch);
        if let ([model], false) = (&state.models[..], state.forces_are_current) {
            let of_tissue = stages.run(Stage::Forces(model.name()), || {
                let (patches, bound) =
                    model.sum_forces_and_bound(&state.positions, self.frequency.as_ref(), scratch)?;
                scratch.write_sums(patches, &mut state.internal_forces);
                Some(bound)
            });
            if let Some(of_tissue) = of_tissue {
                (state.forces_are_current, self.is_linearized) = (true, false);
                self.bound_frequency(of_tissue);
            }
        }
        self.update_internal_forces(stages);
    }

    /// Brings internal forces and what products need up to date together, which is less work than one after the other. Where only
    /// the forces are current they are found again: the bits of a step must not depend on who looked at them before.
    pub(crate) fn update_forces_and_linearize(&mut self, stages: Stages) {
        if self.state.forces_are_current && self.is_linearized {
            return;
        }
        let (state, scratch) = (&mut self.state, &mut self.scratch);
        let (x, out) = (&state.positions, &mut state.internal_forces);
        let stage = |model: &dyn ForceModel<T>| {
            if model.linearization_len() > 0 { Stage::Linearisation } else { Stage::Forces(model.name()) }
        };
        let alone = if let [model] = &state.models[..] { Some(model) } else { None };
        let written = alone.and_then(|model| {
            stages.run(stage(model.as_ref()), || {
                let patches = model.linearize_and_sum_forces(x, scratch)?;
                scratch.write_sums(patches, out);
                Some(())
            })
        });
        if written.is_none() {
            out.fill(Vec3::ZERO);
            for model in &state.models {
                stages.run(stage(model.as_ref()), || model.linearize_and_add_forces(x, scratch, out));
            }
        }
        (state.forces_are_current, self.is_linearized) = (true, true);
    }

    /// Prepares the models for products at the positions, once for all of them.
    pub(crate) fn linearize(&mut self, stages: Stages) {
        if !std::mem::replace(&mut self.is_linearized, true) {
            stages.run(Stage::Linearisation, || {
                for model in &self.state.models {
                    model.linearize(&self.state.positions, &mut self.scratch);
                }
            });
        }
    }
}

/// Finds the internal forces [N] of `models` at `x` [m]. Where there is one model, and it sums on copies of the nodes, it is left to whoever
/// goes through the nodes next to write their sums to `out`; gives the model and the copies then.
pub(crate) fn find_forces<'a, T: Scalar>(
    models: &'a [Box<dyn ForceModel<T>>],
    x: &[Vec3<T>],
    scratch: &mut Scratch<T>,
    out: &mut [Vec3<T>],
    stages: Stages,
) -> Option<(&'a dyn ForceModel<T>, &'a Patches)> {
    if let [model] = models {
        let patches = stages.run(Stage::Forces(model.name()), || model.sum_forces(x, scratch));
        if let Some(patches) = patches {
            return Some((model.as_ref(), patches));
        }
    }
    out.fill(Vec3::ZERO);
    for model in models {
        stages.run(Stage::Forces(model.name()), || model.add_forces(x, scratch, out));
    }
    None
}

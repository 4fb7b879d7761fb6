use super::SimulatedBody;
use crate::material::{LawFamily, LawVisitor, Tissue};
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar};
use crate::model::ModelKind;

/// Volume ratio below which the stress of a cell is no longer spread over a smaller volume: towards 0 it would grow beyond bounds.
const LEAST_RATIO: f64 = 1e-3;

impl<T: Scalar> SimulatedBody<T> {
    /// The law and its parameters.
    pub fn tissue(&self) -> &Tissue {
        self.plan.recipe.tissue()
    }

    /// First Piola–Kirchhoff stress of a cell now [Pa]: what the law makes of [`SimulatedBody::deformation_gradient`], of a
    /// hexahedron at its centre. Where the model turns a linear law with the cell, so does this: P = R P(RᵀF). The
    /// volume-keeping force is no part of it.
    pub fn first_piola_stress(&self, cell: usize) -> Mat3<f64> {
        struct StressAt<'a>(&'a [f64], Mat3<f64>);
        impl LawVisitor for StressAt<'_> {
            type Output = Mat3<f64>;
            fn visit<L: LawFamily>(self) -> Mat3<f64> {
                L::from_values(self.0).stress(&self.1)
            }
        }
        let gradient = self.deformation_gradient(cell);
        let stress = |gradient| self.law.visit(StressAt(self.tissue().values(cell), gradient));
        if self.turns_cells() {
            let rotation = polar(&gradient);
            rotation * stress(rotation.transpose() * gradient)
        } else {
            stress(gradient)
        }
    }

    /// Von Mises stress of a cell [Pa], √(3/2 dev σ : dev σ) with σ = P Fᵀ/J as the law has it; of a linear law its one stress, which
    /// models that turn it with the cell see without the turn. The pressure of kept volume has no part in it.
    pub fn von_mises_stress(&self, cell: usize) -> f64 {
        let (gradient, stress) = (self.deformation_gradient(cell), self.first_piola_stress(cell));
        let stress = if self.law.is_objective() {
            stress * gradient.transpose() * (1.0 / gradient.determinant().abs().max(LEAST_RATIO))
        } else if self.turns_cells() {
            polar(&gradient).transpose() * stress
        } else {
            stress
        };
        let trace = stress.trace();
        (1.5 * (stress.squared_norm() - trace * trace / 3.0)).max(0.0).sqrt()
    }

    /// Whether the model takes the rotation out before it asks the law, or asks no law, and that of the turned cell is what is shown.
    fn turns_cells(&self) -> bool {
        use ModelKind::{Corotational, MassSpring, ShapeMemory, StiffnessWarping};
        matches!(self.model, Corotational | StiffnessWarping | MassSpring | ShapeMemory)
    }
}

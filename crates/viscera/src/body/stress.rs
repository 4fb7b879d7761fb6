use super::SimulatedBody;
use crate::material::{LawFamily, LawVisitor};
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar};
use crate::model::ModelKind;

/// Volume ratio below which the stress of a cell is no longer spread over a smaller volume: towards 0 it would grow beyond bounds.
const LEAST_RATIO: f64 = 1e-3;

impl<T: Scalar> SimulatedBody<T> {
    /// Von Mises stress of a cell [Pa], √(3/2 dev σ : dev σ) with σ = P Fᵀ/J as the law has it; of a linear law its one stress, which
    /// models that turn it with the cell see without the turn. The pressure of kept volume has no part in it.
    pub fn von_mises_stress(&self, cell: usize) -> f64 {
        let gradient = self.deformation_gradient(cell);
        let values = self.plan.recipe.tissue().values(cell);
        let turned = matches!(self.model, ModelKind::Corotational | ModelKind::StiffnessWarping);
        self.law.visit(VonMises { gradient, values, turned })
    }
}

struct VonMises<'a> {
    gradient: Mat3<f64>,
    values: &'a [f64],
    /// Whether the model takes the rotation out before it asks the law.
    turned: bool,
}

impl LawVisitor for VonMises<'_> {
    type Output = f64;

    fn visit<L: LawFamily>(self) -> f64 {
        let law = L::from_values(self.values);
        let stress = if L::OBJECTIVE {
            let ratio = self.gradient.determinant().abs().max(LEAST_RATIO);
            law.stress(&self.gradient) * self.gradient.transpose() * (1.0 / ratio)
        } else if self.turned {
            law.stress(&(polar(&self.gradient).transpose() * self.gradient))
        } else {
            law.stress(&self.gradient)
        };
        let trace = stress.trace();
        (1.5 * (stress.squared_norm() - trace * trace / 3.0)).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::body::Body;
    use crate::material::{LinearElastic, StVenantKirchhoff, Tissue};
    use crate::math::Vec3;
    use crate::mesh::TetMesh;
    use crate::model::{Corotational, ModelRecipe, TotalLagrangian};
    use crate::world::{World, WorldConfig};

    const YOUNG: f64 = 10e3; // Pa
    const POISSON: f64 = 0.4;

    /// Von Mises stress of a small cube whose points go to x' = R (x + u(x)) with R a turn of `angle` about z.
    fn stress(recipe: impl ModelRecipe + 'static, u: fn(Vec3<f64>) -> Vec3<f64>, angle: f64) -> f64 {
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        let id = world.add(Body::new(TetMesh::box_grid([1, 1, 1], [0.1; 3]), 1000.0).model(recipe)).unwrap();
        let (sin, cos) = angle.sin_cos();
        world.body_mut(id).set_positions(|x| {
            let y = x + u(x);
            Vec3::new(cos * y.x - sin * y.y, sin * y.x + cos * y.y, y.z)
        });
        world.body(id).von_mises_stress(3)
    }

    fn tension(x: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(x.x, -POISSON * x.y, -POISSON * x.z) * 1e-6
    }

    fn shear(x: Vec3<f64>) -> Vec3<f64> {
        Vec3::new(1e-6 * x.y, 0.0, 0.0)
    }

    /// Small strains: σ = E ε in tension, √3 μ γ in shear (Timoshenko, Goodier, section 84), and no turn changes it.
    #[test]
    fn tension_and_shear_show_their_stress_however_they_are_turned() {
        let mu = YOUNG / (2.0 * (1.0 + POISSON));
        let svk =
            || TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON).unwrap()));
        let turned = || Corotational::new(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON).unwrap()));
        for angle in [0.0, 1.0] {
            // Strains of 1e-6 leave 1e-5 to the geometry, and to rounding.
            assert_relative_eq!(stress(svk(), tension, angle), YOUNG * 1e-6, max_relative = 1e-5);
            assert_relative_eq!(stress(turned(), tension, angle), YOUNG * 1e-6, max_relative = 1e-5);
            assert_relative_eq!(stress(svk(), shear, angle), 3_f64.sqrt() * mu * 1e-6, max_relative = 1e-5);
            assert_relative_eq!(stress(turned(), shear, angle), 3_f64.sqrt() * mu * 1e-6, max_relative = 1e-5);
        }
    }

    /// The linear law takes a turn for strain: what it computes with is what is shown.
    #[test]
    fn the_linear_law_alone_shows_stress_in_a_mere_turn() {
        let linear = TotalLagrangian::new(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON).unwrap()));
        // F = turn of 1 rad: ε = diag(cos 1 − 1, cos 1 − 1, 0), and σ_vm = 2 μ |cos 1 − 1|.
        let mu = YOUNG / (2.0 * (1.0 + POISSON));
        let expected = 2.0 * mu * (1.0 - 1_f64.cos());
        assert_relative_eq!(stress(linear, |_| Vec3::ZERO, 1.0), expected, max_relative = 1e-10);
    }
}

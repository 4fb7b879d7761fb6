use super::SimulatedBody;
use crate::material::{LawFamily, LawVisitor, Tissue};
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar};
use crate::model::ModelKind;

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
        match self.model {
            ModelKind::Corotational | ModelKind::StiffnessWarping => {
                let rotation = polar(&gradient);
                rotation * stress(rotation.transpose() * gradient)
            }
            _ => stress(gradient),
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use crate::body::Body;
    use crate::material::{LinearElastic, StVenantKirchhoff, Tissue};
    use crate::math::{Mat3, Vec3};
    use crate::mesh::TetMesh;
    use crate::model::{Corotational, ModelRecipe, TotalLagrangian};
    use crate::world::{World, WorldConfig};

    /// The stress of the first cell of a box that is stretched 1.2 times along x and turned by a right angle about z.
    fn stress_of_a_turned_stretch(recipe: impl ModelRecipe + 'static) -> Mat3<f64> {
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        let mesh = TetMesh::box_grid([1, 1, 1], [0.1, 0.2, 0.3]);
        let id = world.add(Body::new(mesh, 1000.0).model(recipe)).unwrap();
        world.body_mut(id).set_positions(|x| Vec3::new(-x.y, 1.2 * x.x, x.z));
        world.body(id).first_piola_stress(0)
    }

    /// E = diag(0.22, 0, 0), S = λ tr E + 2μE, P = F S: the first column of P is (0, 1.2 S₁₁, 0).
    #[test]
    fn stress_is_that_of_the_law_at_the_gradient() {
        let law = StVenantKirchhoff::from_young_poisson(10e3, 0.4).unwrap();
        let stress = stress_of_a_turned_stretch(TotalLagrangian::new(Tissue::uniform(law)));
        assert_relative_eq!(stress.columns[0].y, 1.2 * 0.22 * (law.lambda + 2.0 * law.mu), max_relative = 1e-10);
        assert_relative_eq!(stress.columns[1].x, -0.22 * law.lambda, max_relative = 1e-10);
    }

    /// The small strain of the stretch alone is diag(0.2, 0, 0), and the stress turns with the cell.
    #[test]
    fn stress_of_a_corotational_cell_knows_no_turn() {
        let law = LinearElastic::from_young_poisson(10e3, 0.4).unwrap();
        let stress = stress_of_a_turned_stretch(Corotational::new(Tissue::uniform(law)));
        assert_relative_eq!(stress.columns[0].y, 0.2 * (law.lambda + 2.0 * law.mu), max_relative = 1e-10);
        assert_relative_eq!(stress.columns[1].x, -0.2 * law.lambda, max_relative = 1e-10);
    }
}

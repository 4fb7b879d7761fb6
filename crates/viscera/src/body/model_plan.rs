use crate::mesh::VolumeMesh;
use crate::model::frequency::FrequencyBound;
use crate::model::{ForceModel, ModelError, ModelRecipe, Precision};

/// What the force models of a body are built from; kept, because a body that goes back to before a cut needs them anew.
#[derive(Debug)]
pub(crate) struct ModelPlan {
    pub(crate) recipe: Box<dyn ModelRecipe>,
    /// Density [kg/m³]: one number, or one for each cell.
    pub(crate) density: Vec<f64>,
    /// κ of the volume penalty [Pa]; 0 for none.
    pub(crate) keep_volume: f64,
}

/// Force models, and the bound of the highest frequency: what a cut changes about a body besides its state.
pub(crate) struct Models<T> {
    pub(crate) forces: Vec<Box<dyn ForceModel<T>>>,
    pub(crate) frequency: Box<dyn FrequencyBound<T>>,
}

impl ModelPlan {
    /// The models of a body that was never cut.
    pub(crate) fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Models<T>, ModelError> {
        let mut forces = vec![T::build_model(self.recipe.as_ref(), mesh)?];
        if self.keep_volume != 0.0
            && let VolumeMesh::Tet(tets) = mesh
        {
            forces.push(T::build_volume_penalty(tets, self.keep_volume)?);
        }
        let frequency = T::build_frequency_bound(self.recipe.as_ref(), mesh, &self.density, self.keep_volume)?;
        Ok(Models { forces, frequency })
    }
}

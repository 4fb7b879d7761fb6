use serde::Serialize;
use serde::de::DeserializeOwned;

use super::frequency::FrequencyBound;
use super::{ForceModel, ModelError, ModelRecipe, VolumePenalty};
use crate::math::Scalar;
use crate::mesh::{TetMesh, VolumeMesh};

/// The two precisions that a world can be simulated in, `f32` and `f64`, each with its way to the kernels.
///
/// Kernels are compiled here, for both, and not again in every crate that builds a world: that took four times as long.
pub trait Precision: Scalar + Serialize + DeserializeOwned {
    /// Builds a force model.
    ///
    /// # Errors
    /// As [`ModelRecipe::build_single`].
    fn build_model(recipe: &dyn ModelRecipe, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<Self>>, ModelError>;

    /// Builds the volume penalty of stiffness `kappa` [Pa].
    ///
    /// # Errors
    /// As [`VolumePenalty::new`].
    fn build_volume_penalty(mesh: &TetMesh, kappa: f64) -> Result<Box<dyn ForceModel<Self>>, ModelError>;

    /// Builds the bound of the highest frequency.
    ///
    /// # Errors
    /// As [`ModelRecipe::bound_single`].
    fn build_frequency_bound(
        recipe: &dyn ModelRecipe,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<Self>>, ModelError>;
}

macro_rules! impl_precision {
    ($scalar:ty, $build:ident, $bound:ident) => {
        impl Precision for $scalar {
            fn build_model(
                recipe: &dyn ModelRecipe,
                mesh: &VolumeMesh,
            ) -> Result<Box<dyn ForceModel<Self>>, ModelError> {
                recipe.$build(mesh)
            }

            fn build_volume_penalty(mesh: &TetMesh, kappa: f64) -> Result<Box<dyn ForceModel<Self>>, ModelError> {
                Ok(Box::new(VolumePenalty::<$scalar>::new(mesh, kappa)?))
            }

            fn build_frequency_bound(
                recipe: &dyn ModelRecipe,
                mesh: &VolumeMesh,
                density: &[f64],
                keep_volume: f64,
            ) -> Result<Box<dyn FrequencyBound<Self>>, ModelError> {
                recipe.$bound(mesh, density, keep_volume)
            }
        }
    };
}

impl_precision!(f32, build_single, bound_single);
impl_precision!(f64, build_double, bound_double);

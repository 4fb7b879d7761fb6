//! What a user writes of a model, and how the model's file says it: once, for both precisions.

use std::sync::Arc;

use super::frequency::{FrequencyBound, frequency_bound};
use super::hybrid::Condensation;
use super::precomputed::{Responses, Supports};
use super::{ForceModel, ModelError, ModelKind, Precision};
use crate::material::Tissue;
use crate::mesh::VolumeMesh;

/// What is needed to build a model for a mesh: what the user writes.
pub trait ModelRecipe: std::fmt::Debug + Send + Sync {
    /// The kind of model.
    fn kind(&self) -> ModelKind;

    /// The tissue that it is made of.
    fn tissue(&self) -> &Tissue;

    /// Builds the model in single precision.
    ///
    /// # Errors
    /// [`ModelError`] where the model supports neither the law nor the cells, or a cell has no volume.
    fn build_single(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f32>>, ModelError>;

    /// Builds the model in double precision.
    ///
    /// # Errors
    /// As [`ModelRecipe::build_single`].
    fn build_double(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f64>>, ModelError>;

    /// The recipe with what it finds out about a body that is held so, for models that depend on it; none for all others.
    ///
    /// # Errors
    /// [`ModelError`] where a part of the body is held by nothing, or the tissue does not fit.
    fn supported(&self, supports: &Supports<'_>) -> Result<Option<Box<dyn ModelRecipe>>, ModelError>;

    /// The part of the body that follows its boundary, once the recipe knows the supports; none for models without one.
    fn condensation(&self) -> Option<&Arc<Condensation>>;

    /// How a body that is held so answers forces, where it does not move in time but rests at the end of every step; none for models
    /// that move.
    ///
    /// # Errors
    /// [`ModelError`] where nothing holds the body, or the responses that the model was given are not those of such a body.
    fn responses(&self, supports: &Supports<'_>) -> Result<Option<Arc<Responses>>, ModelError>;

    /// The bound of the body's highest frequency in single precision, for one density [kg/m³] or one for each cell, and the
    /// volume-keeping stiffness κ [Pa]. That of the law, unless the model makes something else of it.
    ///
    /// # Errors
    /// [`ModelError::Mesh`] for a cell without volume.
    fn bound_single(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<f32>>, ModelError>;

    /// The same in double precision.
    ///
    /// # Errors
    /// As [`ModelRecipe::bound_single`].
    fn bound_double(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<f64>>, ModelError>;
}

/// What a model's file says of its recipe; [`recipe!`] makes a [`ModelRecipe`] of it.
pub(crate) trait GenericRecipe: Sized {
    /// The kind of model.
    const KIND: ModelKind;

    /// The tissue that it is made of.
    fn tissue(&self) -> &Tissue;

    /// Builds the model, or says which law or cells it does not support.
    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError>;

    /// As [`ModelRecipe::bound_double`]: that of the law, unless the model makes something else of it.
    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        frequency_bound(mesh, self.tissue(), density, keep_volume)
    }

    /// As [`ModelRecipe::supported`].
    fn supported(&self, _supports: &Supports<'_>) -> Result<Option<Box<dyn ModelRecipe>>, ModelError> {
        Ok(None)
    }

    /// As [`ModelRecipe::condensation`].
    fn condensation(&self) -> Option<&Arc<Condensation>> {
        None
    }

    /// As [`ModelRecipe::responses`].
    fn responses(&self, _supports: &Supports<'_>) -> Result<Option<Arc<Responses>>, ModelError> {
        Ok(None)
    }
}

/// Writes a [`GenericRecipe`] out in both precisions. Not a blanket implementation: that would compile the kernels anew wherever a recipe
/// is boxed.
macro_rules! recipe {
    ($model:ty) => {
        impl $crate::model::ModelRecipe for $model {
            fn kind(&self) -> $crate::model::ModelKind {
                <Self as $crate::model::GenericRecipe>::KIND
            }

            fn tissue(&self) -> &$crate::material::Tissue {
                $crate::model::GenericRecipe::tissue(self)
            }

            fn build_single(
                &self,
                mesh: &$crate::mesh::VolumeMesh,
            ) -> Result<Box<dyn $crate::model::ForceModel<f32>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::build(self, mesh)
            }

            fn build_double(
                &self,
                mesh: &$crate::mesh::VolumeMesh,
            ) -> Result<Box<dyn $crate::model::ForceModel<f64>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::build(self, mesh)
            }

            fn supported(
                &self,
                supports: &$crate::model::precomputed::Supports<'_>,
            ) -> Result<Option<Box<dyn $crate::model::ModelRecipe>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::supported(self, supports)
            }

            fn condensation(&self) -> Option<&std::sync::Arc<$crate::model::hybrid::Condensation>> {
                $crate::model::GenericRecipe::condensation(self)
            }

            fn responses(
                &self,
                supports: &$crate::model::precomputed::Supports<'_>,
            ) -> Result<Option<std::sync::Arc<$crate::model::precomputed::Responses>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::responses(self, supports)
            }

            fn bound_single(
                &self,
                mesh: &$crate::mesh::VolumeMesh,
                density: &[f64],
                keep_volume: f64,
            ) -> Result<Box<dyn $crate::model::frequency::FrequencyBound<f32>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::bound(self, mesh, density, keep_volume)
            }

            fn bound_double(
                &self,
                mesh: &$crate::mesh::VolumeMesh,
                density: &[f64],
                keep_volume: f64,
            ) -> Result<Box<dyn $crate::model::frequency::FrequencyBound<f64>>, $crate::model::ModelError> {
                $crate::model::GenericRecipe::bound(self, mesh, density, keep_volume)
            }
        }
    };
}

pub(crate) use recipe;

use std::path::Path;
use std::sync::Arc;

use viscera::material::Tissue;
use viscera::mesh::VolumeMesh;
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement, Tangent};
use viscera::model::precomputed::Responses;
use viscera::model::{
    Corotational, Hybrid, LinearTensorMass, MassSpring, ModelRecipe, NodallyIntegrated, Precomputed, ShapeMemory,
    StiffnessWarping, TensorMass, TotalLagrangian,
};

use super::region::{Wanted, region};
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{
    BodyFile, LawName, ModelFile, ModelName, RotationName, StrainDisplacementName, TangentName, VolumeName,
};

/// The force model: the one that is named, or the tensor-mass model of the law, or on hexahedra the one that works there.
pub(super) fn recipe(
    file: &BodyFile,
    tissue: Tissue,
    mesh: &VolumeMesh,
    site: &Site,
) -> Result<Box<dyn ModelRecipe>, SceneErrors> {
    let Some(model) = &file.model else {
        return Ok(match (mesh, file.law.kind) {
            (VolumeMesh::Hex(_), _) => Box::new(TotalLagrangian::new(tissue)),
            (VolumeMesh::Tet(_), LawName::Linear) => Box::new(LinearTensorMass::new(tissue)),
            (VolumeMesh::Tet(_), LawName::StVenantKirchhoff) => Box::new(TensorMass::new(tissue)),
            (VolumeMesh::Tet(_), LawName::NeoHookean | LawName::StableNeoHookean) => {
                Box::new(TotalLagrangian::new(tissue))
            }
        });
    };
    check_owners(model, &site.key("model"))?;
    Ok(match model.kind {
        ModelName::LinearTensorMass => Box::new(LinearTensorMass::new(tissue)),
        ModelName::TotalLagrangian => Box::new(TotalLagrangian::new(tissue)),
        ModelName::NodallyIntegrated => {
            let recipe = NodallyIntegrated::new(tissue);
            Box::new(model.stabilise.map_or(recipe.clone(), |share| recipe.stabilise(share)))
        }
        ModelName::StiffnessWarping => Box::new(StiffnessWarping::new(tissue)),
        ModelName::MassSpring => Box::new(MassSpring::new(tissue)),
        ModelName::ShapeMemory => Box::new(ShapeMemory::new(tissue)),
        ModelName::Corotational => Box::new(corotational(model, tissue)),
        ModelName::TensorMass => {
            let recipe = TensorMass::new(tissue);
            Box::new(model.adaptive.map_or(recipe.clone(), |threshold| recipe.adaptive(threshold.0)))
        }
        ModelName::Precomputed => {
            let (recipe, site) = (Precomputed::new(tissue), site.key("model").key("responses"));
            match &model.responses {
                Some(path) => Box::new(recipe.responses(Arc::new(responses(path, &site)?))),
                None => Box::new(recipe),
            }
        }
        ModelName::Hybrid => {
            let (recipe, site) = (Hybrid::new(tissue), site.key("model").key("dynamic"));
            match &model.dynamic {
                Some(file) => Box::new(recipe.dynamic(region(file, Wanted::Nodes, mesh, &site)?)),
                None => Box::new(recipe),
            }
        }
    })
}

/// Reads what `viscera precompute` wrote; whether it is of this body shows when that is built.
fn responses(path: &Path, site: &Site) -> Result<Responses, SceneErrors> {
    let at = site.path(path);
    let unreadable = |error| {
        site.error(
            format!("cannot read {}: {error}", at.display()),
            "`viscera precompute` writes it; without this key nothing is read",
        )
    };
    let bytes = site.read(path).map_err(unreadable)?;
    Responses::from_bytes(&bytes).map_err(|error| {
        let message = error.to_string();
        let (message, help) = message.split_once("; ").unwrap_or((&message, ""));
        site.error(format!("{}: {message}", at.display()), help)
    })
}

/// Refuses settings of another model.
fn check_owners(model: &ModelFile, site: &Site) -> Result<(), SceneErrors> {
    let keys = [
        ("adaptive", model.adaptive.is_some(), ModelName::TensorMass, "tensor-mass"),
        ("stabilise", model.stabilise.is_some(), ModelName::NodallyIntegrated, "nodally-integrated"),
        ("rotation", model.rotation.is_some(), ModelName::Corotational, "corotational"),
        ("strain-displacement", model.strain_displacement.is_some(), ModelName::Corotational, "corotational"),
        ("volume", model.volume.is_some(), ModelName::Corotational, "corotational"),
        ("tangent", model.tangent.is_some(), ModelName::Corotational, "corotational"),
        ("responses", model.responses.is_some(), ModelName::Precomputed, "precomputed"),
        ("dynamic", model.dynamic.is_some(), ModelName::Hybrid, "hybrid"),
    ];
    match keys.into_iter().find(|(_, given, owner, _)| *given && model.kind != *owner) {
        Some((key, _, _, owner)) => {
            let message = format!("`{key}` is a setting of the model `{owner}`");
            Err(site.key(key).error(message, "take that model, or leave it out"))
        }
        None => Ok(()),
    }
}

fn corotational(file: &ModelFile, tissue: Tissue) -> Corotational {
    let mut recipe = Corotational::new(tissue);
    if let Some(rotation) = file.rotation {
        recipe = recipe.rotation(match rotation {
            RotationName::Polar => Rotation::Polar,
            RotationName::Qr => Rotation::Qr,
            RotationName::Svd => Rotation::Svd,
        });
    }
    if let Some(strain_displacement) = file.strain_displacement {
        recipe = recipe.strain_displacement(match strain_displacement {
            StrainDisplacementName::AtRest => StrainDisplacement::AtRest,
            StrainDisplacementName::Updated => StrainDisplacement::Updated,
        });
    }
    if let Some(volume) = file.volume {
        recipe = recipe.volume(match volume {
            VolumeName::Initial => IntegrationVolume::Initial,
            VolumeName::Current => IntegrationVolume::Current,
        });
    }
    if let Some(tangent) = file.tangent {
        recipe = recipe.tangent(match tangent {
            TangentName::Frozen => Tangent::Frozen,
            TangentName::Exact => Tangent::Exact,
        });
    }
    recipe
}

use viscera::body::{Body, BodyError, LoosePieces, Muscle};
use viscera::model::ModelError;
use viscera::model::precomputed::ResponsesError;

use super::action::act;
use super::curve::curve;
use super::law::{densities, tissue};
use super::mesh::{Meshes, PlacedMesh};
use super::model::recipe;
use super::region::{Wanted, region};
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{BodyFile, LoosePiecesFile};

/// The body, and what a person should know about its mesh.
pub(super) fn body(
    name: &str,
    file: &BodyFile,
    meshes: &mut Meshes,
    site: &Site,
) -> Result<(Body, Vec<String>), SceneErrors> {
    let placed = meshes.placed(file, site)?;
    let tissue = tissue(file, &placed, site)?;
    let densities = densities(file, &placed.mesh, site)?;
    let PlacedMesh { mesh, notices, .. } = placed;
    let recipe = recipe(file, tissue, &mesh, site)?;

    let mut body = Body::new(mesh.clone(), file.density.0)
        .name(name)
        .boxed_model(recipe)
        .damping(file.damping.0)
        .stiffness_damping(file.stiffness_damping.0)
        .keep_volume(file.model.as_ref().and_then(|model| model.keep_volume).map_or(0.0, |kappa| kappa.0))
        .loose_pieces(match file.loose_pieces {
            LoosePiecesFile::Free => LoosePieces::Free,
            LoosePiecesFile::Drop => LoosePieces::Drop,
        });
    if let Some(densities) = densities {
        body = body.densities(densities);
    }
    if let Some(fixed) = &file.fix {
        body = body.fix(region(fixed, Wanted::Nodes, &mesh, &site.key("fix"))?);
    }
    for (index, prescribed) in file.prescribe.iter().enumerate() {
        let site = site.key("prescribe").key(index);
        let region = region(&prescribed.region, Wanted::Nodes, &mesh, &site.key("region"))?;
        body = body.prescribe(region, curve(&prescribed.displacement, &site.key("displacement"))?);
    }
    for (index, slide) in file.slide.iter().enumerate() {
        let site = site.key("slide").key(index);
        if slide.normal.iter().all(|&component| component == 0.0) {
            return Err(site.key("normal").error("a direction of length zero", "give the direction that is held"));
        }
        let region = region(&slide.region, Wanted::Nodes, &mesh, &site.key("region"))?;
        body = match &slide.displacement {
            None => body.slide(region, slide.normal),
            Some(way) => body.prescribe_along(region, slide.normal, curve(way, &site.key("displacement"))?),
        };
    }
    for (index, volume) in file.exact_volume.iter().enumerate() {
        let site = site.key("exact-volume").key(index).key("region");
        body = body.keep_volume_exactly(&volume.name, region(&volume.region, Wanted::Cells, &mesh, &site)?);
    }
    for (index, part) in file.rigid.iter().enumerate() {
        body = body.rigid(region(part, Wanted::Nodes, &mesh, &site.key("rigid").key(index))?);
    }
    for (index, muscle) in file.muscle.iter().enumerate() {
        let site = site.key("muscle").key(index);
        body = body.muscle(Muscle {
            region: region(&muscle.region, Wanted::Nodes, &mesh, &site.key("region"))?,
            stiffness: muscle.stiffness.0,
            contraction: muscle.contraction,
            activation: curve(&muscle.activation, &site.key("activation"))?,
        });
    }
    body = act(body, file, &mesh, site)?;
    Ok((body, notices))
}

/// The key of a body that an error of the engine is about.
pub(super) fn blame(error: &BodyError, site: &Site) -> SceneErrors {
    // The name of the body stands in the line that is shown.
    let message = error.to_string();
    let message = message.split_once("`: ").map_or(message.as_str(), |(_, rest)| rest);
    let (message, help) = message.split_once("; ").or(message.split_once(": ")).unwrap_or((message, ""));
    match error {
        BodyError::Model { source: ModelError::Mesh(_), .. }
        | BodyError::Mesh { .. }
        | BodyError::IsolatedNode { .. } => site.key("mesh"),
        BodyError::Model { source: ModelError::Material(_), .. } => site.key("law"),
        BodyError::Model { source: ModelError::Responses(ResponsesError::Stale { .. }), .. } => {
            site.key("model").key("responses")
        }
        BodyError::Model { source: ModelError::Responses(ResponsesError::NothingHolds), .. } => site.key("fix"),
        BodyError::Model { source: ModelError::Region(_), .. } => site.key("model").key("dynamic"),
        BodyError::Model { .. } | BodyError::NoModel { .. } | BodyError::LinearModel { .. } => site.key("model"),
        BodyError::KeepVolumeOnHexahedra { .. } => site.key("model").key("keep-volume"),
        BodyError::HeldRigidPart { .. }
        | BodyError::OverlappingRigidParts { .. }
        | BodyError::RigidPartInLine { .. } => site.key("rigid"),
        BodyError::OutOfRange { name, .. } if name.starts_with("muscle") => site.key("muscle"),
        BodyError::Region { purpose: "a muscle", .. } => site.key("muscle"),
        BodyError::OutOfRange { name, .. } if name.starts_with("actuator") => site.key("actuator"),
        BodyError::OutOfRange { name, .. } if name.starts_with("active fibre") => site.key("active-fibre"),
        BodyError::OutOfRange { name: "attraction radius", .. } => site.key("load"),
        BodyError::OutOfRange { name: "keep-volume", .. } => site.key("model").key("keep-volume"),
        BodyError::OutOfRange { name, .. } => site.key(name.replace(' ', "-")),
        BodyError::WrongDensityCount { .. } => site.key("density"),
        BodyError::Region { .. } => site.clone(),
    }
    .error(message, help)
}

use indexmap::IndexMap;
use viscera::math::Scalar;
use viscera::world::{Attachment, AttachmentId, BodyId, World, WorldError};

use super::region::{Wanted, region};
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::BodyFile;

/// Grows a body to others.
pub(super) fn attach<T: Scalar>(
    world: &mut World<T>,
    bodies: &IndexMap<String, BodyId>,
    body: BodyId,
    file: &BodyFile,
    site: &Site,
) -> Result<Vec<AttachmentId>, SceneErrors> {
    let mut attachments = Vec::new();
    for (index, attached) in file.attach.iter().enumerate() {
        let site = site.key("attach").key(index);
        let Some(&to) = bodies.get(&attached.to) else {
            let known = bodies.keys().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let message = format!("there is no body `{}`", attached.to);
            return Err(site.key("to").error(message, format!("the bodies are {known}")));
        };
        let region = region(&attached.region, Wanted::Nodes, world.body(body).mesh(), &site.key("region"))?;
        let attachment = world.attach(Attachment { body, region, to }).map_err(|error| match &error {
            WorldError::AttachedToItself { .. } => {
                site.key("to").error("a body is not attached to itself", "name another")
            }
            WorldError::TooFarToAttach { .. } => site.key("region").error(&error, ""),
            _ => site.error(&error, ""),
        })?;
        attachments.push(attachment);
    }
    Ok(attachments)
}

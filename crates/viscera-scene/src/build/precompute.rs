//! Responses of the bodies of a scene, computed beforehand.

use std::path::PathBuf;

use viscera::executor::Executor;
use viscera::model::precomputed::Responses;
use viscera::solver::Envelope;

use super::body::{blame, body};
use super::mesh::Meshes;
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::ModelName;
use crate::scene::Scene;

/// The responses of a body, and where the scene looks for them.
#[derive(Clone, Debug)]
pub struct BodyResponses {
    /// Name of the body.
    pub body: String,
    /// The file that the scene names, where it is looked for; none where it names none.
    pub file: Option<PathBuf>,
    /// The responses.
    pub responses: Responses,
}

impl Scene {
    /// Computes the responses of every body whose model is `precomputed`, on the threads of `executor`, whatever files there are.
    /// `progress` is told how many nodes of a body are done, of how many.
    ///
    /// # Errors
    /// All that [`check`](Self::check) finds, and what keeps a body from being built.
    pub fn precompute(
        &self,
        executor: &Executor,
        progress: &(dyn Fn(&str, usize, usize) + Sync),
    ) -> Result<Vec<BodyResponses>, SceneErrors> {
        let (file, root, mut meshes) = (self.check()?, Site::root(self), Meshes::default());
        let mut all = Vec::new();
        for (name, described) in &file.body {
            let Some(model) = described.model.as_ref().filter(|model| model.kind == ModelName::Precomputed) else {
                continue;
            };
            let site = root.key("body").key(name);
            let mut described = described.clone();
            described.model.iter_mut().for_each(|model| model.responses = None);
            let (built, _) = body(name, &described, &mut meshes, &site)?;
            let told = |done: usize, of: usize| progress(name, done, of);
            let responses =
                built.precompute(&mut Envelope::default(), executor, &told).map_err(|error| blame(&error, &site))?;
            let file = model.responses.as_ref().map(|path| site.path(path));
            all.push(BodyResponses { body: name.clone(), file, responses });
        }
        Ok(all)
    }
}

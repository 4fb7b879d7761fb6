//! `viscera scenes`: what is built in.

use viscera_scene::Scene;
use viscera_session::library;

use crate::arguments::ScenesArguments;
use crate::built_in;
use crate::failure::Failure;
use crate::terminal;

pub(crate) fn scenes(arguments: &ScenesArguments) -> Result<(), Failure> {
    if let Some(folder) = &arguments.copy_to {
        built_in::copy_to(folder)
            .map_err(|error| Failure::input(format!("{}: cannot be written: {error}", folder.display())))?;
        terminal::say(&format!("the scenes are in {}", folder.display()));
        return Ok(());
    }
    let width = library::scenes().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, text) in library::scenes() {
        let file = Scene::parse(text, "").and_then(|scene| scene.check()).map_err(Failure::scene)?;
        terminal::say(&format!("{name:<width$}  {}", file.title.unwrap_or_default()));
    }
    Ok(())
}

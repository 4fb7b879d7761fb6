//! Refusals from the errors of other crates.

use viscera_scene::{SceneError, SceneErrors};

use crate::message::{Excerpt, Refusal};
use crate::parameter::NotSet;

/// A refusal for this reason.
pub(crate) fn because(reason: impl Into<String>) -> Box<Refusal> {
    with_help(reason, "")
}

/// A refusal for this reason, and what to do.
pub(crate) fn with_help(reason: impl Into<String>, help: impl Into<String>) -> Box<Refusal> {
    Box::new(Refusal { reason: reason.into(), help: help.into(), ..Refusal::default() })
}

/// What is wrong with a scene: the first thing, with its line.
pub(crate) fn scene(errors: &SceneErrors) -> Refusal {
    let SceneError { message, help, place } = errors.first();
    let excerpt = place.as_ref().map(|place| Excerpt {
        source: place.source.clone(),
        line: place.line,
        column: place.column,
        text: place.text.clone(),
        length: place.width,
    });
    Refusal { reason: message.clone(), help: help.clone(), excerpt, ..Refusal::default() }
}

/// Why a parameter cannot have a value.
pub(crate) fn parameter(key: &str, not_set: NotSet) -> Box<Refusal> {
    let NotSet { reason, help } = not_set;
    Box::new(Refusal { reason, help, key: Some(key.into()), ..Refusal::default() })
}

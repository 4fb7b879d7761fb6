//! What can be changed about a scene while it runs: keys of the scene file, as a page shows them.

mod choices;
mod list;
mod tissue;

pub(crate) use choices::{integrators, laws, models};

use viscera_scene::file::{BodyFile, SceneFile};

use crate::message::{Effect, Parameter, ParameterKind, Scale, Value};
pub(crate) use list::bare;
use list::{OF_BODY, OF_WORLD};

/// Something that can be changed about a scene or, `S` being a body's part of it, about a body.
pub(crate) struct Definition<S: 'static> {
    /// Its key in the file, behind that of the body.
    pub(crate) key: &'static str,
    pub(crate) title: &'static str,
    pub(crate) summary: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) effect: Effect,
    pub(crate) form: Form<S>,
    /// Its value; none where the scene has no place for it.
    pub(crate) get: fn(&S) -> Option<Value>,
    /// Puts a value of the right form there, and tells what else that changed. Knows the scene as it was opened, for what it said of a
    /// choice that was left since.
    pub(crate) set: fn(&mut S, &Value, &S) -> Vec<String>,
}

/// What values it takes.
pub(crate) enum Form<S: 'static> {
    Number {
        least: Option<(f64, Bound)>,
        most: Option<(f64, Bound)>,
        scale: Scale,
        /// What a slider spans, for the value in the scene as it was opened.
        span: fn(f64) -> (f64, f64),
    },
    /// Of what there is now, and in the scene as it was opened.
    Choice(fn(&S, &S) -> Vec<crate::message::Choice>),
    Vector,
}

/// Whether a bound is a value itself.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bound {
    Included,
    Excluded,
}

/// Why a value cannot be put there, and what would do.
#[derive(Debug)]
pub(crate) struct NotSet {
    pub(crate) reason: String,
    pub(crate) help: String,
}

/// Everything that can be changed about `file`, which was `original` when it was opened.
pub(crate) fn parameters(file: &SceneFile, original: &SceneFile) -> Vec<Parameter> {
    let of_world = OF_WORLD.iter().filter_map(|definition| definition.describe("", "world", None, file, original));
    let of_bodies = file.body.iter().enumerate().flat_map(|(index, (name, body))| {
        let before = original.body.get(name).unwrap_or(body);
        OF_BODY.iter().filter_map(move |definition| {
            definition.describe(&format!("body.{name}."), name, Some(index), body, before)
        })
    });
    of_bodies.chain(of_world).collect()
}

/// Puts a value into the file, which was `original` when it was opened; gives what that does to the motion, and notices of what else it
/// changed.
pub(crate) fn set(
    file: &mut SceneFile,
    original: &SceneFile,
    key: &str,
    value: &Value,
) -> Result<(Effect, Vec<String>), NotSet> {
    let unknown = || NotSet {
        reason: format!("there is no parameter `{key}`"),
        help: "the scene lists its parameters with their keys".into(),
    };
    if let Some(definition) = OF_WORLD.iter().find(|definition| definition.key == key) {
        return definition.put(file, value, original);
    }
    // Names of bodies may have dots: the one that fits, not the first part.
    let of_body = |(name, body): (&String, &mut BodyFile)| {
        let rest = key.strip_prefix("body.")?.strip_prefix(name.as_str())?.strip_prefix('.')?;
        let definition = OF_BODY.iter().find(|definition| definition.key == rest)?;
        let before = original.body.get(name).cloned().unwrap_or_else(|| body.clone());
        Some(definition.put(body, value, &before))
    };
    file.body.iter_mut().find_map(of_body).unwrap_or_else(|| Err(unknown()))
}

impl<S> Definition<S> {
    fn describe(&self, prefix: &str, group: &str, body: Option<usize>, file: &S, original: &S) -> Option<Parameter> {
        let value = (self.get)(file)?;
        let default = (self.get)(original).unwrap_or_else(|| value.clone());
        let kind = match &self.form {
            Form::Number { least, most, scale, span } => {
                let (low, high) = span(default.number().unwrap_or(0.0));
                ParameterKind::Number {
                    least: least.map(|(bound, _)| bound),
                    least_excluded: least.is_some_and(|(_, kind)| kind == Bound::Excluded),
                    most: most.map(|(bound, _)| bound),
                    most_excluded: most.is_some_and(|(_, kind)| kind == Bound::Excluded),
                    scale: *scale,
                    low,
                    high,
                }
            }
            Form::Choice(choices) => ParameterKind::Choice { choices: choices(file, original) },
            Form::Vector => ParameterKind::Vector {},
        };
        Some(Parameter {
            key: format!("{prefix}{}", self.key),
            group: group.into(),
            body,
            title: self.title.into(),
            summary: self.summary.into(),
            unit: self.unit.into(),
            value,
            default,
            effect: self.effect,
            kind,
        })
    }

    fn put(&self, file: &mut S, value: &Value, original: &S) -> Result<(Effect, Vec<String>), NotSet> {
        let refuse = |reason: String, help: &str| Err(NotSet { reason, help: help.into() });
        if (self.get)(file).is_none() {
            return refuse(format!("`{}` has no meaning in this scene as it is", self.title), "");
        }
        match (&self.form, value) {
            (Form::Number { least, most, .. }, Value::Number(number)) => {
                let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
                let wanted = match (least, most) {
                    (Some((bound, Bound::Excluded)), _) if *number <= *bound => format!("above {bound}{unit}"),
                    (Some((bound, Bound::Included)), _) if *number < *bound => format!("{bound}{unit} or more"),
                    (_, Some((bound, Bound::Excluded))) if *number >= *bound => format!("below {bound}{unit}"),
                    (_, Some((bound, Bound::Included))) if *number > *bound => format!("{bound}{unit} or less"),
                    _ if !number.is_finite() => "a finite number".into(),
                    _ => return Ok((self.effect, (self.set)(file, value, original))),
                };
                refuse(format!("{} is {number}{unit}, and must be {wanted}", self.title), "")
            }
            (Form::Choice(choices), Value::Text(name)) => {
                let choices = choices(file, original);
                match choices.iter().find(|choice| choice.name == *name) {
                    Some(choice) if choice.available => Ok((self.effect, (self.set)(file, value, original))),
                    Some(choice) => {
                        refuse(format!("`{name}` cannot be chosen now"), choice.reason.as_deref().unwrap_or_default())
                    }
                    None => {
                        let known: Vec<_> = choices.into_iter().map(|choice| choice.name).collect();
                        refuse(format!("there is no `{name}`"), &format!("known: {}", known.join(", ")))
                    }
                }
            }
            (Form::Vector, Value::Vector(components)) => {
                if components.iter().all(|component| component.is_finite()) {
                    Ok((self.effect, (self.set)(file, value, original)))
                } else {
                    refuse(format!("{} is not finite", self.title), "give three finite numbers")
                }
            }
            (Form::Number { .. }, _) => refuse(format!("{} is a number", self.title), ""),
            (Form::Choice(_), _) => refuse(format!("{} is one of several names", self.title), ""),
            (Form::Vector, _) => refuse(format!("{} is three numbers", self.title), ""),
        }
    }
}

impl Value {
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }
}

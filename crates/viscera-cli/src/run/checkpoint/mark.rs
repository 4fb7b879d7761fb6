use std::fs;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::built_in::OpenScene;
use crate::failure::Failure;

/// What makes a run what it is: its scene with all changes, the files that the scene names, and how many pictures it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunMark {
    name: String,
    /// The checked scene as JSON, defaults filled in.
    scene: String,
    /// Of every file that the scene names: how it is called, its length [bytes], its CRC-32.
    files: Vec<(String, u64, u32)>,
    pictures: u64,
}

impl RunMark {
    pub(crate) fn of(open: &OpenScene, pictures: u64) -> Result<Self, Failure> {
        let scene = serde_json::to_string(&open.file()?).map_err(Failure::problem)?;
        let mut files = Vec::new();
        for path in open.scene.files().map_err(Failure::scene)? {
            let bytes = fs::read(&path)
                .map_err(|error| Failure::input(format!("{}: cannot be read: {error}", path.display())))?;
            // Without its folder: built-in scenes lie in another one every time.
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            files.push((name, bytes.len() as u64, crc32fast::hash(&bytes)));
        }
        Ok(Self { name: open.name.clone(), scene, files, pictures })
    }

    /// What is another than in `kept`, in words; nothing if all is the same.
    pub(super) fn difference(&self, kept: &Self) -> Option<String> {
        if self == kept {
            return None;
        }
        let parsed = |text: &str| serde_json::from_str::<Value>(text).unwrap_or_default();
        let in_scene = first_difference(&parsed(&kept.scene), &parsed(&self.scene), "");
        Some(if self.name != kept.name {
            format!("its scene is `{}`, not `{}`", kept.name, self.name)
        } else if let Some((key, then, now)) = in_scene {
            format!("`{key}` was {then} and is {now}")
        } else if self.pictures != kept.pictures {
            format!("it takes {} pictures, not {}", kept.pictures, self.pictures)
        } else {
            let changed = self.files.iter().find(|file| !kept.files.contains(file));
            let name = changed.map_or("a file of the scene", |(name, ..)| name);
            format!("{name} has changed since")
        })
    }
}

/// The first key at which two trees differ, and what stands there in each.
fn first_difference(then: &Value, now: &Value, key: &str) -> Option<(String, String, String)> {
    let below = |part: &str| if key.is_empty() { part.to_owned() } else { format!("{key}.{part}") };
    let shown = |value: Option<&Value>| value.map_or_else(|| "not there".to_owned(), Value::to_string);
    let differ = |part: &str, then: Option<&Value>, now: Option<&Value>| match (then, now) {
        (Some(then), Some(now)) => first_difference(then, now, &below(part)),
        _ => Some((below(part), shown(then), shown(now))),
    };
    match (then, now) {
        (Value::Object(then), Value::Object(now)) => {
            let keys = then.keys().chain(now.keys().filter(|key| !then.contains_key(*key)));
            keys.into_iter().find_map(|part| differ(part, then.get(part), now.get(part)))
        }
        (Value::Array(then), Value::Array(now)) => {
            (0..then.len().max(now.len())).find_map(|place| differ(&place.to_string(), then.get(place), now.get(place)))
        }
        _ => (then != now).then(|| (key.to_owned(), then.to_string(), now.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_first_difference_of_two_scenes_is_named_by_its_key() {
        let difference = |then: Value, now: Value| first_difference(&then, &now, "");
        let scene = |young: f64| json!({ "step": 0.01, "body": { "liver": { "load": [{ "young": young }] } } });
        assert_eq!(difference(scene(3.0), scene(3.0)), None);
        let at = |key: &str, then: &str, now: &str| Some((key.to_owned(), then.to_owned(), now.to_owned()));
        assert_eq!(difference(scene(3.0), scene(5.0)), at("body.liver.load.0.young", "3.0", "5.0"));
        assert_eq!(difference(json!({ "a": 1 }), json!({ "a": 1, "b": 2 })), at("b", "not there", "2"));
    }
}

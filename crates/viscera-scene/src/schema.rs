//! The JSON schema of scene files, for editors and for the check.

use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema};
use serde_json::Value;

use crate::file::SceneFile;

/// The schema of a scene file (draft 7, which TOML editors know).
///
/// Besides the standard keywords, `x-dimension` names what a quantity measures, and `x-exactly-one-of` lists groups of keys of
/// which one must be given whole.
pub fn schema() -> Value {
    schema_of::<SceneFile>()
}

/// The schema as text, as it is kept in `scenes/scene.schema.json`.
pub fn schema_text() -> String {
    format!("{:#}\n", schema())
}

fn schema_of<S: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft07().with_transform(WithoutNull);
    settings.into_generator().into_root_schema_for::<S>().to_value()
}

/// TOML has no null: an optional key is left out.
#[derive(Clone)]
struct WithoutNull;

impl Transform for WithoutNull {
    fn transform(&mut self, schema: &mut Schema) {
        transform_subschemas(self, schema);
        let is_null = |value: &Value| value.is_null() || *value == "null" || value["type"] == "null";
        for key in ["type", "enum", "anyOf"] {
            let Some(Value::Array(choices)) = schema.get_mut(key) else { continue };
            choices.retain(|choice| !is_null(choice));
            if choices.len() != 1 || key == "enum" {
                continue;
            }
            let only = choices.remove(0);
            if key == "type" {
                schema.insert(key.into(), only);
            } else {
                schema.remove(key);
                // A reference stands alone in draft 7.
                if only.get("$ref").is_some() && !schema.as_object().is_none_or(serde_json::Map::is_empty) {
                    schema.insert("allOf".into(), vec![only].into());
                } else if let Value::Object(members) = only {
                    members.into_iter().for_each(|(key, value)| {
                        schema.ensure_object().entry(key).or_insert(value);
                    });
                }
            }
        }
        if schema.get("default").is_some_and(Value::is_null) {
            schema.remove("default");
        }
    }
}

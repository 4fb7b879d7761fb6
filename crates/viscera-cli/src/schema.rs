//! `viscera schema`: the schema of scene files, and the tables of all keys that the guide has of it.

use std::fmt::Write;

use serde_json::{Map, Value as Json};

use crate::arguments::SchemaArguments;
use crate::terminal;

pub(crate) fn schema(arguments: &SchemaArguments) {
    terminal::say(&if arguments.markdown { tables() } else { viscera_scene::schema_text() });
}

/// A section for every table and choice of the format, in the order in which one leads to the next.
fn tables() -> String {
    let root = viscera_scene::schema();
    let mut reference = Reference { root: &root, sections: vec![("scene".to_owned(), String::new())], written: 0 };
    let mut text = String::new();
    while let Some((path, definition)) = reference.sections.get(reference.written).cloned() {
        reference.written += 1;
        let whole = if definition.is_empty() { root.clone() } else { root["definitions"][&definition].clone() };
        let schema = reference.resolved(&whole);
        let _ = write!(text, "### `{path}` {{#{}}}\n\n{}\n\n", anchor(&path), description(&schema));
        text.push_str(&reference.body(&path, &schema));
    }
    text
}

/// What is being written of a schema.
struct Reference<'a> {
    root: &'a Json,
    /// Path and definition of the sections there are to write.
    sections: Vec<(String, String)>,
    /// How many of them are.
    written: usize,
}

impl Reference<'_> {
    fn body(&mut self, path: &str, schema: &Map<String, Json>) -> String {
        if schema.contains_key("properties") {
            return self.table(path, schema);
        }
        let mut text = String::new();
        for way in ways(schema) {
            let way = self.resolved(way);
            if !ways(&way).is_empty() {
                text.push_str(&self.body(path, &way));
            } else if way.contains_key("properties") {
                let tag = way["properties"].as_object().into_iter().flatten().find_map(|(key, value)| {
                    let word = value.get("const").and_then(Json::as_str)?;
                    Some(format!("`{key} = \"{word}\"`: "))
                });
                let _ =
                    write!(text, "\n{}{}\n\n{}", tag.unwrap_or_default(), description(&way), self.table(path, &way));
            } else {
                let _ = writeln!(text, "* {}: {}", self.value(path, &way), description(&way));
            }
        }
        text.push('\n');
        text
    }

    fn table(&mut self, path: &str, schema: &Map<String, Json>) -> String {
        let named = |list: Option<&Json>, key: &str| {
            list.and_then(Json::as_array).into_iter().flatten().any(|name| name.as_str() == Some(key))
        };
        let mut text = "| key | value | |\n|---|---|---|\n".to_owned();
        for (key, property) in schema["properties"].as_object().into_iter().flatten() {
            let property = self.named(property);
            let whole = self.resolved(&property);
            if whole.contains_key("const") {
                continue;
            }
            let inner = if path == "scene" { key.clone() } else { format!("{path}.{key}") };
            let must = match named(schema.get("required"), key) {
                true => "**required**. ",
                false if named(schema.get("then").and_then(|then| then.get("required")), key) => {
                    "**required** where no tissue gives it. "
                }
                false => "",
            };
            let value = self.value(&inner, property.as_object().unwrap_or(&whole));
            let _ = writeln!(text, "| `{key}` | {value} | {must}{} |", description(&whole));
        }
        text.push('\n');
        text
    }

    /// The kind of value that a schema asks for; what has a section of its own is put in line for it.
    fn value(&mut self, path: &str, schema: &Map<String, Json>) -> String {
        let reference = schema.get("$ref").or_else(|| schema.get("allOf")?.get(0)?.get("$ref")).and_then(Json::as_str);
        if let Some(name) = reference.and_then(|reference| reference.strip_prefix("#/definitions/")) {
            return self.section(path, name);
        }
        if let Some(every) = schema.get("additionalProperties").and_then(Json::as_object) {
            return format!("tables by name: {}", self.value(&format!("{path}.NAME"), every));
        }
        let words: Vec<String> = words(schema).iter().map(|word| format!("`\"{word}\"`")).collect();
        let dimension = schema.get("x-dimension").and_then(Json::as_str);
        let kind = match (dimension, schema.get("type").and_then(Json::as_str)) {
            _ if !words.is_empty() => words.join(", "),
            (Some(dimension), _) => dimension.to_owned(),
            (None, Some("array")) => self.list(path, schema),
            (None, Some("integer")) => "whole number".to_owned(),
            (None, Some("boolean")) => "true or false".to_owned(),
            (None, Some("object")) if schema.contains_key("properties") => self.inline(path, schema),
            (None, Some(other)) => other.to_owned(),
            (None, None) => "any".to_owned(),
        };
        format!("{kind}{}", bounds(schema))
    }

    fn list(&mut self, path: &str, schema: &Map<String, Json>) -> String {
        let bound = |key: &str| schema.get(key).and_then(Json::as_u64);
        let each = match schema.get("items") {
            Some(Json::Array(positions)) => {
                let each = positions.iter().filter_map(Json::as_object).map(|item| self.value(path, item));
                return format!("list: {}", each.collect::<Vec<_>>().join(", then "));
            }
            Some(Json::Object(item)) => self.value(path, &item.clone()),
            _ => "any".to_owned(),
        };
        match (bound("minItems"), bound("maxItems")) {
            (Some(least), Some(most)) if least == most => format!("{least} × {each}"),
            (Some(least), _) if least > 1 => format!("list of {each}, {least} or more"),
            _ => format!("list of {each}"),
        }
    }

    /// A small table that has no section: `{ centre, radius }`.
    fn inline(&mut self, path: &str, schema: &Map<String, Json>) -> String {
        let keys = schema["properties"].as_object().into_iter().flatten().map(|(key, value)| {
            let value = self.resolved(value);
            format!("`{key}`: {}", self.value(&format!("{path}.{key}"), &value))
        });
        format!("table of {}", keys.collect::<Vec<_>>().join("; "))
    }

    /// A link to the section of a definition; short lists of words and plain values need none.
    fn section(&mut self, path: &str, name: &str) -> String {
        let schema = self.resolved(&self.root["definitions"][name]);
        if !schema.contains_key("properties") && ways(&schema).is_empty() {
            return self.value(path, &schema);
        }
        let place = match self.sections.iter().find(|(_, known)| known == name) {
            Some((place, _)) => place.clone(),
            None => {
                self.sections.push((path.to_owned(), name.to_owned()));
                path.to_owned()
            }
        };
        format!("[`{place}`](#{})", anchor(&place))
    }

    /// A property with what it says itself, its reference kept.
    fn named(&self, property: &Json) -> Json {
        let mut whole = property.clone();
        if property.get("description").is_none()
            && let Some(members) = whole.as_object_mut()
            && let Some(text) = self.resolved(property).get("description")
        {
            members.insert("description".into(), text.clone());
        }
        whole
    }

    /// The schema with its references written out; what stands nearer wins.
    fn resolved(&self, schema: &Json) -> Map<String, Json> {
        let mut whole = schema.as_object().cloned().unwrap_or_default();
        let references = whole.remove("$ref").into_iter();
        let parts = whole.remove("allOf").and_then(|all| all.as_array().cloned()).unwrap_or_default();
        let referenced = references.filter_map(|path| self.root.pointer(path.as_str()?.strip_prefix('#')?).cloned());
        for part in referenced.chain(parts).collect::<Vec<_>>() {
            for (key, value) in self.resolved(&part) {
                whole.entry(key).or_insert(value);
            }
        }
        whole
    }
}

fn ways(schema: &Map<String, Json>) -> Vec<&Json> {
    ["anyOf", "oneOf"].iter().filter_map(|key| schema.get(*key)?.as_array()).flatten().collect()
}

fn words(schema: &Map<String, Json>) -> Vec<&str> {
    let several = schema.get("enum").and_then(Json::as_array).into_iter().flatten();
    schema.get("const").into_iter().chain(several).filter_map(Json::as_str).collect()
}

fn bounds(schema: &Map<String, Json>) -> String {
    let bound = |key: &str| schema.get(key).and_then(Json::as_f64);
    let least = bound("exclusiveMinimum").map(|least| format!(" above {least}"));
    let least = least.or_else(|| bound("minimum").filter(|&least| least != 0.0).map(|least| format!(" from {least}")));
    let most = bound("exclusiveMaximum").map(|most| format!(" below {most}"));
    let most = most.or_else(|| bound("maximum").map(|most| format!(" to {most}")));
    let both = [least, most].into_iter().flatten().collect::<String>();
    if both.is_empty() { both } else { format!(",{both}") }
}

fn description(schema: &Map<String, Json>) -> String {
    let text = schema.get("description").and_then(Json::as_str).unwrap_or_default();
    text.replace('\n', " ").replace('|', "\\|")
}

fn anchor(path: &str) -> String {
    path.to_lowercase().replace('.', "-")
}

//! How the check speaks of schemas and tables.

use std::fmt::Display;

use serde_json::{Map, Value as Json};

use super::{dimension, names};
use crate::document::Node;
use crate::unit::with_article;

/// "a length", "a list of 3 forces", "a region": what a schema asks for.
pub(super) fn describe(schema: &Map<String, Json>, title: &str) -> String {
    if let Some(dimension) = dimension(schema) {
        return dimension.with_article();
    }
    let words = names(schema);
    if !words.is_empty() {
        return format!("\"{}\"", words.join("\" or \""));
    }
    match schema.get("type").and_then(Json::as_str) {
        Some("number") => "a number".into(),
        Some("integer") => "a whole number".into(),
        Some("string") => "a string".into(),
        Some("boolean") => "true or false".into(),
        Some("array") => describe_list(schema),
        Some("object") if schema.contains_key("title") => format!("a table ({title})"),
        Some("object") => "a table".into(),
        _ => with_article(title),
    }
}

fn describe_list(schema: &Map<String, Json>) -> String {
    let bound = |key: &str| schema.get(key).and_then(Json::as_u64);
    let plural = match schema.get("items") {
        Some(Json::Object(items)) => match (dimension(items), items.get("type").and_then(Json::as_str)) {
            (Some(dimension), _) => match dimension.name.strip_suffix('y') {
                Some(stem) => format!("{stem}ies"),
                None => format!("{}s", dimension.name),
            },
            (None, Some("number")) => "numbers".into(),
            (None, Some("integer")) => "whole numbers".into(),
            _ => "entries".into(),
        },
        _ => "entries".into(),
    };
    match (bound("minItems"), bound("maxItems")) {
        (Some(least), Some(most)) if least == most => format!("a list of {least} {plural}"),
        (Some(least), _) if least > 0 => format!("a list of {least} or more {plural}"),
        _ => "a list".into(),
    }
}

/// "a law of kind `linear`", "a body": what a table is called.
pub(super) fn subject(title: &str, node: &Node) -> String {
    let word = |key: &str| node.child(key).and_then(Node::text);
    match (word("kind"), word("generate")) {
        (Some(kind), _) => format!("{} of kind `{kind}`", with_article(title)),
        (_, Some(shape)) => format!("{} `{shape}`", with_article(title)),
        _ => with_article(title),
    }
}

/// "an instrument of kind `probe` knows: path, radius, …", "a law knows: young, poisson, …" where one schema is that of every kind.
pub(super) fn known_list(schema: &Map<String, Json>, title: &str, node: &Node) -> String {
    let properties = || schema.get("properties").and_then(Json::as_object).into_iter().flatten();
    let keys: Vec<_> = properties().map(|(key, _)| key.as_str()).filter(|key| *key != "kind").collect();
    let is_of_kind = properties().any(|(_, schema)| schema.get("const").is_some());
    let subject = if is_of_kind { subject(title, node) } else { with_article(title) };
    format!("{subject} knows: {}", keys.join(", "))
}

/// The name that a word is, or that a misspelt or shortened one comes nearest to, if any is near.
pub fn closest(word: &str, names: &[String]) -> Option<String> {
    if names.iter().any(|name| name == word) {
        return Some(word.to_owned());
    }
    if let Some(name) = names.iter().find(|name| word.len() >= 3 && name.starts_with(&word.to_lowercase())) {
        return Some(name.clone());
    }
    let distance = |name: &str| strsim::damerau_levenshtein(&word.to_lowercase(), name);
    let (distance, name) = names.iter().map(|name| (distance(name), name)).min_by_key(|pair| pair.0)?;
    // One letter in three may be wrong.
    (distance <= (name.chars().count() / 3).max(1)).then(|| name.clone())
}

/// "`a`, `b`".
pub(super) fn quoted<S: Display>(names: &[S]) -> String {
    let names: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

//! Values that may be written in several ways: finding the way that is meant.

use std::cmp::Reverse;

use serde_json::{Map, Value as Json};

use super::wording::{closest, describe};
use super::{At, Check, Finding, accepts, names, strings};
use crate::document::{Node, Value};
use crate::unit::with_article;

/// One way, and what it is called.
type Way = (Map<String, Json>, String);

impl Check<'_> {
    /// Checks a value against the alternative that it comes nearest to.
    pub(super) fn choice(&self, node: &Node, schema: &Map<String, Json>, at: &At) -> Vec<Finding> {
        let mut ways = Vec::new();
        self.ways(schema, at.title, &mut ways);
        let possible: Vec<&Way> = ways.iter().filter(|(way, _)| accepts(way, node)).collect();
        match &node.value {
            _ if possible.is_empty() => {
                let mut kinds: Vec<String> = Vec::new();
                for (way, title) in &ways {
                    let kind = describe(way, title);
                    if !kinds.contains(&kind) {
                        kinds.push(kind);
                    }
                }
                let own = schema.get("title").is_some().then(|| with_article(at.title));
                let expected = own.unwrap_or_else(|| kinds.join(" or "));
                let help = format!("write {}", kinds.join(", or "));
                vec![self.refuse(node, at, format!("expected {expected}, found {}", node.describe()), help)]
            }
            Value::Text(text) => self.word(node, text, &possible, at),
            Value::Table(_) => self.table_of(node, &possible, at),
            _ => self.nearest(node, &possible, at),
        }
    }

    /// All alternatives, nested ones included, without their own alternatives.
    fn ways(&self, schema: &Map<String, Json>, title: &str, ways: &mut Vec<Way>) {
        let title = schema.get("title").and_then(Json::as_str).unwrap_or(title);
        let mut nested = Vec::new();
        for keyword in ["anyOf", "oneOf"] {
            nested.extend(schema.get(keyword).and_then(Json::as_array).into_iter().flatten());
        }
        if nested.is_empty() {
            return ways.push((schema.clone(), title.to_owned()));
        }
        for way in nested {
            self.ways(&self.resolved(way), title, ways);
        }
    }

    /// The words that a schema allows, by any of its alternatives.
    pub(super) fn words(&self, schema: &Json) -> Vec<String> {
        let mut ways = Vec::new();
        self.ways(&self.resolved(schema), "", &mut ways);
        ways.iter().flat_map(|(way, _)| names(way)).collect()
    }

    fn word(&self, node: &Node, text: &str, possible: &[&Way], at: &At) -> Vec<Finding> {
        let words: Vec<String> = possible.iter().flat_map(|(way, _)| names(way)).collect();
        if words.iter().any(|word| word == text) {
            return Vec::new();
        }
        let free = possible.iter().find(|(way, _)| names(way).is_empty());
        let Some((way, title)) = free else {
            let mut all = Map::new();
            all.insert("enum".into(), words.into());
            return self.text(node, text, &all, at);
        };
        let mut findings = self.single(node, way, &At { title, ..*at }, &[]);
        if let (Some(finding), false) = (findings.first_mut(), words.is_empty()) {
            finding.error.help.push_str(&format!(", or \"{}\"", words.join("\", \"")));
        }
        findings
    }

    /// A table shows what it is by its tag (`kind = "…"`), or else by the keys that only one alternative needs.
    fn table_of(&self, node: &Node, possible: &[&Way], at: &At) -> Vec<Finding> {
        let mut left = possible.to_vec();
        let tags: Vec<&str> = left.iter().flat_map(|(way, _)| tags(way)).map(|(key, _)| key).collect();
        let tag = tags.iter().find_map(|&tag| Some((tag, node.child(tag)?)));
        if let Some((tag, value)) = tag {
            left.retain(|(way, _)| tags_of(way, tag).is_some());
            let words: Vec<String> = left.iter().filter_map(|(way, _)| tags_of(way, tag)).collect();
            left.retain(|(way, _)| tags_of(way, tag).as_deref() == value.text());
            if left.is_empty() {
                let mut all = Map::new();
                all.insert("enum".into(), words.into());
                all.insert("type".into(), "string".into());
                return self.single(value, &all, &At { key: tag, depth: at.depth + 1, ..*at }, &[]);
            }
        }
        let score =
            |way: &Map<String, Json>| strings(way.get("required")).filter(|key| node.child(key).is_some()).count();
        if let (None, [_, _, ..], Some(&tag)) = (tag, &left[..], tags.first()) {
            let words: Vec<String> = left.iter().filter_map(|(way, _)| tags_of(way, tag)).collect();
            if words.len() == left.len() {
                let message = format!("missing key `{tag}` in {}", with_article(at.title));
                return vec![self.refuse(node, at, message, format!("known: {}", words.join(", ")))];
            }
        }
        let best = left.iter().map(|(way, _)| score(way)).max().unwrap_or(0);
        if left.len() > 1 && best == 0 {
            return self.no_way(node, &left, at);
        }
        let Some((chosen, title)) = left.iter().find(|(way, _)| score(way) == best) else { return Vec::new() };
        let rivals: Vec<String> = possible.iter().flat_map(|(way, _)| keys(way)).collect();
        self.single(node, chosen, &At { title, ..*at }, &rivals)
    }

    /// The table has none of the keys that would tell what it is.
    fn no_way(&self, node: &Node, ways: &[&Way], at: &At) -> Vec<Finding> {
        let mut telling: Vec<String> = Vec::new();
        for (way, _) in ways {
            let tag = tags(way).next().map(|(key, _)| key.to_owned());
            let key = tag.or_else(|| strings(way.get("required")).next().map(str::to_owned));
            telling.extend(key.filter(|key| !telling.contains(key)));
        }
        let advice = format!("{} has one of the keys: {}", with_article(at.title), telling.join(", "));
        let all: Vec<String> = ways.iter().flat_map(|(way, _)| keys(way)).collect();
        match node.entries().iter().find(|entry| !all.contains(&entry.key)) {
            Some(entry) => {
                let guess =
                    closest(&entry.key, &telling).map_or(String::new(), |key| format!(", did you mean `{key}`?"));
                let message = format!("unknown key `{}`{guess}", entry.key);
                vec![Finding { error: self.document.error(&entry.key_span, message, advice), depth: at.depth }]
            }
            None => {
                let message = format!("missing key in {}", with_article(at.title));
                vec![self.refuse(node, at, message, advice)]
            }
        }
    }

    /// Lists and numbers: the alternative whose errors lie deepest, and then the one with the fewest.
    fn nearest(&self, node: &Node, possible: &[&Way], at: &At) -> Vec<Finding> {
        let tried = possible.iter().map(|(way, title)| self.single(node, way, &At { title, ..*at }, &[]));
        let rank = |findings: &Vec<Finding>| {
            let shallowest = findings.iter().map(|finding| finding.depth).min().unwrap_or(usize::MAX);
            (shallowest, Reverse(findings.len()))
        };
        tried.max_by_key(rank).unwrap_or_default()
    }
}

/// Keys that must hold one certain word.
fn tags(way: &Map<String, Json>) -> impl Iterator<Item = (&str, &str)> {
    let properties = way.get("properties").and_then(Json::as_object);
    properties.into_iter().flatten().filter_map(|(key, schema)| Some((key.as_str(), schema.get("const")?.as_str()?)))
}

fn tags_of(way: &Map<String, Json>, tag: &str) -> Option<String> {
    tags(way).find(|(key, _)| *key == tag).map(|(_, word)| word.to_owned())
}

fn keys(way: &Map<String, Json>) -> impl Iterator<Item = String> {
    way.get("properties").and_then(Json::as_object).into_iter().flatten().map(|(key, _)| key.clone())
}

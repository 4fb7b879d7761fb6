//! The check of a document against the schema: every key, type, unit and range, each refusal with its place.

mod choice;
mod wording;

use serde_json::{Map, Value as Json};

use crate::document::{Document, Entry, Node, Value};
use crate::error::SceneError;
use crate::unit::{Dimension, with_article};
pub use wording::closest;
use wording::{describe, known_list, quoted};

/// Everything in the document that the schema does not allow.
pub(crate) fn check(document: &Document, schema: &Json) -> Vec<SceneError> {
    let check = Check { document, root: schema };
    let findings = check.node(&document.root, schema, &At { title: "scene", key: "", depth: 0 });
    findings.into_iter().map(|finding| finding.error).collect()
}

struct Check<'a> {
    document: &'a Document,
    root: &'a Json,
}

/// A refusal, and how deep in the document it lies.
struct Finding {
    error: SceneError,
    depth: usize,
}

/// Where the check is: what the surrounding schema is called, the key that led here, and how deep it lies.
#[derive(Clone, Copy)]
struct At<'a> {
    title: &'a str,
    key: &'a str,
    depth: usize,
}

impl Check<'_> {
    fn node(&self, node: &Node, schema: &Json, at: &At) -> Vec<Finding> {
        let schema = self.resolved(schema);
        // A table without a title of its own is called by its key: "a sphere".
        let own = schema.get("title").and_then(Json::as_str);
        let title = own.unwrap_or(if schema.contains_key("properties") { at.key } else { at.title }).to_owned();
        let at = At { title: &title, ..*at };
        if schema.contains_key("anyOf") || schema.contains_key("oneOf") {
            return self.choice(node, &schema, &at);
        }
        self.single(node, &schema, &at, &[])
    }

    /// Checks against a schema without alternatives; `rivals` are keys of the alternatives that were not chosen.
    fn single(&self, node: &Node, schema: &Map<String, Json>, at: &At, rivals: &[String]) -> Vec<Finding> {
        if !accepts(schema, node) {
            let help = self.as_kind(node, schema, at).or_else(|| dimension(schema).map(Dimension::advice));
            return vec![self.refuse(
                node,
                at,
                format!("expected {}, found {}", describe(schema, at.title), node.describe()),
                help.unwrap_or_default(),
            )];
        }
        match &node.value {
            Value::Text(text) => self.text(node, text, schema, at),
            Value::Integer(integer) => self.number(node, *integer as f64, schema, at),
            Value::Number(number) => self.number(node, *number, schema, at),
            Value::List(items) => self.list(node, items, schema, at),
            Value::Table(entries) => self.table(node, entries, schema, at, rivals),
            Value::Boolean(_) | Value::Date(_) => Vec::new(),
        }
    }

    fn refuse(&self, node: &Node, at: &At, message: impl Into<String>, help: impl Into<String>) -> Finding {
        Finding { error: self.document.error(&node.span, message, help), depth: at.depth }
    }

    fn text(&self, node: &Node, text: &str, schema: &Map<String, Json>, at: &At) -> Vec<Finding> {
        let names = names(schema);
        if let Some(dimension) = dimension(schema) {
            return match dimension.parse(text) {
                Ok(value) => self.number(node, value, schema, at),
                Err(error) => vec![self.refuse(node, at, error.to_string(), dimension.advice())],
            };
        }
        if names.is_empty() || names.iter().any(|name| name == text) {
            return Vec::new();
        }
        let guess = closest(text, &names).map_or(String::new(), |name| format!(", did you mean `{name}`?"));
        let message = format!("unknown value `{text}` for `{}`{guess}", at.key);
        vec![self.refuse(node, at, message, format!("known: {}", names.join(", ")))]
    }

    fn number(&self, node: &Node, value: f64, schema: &Map<String, Json>, at: &At) -> Vec<Finding> {
        let unit = dimension(schema).map_or(String::new(), |dimension| format!(" {}", dimension.si()));
        let bound = |key: &str| schema.get(key).and_then(Json::as_f64);
        // Node numbers and counts are kept in 32 bits.
        let largest = schema.get("format").is_some_and(|format| format == "uint32").then_some(f64::from(u32::MAX));
        let problem = if !value.is_finite() {
            Some("a finite number".to_owned())
        } else if let Some(limit) = bound("exclusiveMinimum").filter(|&limit| value <= limit) {
            Some(format!("above {limit}{unit}"))
        } else if let Some(limit) = bound("minimum").filter(|&limit| value < limit) {
            Some(format!("{limit}{unit} or more"))
        } else if let Some(limit) = bound("exclusiveMaximum").filter(|&limit| value >= limit) {
            Some(format!("below {limit}{unit}"))
        } else {
            bound("maximum").or(largest).filter(|&limit| value > limit).map(|limit| format!("{limit}{unit} or less"))
        };
        let Some(problem) = problem else { return Vec::new() };
        let subject = if at.key.is_empty() { "the number".to_owned() } else { format!("`{}`", at.key) };
        let help = match at.key {
            "poisson" if value == 0.5 => "0.5 makes lambda infinite: take 0.49 for nearly incompressible tissue",
            "poisson" => "soft tissue lies between 0.4 and 0.49",
            _ => "",
        };
        vec![self.refuse(node, at, format!("{subject} is {value}{unit}, and must be {problem}"), help)]
    }

    fn list(&self, node: &Node, items: &[Node], schema: &Map<String, Json>, at: &At) -> Vec<Finding> {
        let bound = |key: &str| schema.get(key).and_then(Json::as_u64).map(|count| count as usize);
        let least = bound("minItems").unwrap_or(0);
        if items.len() < least || bound("maxItems").is_some_and(|most| items.len() > most) {
            let message = format!("expected {}, found {}", describe(schema, at.title), node.describe());
            return vec![self.refuse(node, at, message, "")];
        }
        let inner = At { depth: at.depth + 1, ..*at };
        let each = |index: usize| match &schema["items"] {
            Json::Array(positions) => positions.get(index),
            every => Some(every),
        };
        if !schema.contains_key("items") {
            return Vec::new();
        }
        let pairs = items.iter().enumerate().filter_map(|(index, item)| Some((item, each(index)?)));
        pairs.flat_map(|(item, schema)| self.node(item, schema, &inner)).collect()
    }

    fn table(
        &self,
        node: &Node,
        entries: &[Entry],
        schema: &Map<String, Json>,
        at: &At,
        rivals: &[String],
    ) -> Vec<Finding> {
        let empty = Map::new();
        let properties = schema.get("properties").and_then(Json::as_object).unwrap_or(&empty);
        let known: Vec<String> = properties.keys().cloned().collect();
        if let Some(every) = schema.get("additionalProperties").filter(|every| every.is_object()) {
            return self.named_tables(entries, every, at);
        }
        let mut findings = Vec::new();
        let mut meant = Vec::new();
        for Entry { key, key_span, node: value } in entries {
            let inner = At { title: at.title, key, depth: at.depth + 1 };
            if let Some(schema) = properties.get(key) {
                findings.extend(self.node(value, schema, &inner));
            } else if rivals.contains(key) {
                let present: Vec<_> =
                    entries.iter().map(|entry| &entry.key).filter(|key| known.contains(key)).collect();
                let message = format!("`{key}` does not go together with {}", quoted(&present));
                let help =
                    if known.len() == 1 { "keep one of the two".into() } else { known_list(schema, at.title, node) };
                findings.push(Finding { error: self.document.error(key_span, message, help), depth: at.depth });
            } else {
                let missing: Vec<_> = known.iter().filter(|name| node.child(name).is_none()).cloned().collect();
                let guess = closest(key, &missing);
                meant.extend(guess.clone());
                let of_scene = if guess.is_none() && at.depth > 0 { self.key_of_scene(key) } else { None };
                let guess = guess.map_or(String::new(), |name| format!(", did you mean `{name}`?"));
                let message = format!("unknown key `{key}`{guess}");
                let help = of_scene.unwrap_or_else(|| known_list(schema, at.title, node));
                let error = self.document.error(key_span, message, help);
                findings.push(Finding { error, depth: at.depth });
            }
        }
        // A misspelt key is reported once, not as missing too.
        let present = |key: &str| node.child(key).is_some() || meant.iter().any(|name| name == key);
        // What a tissue may give instead, it has given by now.
        let given_otherwise = strings(schema.get("then").and_then(|then| then.get("required")));
        for key in strings(schema.get("required")).chain(given_otherwise).filter(|key| !present(key)) {
            let schema = self.resolved(&properties[key]);
            let help = match schema.get("description").and_then(Json::as_str) {
                Some(description) => description.replace('\n', " "),
                None => format!("it is {}", describe(&schema, key)),
            };
            let message = format!("missing key `{key}` in {}", wording::subject(at.title, node));
            findings.push(self.refuse(node, at, message, help));
        }
        for (_, groups) in schema.iter().filter(|(keyword, _)| keyword.starts_with("x-exactly-one-of")) {
            findings.extend(self.exactly_one(node, entries, groups, at, &present));
        }
        findings
    }

    /// How to write a word as the table of its kind that is asked for.
    fn as_kind(&self, node: &Node, schema: &Map<String, Json>, at: &At) -> Option<String> {
        let word = node.text()?;
        let kind = closest(word, &self.words(schema.get("properties")?.get("kind")?))?;
        Some(format!("write {} = {{ kind = \"{kind}\" }}", at.key))
    }

    /// Where a key belongs that stands behind the head of a table, and is one of the scene itself; not of its tables of named tables, which have
    /// heads of their own.
    fn key_of_scene(&self, key: &str) -> Option<String> {
        let scene = self.resolved(self.root);
        let has_names = |schema: &Json| self.resolved(schema).get("additionalProperties").is_some_and(Json::is_object);
        let keys = scene.get("properties")?.as_object()?.iter().filter(|(_, schema)| !has_names(schema));
        let name = closest(key, &keys.map(|(key, _)| key.clone()).collect::<Vec<_>>())?;
        Some(format!("`{name}` is a key of the scene: write it above the first [table]"))
    }

    /// A table of tables under names that the user chooses, such as bodies.
    fn named_tables(&self, entries: &[Entry], every: &Json, at: &At) -> Vec<Finding> {
        let whole = self.resolved(every);
        let title = whole.get("title").and_then(Json::as_str).unwrap_or(at.title);
        let keys = whole.get("properties").and_then(Json::as_object);
        let inner = At { title, key: "", depth: at.depth + 1 };
        if let Some(entry) = entries.iter().find(|entry| keys.is_some_and(|keys| keys.contains_key(&entry.key))) {
            let message = format!("`{}` is a key of {}, whose name is missing", entry.key, with_article(title));
            let help = format!("write the table as [{}.NAME]", at.key);
            return vec![Finding { error: self.document.error(&entry.key_span, message, help), depth: at.depth }];
        }
        entries.iter().flat_map(|entry| self.node(&entry.node, every, &inner)).collect()
    }

    /// Of several groups of keys, one must be given whole and the others not at all.
    fn exactly_one(
        &self,
        node: &Node,
        entries: &[Entry],
        groups: &Json,
        at: &At,
        present: &dyn Fn(&str) -> bool,
    ) -> Option<Finding> {
        let groups: Vec<Vec<&str>> =
            groups.as_array().into_iter().flatten().map(|group| strings(Some(group)).collect()).collect();
        let ways: Vec<String> = groups.iter().map(|group| quoted(group).replace(", ", " with ")).collect();
        let advice = format!("give one of: {}", ways.join("; "));
        let begun: Vec<_> = groups.iter().filter(|group| group.iter().any(|key| present(key))).collect();
        match begun[..] {
            [] => {
                let message = format!("missing key in {}", wording::subject(at.title, node));
                Some(self.refuse(node, at, message, advice))
            }
            [group] => {
                let missing = group.iter().find(|key| !present(key))?;
                let given: Vec<_> = group.iter().filter(|key| present(key)).collect();
                let message = format!("missing key `{missing}`, which goes together with {}", quoted(&given));
                Some(self.refuse(node, at, message, advice))
            }
            [first, second, ..] => {
                let entry = entries.iter().find(|entry| second.contains(&entry.key.as_str()))?;
                let kept: Vec<_> = first.iter().filter(|key| present(key)).collect();
                let message = format!("`{}` does not go together with {}", entry.key, quoted(&kept));
                Some(Finding { error: self.document.error(&entry.key_span, message, advice), depth: at.depth })
            }
        }
    }

    /// The schema with its references and `allOf` written out; what stands nearer wins.
    fn resolved(&self, schema: &Json) -> Map<String, Json> {
        let mut whole = schema.as_object().cloned().unwrap_or_default();
        let mut parts: Vec<Json> = whole.remove("$ref").map(|path| self.referenced(&path)).into_iter().collect();
        if let Some(Json::Array(all)) = whole.remove("allOf") {
            parts.extend(all);
        }
        for part in parts {
            for (key, value) in self.resolved(&part) {
                whole.entry(key).or_insert(value);
            }
        }
        whole
    }

    fn referenced(&self, path: &Json) -> Json {
        let pointer = path.as_str().and_then(|path| path.strip_prefix('#')).unwrap_or_default();
        self.root.pointer(pointer).cloned().unwrap_or_default()
    }
}

/// Whether the value has a type that the schema allows.
fn accepts(schema: &Map<String, Json>, node: &Node) -> bool {
    let names: &[&str] = match &node.value {
        Value::Text(_) => &["string"],
        Value::Integer(_) => &["integer", "number"],
        Value::Number(_) => &["number"],
        Value::Boolean(_) => &["boolean"],
        Value::List(_) => &["array"],
        Value::Table(_) => &["object"],
        Value::Date(_) => &[],
    };
    match schema.get("type") {
        Some(Json::Array(types)) => types.iter().any(|name| names.iter().any(|known| name == known)),
        Some(name) => names.iter().any(|known| name == known),
        None => schema.get("const").or(schema.get("enum")).is_some() && node.text().is_some(),
    }
}

/// The words that a schema of strings allows; empty where it allows any.
fn names(schema: &Map<String, Json>) -> Vec<String> {
    let constant = schema.get("const").and_then(Json::as_str);
    constant.into_iter().chain(strings(schema.get("enum"))).map(str::to_owned).collect()
}

fn strings(list: Option<&Json>) -> impl Iterator<Item = &str> {
    list.and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str)
}

fn dimension(schema: &Map<String, Json>) -> Option<&'static Dimension> {
    schema.get("x-dimension").and_then(Json::as_str).and_then(Dimension::named)
}

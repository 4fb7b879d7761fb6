//! The text of a scene as a tree in which every key and value knows where it stands.

use std::ops::Range;

use serde_json::Value as Json;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{Place, SceneError, SceneErrors};

/// Bytes of one of the document's sources: the file, or an override.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Span {
    source: usize,
    bytes: Range<usize>,
}

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) span: Span,
}

/// What TOML knows, less its dates, which no scene needs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    Number(f64),
    Boolean(bool),
    Date(String),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key with its own place, and its value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_span: Span,
    pub(crate) node: Node,
}

/// A scene's text and its overrides.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Document {
    /// Name and text of the file, then of every override.
    sources: Vec<(String, String)>,
    pub(crate) root: Node,
}

impl Document {
    pub(crate) fn parse(name: &str, text: &str) -> Result<Self, SceneErrors> {
        let (table, errors) = DeTable::parse_recoverable(text);
        let errors = errors.iter().map(|error| {
            let span = error.span().unwrap_or(0..0);
            let message = error.message();
            SceneError {
                // The parser says "duplicate key" and leaves the name to the line shown.
                message: match message {
                    "duplicate key" => format!("duplicate key `{}`", text.get(span.clone()).unwrap_or_default()),
                    other => other.replace('\n', "; "),
                },
                help: match message {
                    "duplicate key" => "the table has this key already; keep one of the two".into(),
                    _ => String::new(),
                },
                place: Some(Box::new(Place::new(name, text, span))),
            }
        });
        SceneErrors::unless_empty(errors.collect())?;
        let root = Node::from_toml(&Spanned::new(table.span(), DeValue::Table(table.into_inner())), 0);
        Ok(Self { sources: vec![(name.to_owned(), text.to_owned())], root })
    }

    /// Puts `value` under the dotted key, as `--set key=value` does. Errors about it point at the override.
    pub(crate) fn set(&mut self, key: &str, value: &str) -> Result<(), SceneErrors> {
        let text = format!("{key} = {value}");
        let source = self.sources.len();
        let start = key.len() + 3;
        // "8 kPa" is no TOML value, and a shell eats quotes: what does not parse as TOML is a string.
        let node = match DeValue::parse(value) {
            Ok(parsed) => Node::from_toml(&parsed, source).shifted(start),
            Err(_) => {
                Node { value: Value::Text(value.trim().to_owned()), span: Span { source, bytes: start..text.len() } }
            }
        };
        self.sources.push(("--set".to_owned(), text));
        let mut at = 0;
        let mut slot = &mut self.root;
        let mut before: Option<&str> = None;
        for part in key.split('.') {
            let key_span = Span { source, bytes: at..at + part.len() };
            at += part.len() + 1;
            let place = Place::new("--set", &format!("{key} = {value}"), key_span.bytes.clone());
            let refuse = |message: String, help: &str| {
                SceneErrors::from(SceneError { message, help: help.to_owned(), place: Some(Box::new(place)) })
            };
            if part.is_empty() {
                return Err(refuse("a part of the key is empty".into(), "write it like body.liver.law.young"));
            }
            slot = match &mut slot.value {
                Value::Table(entries) => {
                    let found = entries.iter().position(|entry| entry.key == part);
                    let index = found.unwrap_or_else(|| {
                        let node = Node { value: Value::Table(Vec::new()), span: key_span.clone() };
                        entries.push(Entry { key: part.to_owned(), key_span, node });
                        entries.len() - 1
                    });
                    &mut entries[index].node
                }
                Value::List(items) => {
                    let count = items.len();
                    part.parse().ok().and_then(|index: usize| items.get_mut(index)).ok_or_else(|| {
                        refuse(
                            format!("`{part}` is no place in the list"),
                            &format!("the list has {count} entries, counted from 0"),
                        )
                    })?
                }
                _ => {
                    return Err(refuse(
                        format!("`{}` is not a table, so it has no key `{part}`", before.unwrap_or_default()),
                        "end the key before it to replace the value",
                    ));
                }
            };
            before = Some(part);
        }
        *slot = node;
        Ok(())
    }

    /// The error `message` at `span`.
    pub(crate) fn error(&self, span: &Span, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        let (name, text) = &self.sources[span.source];
        let place = Some(Box::new(Place::new(name, text, span.bytes.clone())));
        SceneError { message: message.into(), help: help.into(), place }
    }

    /// The error `message` at the value that the path leads to, or as far towards it as the document goes.
    pub(crate) fn error_at(&self, path: &[&str], message: impl Into<String>, help: impl Into<String>) -> SceneError {
        let mut node = &self.root;
        for part in path {
            match node.child(part) {
                Some(child) => node = child,
                None => break,
            }
        }
        self.error(&node.span, message, help)
    }
}

impl Node {
    fn from_toml(spanned: &Spanned<DeValue>, source: usize) -> Self {
        let value = match spanned.get_ref() {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(small) => Value::Integer(small),
                Err(_) => Value::Number(integer.as_str().parse().unwrap_or(f64::INFINITY)),
            },
            DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(truth) => Value::Boolean(*truth),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => Value::List(items.iter().map(|item| Self::from_toml(item, source)).collect()),
            DeValue::Table(table) => Value::Table(
                table
                    .iter()
                    .map(|(key, value)| Entry {
                        key: key.get_ref().to_string(),
                        key_span: Span { source, bytes: key.span() },
                        node: Self::from_toml(value, source),
                    })
                    .collect(),
            ),
        };
        Self { value, span: Span { source, bytes: spanned.span() } }
    }

    /// The same node, its text `offset` bytes further on.
    fn shifted(mut self, offset: usize) -> Self {
        let shift = |span: &mut Span| span.bytes = span.bytes.start + offset..span.bytes.end + offset;
        shift(&mut self.span);
        self.value = match self.value {
            Value::List(items) => Value::List(items.into_iter().map(|item| item.shifted(offset)).collect()),
            Value::Table(mut entries) => {
                for entry in &mut entries {
                    shift(&mut entry.key_span);
                    entry.node = entry.node.clone().shifted(offset);
                }
                Value::Table(entries)
            }
            other => other,
        };
        self
    }

    /// The value of a key, or the entry of a list by its number.
    pub(crate) fn child(&self, part: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == part).map(|entry| &entry.node),
            Value::List(items) => items.get(part.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub(crate) fn child_mut(&mut self, part: &str) -> Option<&mut Node> {
        match &mut self.value {
            Value::Table(entries) => entries.iter_mut().find(|entry| entry.key == part).map(|entry| &mut entry.node),
            Value::List(items) => items.get_mut(part.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// The values of a table or list, to be changed.
    pub(crate) fn children_mut(&mut self) -> Vec<&mut Node> {
        match &mut self.value {
            Value::Table(entries) => entries.iter_mut().map(|entry| &mut entry.node).collect(),
            Value::List(items) => items.iter_mut().collect(),
            _ => Vec::new(),
        }
    }

    /// Puts a value under a key of a table that has none there.
    pub(crate) fn put_if_absent(&mut self, key: &str, node: Node) {
        if let Value::Table(entries) = &mut self.value
            && entries.iter().all(|entry| entry.key != key)
        {
            entries.push(Entry { key: key.to_owned(), key_span: node.span.clone(), node });
        }
    }

    pub(crate) fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    pub(crate) fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// What a message calls the value.
    pub(crate) fn describe(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("the string \"{text}\""),
            Value::Integer(integer) => format!("the number {integer}"),
            Value::Number(number) => format!("the number {number}"),
            Value::Boolean(truth) => format!("`{truth}`"),
            Value::Date(date) => format!("the date {date}"),
            Value::List(items) if items.len() == 1 => "a list of 1 entry".into(),
            Value::List(items) => format!("a list of {} entries", items.len()),
            Value::Table(_) => "a table".into(),
        }
    }

    /// The plain data, for the typed scene.
    pub(crate) fn to_json(&self) -> Json {
        match &self.value {
            Value::Text(text) | Value::Date(text) => text.as_str().into(),
            Value::Integer(integer) => (*integer).into(),
            Value::Number(number) => (*number).into(),
            Value::Boolean(truth) => (*truth).into(),
            Value::List(items) => items.iter().map(Self::to_json).collect(),
            Value::Table(entries) => {
                Json::Object(entries.iter().map(|entry| (entry.key.clone(), entry.node.to_json())).collect())
            }
        }
    }
}

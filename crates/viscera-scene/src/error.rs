//! What is wrong with a scene, and where.

use std::fmt;
use std::ops::Range;

/// One thing that is wrong in a scene: what, where, and how to mend it.
///
/// `Display` shows the line itself, without colour:
///
/// ```text
/// error: unknown key `youngs`, did you mean `young`?
///   ┌─ scenes/liver.toml:12:3
/// 12 │   youngs = "5 kPa"
///    │   ^^^^^^ a law knows: young, poisson, lambda, mu, fibre, tissue
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", render(self))]
pub struct SceneError {
    /// What is wrong, in one line.
    pub message: String,
    /// How to mend it; may be empty.
    pub help: String,
    /// Where it stands; absent where there is no text, such as a scene file that cannot be read.
    pub place: Option<Box<Place>>,
}

/// A stretch of one line of a scene's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, or the override (`--set`).
    pub source: String,
    /// Bytes of the offending text in its source.
    pub span: Range<usize>,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// The text of the line.
    pub text: String,
    /// How many characters of the line are meant, at least 1.
    pub width: usize,
}

impl SceneError {
    /// An error that has no place in a text.
    pub fn without_place(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { message: message.into(), help: help.into(), place: None }
    }

    /// Line and column, from 1, where there is a place.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        self.place.as_ref().map(|place| (place.line, place.column))
    }
}

impl Place {
    /// The place of the bytes `span` in `text`.
    pub(crate) fn new(source: &str, text: &str, span: Range<usize>) -> Self {
        let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let (start, end) = (boundary(span.start), boundary(span.end));
        let begin = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let finish = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let width = text[start..end.clamp(start, finish)].chars().count().max(1);
        Self {
            source: source.to_owned(),
            line: text[..begin].matches('\n').count() + 1,
            column: text[begin..start].chars().count() + 1,
            text: text[begin..finish].trim_end().to_owned(),
            width,
            span,
        }
    }
}

fn render(error: &SceneError) -> String {
    let SceneError { message, help, place } = error;
    let Some(place) = place else {
        return if help.is_empty() { format!("error: {message}") } else { format!("error: {message}\n  {help}") };
    };
    let number = place.line.to_string();
    let gutter = " ".repeat(number.len());
    // Tabs are kept, so that the carets stand under what they mean however wide a tab is shown.
    let indent: String =
        place.text.chars().take(place.column - 1).map(|letter| if letter == '\t' { '\t' } else { ' ' }).collect();
    let indent = format!("{indent:<width$}", width = place.column - 1);
    let carets = "^".repeat(place.width);
    let pointer = format!("{indent}{carets} {help}");
    format!(
        "error: {message}\n {gutter}┌─ {}:{}:{}\n{number} │ {}\n{gutter} │ {}",
        place.source,
        place.line,
        place.column,
        place.text,
        pointer.trim_end()
    )
}

/// Everything that is wrong in a scene, in the order of the file; never empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneErrors(Vec<SceneError>);

impl SceneErrors {
    /// The errors, in the order of the file; `Ok` when there is none.
    pub(crate) fn unless_empty(mut errors: Vec<SceneError>) -> Result<(), Self> {
        errors.sort_by_key(|error| error.place.as_ref().map(|place| (place.source.clone(), place.span.start)));
        if errors.is_empty() { Ok(()) } else { Err(Self(errors)) }
    }

    /// The first error.
    pub fn first(&self) -> &SceneError {
        &self.0[0]
    }

    /// All errors.
    pub fn all(&self) -> &[SceneError] {
        &self.0
    }
}

impl From<SceneError> for SceneErrors {
    fn from(error: SceneError) -> Self {
        Self(vec![error])
    }
}

impl std::error::Error for SceneErrors {}

impl fmt::Display for SceneErrors {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let texts: Vec<_> = self.0.iter().map(ToString::to_string).collect();
        formatter.write_str(&texts.join("\n\n"))
    }
}

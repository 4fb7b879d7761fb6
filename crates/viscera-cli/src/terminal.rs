//! What goes to the terminal: results to stdout, complaints to stderr, colour only where a person sees it.
//!
//! Colour is left out where the stream is no terminal, or `NO_COLOR` is set (`anstream` sees to both).

use std::io::{ErrorKind, Write};
use std::sync::OnceLock;

use crate::failure::Failure;

const BOLD: &str = "\x1b[1m";
const RED: &str = "\x1b[1;31m";
const YELLOW: &str = "\x1b[1;33m";
const BLUE: &str = "\x1b[34m";
const PLAIN: &str = "\x1b[0m";

/// The first error of stdout.
static UNSAID: OnceLock<String> = OnceLock::new();

/// Writes a result. A reader that has gone away, as behind `| head`, is no error; other errors are kept for [`all_was_said`].
pub(crate) fn say(text: &str) {
    let mut out = anstream::stdout();
    match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            // The first one counts.
            let _ = UNSAID.set(error.to_string());
        }
        _ => {}
    }
}

/// Fails if a result could not be written, as to a file on a full disk.
pub(crate) fn all_was_said() -> Result<(), Failure> {
    match UNSAID.get() {
        Some(error) => Err(Failure::problem(format!(
            "what this command says could not be written: {error}; make room, or send it to another place"
        ))),
        None => Ok(()),
    }
}

/// Writes what is wrong, or what a person should know.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(anstream::stderr(), "{}", painted(text.trim_end()));
}

/// Text that stands out, as a heading does.
pub(crate) fn heading(text: &str) -> String {
    format!("{BOLD}{text}{PLAIN}")
}

/// A message with its head, the frame of its snippet and its carets in colour.
fn painted(text: &str) -> String {
    text.lines().map(painted_line).collect::<Vec<_>>().join("\n")
}

fn painted_line(line: &str) -> String {
    for (head, colour) in [("error:", RED), ("warning:", YELLOW)] {
        if let Some(rest) = line.strip_prefix(head) {
            return format!("{colour}{head}{PLAIN}{BOLD}{rest}{PLAIN}");
        }
    }
    if line.trim_start().starts_with("┌─") {
        return format!("{BLUE}{line}{PLAIN}");
    }
    match line.split_once(" │ ") {
        Some((gutter, source)) if gutter.trim().chars().all(|letter| letter.is_ascii_digit()) => {
            let source = match source.trim_start().strip_prefix('^') {
                Some(_) if gutter.trim().is_empty() => painted_carets(source),
                _ => source.to_owned(),
            };
            format!("{BLUE}{gutter} │{PLAIN} {source}")
        }
        _ => line.to_owned(),
    }
}

fn painted_carets(line: &str) -> String {
    let start = line.find('^').unwrap_or(0);
    let end = line[start..].find(|letter| letter != '^').map_or(line.len(), |length| start + length);
    format!("{}{RED}{}{PLAIN}{}", &line[..start], &line[start..end], &line[end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_marks_head_frame_and_carets_and_changes_no_letter() {
        let text = "error: unknown key `youngs`\n   ┌─ scene:11:39\n11 │ youngs = 5\n   │ ^^^^^^ knows: young";
        let painted = painted(text);
        assert!(painted.contains("\x1b[1;31merror:"), "{painted:?}");
        assert!(painted.contains("\x1b[1;31m^^^^^^\x1b[0m knows"), "{painted:?}");
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), text);
    }
}

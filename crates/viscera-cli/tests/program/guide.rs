//! The guide against the program: its commands are run, its outputs compared, its tables and links held to what is there.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Desk;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").canonicalize().unwrap()
}

/// Every Markdown file of the book, in any folder of it.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages.extend(self::pages(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(path);
        }
    }
    pages.sort();
    pages
}

/// A file that the program writes is kept as it would write it now; where it is not, the fresh one is put aside to be copied.
fn assert_current(kept: &Path, fresh: &str) {
    let text = fs::read_to_string(kept).unwrap_or_default();
    if text.trim_end() != fresh.trim_end() {
        let aside = std::env::temp_dir().join(kept.file_name().unwrap());
        fs::write(&aside, format!("{}\n", fresh.trim_end())).unwrap();
        let differs = text.lines().zip(fresh.lines()).find(|(kept, fresh)| kept != fresh);
        panic!("{} is out of date, first {differs:#?}: copy {} over it", kept.display(), aside.display());
    }
}

#[test]
fn the_tables_of_tissues_and_keys_are_those_of_the_program() {
    let desk = Desk::new();
    for (name, command) in [("tissues.md", "tissues"), ("scene-keys.md", "schema")] {
        let fresh = desk.viscera(&[command, "--markdown"]).ends_with(0).out;
        assert_current(&docs().join("generated").join(name), &fresh);
    }
}

/// The words of a command line; double quotes keep words together.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quoted = false;
    for letter in line.trim().chars() {
        match letter {
            '"' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            letter => words.last_mut().unwrap().push(letter),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Blocks fenced `sh run` are run in their order, in a folder with the scenes of the chapter; a block fenced `text output`
/// behind one is what the program said.
#[test]
fn the_commands_of_the_guide_say_what_stands_there() {
    let mut ran = 0;
    for page in pages(&docs().join("guide")) {
        let (text, desk) = (fs::read_to_string(&page).unwrap(), Desk::new());
        let mut pieces: Vec<String> = text.split("\n```").map(str::to_owned).collect();
        let mut said = String::new();
        for piece in pieces.iter_mut().skip(1).step_by(2) {
            let (kind, body) = piece.split_once('\n').unwrap_or((piece, ""));
            let (kind, body) = (kind.to_owned(), body.to_owned());
            if let Some(name) = kind.strip_prefix("toml scene ") {
                desk.write(&format!("{name}.toml"), &body);
            } else if let Some(how) = kind.strip_prefix("sh run") {
                for line in body.lines() {
                    let words = words(line);
                    let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
                    assert_eq!(words[0], "viscera", "{}: {line}", page.display());
                    let outcome = desk.viscera(&arguments);
                    assert_eq!(outcome.code == Some(0), how.trim() != "fails", "{line}: {}", outcome.err);
                    said = format!("{}{}", outcome.out, outcome.err);
                    ran += 1;
                }
            } else if kind == "text output" {
                *piece = format!("{kind}\n{}", said.trim_end());
            }
        }
        assert_current(&page, &pieces.join("\n```"));
    }
    assert!(ran >= 4, "only {ran} commands were run: is the scan blind?");
}

/// Commands that are not run are at least known, and so are their options.
#[test]
fn every_command_of_the_book_is_known_with_its_options() {
    let desk = Desk::new();
    let mut looked_at = 0;
    let root = docs().parent().unwrap().to_owned();
    for page in pages(&docs()).into_iter().chain(["README.md", "CONTRIBUTING.md"].map(|name| root.join(name))) {
        let text = fs::read_to_string(&page).unwrap();
        let command = |line| {
            ["    viscera ", "    cargo run --release -- "].iter().find_map(|ahead| str::strip_prefix(line, ahead))
        };
        for line in text.lines().filter_map(command) {
            let line = line.split("  #").next().unwrap_or_default();
            let words = words(line);
            let depth = if ["bench", "mesh"].contains(&words[0].as_str()) { 2 } else { 1 };
            let command: Vec<&str> = words[..depth].iter().map(String::as_str).chain(["--help"]).collect();
            let help = desk.viscera(&command);
            assert_eq!(help.code, Some(0), "{}: {line}: {}", page.display(), help.err);
            for option in words.iter().filter(|word| word.starts_with("--")) {
                assert!(help.out.contains(option.as_str()), "{}: {line}: no {option}", page.display());
            }
            looked_at += 1;
        }
    }
    assert!(looked_at >= 20, "only {looked_at} commands were found: is the scan blind?");
}

/// Links within the book lead to a file of it, and what is included is there.
#[test]
fn every_link_of_the_book_leads_somewhere() {
    let mut followed = 0;
    for page in pages(&docs()) {
        let text = fs::read_to_string(&page).unwrap();
        let links = text.split("](").skip(1).filter_map(|after| after.split(')').next());
        let links = links.filter(|link| !link.contains("://") && !link.starts_with('#') && !link.contains(' '));
        let included = text.split("{{#include ").skip(1).filter_map(|after| after.split("}}").next());
        for link in links.map(|link| link.split('#').next().unwrap_or_default()).chain(included) {
            let target = page.parent().unwrap().join(link);
            assert!(target.exists(), "{} leads to {link}, which is not there", page.display());
            followed += 1;
        }
    }
    assert!(followed > 100, "only {followed} links were found: is the scan blind?");
}

/// The book leaves nothing out: every page stands in its summary, every decision in both lists.
#[test]
fn every_page_stands_in_the_summary() {
    let docs = docs();
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let index = fs::read_to_string(docs.join("decisions/README.md")).unwrap();
    for page in pages(&docs) {
        let path = page.strip_prefix(&docs).unwrap().display().to_string();
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        if path.starts_with("generated/") || path == "SUMMARY.md" {
            continue;
        }
        assert!(summary.contains(&format!("]({path})")), "docs/SUMMARY.md leaves out {path}");
        if path.starts_with("decisions/") && name != "README.md" {
            let title = fs::read_to_string(&page).unwrap().lines().next().unwrap().trim_start_matches("# ").to_owned();
            let entry = format!("[{title}]({name})");
            assert!(index.contains(&entry), "docs/decisions/README.md leaves out {entry}");
        }
    }
}

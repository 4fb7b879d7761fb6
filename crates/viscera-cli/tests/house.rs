//! What the house promises about its own text: modules depend downwards, the engine touches nothing outside itself, files
//! stay short, and the map names what is there.

use std::fs;
use std::path::{Path, PathBuf};

/// The engine's modules, from the ground up: each uses those before it and, of its own, any part.
const ORDER: &[&str] = &[
    "math",
    "executor",
    "curve",
    "stage",
    "mesh",
    "material",
    "solver",
    "model",
    "constraint",
    "contact",
    "body",
    "dynamics",
    "cutting",
    "instrument",
    "world",
];

/// Ways of the standard library out of the engine: files, sockets, clocks, processes, threads.
const OUTSIDE: &[&str] = &["std::fs", "std::net", "std::time", "std::process", "std::env", "std::thread", "std::io"];

/// No file holds more than one concept can fill.
const MOST_LINES: usize = 500;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Every Rust file under a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The text without comments and without the tests inside it, which may use whatever they need.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The modules that stand behind `crate::` in a text, one by one or in braces.
fn modules_used(code: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut used = Vec::new();
    for after in code.split("crate::").skip(1) {
        match after.strip_prefix('{') {
            None => used.push(word(after)),
            Some(list) => {
                let (mut depth, mut start) = (1, true);
                for (place, c) in list.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' => depth -= 1,
                        ',' => start = depth == 1,
                        c if start && !c.is_whitespace() => {
                            used.push(word(&list[place..]));
                            start = false;
                        }
                        _ => {}
                    }
                    if depth == 0 {
                        break;
                    }
                }
            }
        }
    }
    used
}

#[test]
fn modules_of_the_engine_depend_downwards_only() {
    let source = root().join("crates/viscera/src");
    let rank = |module: &str| ORDER.iter().position(|known| *known == module);
    let mut wrong = Vec::new();
    for file in rust_files(&source) {
        let inside = file.strip_prefix(&source).unwrap();
        let module = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let own = rank(module).unwrap_or_else(|| panic!("`{module}` has no place in ORDER: give it one"));
        for used in modules_used(&code(&file)) {
            let below = rank(&used).unwrap_or_else(|| panic!("{}: no module `{used}`", inside.display()));
            if below > own {
                wrong.push(format!("{} uses `{used}`, which stands above `{module}`", inside.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_scan_finds_modules_however_they_are_named() {
    let code = "use crate::math::{Vec3, Real};\nuse crate::{mesh::{A, B}, model};\npub(crate) fn f() -> crate::body::X";
    assert_eq!(modules_used(code), ["math", "mesh", "model", "body"]);
}

#[test]
fn the_engine_touches_no_file_socket_clock_or_thread() {
    for file in rust_files(&root().join("crates/viscera/src")) {
        let code = code(&file);
        // The executor starts threads, and says why the system refuses to.
        let is_executor = file.parent().is_some_and(|folder| folder.ends_with("executor"));
        let may = |way: &str| is_executor && ["std::thread", "std::io"].contains(&way);
        for way in OUTSIDE.iter().filter(|&&way| !may(way)) {
            assert!(!code.contains(way), "{} uses {way}", file.display());
        }
        // Brought in by halves, as `use std::{fs, …}`.
        let halves = ["std::{fs", "std::{net", "std::{time", "std::{thread", "std::{io", "std::{env", "std::{process"];
        assert!(halves.iter().all(|half| !code.contains(half)), "{} leaves the engine", file.display());
    }
}

/// Where the engine promises the compiler what that cannot see for itself.
const UNSAFE: &[&str] = &["executor/team.rs", "math/large_pages.rs", "math/prefetch.rs"];

#[test]
fn the_engine_is_unsafe_in_three_files_which_say_why() {
    let source = root().join("crates/viscera/src");
    let is_unsafe = |file: &PathBuf| code(file).contains("unsafe ");
    let found: Vec<PathBuf> = rust_files(&source).into_iter().filter(is_unsafe).collect();
    assert_eq!(found, UNSAFE.iter().map(|file| source.join(file)).collect::<Vec<_>>());
    for file in found {
        let text = fs::read_to_string(&file).unwrap();
        let promises = code(&file).matches("unsafe ").count();
        assert_eq!(text.matches("// SAFETY: ").count(), promises, "{} does not say why it holds", file.display());
    }
}

#[test]
fn no_file_grows_beyond_five_hundred_lines() {
    for member in fs::read_dir(root().join("crates")).unwrap() {
        for file in rust_files(&member.unwrap().path().join("src")) {
            let lines = fs::read_to_string(&file).unwrap().lines().count();
            assert!(lines <= MOST_LINES, "{} has {lines} lines: look for the second concept in it", file.display());
        }
    }
}

/// Paths stand in back quotes and hold a slash; commands, types and names of things do not.
#[test]
fn every_path_that_the_documents_name_is_there() {
    let root = root();
    let mut documents: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name)).into();
    documents.extend(fs::read_dir(root.join("docs/decisions")).unwrap().map(|entry| entry.unwrap().path()));
    let mut named = 0;
    for document in documents {
        let text = fs::read_to_string(&document).unwrap();
        for path in text.split('`').skip(1).step_by(2) {
            let is_path = |c: char| c.is_alphanumeric() || "/._-".contains(c);
            let is_place = ["crates/", "benches/", "validation/", "docs/", "scenes/", "fuzz/", ".ci/"]
                .iter()
                .any(|top| path.starts_with(top));
            if is_place && path.chars().all(is_path) {
                assert!(root.join(path).exists(), "{} names {path}, which is not there", document.display());
                named += 1;
            }
        }
    }
    assert!(named > 20, "only {named} paths were found: is the scan blind?");
}

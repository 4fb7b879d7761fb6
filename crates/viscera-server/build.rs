//! Builds the page, where Node.js is installed, and lists its files for embedding. Where it cannot be built, the program is built without
//! it and says why.
//!
//! The page is built from a copy in the output folder: the source tree is only read. `VISCERA_PAGE` names a folder with a page that is
//! built already (or is empty, for none).

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

/// What the page is made of.
const SOURCES: [&str; 6] = ["src", "public", "index.html", "package.json", "package-lock.json", "vite.config.ts"];
/// Settings of the compiler, whichever there are.
const SETTINGS: &str = "tsconfig";

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    let web = root.join("../../web");
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=VISCERA_PAGE");
    for source in sources(&web) {
        println!("cargo:rerun-if-changed={}", source.display());
    }
    let page = match env::var_os("VISCERA_PAGE") {
        Some(given) if given.is_empty() => Err("VISCERA_PAGE was empty when the program was built.".to_owned()),
        Some(given) => {
            println!("cargo:rerun-if-changed={}", Path::new(&given).display());
            Ok(PathBuf::from(given))
        }
        // Not to be watched: it is newer than the run that made it, and the program was compiled anew at every start.
        None => build(&web, &out).inspect_err(|_| watch_programs()),
    };
    let (page, missing) = match page {
        Ok(page) => (Some(page), None),
        Err(reason) => {
            println!("cargo:warning=the program is built without its page: {reason}");
            (None, Some(reason))
        }
    };
    let mut files = Vec::new();
    if let Some(page) = &page {
        list(page, &mut files).expect("the page that was just built can be read");
        files.sort();
    }
    let mut text = "pub(super) const FILES: &[(&str, &[u8])] = &[\n".to_owned();
    for file in &files {
        let name = file.strip_prefix(page.as_deref().unwrap_or(Path::new(""))).expect("files of the page lie in it");
        let name = name.to_string_lossy().replace('\\', "/");
        let place = fs::canonicalize(file).expect("a file that was just listed is there");
        writeln!(text, "    ({:?}, include_bytes!({:?})),", format!("/{name}"), place).expect("memory takes it");
    }
    writeln!(text, "];\npub(super) const MISSING: Option<&str> = {missing:?};").expect("memory takes it");
    fs::write(out.join("page.rs"), text).expect("cargo's output folder can be written");
}

/// The files and folders that the page is made of, those that there are; the folder itself where there are none.
fn sources(web: &Path) -> Vec<PathBuf> {
    let mut sources: Vec<PathBuf> = SOURCES.iter().map(|name| web.join(name)).filter(|path| path.exists()).collect();
    let settings = |entry: io::Result<fs::DirEntry>| {
        let path = entry.ok()?.path();
        path.file_name()?.to_str()?.starts_with(SETTINGS).then_some(path)
    };
    sources.extend(fs::read_dir(web).into_iter().flatten().filter_map(settings));
    sources.sort();
    if sources.is_empty() { vec![web.to_owned()] } else { sources }
}

fn build(web: &Path, out: &Path) -> Result<PathBuf, String> {
    if !web.join("package.json").exists() {
        return Err("the folder `web` is missing.".into());
    }
    let copy = out.join("web");
    let unwritable = |error: io::Error| format!("the page cannot be copied to build it: {error}.");
    let _ = fs::remove_dir_all(copy.join("src"));
    fs::create_dir_all(&copy).map_err(unwritable)?;
    for source in sources(web) {
        copy_to(&source, &copy.join(source.file_name().unwrap_or_default())).map_err(unwritable)?;
    }
    let lock = fs::read(web.join("package-lock.json")).unwrap_or_default();
    let installed = copy.join("node_modules/.of-lock");
    if fs::read(&installed).ok().as_deref() != Some(&lock) {
        // Not `ci`: it wants the binaries of every platform in the lock, which registries that mirror some do not have.
        npm(&copy, &["install", "--no-save", "--no-audit", "--no-fund", "--prefer-offline"])?;
        fs::write(&installed, &lock).map_err(unwritable)?;
    }
    npm(&copy, &["run", "build"])?;
    let page = copy.join("dist");
    if page.join("index.html").exists() { Ok(page) } else { Err("`npm run build` made no page.".into()) }
}

/// Builds the page when there is something new among the programs: Node.js, perhaps.
fn watch_programs() {
    println!("cargo:rerun-if-env-changed=PATH");
    let path = env::var_os("PATH").unwrap_or_default();
    for folder in env::split_paths(&path).filter(|folder| folder.is_dir()) {
        println!("cargo:rerun-if-changed={}", folder.display());
    }
}

fn npm(folder: &Path, arguments: &[&str]) -> Result<(), String> {
    let program = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let output = Command::new(program).args(arguments).current_dir(folder).env_remove("NODE_OPTIONS").output();
    match output {
        Err(error) => Err(format!("npm, of Node.js, cannot be started: {error}.")),
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let said =
                [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
            let last: Vec<&str> = said.lines().filter(|line| !line.trim().is_empty()).rev().take(6).collect();
            let last: Vec<&str> = last.into_iter().rev().collect();
            Err(format!("`npm {}` failed: {}", arguments.join(" "), last.join(" / ")))
        }
    }
}

fn copy_to(from: &Path, to: &Path) -> io::Result<()> {
    if !from.is_dir() {
        return fs::copy(from, to).map(|_| ());
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        copy_to(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

fn list(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { list(&path, files)? } else { files.push(path) }
    }
    Ok(())
}

//! The scenes and recordings that are built in, so that an installed program and a page without a server have them at hand.

use std::collections::BTreeMap;
use std::sync::Arc;

use viscera_scene::{Files, Scene, SceneErrors};

macro_rules! files {
    ($($path:literal),+ $(,)?) => {
        &[$(($path, include_bytes!(concat!("../../../scenes/", $path)) as &[u8])),+]
    };
}

/// Every file of the project's folder `scenes`.
pub const FILES: &[(&str, &[u8])] = files![
    "breathing-trunk.toml",
    "cylinder-bend.toml",
    "fibre-tubes.toml",
    "gallbladder.toml",
    "liver-adaptive.toml",
    "liver-hybrid.toml",
    "liver-inversion.toml",
    "liver-precomputed.toml",
    "liver-probe.toml",
    "liver-pull.toml",
    "liver-resection.toml",
    "liver.toml",
    "magnet.toml",
    "meshes/gallbladder.obj",
    "paths/liver-resection.csv",
    "recordings/edge-cut.viscera-recording",
    "recordings/lobe-pulled.viscera-recording",
    "scene.schema.json",
    "soft-arm.toml",
];

/// The scene with which a session begins: nothing happens in it until a hand does something.
pub const FIRST: &str = "liver";

/// Names and texts of the scenes.
pub fn scenes() -> impl Iterator<Item = (&'static str, &'static str)> {
    FILES.iter().filter_map(|(path, bytes)| Some((path.strip_suffix(".toml")?, std::str::from_utf8(bytes).ok()?)))
}

/// Names and bytes of the recordings.
pub fn recordings() -> impl Iterator<Item = (&'static str, &'static [u8])> {
    FILES.iter().filter_map(|(path, bytes)| {
        Some((path.strip_prefix("recordings/")?.strip_suffix(".viscera-recording")?, *bytes))
    })
}

/// The files that built-in scenes name. Recordings take them along.
pub fn files() -> Files {
    let is_named =
        |path: &str| !path.starts_with("recordings/") && !path.ends_with(".toml") && !path.ends_with(".json");
    let named = FILES.iter().filter(|(path, _)| is_named(path));
    let named: BTreeMap<String, Vec<u8>> = named.map(|(path, bytes)| ((*path).into(), bytes.to_vec())).collect();
    Files::Memory(Arc::new(named))
}

/// A scene by its name; none of that name.
///
/// # Errors
/// Where its text is wrong, which the tests exclude.
pub fn scene(name: &str) -> Option<Result<Scene, SceneErrors>> {
    let (name, text) = scenes().find(|(known, _)| *known == name)?;
    Some(Scene::parse_with(&format!("{name}.toml"), text, files()))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn a_file_that_goes_with_the_scenes_is_named_by_one() {
        let Files::Memory(files) = files() else { panic!("they are built in") };
        assert!(!files.is_empty());
        for name in files.keys() {
            assert!(scenes().any(|(_, text)| text.contains(name)), "no scene names {name}");
        }
    }

    #[test]
    fn every_file_of_the_scenes_folder_is_built_in() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let mut found = Vec::new();
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    found.push(path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/"));
                }
            }
        }
        found.sort();
        let mut known: Vec<_> = FILES.iter().map(|(path, _)| (*path).to_owned()).collect();
        known.sort();
        assert_eq!(known, found);
    }
}

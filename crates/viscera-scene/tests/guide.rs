//! The scenes of the guide: every one is checked and built, and the first one does what its chapter says.

use std::fs;
use std::path::{Path, PathBuf};

use viscera::world::BodyObservables;
use viscera_scene::{BuiltScene, Scene};

/// Every file of the guide, with its text.
fn chapters() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guide");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.map(|file| (file.clone(), fs::read_to_string(file).unwrap())).collect()
}

/// The blocks of a chapter that are fenced as scenes, with what stands behind the word.
fn scenes(chapter: &str) -> Vec<(String, String)> {
    let blocks = chapter.split("\n```").skip(1).step_by(2);
    let scenes = blocks.filter_map(|block| block.strip_prefix("toml scene")?.split_once('\n'));
    scenes.map(|(name, text)| (name.trim().to_owned(), text.to_owned())).collect()
}

fn built(text: &str) -> BuiltScene<f64> {
    Scene::parse(text, "").and_then(|scene| scene.build()).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn every_scene_of_the_guide_can_be_run() {
    let mut found = 0;
    for (file, text) in chapters() {
        for (_, scene) in scenes(&text) {
            let mut built = Scene::parse(&scene, "")
                .and_then(|scene| scene.build::<f64>())
                .unwrap_or_else(|errors| panic!("{}: {errors}", file.display()));
            built.world.step().unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            found += 1;
        }
    }
    assert!(found >= 6, "only {found} scenes were found: is the scan blind?");
}

/// The strip hangs by its upper end and stretches; then the cautery goes through it, and what hung below is gone: the upper end
/// carries the weight of what is left, averaged over its swings.
#[test]
fn the_first_cut_leaves_the_weight_of_the_upper_piece() {
    let chapters = chapters();
    let mut scenes = chapters.iter().flat_map(|(_, text)| scenes(text));
    let (_, text) = scenes.find(|(name, _)| name == "first-cut").expect("the first cut is in the guide");
    let mut built = built(&text);
    let strip = built.bodies["strip"];
    let mass = |built: &BuiltScene<f64>| built.world.body(strip).state().masses.iter().sum::<f64>();
    let whole = mass(&built);
    let mut after = Vec::new();
    for _ in 0..built.steps() {
        built.world.step().unwrap();
        let observed: BodyObservables = built.world.observe(strip);
        if built.world.time() > 1.0 {
            after.push(observed.reaction.y);
        } else if built.world.time() < 0.4 {
            assert_eq!(observed.removed_cells, 0, "nothing is cut before 0.4 s");
        }
    }
    let left = mass(&built);
    assert!((0.5..0.75).contains(&(left / whole)), "{left} kg of {whole} kg are left");
    let carried = after.iter().sum::<f64>() / after.len() as f64;
    assert!((carried / (left * 9.81) - 1.0).abs() < 0.02, "{carried} N carry {left} kg");
}

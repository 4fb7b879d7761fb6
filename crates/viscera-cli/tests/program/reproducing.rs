//! `viscera reproduce`: names, data, the page and its files.

use std::fs;
use std::path::Path;

use viscera_reproduce::EXPERIMENTS;

use super::Desk;

#[test]
fn an_experiment_is_run_and_its_page_written() {
    let desk = Desk::new();
    desk.viscera(&["reproduce", "rotation", "truth-cube", "--quick", "--out", "papers"])
        .ends_with(0)
        .says("relations hold")
        .says("not run")
        .says("index.html");
    let page = desk.read("papers/index.html");
    assert!(page.contains("viscera reproduce rotation truth-cube --quick"));
    assert!(page.contains("id=\"rotation\"") && !page.contains("id=\"cylinder\""));
    assert!(desk.read("papers/rotation/growth.csv").lines().count() == 8);
    assert!(desk.read("papers/rotation/growth.svg").contains("<svg"));
    assert!(desk.read_bytes("papers/rotation/linear.png").starts_with(b"\x89PNG"));
}

#[test]
fn an_experiment_that_does_not_exist_is_answered_with_the_ones_that_do() {
    let outcome = Desk::new().viscera(&["reproduce", "cilynder"]);
    outcome.ends_with(2).complains("cylinder").complains("truth-cube").complains("extrapolation");
}

#[test]
fn a_folder_without_beads_is_refused_before_anything_is_run() {
    let desk = Desk::new();
    desk.viscera(&["reproduce", "truth-cube", "--data", "."]).ends_with(2).complains("uniaxial_positions.csv");
    assert!(!desk.path("out").exists());
}

#[test]
fn a_folder_that_cannot_be_written_to_is_told_at_once() {
    let desk = Desk::new();
    desk.write("file", "");
    desk.viscera(&["reproduce", "--out", "file/papers"]).ends_with(2).complains("choose another folder");
}

/// The whole command, quick: it ends well, which it does only if every relation holds; every experiment has its section on a page that
/// needs no other file, and whatever the page shows lies beside it as a file.
#[test]
fn every_experiment_has_its_section_and_its_files() {
    let desk = Desk::new();
    let outcome = desk.viscera(&["reproduce", "--quick", "--quiet", "--out", "papers"]).ends_with(0);
    assert_eq!(outcome.err, "");
    let page = desk.read("papers/index.html");
    let kinds = |folder: &Path| {
        let mut kinds: Vec<_> = fs::read_dir(folder)
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
            .map(|entry| entry.unwrap().path().extension().unwrap().to_string_lossy().into_owned())
            .collect();
        kinds.sort();
        kinds.dedup();
        kinds
    };
    let (mut pictures, mut plots) = (0, 0);
    for experiment in EXPERIMENTS {
        let name = experiment.name;
        assert!(page.contains(&format!("id=\"{name}\"")), "{name} has no section");
        let kinds = kinds(&desk.path("papers").join(name));
        let has = |kind: &str| kinds.iter().any(|found| found == kind);
        assert!(has("md"), "{name}: {kinds:?}");
        // Without the beads that were measured nothing can be compared with them.
        assert!(name == "truth-cube" || has("csv"), "{name}: {kinds:?}");
        pictures += usize::from(has("png"));
        plots += usize::from(has("svg"));
    }
    assert!(pictures >= 6 && plots >= 6, "{pictures} sections with pictures, {plots} with plots");
    assert!(!page.contains('✗'), "a relation is marked as one that does not hold");
    // A drawing names its format by an address, and nothing is fetched from there.
    for (place, _) in page.match_indices("http") {
        assert!(page[place..].starts_with("http://www.w3.org/"), "{}", &page[place..place + 60]);
    }
    for link in ["src=\"", "href=\""] {
        for (place, _) in page.match_indices(link) {
            let target = &page[place + link.len()..];
            assert!(target.starts_with('#') || target.starts_with("data:"), "the page needs {}", &target[..40]);
        }
    }
}

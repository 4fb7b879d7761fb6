//! `viscera reproduce`: names, data, the page and its files.

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

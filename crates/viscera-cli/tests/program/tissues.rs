//! `viscera tissues`: what there is, where it comes from, and what is said of a name that is not there.

use serde_json::Value;

use crate::Desk;

#[test]
fn tissues_are_listed_with_their_stiffness_and_told_in_full_with_their_sources() {
    let desk = Desk::new();
    let list = desk.viscera(&["tissues"]).ends_with(0);
    for name in ["liver", "kidney", "spleen", "brain", "fat", "muscle", "skin", "gallbladder-wall", "artery"] {
        assert!(list.out.lines().any(|line| line.starts_with(name)), "{name} is missing in\n{}", list.out);
    }
    let liver = list.out.lines().find(|line| line.starts_with("liver")).unwrap();
    assert!(liver.contains("6.27 kPa") && liver.contains("1060") && liver.contains("human"), "{liver}");
    desk.viscera(&["tissues", "muscle"])
        .ends_with(0)
        .says("Young's modulus along the muscle fibres: 447 kPa, reported 349 kPa to 545 kPa")
        .says("  value   as commonly cited; the source itself was not consulted")
        .says("  weak    the curve is flat before it is steep");
}

#[test]
fn tissues_are_written_as_json_in_si() {
    let desk = Desk::new();
    let outcome = desk.viscera(&["tissues", "artery", "--json"]).ends_with(0);
    let artery: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(artery[0]["fibre"]["young"]["value"], 771e3);
    assert_eq!(artery[0]["density"]["range"], serde_json::json!([1030.0, 1102.0]));
    assert_eq!(artery[0]["law"], "st-venant-kirchhoff");
}

#[test]
fn an_unknown_tissue_is_answered_with_the_nearest() {
    Desk::new()
        .viscera(&["tissues", "spleeen"])
        .ends_with(2)
        .complains("there is no tissue `spleeen`, did you mean `spleen`?");
}

//! Tissues by name: what stands for what.

use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::TissuePreset;
use viscera::solver::Iterative;
use viscera_scene::file::{LawName, SceneFile};
use viscera_scene::{Scene, SceneErrors};

const BODY: &str =
    "duration = 1\n[body.block]\nmesh = { generate = \"box\", size = [0.1, 0.1, 0.1], cells = [2, 2, 2] }\n";

fn scene(body: &str) -> Scene {
    Scene::parse(&format!("{BODY}{body}"), "").unwrap_or_else(|errors| panic!("{errors}"))
}

fn checked(body: &str) -> Result<SceneFile, SceneErrors> {
    scene(body).check()
}

fn refused(body: &str) -> String {
    checked(body).map_or_else(|errors| errors.to_string(), |_| panic!("{body} is accepted"))
}

/// A litre of every tissue weighs its density, and stands for its numbers: the file with the name is the file with the numbers.
#[test]
fn every_tissue_stands_for_its_law_its_numbers_and_its_density() {
    for preset in TissuePreset::ALL {
        let named = checked(&format!("law = {{ tissue = \"{}\" }}", preset.name)).unwrap();
        let (law, young, poisson) = (preset.law, preset.young.value, preset.poisson.value);
        let density = preset.density.value;
        let numbers =
            format!("density = {density}\nlaw = {{ kind = \"{law}\", young = {young}, poisson = {poisson} }}");
        assert_eq!(named, checked(&numbers).unwrap(), "{}", preset.name);
        let summary = scene(&format!("law = {{ tissue = \"{}\" }}", preset.name)).summary().unwrap();
        assert!((summary.bodies[0].mass / (1e-3 * density) - 1.0).abs() < 1e-6, "{} kg", summary.bodies[0].mass);
        assert_eq!(summary.bodies[0].law, law.name());
    }
}

/// A bar of muscle hangs by one end, its fibres along it or across it: it stretches under its weight by ρgl²/2E, with the modulus
/// that the tissue states for that direction.
#[test]
fn fibres_of_a_tissue_make_it_as_stiff_as_is_stated() {
    let muscle = TissuePreset::named("muscle").unwrap();
    let stretch = |direction: &str| {
        let text = format!(
            "gravity = [0, 0, -0.01]\nduration = 1\nprecision = \"double\"\n[body.bar]\n\
             mesh = {{ generate = \"box\", size = [0.1, 0.1, 0.4], cells = [2, 2, 8], shape = \"hexahedra\" }}\n\
             law = {{ tissue = \"muscle\", fibre = {{ direction = {direction} }} }}\n\
             slide = [{{ region = \"z-max\", normal = [0, 0, 1] }}, {{ region = \"x-min\", normal = [1, 0, 0] }}, \
                      {{ region = \"y-min\", normal = [0, 1, 0] }}]\n"
        );
        let mut built = Scene::parse(&text, "").unwrap().build::<f64>().unwrap_or_else(|errors| panic!("{errors}"));
        let bar = built.bodies["bar"];
        built.world.settle(bar, &QuasiStatic::default(), &mut Iterative::default()).unwrap();
        let body = built.world.body(bar);
        -body.state().positions.iter().map(|place| place.z).fold(f64::INFINITY, f64::min)
    };
    let expected = |young: f64| muscle.density.value * 0.01 * 0.4 * 0.4 / (2.0 * young);
    for (direction, young) in [("[0, 0, 1]", muscle.fibre.unwrap().young.value), ("[1, 0, 0]", muscle.young.value)] {
        let (found, expected) = (stretch(direction), expected(young));
        assert!((found / expected - 1.0).abs() < 0.02, "{direction}: {found} m for {expected} m");
    }
}

/// What the file says itself, it keeps; the tissue gives the rest.
#[test]
fn a_tissue_gives_only_what_the_file_leaves_open() {
    let file = checked("density = 1000\nlaw = { tissue = \"liver\", kind = \"linear\", young = \"8 kPa\" }").unwrap();
    let body = &file.body["block"];
    assert_eq!((body.density.0, body.law.kind), (1000.0, LawName::Linear));
    assert_eq!((body.law.young.map(|young| young.0), body.law.poisson), (Some(8000.0), Some(0.49)));

    let lame = checked("law = { tissue = \"liver\", lambda = \"20 kPa\", mu = \"2 kPa\" }").unwrap();
    assert_eq!((lame.body["block"].law.young, lame.body["block"].law.poisson), (None, None));

    let fibre = checked("law = { tissue = \"muscle\", fibre = { direction = [1, 0, 0], factor = 2 } }").unwrap();
    assert_eq!(fibre.body["block"].law.fibre.as_ref().and_then(|fibre| fibre.factor), Some(2.0));
}

/// A part takes the numbers of its tissue and the law of its body.
#[test]
fn a_part_of_another_tissue_has_its_numbers_in_the_law_of_the_body() {
    let file = checked(
        "law = { tissue = \"liver\" }\npart = [{ region = { half-space = { point = [0.05, 0, 0], normal = [1, 0, 0] } }, \
         law = { tissue = \"fat\" } }]",
    )
    .unwrap();
    let (part, fat) = (&file.body["block"].part[0], TissuePreset::named("fat").unwrap());
    assert_eq!(part.density.map(|density| density.0), Some(fat.density.value));
    let law = part.law.as_ref().unwrap();
    assert_eq!((law.kind, law.young.map(|young| young.0)), (LawName::NeoHookean, Some(fat.young.value)));
}

/// Overrides reach below a name.
#[test]
fn an_override_changes_a_number_of_a_named_tissue() {
    let mut scene = scene("law = { tissue = \"liver\" }");
    scene.set("body.block.law.young", "9 kPa").unwrap();
    let law = &scene.check().unwrap().body["block"].law;
    assert_eq!((law.young.map(|young| young.0), law.poisson), (Some(9000.0), Some(0.49)));
    scene.set("body.block.law.tissue", "kidney").unwrap();
    assert_eq!(scene.check().unwrap().body["block"].density.0, TissuePreset::named("kidney").unwrap().density.value);
}

#[test]
fn an_unknown_tissue_is_shown_in_its_line_with_the_nearest_name() {
    let message = refused("law = { tissue = \"livr\" }");
    assert_eq!(message.matches("error:").count(), 1, "{message}");
    assert!(message.starts_with("error: unknown value `livr` for `tissue`, did you mean `liver`?"), "{message}");
    assert!(message.contains("gallbladder-wall"), "{message}");
}

#[test]
fn what_a_tissue_cannot_give_is_asked_for() {
    let message = refused("law = { tissue = \"liver\", fibre = { direction = [1, 0, 0] } }");
    assert!(message.contains("missing key in a fibre"), "liver has no fibres: {message}");
    let message = refused("law = { young = 1e4, poisson = 0.4 }");
    assert!(message.contains("missing key `density`") && message.contains("missing key `kind`"), "{message}");
    let message = refused("law = { tissue = 3 }");
    assert!(message.contains("expected"), "{message}");
}

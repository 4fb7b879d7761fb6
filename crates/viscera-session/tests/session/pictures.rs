use viscera_session::Seen;
use viscera_session::message::{Answer, Command, Manner, PartKind};

use crate::support::{BAR, Page, hybrid_bar, light_bar};

/// Pictures that were left out are not missed: the next one has every surface and the scene, if they changed meanwhile.
#[test]
fn whoever_misses_pictures_is_brought_up_to_date_by_the_next() {
    let mut page = Page::open(BAR);
    let mut slow = Seen::default();
    page.step(1);
    page.session.handle(Command::Colour { by: "none".into() }.into());
    let kinds = |parts: Vec<std::sync::Arc<[u8]>>| -> Vec<&'static str> {
        let kind = |answer: Answer| match answer {
            Answer::Scene(_) => "scene",
            Answer::Surface(_) => "surface",
            Answer::Frame(_) => "frame",
            _ => "other",
        };
        parts.iter().map(|part| kind(Answer::decode(part).unwrap())).collect()
    };
    let picture = page.session.picture().unwrap();
    assert_eq!(kinds(picture.parts_for(&mut slow)), ["scene", "surface", "frame"]);
    assert!(picture.parts_for(&mut slow).is_empty(), "the same picture twice is nothing new");
    page.step(1);
    page.session.handle(Command::Reset {}.into());
    let _left_out = page.session.picture().unwrap();
    page.session.handle(Command::Step { count: 1 }.into());
    while page.session.work() {}
    let picture = page.session.picture().unwrap();
    assert_eq!(kinds(picture.parts_for(&mut slow)), ["scene", "surface", "frame"]);
    page.session.handle(Command::Step { count: 1 }.into());
    while page.session.work() {}
    assert_eq!(kinds(page.session.picture().unwrap().parts_for(&mut slow)), ["frame"]);
    assert!(page.session.picture().is_none(), "nothing has changed since");
}

/// Each colouring has one number for each vertex, inside its scale.
#[test]
fn colours_lie_on_their_scale() {
    let mut page = Page::open(BAR);
    page.step(30);
    for (by, unit) in [("displacement", "m"), ("von-mises", "Pa"), ("volume-change", ""), ("adaptive-mode", "")] {
        page.say(Command::Colour { by: by.into() });
        let frame = page.frame();
        assert_eq!((frame.colouring.by.as_str(), frame.colouring.unit.as_str()), (by, unit));
        let scalars = &frame.bodies[0].scalars.as_ref().unwrap().0;
        assert_eq!(3 * scalars.len(), frame.bodies[0].positions.0.len());
        let (low, high) = (frame.colouring.low as f32, frame.colouring.high as f32);
        assert!(scalars.iter().all(|scalar| (low..=high).contains(scalar)), "{by}");
        assert!(scalars.iter().any(|&scalar| scalar != 0.0), "{by} shows something on a bar that bends");
    }
    page.say(Command::Colour { by: "none".into() });
    assert!(page.frame().bodies[0].scalars.is_none());
    page.say(Command::Colour { by: "taste".into() });
    assert!(page.refusals()[0].help.contains("von-mises"));
}

/// The displacement that is shown is that of the observables, and a table of them goes home.
#[test]
fn exports_hold_what_is_shown() {
    let mut page = Page::open(BAR);
    page.say(Command::Colour { by: "displacement".into() });
    for _ in 0..5 {
        page.step(5);
    }
    let shown = page.frame().bodies[0].scalars.as_ref().unwrap().0.iter().copied().fold(0.0, f32::max);
    let observed = page.frame().observables.as_ref().unwrap()[0].largest_displacement;
    assert!((f64::from(shown) / observed - 1.0).abs() < 1e-5, "{shown} {observed}");
    page.say(Command::Export { what: viscera_session::message::Export::Observables });
    let text = String::from_utf8(page.file()).unwrap();
    let last: Vec<f64> = text.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    assert!(text.starts_with("time [s],bar: kinetic energy [J],"));
    assert_eq!((last[0], last[5]), (page.frame().time, observed));
    page.say(Command::Export { what: viscera_session::message::Export::State });
    let grid = viscera_io::vtu::parse(&page.file()).unwrap();
    let viscera_io::ImportedMesh::Tet(mesh) = grid.mesh else { panic!("a bar of tetrahedra") };
    assert_eq!(mesh.cells.len(), 144);
    page.set("body.bar.law.young", 7e3);
    page.say(Command::Export { what: viscera_session::message::Export::Scene });
    let text = String::from_utf8(page.file()).unwrap();
    assert!(text.contains("young = 7000"), "{text}");
    page.say(Command::OpenText { text, name: None });
    assert_eq!(page.refusals(), [], "the scene that went home comes back");
}

/// What was measured stays measured while the linear model comes and goes, and what a tool felt stands beside it.
#[test]
fn measurements_outlast_the_ghost_and_hold_the_forces_on_tools() {
    let mut page = Page::open(&light_bar());
    for _ in 0..4 {
        page.step(1);
    }
    page.say(Command::Ghost { on: true });
    let probe = page.add("probe", [0.02, 0.05, 0.1], [0.0, -1.0, 0.0]);
    let mut felt = 0.0;
    for step in 1..=10 {
        page.lead(probe, [0.02, 0.05 - 0.002 * f64::from(step), 0.1], 0.0);
        page.step(1);
        felt = page.frame().instruments[0].force[1];
    }
    assert!(felt > 0.0, "tissue that is dented pushes the probe up: {felt} N");
    page.say(Command::Ghost { on: false });
    page.say(Command::Export { what: viscera_session::message::Export::Observables });
    let text = String::from_utf8(page.file()).unwrap();
    let (heading, rows) = text.split_once('\n').unwrap();
    let heading: Vec<&str> = heading.split(',').collect();
    assert_eq!(heading[10..], ["probe 1: force x [N]", "probe 1: force y [N]", "probe 1: force z [N]"]);
    let column = |place: usize| -> Vec<f64> {
        rows.lines().map(|row| row.split(',').nth(place).unwrap().parse().unwrap()).collect()
    };
    // From the beginning: 4 steps before the ghost came, and 10 while it was there.
    let times: Vec<f64> = (0..=14).map(|step| 0.01 * f64::from(step)).collect();
    assert!(column(0).iter().zip(&times).all(|(kept, time)| (kept - time).abs() < 1e-9), "{:?}", column(0));
    assert_eq!(column(0).len(), times.len());
    let forces = column(11);
    assert!(forces[..=4].iter().all(|&force| force == 0.0), "there was no probe yet: {forces:?}");
    assert_eq!(forces.last(), Some(&felt));
}

/// Bodies that promise something exact say how well they keep it, and others say nothing.
#[test]
fn kept_volumes_and_precomputed_parts_tell_their_error() {
    let errors = |text: &str| {
        let mut page = Page::open(text);
        page.step(5);
        let seen = page.frame().observables.as_ref().unwrap()[0];
        (seen.volume_error, seen.interface_residual)
    };
    assert_eq!(errors(BAR), (None, None));
    let volume = "density = 1000\nexact-volume = [{ name = \"bar\", region = \"all\" }]";
    let (volume, interface) = errors(&BAR.replace("backward-euler", "explicit").replace("density = 1000", volume));
    assert!(volume.is_some_and(|error| error < 1e-4), "to the rounding of single precision: {volume:?}");
    assert_eq!(interface, None);
    // The bar falls: what holds its moving half has more to hold with each step.
    let (volume, interface) = errors(&hybrid_bar());
    assert_eq!(volume, None);
    assert!(interface.is_some_and(|change| change > 0.0 && change.is_finite()), "{interface:?}");
}

/// The angle between the jaws of a tool as a frame tells of them [rad].
fn between_jaws(parts: &[f32]) -> f64 {
    let rods: Vec<_> = parts.chunks_exact(7).collect();
    let [.., one, other] = rods[..] else { panic!("it has no jaws: {parts:?}") };
    let along = |rod: &[f32]| -> [f64; 3] { std::array::from_fn(|axis| f64::from(rod[3 + axis] - rod[axis])) };
    let (one, other) = (along(one), along(other));
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| a[axis] * b[axis]).sum::<f64>();
    (dot(one, other) / (dot(one, one) * dot(other, other)).sqrt()).acos()
}

/// What a page draws is what touches: a rod of the scene's measures, and jaws as wide as the scene says, in proportion to the trigger.
#[test]
fn parts_are_told_as_they_touch() {
    let grasper = r#"
[instrument.narrow]
kind = "grasper"
path = [0.02, 0.1, 0.06]
jaws = { length = "20 mm", radius = "1.5 mm", opening = 0.4 }
shaft = { radius = "3 mm", length = "25 cm" }

[instrument.beam]
kind = "cautery"
path = [0.02, 0.2, 0.06]
"#;
    let mut page = Page::open(&(light_bar() + grasper));
    page.step(1);
    let (shape, frame) = (page.scene().instruments[0].clone(), page.frame().instruments[0].clone());
    let kinds: Vec<PartKind> = shape.parts.iter().map(|part| part.kind).collect();
    assert_eq!((shape.manner, kinds), (Manner::Hold, vec![PartKind::Shaft, PartKind::Jaw, PartKind::Jaw]));
    assert_eq!((shape.parts[0].radius, frame.parts.0.len()), (0.003, 21));
    assert!((shape.parts[0].length - 0.25).abs() < 1e-12);
    // Jaws end a radius to the side of their hinge's lines, and so that they lie side by side when they are closed.
    let aside = (1.5_f64 / 20.0).atan();
    let open = between_jaws(&frame.parts.0);
    assert!(open > 0.4 && open < 0.4 + 2.0 * aside, "{open} rad");
    page.lead(0, [0.02, 0.1, 0.06], 1.0);
    page.step(1);
    let closed = between_jaws(&page.frame().instruments[0].parts.0);
    assert!((closed - 2.0 * aside).abs() < 1e-5, "{closed} rad");
    // One without a rod touches nothing, and has nothing to draw that would seem to.
    let (shape, frame) = (&page.scene().instruments[1], &page.frame().instruments[1]);
    assert_eq!((shape.manner, &shape.parts[..], &frame.parts.0[..]), (Manner::Burn, &[][..], &[][..]));
}

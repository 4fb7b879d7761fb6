use viscera::math::Vec3;
use viscera_session::message::{Command, RunState, Trocar};

use crate::support::{BAR, Page, light_bar};

/// Simulated time is that of the clock, and stands still while it is paused.
#[test]
fn time_follows_the_clock_and_stands_still_while_paused() {
    let mut page = Page::open(BAR);
    page.say(Command::Play {});
    for _ in 0..30 {
        page.session.elapse(1.0 / 60.0);
        while page.session.work() {}
    }
    page.listen();
    // Half a second in steps of 10 ms, the last perhaps not yet due.
    assert!((49..=50).contains(&page.frame().steps), "{}", page.frame().steps);
    page.say(Command::Pause {});
    let (steps, places) = (page.frame().steps, page.positions(0));
    for _ in 0..30 {
        page.session.elapse(1.0 / 60.0);
        assert!(!page.session.work(), "nothing is done while paused");
    }
    page.listen();
    assert_eq!((page.frame().steps, page.positions(0), page.frame().state), (steps, places, RunState::Paused));
}

#[test]
fn steps_are_made_one_by_one_and_reset_goes_back_to_rest() {
    let mut page = Page::open(BAR);
    let rest = page.positions(0);
    page.step(1);
    assert_eq!(page.frame().steps, 1);
    page.step(20);
    assert_eq!(page.frame().steps, 21);
    assert_ne!(page.positions(0), rest);
    page.say(Command::Reset {});
    assert_eq!((page.frame().steps, page.positions(0)), (0, rest));
}

/// The state of a slot goes on as it went before, also after the material has changed since.
#[test]
fn a_snapshot_goes_on_to_the_same_bits_parameters_and_all() {
    let mut page = Page::open(BAR);
    page.step(10);
    page.say(Command::TakeSnapshot { slot: 3 });
    page.step(10);
    let places = page.positions(0);
    page.set("body.bar.law.young", 5e3);
    page.step(10);
    page.say(Command::RestoreSnapshot { slot: 3 });
    assert_eq!(page.frame().steps, 10);
    page.step(10);
    assert_eq!(page.positions(0), places);
    page.say(Command::RestoreSnapshot { slot: 4 });
    assert!(page.refusals()[0].reason.contains("slot 4 is empty"));
}

/// Jaws that close on the free end of the bar carry it along, and the hand feels its weight.
#[test]
fn a_grasper_carries_what_it_closes_on() {
    let mut page = Page::open(&light_bar());
    // Its tip in the end of the bar, which the closing jaws sweep over.
    let grasper = page.add("grasper", [0.02, 0.036, 0.115], [0.0, -1.0, 0.0]);
    page.step(1);
    page.lead(grasper, [0.02, 0.036, 0.115], 1.0);
    page.step(3);
    assert!(page.frame().instruments[0].holds, "{:?}", page.notices());
    let before = page.lowest(0);
    for lift in 1..=20 {
        page.lead(grasper, [0.02, 0.036 + 0.002 * f64::from(lift), 0.115], 1.0);
        page.step(1);
    }
    let farthest = |page: &Page| page.frame().observables.as_ref().unwrap()[0].largest_displacement;
    // The end is 4 cm above its place, less what slides through the jaws.
    assert!(farthest(&page) > 0.03, "{}", farthest(&page));
    assert!(page.lowest(0) > before - 0.01);
    // Tissue that is bent up pulls the tool down.
    assert!(page.frame().instruments[0].force[1] < 0.0);
    page.lead(grasper, [0.02, 0.06, 0.12], 0.0);
    page.step(2);
    assert!(!page.frame().instruments[0].holds);
}

/// Jaws hold with 10 N and no more: the bar, which takes 32 N for every time its length, slips through them when it is pulled further.
#[test]
fn tissue_slips_through_jaws_that_pull_too_much() {
    let mut page = Page::open(&light_bar());
    let place = |pull: f64| [0.02, 0.036, 0.115 + pull];
    let grasper = page.add("grasper", place(0.0), [0.0, -1.0, 0.0]);
    page.step(1);
    page.lead(grasper, place(0.0), 1.0);
    page.step(3);
    assert!(page.frame().instruments[0].holds, "{:?}", page.notices());
    let mut largest = 0.0f64;
    for step in 1..=100 {
        page.lead(grasper, place(0.0025 * f64::from(step)), 1.0);
        page.step(1);
        let [x, y, z] = page.frame().instruments[0].force;
        largest = largest.max((x * x + y * y + z * z).sqrt());
    }
    assert!(largest > 8.0 && largest < 10.5, "{largest} N");
    let farthest = page.frame().observables.as_ref().unwrap()[0].largest_displacement;
    assert!(farthest < 0.12, "the bar was carried along {farthest} m of 0.25 m");
}

/// A hand that came and closed the jaws while the simulation made one step of it: they hold what they were led to.
#[test]
fn jaws_hold_where_a_hurried_hand_closed_them() {
    let mut page = Page::open(&light_bar());
    let (above, end) = ([0.02, 0.12, 0.115], [0.02, 0.036, 0.115]);
    let grasper = page.add("grasper", above, [0.0, -1.0, 0.0]);
    page.step(1);
    page.lead(grasper, [0.02, 0.08, 0.115], 0.0);
    page.lead(grasper, end, 0.0);
    page.lead(grasper, end, 1.0);
    page.step(3);
    assert!(page.frame().instruments[0].holds, "{:?}", page.frame().instruments[0]);
}

/// Wherever a hand presses them on the liver, jaws take hold: those of the scene on its cells, and those that a hand brings in also on
/// cells that are longer than the jaws.
#[test]
fn jaws_take_hold_wherever_they_are_pressed() {
    const CLEARANCE: f64 = 0.03;
    const DEPTH: f64 = 0.007;
    for (edge, tool) in [(0.016, 0), (0.024, 3)] {
        let mut page = Page::open(BAR);
        page.say(Command::OpenScene { name: "liver".into() });
        page.set("body.liver.mesh.edge", edge);
        page.listen();
        if tool == 3 {
            assert_eq!(page.add("grasper", [0.0, 0.3, 0.0], [0.0, -1.0, 0.0]), 3);
        }
        let places = centroids(&page);
        // From above, and a little from where the trocar is.
        let seen: Vec<_> = places.into_iter().filter(|(_, normal)| normal[1] > 0.5 && normal[2] > 0.0).collect();
        assert!(seen.len() > 30, "{}", seen.len());
        for (place, _) in seen.iter().step_by(seen.len() / 3) {
            page.say(Command::Reset {});
            let above = |height: f64| [place[0], place[1] + height, place[2]];
            for height in [CLEARANCE, 0.5 * CLEARANCE, -0.5 * DEPTH, -DEPTH] {
                page.lead(tool, above(height), 0.0);
                page.step(1);
            }
            page.lead(tool, above(-DEPTH), 1.0);
            page.step(2);
            let frame = page.frame().instruments.iter().find(|frame| frame.instrument == tool).unwrap();
            assert!(frame.holds, "nothing is held at {place:?} with cells of {edge} m");
        }
    }
}

/// Middles of the triangles of the first body at rest, and their normals.
fn centroids(page: &Page) -> Vec<([f64; 3], [f64; 3])> {
    let surface = &page.surfaces[0];
    let corner =
        |vertex: u32| -> [f64; 3] { std::array::from_fn(|axis| f64::from(surface.rest.0[3 * vertex as usize + axis])) };
    let of = |triangle: &[u32]| {
        let [a, b, c] = [corner(triangle[0]), corner(triangle[1]), corner(triangle[2])];
        let [u, v]: [[f64; 3]; 2] = [b, c].map(|end| std::array::from_fn(|axis| end[axis] - a[axis]));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
        (std::array::from_fn(|axis| (a[axis] + b[axis] + c[axis]) / 3.0), normal.map(|part| part / length))
    };
    surface.triangles.0.chunks_exact(3).map(of).collect()
}

/// The hook burns its way, vertices keep their numbers, new ones come at the end, and the rim is seared.
#[test]
fn a_cautery_removes_cells_and_leaves_a_seared_rim() {
    let mut page = Page::open(BAR);
    let (vertices, epoch) = (page.surfaces[0].vertices, page.surfaces[0].epoch);
    let first_rest = page.surfaces[0].rest.0.clone();
    let cautery = page.add("cautery", [0.02, 0.06, 0.1], [0.0, -1.0, 0.0]);
    for step in 0..60 {
        page.lead(cautery, [0.02, 0.06 - 0.001 * f64::from(step), 0.1], 1.0);
        page.step(1);
    }
    // It stays where it came to: what it touches there takes in its power until it goes.
    page.step(100);
    let observed = page.frame().observables.as_ref().unwrap()[0];
    assert!(observed.removed > 0 && observed.cells + observed.removed == 144, "{observed:?}");
    let surface = &page.surfaces[0];
    assert!(surface.epoch > epoch && surface.skin == vertices);
    assert_eq!(surface.rest.0[..first_rest.len()], first_rest, "vertices keep their numbers");
    assert!(surface.cut.0.contains(&1));
    assert_eq!(page.frame().bodies[0].positions.0.len(), 3 * surface.vertices);
    let seared = page.frame().bodies[0].seared.as_ref().expect("something is seared");
    assert!(seared.0.iter().any(|&share| share > 0.5));
}

/// A ghost sags as the linear law would have it: the same under small loads, and turned tissue swells.
#[test]
fn the_ghost_is_the_same_body_with_the_linear_law() {
    let mut page = Page::open(BAR);
    page.step(5);
    page.say(Command::Ghost { on: true });
    assert_eq!(page.scene().bodies.len(), 2);
    assert_eq!(page.scene().bodies[1].ghost_of, Some(0));
    assert_eq!(page.scene().bodies[1].law, "linear");
    assert_eq!(page.positions(0), page.positions(1), "it begins where the body is");
    page.step(100);
    assert_ne!(page.positions(0), page.positions(1));
    page.set("body.bar.law.young", 10e3);
    page.step(1);
    assert_eq!(page.frame().bodies.len(), 2, "it stays when parameters change");
    page.say(Command::Ghost { on: false });
    assert_eq!((page.scene().bodies.len(), page.frame().bodies.len()), (1, 1));
}

/// A tool that was pressed into tissue, and around which it begins anew, is drawn back along its shaft: the tissue hung on it, or could make
/// no step at all.
#[test]
fn a_new_beginning_draws_tools_out_of_the_tissue() {
    let mut page = Page::open(BAR);
    let rest = page.surfaces[0].rest.0.clone();
    let middle: [f64; 3] = std::array::from_fn(|axis| {
        let of_axis = || rest.iter().skip(axis).step_by(3).map(|&x| f64::from(x));
        0.5 * (of_axis().fold(f64::MAX, f64::min) + of_axis().fold(f64::MIN, f64::max))
    });
    let tool = page.add("probe", [middle[0], middle[1] + 0.2, middle[2]], [0.0, -1.0, 0.0]);
    page.lead(tool, middle, 0.0);
    page.say(Command::Reset {});
    let tip = page.frame().instruments[0].tip;
    let top = rest.iter().skip(1).step_by(3).fold(f32::MIN, |top, &y| top.max(y));
    let aside = (tip[0] - middle[0]).abs() + (tip[2] - middle[2]).abs();
    assert!(tip[1] > f64::from(top) && aside < 1e-12, "{tip:?} from {middle:?}");
    page.step(30);
    let mut untouched = Page::open(BAR);
    untouched.step(30);
    assert_eq!(page.positions(0), untouched.positions(0));
}

/// A tool that was on its way through a trocar is drawn back along the shaft that it comes to have, towards the trocar; that of before would
/// lead aside.
#[test]
fn a_new_beginning_draws_a_shaft_back_towards_its_trocar() {
    let mut page = Page::open(BAR);
    let rest = page.surfaces[0].rest.0.clone();
    let bounds = |axis: usize| {
        let of_axis = rest.iter().skip(axis).step_by(3).map(|&x| f64::from(x));
        of_axis.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
    };
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (bounds(axis).0 + bounds(axis).1));
    let top = bounds(1).1;
    let trocar = [middle[0] + 0.1, top + 0.2, middle[2] - 0.05];
    let tip = [middle[0] - 0.1, top + 0.05, middle[2]];
    page.say(Command::AddInstrument {
        kind: "probe".into(),
        tip: Some(tip),
        direction: None,
        trocar: Some(Trocar::At(trocar)),
    });
    page.step(1);
    page.lead(0, middle, 0.0);
    page.say(Command::Reset {});
    let tip = Vec3::from(page.frame().instruments[0].tip);
    let [middle, trocar] = [middle, trocar].map(Vec3::from);
    let aside = (tip - middle).cross((trocar - middle).normalized().unwrap()).norm();
    assert!(tip.y > top && tip.y < trocar.y && aside < 1e-12, "{tip:?} from {middle:?}");
}

/// What the engine refuses stops the clock with its reason; a reset goes on.
#[test]
fn a_step_that_is_refused_stops_with_its_reason() {
    let text = BAR
        .replace("backward-euler", "explicit")
        .replace("[body.bar]", "[body.bar]\nload = [{ region = \"z-max\", force = [0, 1e9, 0] }]");
    let mut page = Page::open(&text);
    page.say(Command::Play {});
    for _ in 0..50 {
        page.session.elapse(0.05);
        while page.session.work() {}
    }
    page.listen();
    assert_eq!(page.frame().state, RunState::Stopped);
    let notices = page.notices();
    assert!(notices.iter().any(|notice| notice.contains("the step is undone")), "{notices:?}");
    page.say(Command::Reset {});
    assert_eq!((page.frame().steps, page.frame().state), (0, RunState::Paused));
}

/// A cube of 4 cm in millimetres, as a scanner exports it: filled, taken for millimetres, and held from below.
#[test]
fn a_surface_that_is_dropped_becomes_tissue() {
    let corner = |index: usize| [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 40.0 } else { 0.0 });
    let mut text = String::new();
    for index in 0..8 {
        let [x, y, z] = corner(index);
        text += &format!("v {x} {y} {z}\n");
    }
    // Quads by corners 1 to 8, counter-clockwise from outside.
    for [a, b, c, d] in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    let mut page = Page::open(BAR);
    let bytes = viscera_session::message::Bytes(text.into_bytes());
    page.say(Command::OpenMesh { name: "my cube.obj".into(), bytes, unit: None, edge: Some(0.01) });
    assert_eq!(page.refusals(), []);
    assert_eq!(page.scene().name, "my cube");
    // Half the diagonal of the cube.
    assert!((page.scene().radius - 0.02 * 3_f64.sqrt()).abs() < 0.002, "{}", page.scene().radius);
    let bottom = page.lowest(0);
    page.step(20);
    assert!((page.lowest(0) - bottom).abs() < 1e-6, "it is held from below");
    assert!(page.frame().observables.as_ref().unwrap()[0].largest_displacement > 1e-5, "and sags");
}

#[test]
fn what_is_no_mesh_is_refused_with_its_reason_and_the_scene_goes_on() {
    let mut page = Page::open(BAR);
    page.step(3);
    let places = page.positions(0);
    let bytes = viscera_session::message::Bytes(b"solid open\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n".to_vec());
    page.say(Command::OpenMesh { name: "broken.stl".into(), bytes, unit: None, edge: None });
    let refusals = page.refusals();
    assert!(refusals[0].command == "open-mesh" && refusals[0].reason.contains("broken.stl"), "{refusals:?}");
    assert_eq!((page.scene().name.as_str(), page.positions(0)), ("bar", places));
}

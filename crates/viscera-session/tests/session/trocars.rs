//! Points in the wall of the belly that shafts pass through.

use viscera_session::message::{Command, Trocar};

use crate::support::{BAR, Page, light_bar};

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// How far a shaft passes from its trocar [m].
fn off(tip: [f64; 3], direction: [f64; 3], trocar: [f64; 3]) -> f64 {
    let back: [f64; 3] = std::array::from_fn(|axis| trocar[axis] - tip[axis]);
    let along: f64 = (0..3).map(|axis| back[axis] * direction[axis]).sum();
    (0..3).map(|axis| (back[axis] - along * direction[axis]).powi(2)).sum::<f64>().sqrt()
}

fn bring_in(page: &mut Page, tip: [f64; 3]) -> u32 {
    let (tip, trocar) = (Some(tip), Some(Trocar::Wanted(true)));
    page.say(Command::AddInstrument { kind: "grasper".into(), tip, direction: None, trocar });
    assert_eq!(page.refusals(), []);
    page.scene().instruments.last().unwrap().instrument
}

/// Above the bodies and outside the ball around them, nearer than a shaft is long, and apart from each other.
#[test]
fn a_session_chooses_points_above_the_bodies() {
    let mut page = Page::open(&light_bar());
    let (centre, radius) = (page.scene().centre, page.scene().radius);
    for _ in 0..4 {
        bring_in(&mut page, [0.02, 0.05, 0.1]);
    }
    page.step(1);
    let tools = page.frame().instruments.clone();
    let points: Vec<[f64; 3]> = tools.iter().map(|tool| tool.trocar.unwrap()).collect();
    for (number, point) in points.iter().enumerate() {
        assert!(point[1] > centre[1] + radius, "{point:?} is above the bar");
        assert!(distance(*point, centre) >= 1.15 * radius * (1.0 - 1e-12), "{point:?} is clear of the bar");
        let within = distance(*point, tools[number].tip);
        assert!((0.105 - 1e-9..=0.24 + 1e-9).contains(&within), "{within} m of a shaft of 300 mm are within");
        assert!(points[..number].iter().all(|other| distance(*other, *point) > 0.3 * radius), "{points:?}");
    }
}

/// The tip goes where the hand has it, and the shaft through the point: while it stays, while it moves, and again without.
#[test]
fn a_shaft_passes_through_its_trocar_until_it_has_none() {
    let mut page = Page::open(&light_bar());
    let tool = bring_in(&mut page, [0.02, 0.08, 0.1]);
    for step in 0..10 {
        let tip = [0.02 + 0.002 * f64::from(step), 0.08, 0.1];
        page.lead(tool, tip, 0.0);
        page.step(1);
        let state = page.frame().instruments[0].clone();
        assert!(distance(state.tip, tip) < 1e-12 && off(state.tip, state.direction, state.trocar.unwrap()) < 1e-12);
    }
    let point = [0.1, 0.2, 0.2];
    page.say(Command::SetTrocar { instrument: tool, trocar: Trocar::At(point) });
    page.step(1);
    let state = page.frame().instruments[0].clone();
    assert_eq!(state.trocar, Some(point));
    assert!(off(state.tip, state.direction, point) < 1e-12);
    page.say(Command::SetTrocar { instrument: tool, trocar: Trocar::Wanted(false) });
    page.step(1);
    let free = page.frame().instruments[0].clone();
    assert_eq!(free.trocar, None);
    assert!(distance(free.direction, state.direction) < 1e-12, "it stays as it was held");
    page.lead(tool, [0.02, 0.08, 0.1], 0.0);
    page.step(1);
    assert_eq!(page.frame().instruments[0].direction, [0.0, -1.0, 0.0], "the hand leads it freely");
}

/// Nothing but the person changes it: not a parameter that rebuilds the world, not a scene that begins again, not a kept state. Tools that
/// were brought in and never led stay where they came in as well.
#[test]
fn tools_keep_place_and_trocar_when_the_world_is_built_anew() {
    let mut page = Page::open(&light_bar());
    let tip = [0.02, 0.08, 0.1];
    let tool = bring_in(&mut page, tip);
    page.step(3);
    let point = page.frame().instruments[0].trocar;
    let holds = |page: &Page, when: &str| {
        let state = &page.frame().instruments[0];
        assert!(distance(state.tip, tip) < 1e-12 && state.trocar == point, "{when}: {state:?}");
    };
    page.set("body.bar.law.young", 12e3);
    page.step(2);
    holds(&page, "after a parameter");
    page.say(Command::Reset {});
    page.step(2);
    holds(&page, "after a new beginning");
    page.say(Command::Ghost { on: true });
    page.say(Command::TakeSnapshot { slot: 0 });
    page.say(Command::SetTrocar { instrument: tool, trocar: Trocar::At([0.0, 0.3, 0.3]) });
    page.step(2);
    assert_ne!(page.frame().instruments[0].trocar, point);
    page.say(Command::RestoreSnapshot { slot: 0 });
    page.step(1);
    holds(&page, "after a kept state");
    assert_eq!(page.refusals(), []);
}

#[test]
fn trocars_of_nothing_and_nowhere_are_refused() {
    let mut page = Page::open(BAR);
    let tool = bring_in(&mut page, [0.02, 0.1, 0.06]);
    let before = page.frame().instruments[0].trocar;
    for (instrument, trocar) in
        [(9, Trocar::Wanted(true)), (9, Trocar::At([0.0; 3])), (tool, Trocar::At([f64::NAN, 0.0, 0.0]))]
    {
        page.say(Command::SetTrocar { instrument, trocar });
        assert_eq!(page.refusals().len(), 1, "{instrument} {trocar:?}");
    }
    page.step(1);
    assert_eq!(page.frame().instruments[0].trocar, before);
}

use viscera_session::library;
use viscera_session::message::{Command, ParameterKind, Value};

use crate::support::{BAR, Page, hybrid_bar};

/// The bar comes to rest lower the softer it is, from wherever it is when that changes.
#[test]
fn softer_tissue_sags_more_from_where_it_is() {
    let mut page = Page::open(BAR);
    page.step(100);
    let (stiff, steps) = (page.lowest(0), page.frame().steps);
    page.set("body.bar.law.young", 10e3);
    assert_eq!(page.lowest(0), stiff, "the change itself moves nothing");
    assert_eq!(page.frame().steps, steps, "and takes no time");
    page.step(100);
    let soft = page.lowest(0);
    // At small deflections it is in inverse proportion to Young's modulus: about twice as much, less what the bend takes.
    assert!(soft < 1.5 * stiff, "{soft} m, before {stiff} m");
    page.set("body.bar.law.young", 40e3);
    page.step(100);
    assert!(page.lowest(0) > stiff);
}

#[test]
fn gravity_that_is_turned_round_lifts() {
    let mut page = Page::open(BAR);
    page.step(50);
    let below = page.lowest(0);
    page.set("gravity", [0.0, 9.81, 0.0]);
    page.step(100);
    assert!(page.lowest(0) > below + 0.001);
}

/// Every value of every choice, one after the other: it goes on from there, or says why it cannot, and then nothing has changed.
#[test]
fn every_choice_of_every_scene_is_taken_or_refused_with_a_reason() {
    for text in
        [BAR, &BAR.replace("stable-neo-hookean", "st-venant-kirchhoff").replace("total-lagrangian", "tensor-mass")]
    {
        let mut page = Page::open(text);
        page.step(2);
        let parameters = page.scene().parameters.clone();
        for parameter in parameters {
            let ParameterKind::Choice { choices } = &parameter.kind else { continue };
            for choice in choices {
                page.set(&parameter.key, choice.name.as_str());
                let refusals = page.refusals();
                let now =
                    page.scene().parameters.iter().find(|known| known.key == parameter.key).unwrap().value.clone();
                if refusals.is_empty() {
                    assert_eq!(now, Value::Text(choice.name.clone()), "{}", parameter.key);
                } else {
                    assert!(!refusals[0].reason.is_empty() && refusals[0].key.as_deref() == Some(&parameter.key));
                }
                page.step(1);
            }
            page.say(Command::Set { key: parameter.key.clone(), value: parameter.default.clone() });
            assert_eq!(page.refusals(), [], "{} goes back to where it was", parameter.key);
        }
    }
}

/// Whoever tries another model or another law comes back to the region that the scene lets move.
#[test]
fn a_model_that_is_chosen_again_has_the_settings_of_the_scene() {
    let mut page = Page::open(&hybrid_bar());
    let opened = page.text();
    assert!(opened.contains("dynamic"), "{opened}");
    page.set("body.bar.model.kind", "hybrid");
    assert_eq!(page.text(), opened, "it is chosen already");
    page.set("body.bar.model.kind", "total-lagrangian");
    assert_eq!(page.refusals(), []);
    assert!(!page.text().contains("dynamic"), "another model has no such setting");
    page.step(1);
    page.set("body.bar.model.kind", "hybrid");
    assert_eq!(page.refusals(), []);
    assert_eq!(page.text(), opened);
    page.step(1);
}

/// A tissue that is chosen makes the scene that names it, and its own numbers come back.
#[test]
fn a_tissue_by_name_brings_its_law_its_numbers_and_its_density() {
    let own = r#"law = { kind = "stable-neo-hookean", young = 20e3, poisson = 0.4 }"#;
    let naming = |law: &str| BAR.replace("density = 1000\n", "").replace(own, law);
    let tissue = |page: &Page| {
        let known = page.scene().parameters.iter().find(|known| known.key == "body.bar.law.tissue").unwrap();
        known.value.clone()
    };
    let mut page = Page::open(BAR);
    let opened = page.text();
    assert_eq!(tissue(&page), Value::Text("own".into()));
    page.set("body.bar.law.tissue", "kidney");
    assert_eq!(page.refusals(), []);
    let mut kidney = Page::open(&naming(r#"law = { tissue = "kidney" }"#));
    assert_eq!((tissue(&page), tissue(&kidney)), (Value::Text("kidney".into()), Value::Text("kidney".into())));
    assert_eq!(page.text(), kidney.text());
    page.step(1);
    page.set("body.bar.law.young", 9e3);
    assert_eq!(tissue(&page), Value::Text("own".into()), "a kidney is stiffer");
    page.set("body.bar.law.tissue", "liver");
    page.set("body.bar.law.tissue", "own");
    assert_eq!(page.refusals(), []);
    assert_eq!(page.text(), opened);
    kidney.set("body.bar.law.tissue", "own");
    assert!(kidney.refusals()[0].help.contains("the scene has those of `kidney`"));
}

/// Fibres stay where the scene has them run, also after a tissue that has none.
#[test]
fn a_tissue_with_fibres_takes_their_course_from_the_scene() {
    let own = r#"kind = "stable-neo-hookean", young = 20e3, poisson = 0.4"#;
    let course = "fibre = { direction = [0, 0, 1], factor = 2 }";
    let mut page = Page::open(
        &BAR.replace(own, &format!(r#"kind = "st-venant-kirchhoff", young = 20e3, poisson = 0.4, {course}"#)),
    );
    let muscle = r#"tissue = "muscle", fibre = { direction = [0, 0, 1] }"#;
    let muscle = Page::open(&BAR.replace("density = 1000\n", "").replace(own, muscle)).text();
    page.set("body.bar.law.tissue", "muscle");
    assert_eq!(page.text(), muscle);
    page.set("body.bar.law.tissue", "liver");
    assert_eq!(page.notices(), ["the tissue `liver` has no fibres: they are left out"]);
    assert!(!page.text().contains("fibre"));
    page.set("body.bar.law.tissue", "muscle");
    assert_eq!(page.refusals(), []);
    assert_eq!(page.text(), muscle);
}

/// What a page shows is what the catalogue says: each value lies in its range, each default is what the scene file had.
#[test]
fn parameters_of_the_built_in_scenes_lie_in_their_ranges() {
    let mut page = Page::open(BAR);
    for (name, _) in library::scenes() {
        page.say(Command::OpenScene { name: name.into() });
        assert_eq!(page.refusals(), [], "{name}");
        for parameter in &page.scene().parameters {
            let inside = match (&parameter.kind, &parameter.value) {
                (ParameterKind::Number { least, most, low, high, .. }, Value::Number(value)) => {
                    least.is_none_or(|least| least <= *value) && most.is_none_or(|most| *value <= most) && low < high
                }
                (ParameterKind::Choice { choices }, Value::Text(name)) => {
                    choices.iter().any(|choice| choice.name == *name && choice.available)
                }
                (ParameterKind::Vector {}, Value::Vector(_)) | (ParameterKind::Flag {}, Value::Flag(_)) => true,
                _ => false,
            };
            assert!(inside, "{name}: {parameter:?}");
            assert_eq!(parameter.value, parameter.default, "{name}: {}", parameter.key);
        }
    }
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let mut page = Page::open(BAR);
    page.step(5);
    let (places, scene) = (page.positions(0), page.scene().clone());
    for (key, value, reason) in [
        ("body.bar.law.poisson", Value::Number(0.5), "below 0.5"),
        ("body.bar.law.young", Value::Number(-1.0), "above 0 Pa"),
        ("body.bar.law.young", Value::Text("soft".into()), "is a number"),
        ("body.bar.law.young", Value::Number(f64::NAN), "finite"),
        ("body.bar.law.kind", Value::Text("jelly".into()), "there is no `jelly`"),
        ("body.bar.model.kind", Value::Text("tensor-mass".into()), "cannot be chosen now"),
        ("step", Value::Number(0.0), "0.00001 s or more"),
        ("gravity", Value::Vector([0.0, f64::INFINITY, 0.0]), "not finite"),
        ("body.nobody.law.young", Value::Number(1.0), "no parameter"),
        ("body.bar.fix", Value::Text("all".into()), "no parameter"),
    ] {
        page.say(Command::Set { key: key.into(), value });
        let refusals = page.refusals();
        assert!(refusals.len() == 1 && refusals[0].reason.contains(reason), "{key}: {refusals:?}");
        assert_eq!(refusals[0].key.as_deref(), Some(key));
    }
    assert_eq!((page.positions(0), page.scene()), (places, &scene));
}

/// A slider sends many values; each is a change of the same thing, and the last is what counts.
#[test]
fn of_many_values_of_one_parameter_the_last_counts() {
    let mut page = Page::open(BAR);
    page.step(10);
    for value in [1e3, -1.0, 30e3] {
        let command = Command::Set { key: "body.bar.law.young".into(), value: Value::Number(value) };
        page.session.receive(&viscera_session::message::Request::from(command).encode());
    }
    page.listen();
    assert_eq!(page.refusals(), [], "the value that makes no sense was overtaken");
    let young = page.scene().parameters.iter().find(|known| known.key == "body.bar.law.young").unwrap();
    assert_eq!(young.value, Value::Number(30e3));
}

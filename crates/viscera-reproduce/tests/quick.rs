//! Every experiment, quick, with what has to hold; and the page that comes of it.

use std::collections::BTreeSet;
use std::fs;

use viscera_reproduce::{Amount, Chapter, EXPERIMENTS, Experiment, Part, Report, Section, Settings, Size};

/// Runs an experiment and holds it to its relations.
fn run(name: &str) -> Section {
    let settings = Settings { size: Size::Small, measured: None };
    let section = Experiment::named(name).unwrap().run(&settings).unwrap_or_else(|error| panic!("{name}: {error}"));
    for relation in &section.relations {
        assert!(relation.holds, "{name}: {}: {}", relation.claim, relation.measured);
    }
    // What differs from what was published is explained.
    for row in &section.comparisons {
        let differs = match (&row.published, &row.ours) {
            (Amount::Number { value: theirs, .. }, Amount::Number { value: ours, .. }) => {
                assert!(ours.is_finite(), "{name}: {}: {ours}", row.quantity);
                (ours / theirs - 1.0).abs() > 0.02
            }
            _ => false,
        };
        assert!(!differs || !row.why.is_empty(), "{name}: {} is not explained", row.quantity);
    }
    section
}

macro_rules! holds {
    ($($test:ident: $name:literal),+ $(,)?) => {
        $(#[test]
        fn $test() {
            run($name);
        })+

        /// No experiment is left out.
        #[test]
        fn every_experiment_has_its_test() {
            assert_eq!(EXPERIMENTS.map(|experiment| experiment.name).to_vec(), [$($name),+]);
        }
    };
}

holds! {
    linear_tissue_takes_a_turn_for_strain_and_the_rest_does_not: "rotation",
    linear_volume_grows_as_the_square_of_the_force: "cylinder",
    fibres_along_a_tube_make_it_give_way_less: "tubes",
    the_linear_liver_swells_and_the_others_hardly_do: "liver",
    the_higher_the_threshold_the_larger_the_error: "adaptive",
    a_lobe_is_burnt_off_with_a_part_of_the_vertices_non_linear: "resection",
    tables_explain_what_the_non_linear_model_costs: "cost",
    an_outdated_b_turns_tissue_only_where_theory_says_so: "torque",
    assembling_is_timed: "assembly",
    rotations_bring_inverted_tissue_back: "inversion",
    steps_are_timed: "speed",
    with_multigrid_iterations_do_not_grow_with_the_mesh: "multigrid",
    a_beam_sinks_as_theory_says: "beam",
    cantilevers_bend_as_in_other_programs: "cantilevers",
    tissue_that_keeps_its_volume_locks_plain_elements: "nearly-incompressible",
    without_its_beads_the_truth_cube_is_not_run: "truth-cube",
    extrapolated_forces_are_off_by_their_order: "extrapolation",
}

/// A report of pictures, of plots and of what is not run is one page that needs no other file; and there is a file for each table, plot and
/// picture.
#[test]
fn the_page_needs_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings { size: Size::Small, measured: None };
    let mut report = Report { command: "viscera reproduce <&>".into(), ..Report::default() };
    let mut expected = BTreeSet::new();
    for name in ["liver", "assembly", "truth-cube"] {
        let chapter = Chapter::run(Experiment::named(name).unwrap(), &settings);
        assert!(chapter.is_good());
        for part in &chapter.found.as_ref().unwrap().parts {
            match part {
                Part::Text(_) => {}
                Part::Table(_, table) => _ = expected.insert(format!("{name}/{}.csv", table.name())),
                Part::Plot(plot) => _ = expected.insert(format!("{name}/{}.svg", plot.name)),
                Part::Pictures(pictures) => {
                    expected.extend(pictures.iter().map(|picture| format!("{name}/{}.png", picture.name)));
                }
            }
        }
        report.chapters.push(chapter);
        report.write(folder.path()).unwrap();
    }
    let page = fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert!(page.contains("viscera reproduce &lt;&amp;&gt;") && page.contains("href=\"#assembly\""));
    assert!(page.contains("data:image/png;base64,") && page.contains("<svg width") && page.contains("not run"));
    // Nothing is fetched: no address but those that name the format of a drawing.
    for (place, _) in page.match_indices("http") {
        assert!(page[place..].starts_with("http://www.w3.org/"), "{}", &page[place..place + 60]);
    }
    for file in expected {
        let bytes = fs::read(folder.path().join(&file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(bytes.len() > 40, "{file}");
    }
}

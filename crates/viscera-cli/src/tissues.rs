//! `viscera tissues`: the tissues that scenes can name, their numbers and where these come from.

use std::fmt::Write;

use viscera::material::{Evidence, Measured, TissuePreset};

use crate::arguments::TissuesArguments;
use crate::failure::Failure;
use crate::tables::{table, table_text};
use crate::terminal;

pub(crate) fn tissues(arguments: &TissuesArguments) -> Result<(), Failure> {
    let presets: Vec<&TissuePreset> = match &arguments.name {
        None => TissuePreset::ALL.iter().collect(),
        Some(name) => vec![TissuePreset::named(name).ok_or_else(|| unknown(name))?],
    };
    terminal::say(&match (&arguments.name, arguments.json, arguments.markdown) {
        (_, true, _) => serde_json::to_string_pretty(&presets)
            .map_err(|error| Failure::problem(format!("the tissues cannot be written as JSON: {error}")))?,
        (_, _, true) => presets.iter().map(|preset| chapter(preset)).collect(),
        (None, ..) => list(&presets),
        (Some(_), ..) => presets.iter().map(|preset| in_full(preset)).collect(),
    });
    Ok(())
}

fn unknown(name: &str) -> Failure {
    let known: Vec<String> = TissuePreset::ALL.iter().map(|preset| preset.name.to_owned()).collect();
    let guess = viscera_scene::closest(name, &known).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
    Failure::input(format!("there is no tissue `{name}`{guess}; known: {}", known.join(", ")))
}

/// One line for each.
fn list(presets: &[&TissuePreset]) -> String {
    let mut lines = table(&["tissue", "E", "from", "to", "E along fibres", "ν", "ρ kg/m³", "measured on"]);
    for preset in presets {
        let TissuePreset { name, young, fibre, poisson, density, .. } = preset;
        lines.add_row([
            (*name).to_owned(),
            pressure(young.value),
            pressure(young.range.0),
            pressure(young.range.1),
            fibre.map_or(String::new(), |fibre| pressure(fibre.young.value)),
            poisson.value.to_string(),
            density.value.to_string(),
            young.species.to_owned(),
        ]);
    }
    format!(
        "{}\n\nin a scene: law = {{ tissue = \"liver\" }}; sources and states: viscera tissues NAME",
        table_text(&lines)
    )
}

/// Every number of a tissue, with what it is called.
fn numbers(preset: &TissuePreset) -> Vec<(String, &'static str, Measured)> {
    let across = if preset.fibre.is_some() { "Young's modulus across the fibres" } else { "Young's modulus" };
    let along = preset.fibre.map(|fibre| (format!("Young's modulus {}", fibre.course), "Pa", fibre.young));
    let mut numbers = vec![(across.to_owned(), "Pa", preset.young)];
    numbers.extend(along);
    numbers.push(("Poisson's ratio".to_owned(), "", preset.poisson));
    numbers.push(("density".to_owned(), "kg/m³", preset.density));
    numbers
}

fn in_full(preset: &TissuePreset) -> String {
    let mut text = terminal::heading(preset.title);
    let _ = write!(text, "\n{}", laws(preset));
    for (name, unit, number) in numbers(preset) {
        let _ = write!(text, "\n\n{name}: {}, reported {}", quantity(number.value, unit), range(&number, unit));
        let _ = write!(text, "\n  tissue  {}\n  state   {}\n  source  {}", number.species, number.state, number.source);
        let _ = write!(text, "\n  value   {}", number.evidence.words());
        if let Some(weakness) = number.weakness {
            let _ = write!(text, "\n  weak    {weakness}");
        }
    }
    text
}

/// A chapter of the guide.
fn chapter(preset: &TissuePreset) -> String {
    let mut text = format!("### `{}`: {}\n\n{}.\n\n", preset.name, preset.title, laws(preset));
    text.push_str("| | value | reported | tissue and state | source |\n|---|---|---|---|---|\n");
    for (name, unit, number) in numbers(preset) {
        let weak = number.weakness.map_or(String::new(), |weakness| format!("; **weak data**: {weakness}"));
        let cited = if number.evidence == Evidence::Cited { "; **as cited**" } else { "" };
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {}; {}{cited}{weak} | {} |",
            quantity(number.value, unit),
            range(&number, unit),
            number.species,
            number.state,
            number.source
        );
    }
    text.push('\n');
    text
}

fn laws(preset: &TissuePreset) -> String {
    let with_fibres = if preset.fibre.is_some() { ", `transverse-st-venant-kirchhoff` with `fibre`" } else { "" };
    format!("law `{}`{with_fibres}", preset.law)
}

fn range(number: &Measured, unit: &str) -> String {
    let (least, most) = number.range;
    if least == most { "the same".to_owned() } else { format!("{} to {}", quantity(least, unit), quantity(most, unit)) }
}

fn quantity(value: f64, unit: &str) -> String {
    match unit {
        "Pa" => pressure(value),
        "" => value.to_string(),
        unit => format!("{value} {unit}"),
    }
}

/// Three digits are more than any of these numbers deserves.
fn pressure(pascal: f64) -> String {
    let (value, unit) = if pascal < 1e6 { (pascal / 1e3, "kPa") } else { (pascal / 1e6, "MPa") };
    format!("{} {unit}", (value * 100.0).round() / 100.0)
}

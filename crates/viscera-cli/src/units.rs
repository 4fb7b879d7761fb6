//! Quantities as a person types them: a number is SI, a unit may follow.

use viscera_scene::file::LengthUnit;
use viscera_scene::unit::{Dimension, LENGTH, TIME};

/// A positive length, such as `0.3`, `30cm` or `"30 cm"` [m].
pub(crate) fn length(text: &str) -> Result<f64, String> {
    positive(text, &LENGTH)
}

/// A positive time, such as `0.5`, `500ms` or `"10 min"` [s].
pub(crate) fn time(text: &str) -> Result<f64, String> {
    // Hours are for runs: no scene lasts one, and its units stay as they are.
    let hours = text.trim().strip_suffix('h').and_then(|number| number.trim().parse::<f64>().ok());
    match hours {
        Some(hours) => positive(&format!("{}", 3600.0 * hours), &TIME),
        None => positive(text, &TIME),
    }
}

fn positive(text: &str, dimension: &Dimension) -> Result<f64, String> {
    let value = match text.trim().parse::<f64>() {
        Ok(value) => value,
        Err(_) => dimension.parse(text).map_err(|error| format!("{error}; {}", dimension.advice()))?,
    };
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(format!("{} must be positive and finite", dimension.with_article()))
    }
}

/// The unit of a file's coordinates, by its symbol.
pub(crate) fn length_unit(symbol: &str) -> Result<LengthUnit, String> {
    serde_json::from_value(symbol.into()).map_err(|_| "known: m, cm, mm, um, in".to_owned())
}

/// A number with a prefix that leaves one to three digits before the point: `12.3 mJ`.
pub(crate) fn with_prefix(value: f64, unit: &str) -> String {
    const PREFIXES: [(&str, f64); 7] =
        [("n", 1e-9), ("µ", 1e-6), ("m", 1e-3), ("", 1.0), ("k", 1e3), ("M", 1e6), ("G", 1e9)];
    // 0.9995 of a prefix is already shown as 1.00 of it.
    let fitting = PREFIXES.iter().rev().find(|(_, factor)| value.abs() >= 0.9995 * factor);
    match fitting {
        _ if value == 0.0 => format!("0 {unit}"),
        _ if !value.is_finite() => format!("{value} {unit}"),
        Some((prefix, factor)) => {
            let scaled = value / factor;
            let decimals = if scaled.abs() < 9.995 { 2 } else { usize::from(scaled.abs() < 99.95) };
            format!("{scaled:.decimals$} {prefix}{unit}")
        }
        None => format!("{value:.1e} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_is_shown_with_three_digits_and_the_prefix_that_fits() {
        let shown = [0.01234, -5.0, 0.0, 999.6, 1e-12, 123.4].map(|value| with_prefix(value, "N"));
        assert_eq!(shown, ["12.3 mN", "-5.00 N", "0 N", "1.00 kN", "1.0e-12 N", "123 N"]);
    }

    #[test]
    fn a_time_is_in_seconds_or_says_its_unit() {
        assert_eq!(["0.5", "500 ms", "10 min", "1 h", "1.5h"].map(time), [0.5, 0.5, 600.0, 3600.0, 5400.0].map(Ok));
        assert!(time("0").unwrap_err().contains("must be positive"));
        assert!(time("5 m").unwrap_err().contains("found the length"));
    }

    #[test]
    fn a_length_is_in_metres_or_says_its_unit() {
        assert_eq!(length("0.3"), Ok(0.3));
        assert_eq!(length("30 cm"), Ok(0.3));
        assert!(length("5 kg").unwrap_err().contains("found the mass"), "{:?}", length("5 kg"));
        assert!(length("-1").unwrap_err().contains("must be positive"));
        assert_eq!(length_unit("mm"), Ok(LengthUnit::Millimetre));
        assert_eq!(length_unit("ft"), Err("known: m, cm, mm, um, in".to_owned()));
    }
}

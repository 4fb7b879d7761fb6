//! Lengths, areas and volumes for people to read: four digits, in the unit in which they are said.

/// A length [m].
pub(crate) fn length(metres: f64) -> String {
    in_the_largest(metres, &[(1.0, "m"), (1e-3, "mm"), (1e-6, "µm")])
}

/// An area [m²].
pub(crate) fn area(square_metres: f64) -> String {
    in_the_largest(square_metres, &[(1.0, "m²"), (1e-4, "cm²"), (1e-6, "mm²"), (1e-12, "µm²")])
}

/// A volume [m³].
pub(crate) fn volume(cubic_metres: f64) -> String {
    in_the_largest(cubic_metres, &[(1.0, "m³"), (1e-6, "cm³"), (1e-9, "mm³"), (1e-18, "µm³")])
}

/// In the largest unit of which there is a tenth at least; the units go from the largest to the smallest, and the first has no prefix.
fn in_the_largest(value: f64, units: &[(f64, &str)]) -> String {
    let (factor, unit) = match units.iter().find(|(factor, _)| value.abs() >= 0.1 * *factor) {
        Some(&unit) => unit,
        None if value == 0.0 => units[0],
        None => return format!("{value:.3e} {}", units[0].1),
    };
    let scaled = value / factor;
    let before = if scaled == 0.0 { 0 } else { scaled.abs().log10().floor().max(0.0) as usize };
    format!("{scaled:.*} {unit}", 3usize.saturating_sub(before))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_are_said_in_the_unit_that_fits() {
        assert_eq!(
            [8e-3, 0.0853612, 1.5, 250.0, 4e-7].map(length),
            ["8.000 mm", "85.36 mm", "1.500 m", "250.0 m", "0.400 µm"]
        );
        assert_eq!([6.2708e-3, 0.5, 2.0].map(area), ["62.71 cm²", "0.500 m²", "2.000 m²"]);
        assert_eq!([3.1765e-5, 2e-9, -2e-3, 0.0].map(volume), ["31.77 cm³", "2.000 mm³", "-2000 cm³", "0.000 m³"]);
    }
}

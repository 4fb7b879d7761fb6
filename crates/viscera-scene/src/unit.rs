//! Units: what a string such as `"5 kPa"` means in SI.

use std::f64::consts::PI;

/// One kind of quantity and the units that it may be written in, the SI unit first.
#[derive(Debug, PartialEq)]
pub struct Dimension {
    /// What a message calls it: "length".
    pub name: &'static str,
    /// Symbol, and the factor to SI as numerator and denominator.
    ///
    /// Two numbers, because dividing by 100 rounds "30 cm" to the bits of 0.3 and multiplying by 0.01 does not.
    pub units: &'static [(&'static str, f64, f64)],
}

macro_rules! dimensions {
    ($($constant:ident = $name:literal { $($symbol:literal = $numerator:expr, $denominator:expr;)+ })+) => {
        $(
            #[doc = concat!("The dimension ", $name, ".")]
            pub const $constant: Dimension =
                Dimension { name: $name, units: &[$(($symbol, $numerator, $denominator)),+] };
        )+
        /// Every dimension.
        pub const DIMENSIONS: &[Dimension] = &[$($constant),+];
    };
}

dimensions! {
    LENGTH = "length" {
        "m" = 1.0, 1.0; "cm" = 1.0, 1e2; "mm" = 1.0, 1e3; "µm" = 1.0, 1e6; "um" = 1.0, 1e6; "km" = 1e3, 1.0;
    }
    TIME = "time" { "s" = 1.0, 1.0; "ms" = 1.0, 1e3; "µs" = 1.0, 1e6; "us" = 1.0, 1e6; "min" = 60.0, 1.0; }
    MASS = "mass" { "kg" = 1.0, 1.0; "g" = 1.0, 1e3; "mg" = 1.0, 1e6; }
    DENSITY = "density" {
        "kg/m^3" = 1.0, 1.0; "kg/m³" = 1.0, 1.0; "g/cm^3" = 1e3, 1.0; "g/cm³" = 1e3, 1.0; "g/ml" = 1e3, 1.0;
    }
    PRESSURE = "pressure" {
        "Pa" = 1.0, 1.0; "kPa" = 1e3, 1.0; "MPa" = 1e6, 1.0; "GPa" = 1e9, 1.0; "N/m^2" = 1.0, 1.0; "N/m²" = 1.0, 1.0;
        "mmHg" = 133.322_387_415, 1.0;
    }
    STIFFNESS = "stiffness" { "N/m" = 1.0, 1.0; "N/mm" = 1e3, 1.0; "mN/m" = 1.0, 1e3; }
    FORCE = "force" { "N" = 1.0, 1.0; "mN" = 1.0, 1e3; "kN" = 1e3, 1.0; }
    ACCELERATION = "acceleration" { "m/s^2" = 1.0, 1.0; "m/s²" = 1.0, 1.0; }
    FORCE_DENSITY = "force density" {
        "N/m^3" = 1.0, 1.0; "N/m³" = 1.0, 1.0; "kN/m^3" = 1e3, 1.0; "kN/m³" = 1e3, 1.0; "N/cm^3" = 1e6, 1.0;
        "N/cm³" = 1e6, 1.0;
    }
    ANGLE = "angle" { "rad" = 1.0, 1.0; "deg" = PI, 180.0; "°" = PI, 180.0; }
    RATE = "rate" { "1/s" = 1.0, 1.0; "s^-1" = 1.0, 1.0; "Hz" = 1.0, 1.0; }
    POWER = "power" { "W" = 1.0, 1.0; "mW" = 1.0, 1e3; "kW" = 1e3, 1.0; }
    ENERGY_DENSITY = "energy density" {
        "J/m^3" = 1.0, 1.0; "J/m³" = 1.0, 1.0; "J/cm^3" = 1e6, 1.0; "J/cm³" = 1e6, 1.0; "J/mm^3" = 1e9, 1.0;
        "J/mm³" = 1e9, 1.0;
    }
}

/// Why a string is not a quantity of the wanted dimension.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The string does not begin with a number.
    #[error("expected {wanted}, found \"{text}\", which does not begin with a number")]
    NoNumber {
        /// What was wanted, with its article.
        wanted: String,
        /// The string.
        text: String,
    },
    /// The number is so large that it is infinite.
    #[error("\"{text}\" is too large a number")]
    TooLarge {
        /// The string.
        text: String,
    },
    /// A string without a unit; a bare number would be SI.
    #[error("\"{text}\" has no unit")]
    NoUnit {
        /// The string.
        text: String,
    },
    /// No dimension has this unit.
    #[error("unknown unit `{unit}` for {wanted}")]
    Unknown {
        /// What was wanted, with its article.
        wanted: String,
        /// The unit as written.
        unit: String,
    },
    /// The unit belongs to another dimension.
    #[error("expected {wanted}, found the {found} \"{text}\"")]
    Dimension {
        /// What was wanted, with its article.
        wanted: String,
        /// The dimension that the unit has.
        found: &'static str,
        /// The string.
        text: String,
    },
}

impl Dimension {
    /// The dimension with this name.
    pub fn named(name: &str) -> Option<&'static Dimension> {
        DIMENSIONS.iter().find(|dimension| dimension.name == name)
    }

    /// "a length", "an angle".
    pub fn with_article(&self) -> String {
        with_article(self.name)
    }

    /// The SI unit.
    pub fn si(&self) -> &'static str {
        self.units[0].0
    }

    /// How the quantity may be written, for a message.
    pub fn advice(&self) -> String {
        let symbols: Vec<_> = self.units.iter().map(|unit| unit.0).collect();
        format!("write a number in {}, or a string with one of the units {}", self.si(), symbols.join(", "))
    }

    /// Value in SI of a string such as `"5 kPa"`.
    ///
    /// # Errors
    /// [`UnitError`], which says what the string is instead.
    pub fn parse(&self, text: &str) -> Result<f64, UnitError> {
        let wanted = || self.with_article();
        let (number, symbol) =
            split(text).ok_or_else(|| UnitError::NoNumber { wanted: wanted(), text: text.to_owned() })?;
        if !number.is_finite() {
            return Err(UnitError::TooLarge { text: text.to_owned() });
        }
        if symbol.is_empty() {
            return Err(UnitError::NoUnit { text: text.to_owned() });
        }
        // Keyboards write U+00B5 (micro) and U+03BC (mu) for the same sign.
        let symbol = symbol.replace('μ', "µ");
        let of = |dimension: &Dimension| dimension.units.iter().copied().find(|unit| unit.0 == symbol);
        match of(self) {
            Some((_, numerator, denominator)) => Ok(number * numerator / denominator),
            None => Err(match DIMENSIONS.iter().find(|dimension| of(dimension).is_some()) {
                Some(other) => UnitError::Dimension { wanted: wanted(), found: other.name, text: text.to_owned() },
                None => UnitError::Unknown { wanted: wanted(), unit: symbol },
            }),
        }
    }

    /// A regular expression for what [`Self::parse`] accepts, for editors.
    pub fn pattern(&self) -> String {
        let symbols: Vec<_> = self.units.iter().map(|unit| unit.0.replace('^', "\\^")).collect();
        format!("^\\s*[-+]?[0-9.][0-9.eE+-]*\\s*({})\\s*$", symbols.join("|"))
    }
}

/// The longest leading number and the rest, both trimmed.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let ends = text.char_indices().rev().map(|(at, letter)| (at + letter.len_utf8(), letter));
    ends.filter(|(_, letter)| letter.is_ascii_digit() || *letter == '.')
        .find_map(|(end, _)| Some((text[..end].parse().ok()?, text[end..].trim())))
}

/// "a length", "an instrument".
pub(crate) fn with_article(noun: &str) -> String {
    format!("{} {noun}", if noun.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit changes nothing but the way a number is written: the bits are those of the SI literal.
    #[test]
    fn a_unit_gives_the_bits_of_the_si_literal() {
        for (dimension, text, si) in [
            (&LENGTH, "30 cm", 0.3),
            (&LENGTH, "2mm", 0.002),
            (&LENGTH, " 12.5 µm ", 12.5e-6),
            (&LENGTH, "12.5 μm", 12.5e-6),
            (&TIME, "20 ms", 0.02),
            (&PRESSURE, "5 kPa", 5000.0),
            (&PRESSURE, "1.2e-2 MPa", 12000.0),
            (&DENSITY, "1060 kg/m^3", 1060.0),
            (&DENSITY, "1.06 g/cm³", 1060.0),
            (&FORCE, "-12 mN", -0.012),
            (&ACCELERATION, "9.81 m/s^2", 9.81),
            (&FORCE_DENSITY, "2.5 kN/m^3", 2500.0),
            (&ANGLE, "180 deg", PI),
            (&RATE, "5 1/s", 5.0),
            (&POWER, "40 W", 40.0),
            (&ENERGY_DENSITY, "2.4 J/mm^3", 2.4e9),
        ] {
            assert_eq!(dimension.parse(text), Ok(si), "{text}");
        }
    }

    /// One millimetre of mercury is 133.322 Pa (BIPM SI brochure, 8th edition, table 8).
    #[test]
    fn blood_pressure_may_be_written_in_millimetres_of_mercury() {
        let systolic = PRESSURE.parse("120 mmHg");
        assert!(systolic.is_ok_and(|pascal| (pascal - 15_998.7).abs() < 0.05));
    }

    #[test]
    fn every_refusal_says_what_the_string_is_instead() {
        let refusal = |text: &str| LENGTH.parse(text).map_err(|error| error.to_string());
        assert_eq!(refusal("5 kg"), Err("expected a length, found the mass \"5 kg\"".into()));
        assert_eq!(refusal("5 miles"), Err("unknown unit `miles` for a length".into()));
        assert_eq!(refusal("5"), Err("\"5\" has no unit".into()));
        assert_eq!(
            refusal("long"),
            Err("expected a length, found \"long\", which does not begin with a number".into())
        );
        assert_eq!(
            refusal("inf m"),
            Err("expected a length, found \"inf m\", which does not begin with a number".into())
        );
        assert_eq!(refusal("1e999 m"), Err("\"1e999 m\" is too large a number".into()));
    }
}

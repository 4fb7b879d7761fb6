//! A quantity as it stands in a comparison.

use viscera_validation::brief;

/// A number with its unit, or words where a paper has a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Amount {
    /// A number.
    Number {
        /// It.
        value: f64,
        /// Its unit, as written behind it; empty for a ratio.
        unit: &'static str,
    },
    /// What a picture or a sentence says.
    Words(String),
}

impl Amount {
    /// A number with its unit.
    pub fn number(value: f64, unit: &'static str) -> Self {
        Self::Number { value, unit }
    }

    /// As it is read; a minus sign is one.
    pub fn text(&self) -> String {
        match self {
            Self::Words(words) => words.clone(),
            Self::Number { value, unit } => {
                let number = brief(*value).replace('-', "−");
                if unit.is_empty() { number } else { format!("{number} {unit}") }
            }
        }
    }

    /// How far `self` is from `published`: in per cent where that is within a half and double, else as a factor; a dash between words.
    pub fn difference_from(&self, published: &Self) -> String {
        let (Self::Number { value: ours, .. }, Self::Number { value: theirs, .. }) = (self, published) else {
            return "–".into();
        };
        let ratio = ours / theirs;
        match ratio {
            ratio if !ratio.is_finite() => "–".into(),
            ratio if (ratio - 1.0).abs() < 5e-4 => "none".into(),
            ratio if (0.5..=2.0).contains(&ratio) => format!("{:+.1} %", 100.0 * (ratio - 1.0)).replace('-', "−"),
            ratio => format!("× {}", brief(ratio).replace('-', "−")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_per_cents_near_and_factors_far_away() {
        let published = Amount::number(4.0, "%");
        let from = |value: f64| Amount::number(value, "%").difference_from(&published);
        assert_eq!(
            [4.0, 3.0, 8.0, 20.0, 1.0, -1.0].map(from),
            ["none", "−25.0 %", "+100.0 %", "× 5.00", "× 0.250", "× −0.250"]
        );
        assert_eq!(Amount::Words("grows".into()).difference_from(&published), "–");
    }
}

//! What has to hold between the numbers of an experiment, whatever mesh or machine it runs on.

use viscera_validation::brief;

/// A claim, what was measured for it, and whether it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Relation {
    /// In words.
    pub claim: String,
    /// What was measured, and the bound.
    pub measured: String,
    /// Whether it holds.
    pub holds: bool,
}

impl Relation {
    /// `measured` is `expected`, but for a share of it.
    pub fn near(claim: impl Into<String>, measured: f64, expected: f64, share: f64) -> Self {
        let holds = (measured - expected).abs() <= share * expected.abs();
        let bound = if share < 1e-4 { format!("{share:.0e}") } else { format!("{} %", brief(100.0 * share)) };
        let measured = format!("{} for {} ± {bound}", brief(measured), brief(expected));
        Self { claim: claim.into(), measured, holds }
    }

    /// `measured` is no more than `limit`.
    pub fn at_most(claim: impl Into<String>, measured: f64, limit: f64) -> Self {
        let holds = measured <= limit;
        Self { claim: claim.into(), measured: format!("{} ≤ {}", brief(measured), brief(limit)), holds }
    }

    /// `measured` is no less than `limit`.
    pub fn at_least(claim: impl Into<String>, measured: f64, limit: f64) -> Self {
        let holds = measured >= limit;
        Self { claim: claim.into(), measured: format!("{} ≥ {}", brief(measured), brief(limit)), holds }
    }

    /// Each of `values` is less than the one before.
    pub fn falls(claim: impl Into<String>, values: &[f64]) -> Self {
        let holds = values.windows(2).all(|pair| pair[1] < pair[0]);
        let measured = values.iter().map(|&value| brief(value)).collect::<Vec<_>>().join(" > ");
        Self { claim: claim.into(), measured, holds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is not a number holds nowhere.
    #[test]
    fn relations_hold_within_their_bounds_and_never_for_what_is_no_number() {
        assert!(Relation::near("", 4.01, 4.0, 0.01).holds && !Relation::near("", 4.1, 4.0, 0.01).holds);
        assert!(Relation::near("", -4.01, -4.0, 0.01).holds);
        assert!(Relation::at_most("", 1.0, 1.0).holds && !Relation::at_least("", 0.9, 1.0).holds);
        assert!(Relation::falls("", &[3.0, 2.0, -1.0]).holds && !Relation::falls("", &[3.0, 3.0]).holds);
        let none = f64::NAN;
        assert!(!Relation::near("", none, 1.0, 1.0).holds && !Relation::falls("", &[1.0, none]).holds);
        assert!(!Relation::at_most("", none, 1.0).holds && !Relation::at_least("", none, 1.0).holds);
    }
}

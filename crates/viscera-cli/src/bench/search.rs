//! The largest size whose steps are made in time, by bisection.

use super::organ::Measured;
use crate::failure::Failure;

/// Sizes between which is searched: fewer cells are no organ, and more than these do not fit into ordinary memory.
const FEWEST: f64 = 1e3;
const MOST: f64 = 8e6;
/// The first size that is measured.
const FIRST: f64 = 2e4;
/// From one measurement to the next the size changes by this factor at most, as long as one side of the answer is open.
const STRIDE: f64 = 16.0;
/// The most measurements: each halves the interval at least, and rounding of meshes ends it.
const TRIALS: usize = 16;

/// What a search found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    /// The largest size that was made in time, and none larger by more than the tolerance is.
    Largest(Measured),
    /// This size is made in time, and a larger one was not tried.
    AtLeast(Measured),
    /// Not even this size is made in time.
    Less(Measured),
}

/// Finds the largest size at which `measure` takes no more than `budget` [s] for a step, within the share `tolerance`.
pub(super) fn largest(
    budget: f64,
    tolerance: f64,
    mut measure: impl FnMut(f64) -> Result<Measured, Failure>,
) -> Result<Found, Failure> {
    let (mut fits, mut fails): (Option<Measured>, Option<Measured>) = (None, None);
    let mut wanted = FIRST;
    for _ in 0..TRIALS {
        let now = measure(wanted)?;
        let side = if now.time <= budget { &mut fits } else { &mut fails };
        // Meshes come in steps of their own: the same size again tells nothing new.
        let stands_still = side.is_some_and(|before| before.cells == now.cells);
        *side = Some(now);
        wanted = match (fits, fails) {
            (Some(low), Some(high)) => {
                let (low, high) = (low.cells as f64, high.cells as f64);
                if high <= low * (1.0 + tolerance) || stands_still {
                    break;
                }
                (low * high).sqrt()
            }
            // Time goes about with the size; a little beyond the guess, so that the answer lies between.
            (Some(low), None) if wanted < MOST => guess(&low, budget, 1.1).min(MOST),
            (None, Some(high)) if wanted > FEWEST => guess(&high, budget, 1.0 / 1.1).max(FEWEST),
            _ => break,
        };
    }
    Ok(match (fits, fails) {
        (Some(largest), Some(_)) => Found::Largest(largest),
        (Some(largest), None) => Found::AtLeast(largest),
        (None, Some(smallest)) => Found::Less(smallest),
        (None, None) => unreachable!("at least one size is measured"),
    })
}

fn guess(measured: &Measured, budget: f64, beyond: f64) -> f64 {
    measured.cells as f64 * (budget / measured.time * beyond).clamp(1.0 / STRIDE, STRIDE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps that take so long for each cell, and twice that from a size on where they leave the cache.
    fn search(each: f64, budget: f64) -> (Found, usize) {
        let mut trials = 0;
        let found = largest(budget, 0.02, |cells| {
            trials += 1;
            let time = each * cells * if cells > 3e5 { 2.0 } else { 1.0 };
            Ok(Measured { cells: cells as usize, nodes: 0, edge: 0.0, time, substeps: 1.0 })
        });
        (found.expect("nothing fails"), trials)
    }

    #[test]
    fn the_largest_size_in_time_is_found_within_the_tolerance() {
        for (each, expected) in [(1e-8, 1e5), (2e-7, 5e3), (1e-9, 5e5), (2.5e-9, 3e5)] {
            let (found, trials) = search(each, 1e-3);
            let Found::Largest(largest) = found else { panic!("{found:?}") };
            let share = largest.cells as f64 / expected;
            assert!((0.98..=1.0).contains(&share), "{largest:?} for {expected}");
            assert!(trials <= 13, "{trials} trials");
        }
    }

    #[test]
    fn a_machine_that_is_too_fast_or_too_slow_is_told() {
        assert!(matches!(search(1e-12, 1e-3).0, Found::AtLeast(measured) if measured.cells == 8_000_000));
        assert!(matches!(search(1e-3, 1e-3).0, Found::Less(measured) if measured.cells == 1000));
    }
}

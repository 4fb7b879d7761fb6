//! The measured beads.

use std::path::Path;

use crate::ValidationError;
use crate::references::Vector;

/// Strains of the four states, by the plate's nominal way over 80 mm.
pub(super) const STRAINS: [f64; 3] = [0.05, 0.125, 0.1825];

/// Displacement [m] of every bead at every strain, beads in the order of the reference case: x slowest, then y, then z, in the
/// axes of the model, which are x, −y, −z of the scanner; so the second index of the file runs against y.
pub(super) fn read(path: &Path) -> Result<[Vec<Vector>; 3], ValidationError> {
    let text = std::fs::read_to_string(path).map_err(|error| ValidationError::File { path: path.into(), error })?;
    let problem = |line: usize, what: String| ValidationError::Beads { path: path.into(), line, what };
    let mut displacements: [Vec<Vector>; 3] = std::array::from_fn(|_| vec![Vector::ZERO; 343]);
    let mut seen = vec![false; 343];
    for (number, line) in text.lines().enumerate() {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        // Titles come first; a bead has three indices and four positions.
        let Ok(indices) = cells.iter().take(3).map(|cell| cell.parse::<usize>()).collect::<Result<Vec<_>, _>>() else {
            continue;
        };
        let values: Vec<f64> = cells.iter().skip(3).take(12).filter_map(|cell| cell.parse().ok()).collect();
        let (&[i, j, k], 12) = (indices.as_slice(), values.len()) else {
            return Err(problem(number + 1, "three indices and four positions of three numbers are expected".into()));
        };
        if [i, j, k].iter().any(|index| !(1..=7).contains(index)) {
            return Err(problem(number + 1, format!("a bead ({i}, {j}, {k}); indices go from 1 to 7")));
        }
        let bead = (i - 1) * 49 + (7 - j) * 7 + (k - 1);
        if std::mem::replace(&mut seen[bead], true) {
            return Err(problem(number + 1, format!("the bead ({i}, {j}, {k}) a second time")));
        }
        let place =
            |state: usize| Vector::new(values[3 * state], -values[3 * state + 1], -values[3 * state + 2]) * 1e-3;
        for (state, displacements) in displacements.iter_mut().enumerate() {
            displacements[bead] = place(state + 1) - place(0);
        }
    }
    match seen.iter().position(|seen| !seen) {
        Some(bead) => {
            let (i, j, k) = (bead / 49 + 1, 7 - bead / 7 % 7, bead % 7 + 1);
            Err(problem(text.lines().count(), format!("the bead ({i}, {j}, {k}) is missing")))
        }
        None => Ok(displacements),
    }
}

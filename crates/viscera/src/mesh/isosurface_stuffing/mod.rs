//! Isosurface stuffing: tetrahedra of bounded dihedral angles inside any smooth solid.
//!
//! A body-centred cubic lattice of good tetrahedra is laid over the solid. Lattice nodes that the skin passes closely are
//! moved onto it (`warp`); the tetrahedra that it still cuts are replaced by the part inside (`stencil`). Nodes on the
//! skin lie exactly on it, and no cell is thin, however the skin runs: the angles come from the lattice and the thresholds
//! of warping, not from the solid.
//!
//! Source: F. Labelle, J. R. Shewchuk, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles", ACM
//! Transactions on Graphics 26(3), 2007, the uniform lattice.

mod lattice;
mod pinches;
mod skin;
mod stencil;
mod warp;

use super::{GenerateError, SignedDistance, TetMesh};
use lattice::Lattice;
use skin::{Skin, crossings};

impl TetMesh {
    /// Fills a solid with tetrahedra whose lattice has cubes of the given `edge` [m].
    ///
    /// The edges of inner cells are `edge` and 0.87 `edge` long, their volume is `edge³ / 12`; all dihedral angles lie
    /// between 10.7° and 164.8°. The skin is a closed manifold. Creases are rounded off at the size of an edge, and parts
    /// thinner than about an edge are lost: [`SignedDistance`] is asked at the lattice nodes only.
    ///
    /// # Errors
    /// [`GenerateError::Length`] for an edge or an extent that is not positive, [`GenerateError::TooFine`] beyond
    /// about 10⁸ cells, [`GenerateError::NothingInside`] where no lattice node lies inside the solid.
    pub fn from_signed_distance(solid: &impl SignedDistance, edge: f64) -> Result<Self, GenerateError> {
        let lattice = Lattice::around(solid.bounds(), edge)?;
        let mut skin = Skin::sample(&lattice, |place| solid.distance(place));
        let mut cuts = crossings(&lattice, &skin, |place| solid.distance(place));
        warp::onto_skin(&lattice, &mut skin, &mut cuts);
        let mut mesh = stencil::fill(&lattice, &skin, &cuts, |place| solid.distance(place));
        pinches::open(&mut mesh);
        if mesh.cells.is_empty() { Err(GenerateError::NothingInside { edge }) } else { Ok(mesh) }
    }

    /// The edge [m] with which [`from_signed_distance`](Self::from_signed_distance) makes about `cells` tetrahedra: the
    /// best of six trials, usually within 1 %.
    ///
    /// # Errors
    /// Those of `from_signed_distance`; [`GenerateError::Divisions`] for fewer than 100 cells, which cannot be told from
    /// the rounding of the skin.
    pub fn edge_for_cells(solid: &impl SignedDistance, cells: usize) -> Result<f64, GenerateError> {
        GenerateError::check_divisions("the wanted number of cells", cells, 100)?;
        let (low, high) = solid.bounds();
        let extent = high - low;
        // A cube of the lattice holds twelve cells; most solids fill about half of their box.
        let mut edge = (0.5 * 12.0 * extent.x * extent.y * extent.z / cells as f64).cbrt();
        let mut best = (f64::INFINITY, edge);
        for _ in 0..6 {
            let made = Self::from_signed_distance(solid, edge)?.cells.len() as f64;
            let ratio = made / cells as f64;
            if (ratio.ln()).abs() < best.0 {
                best = (ratio.ln().abs(), edge);
            }
            edge *= ratio.cbrt();
        }
        Ok(best.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::skin::Cut;
    use super::warp::{TOO_CLOSE_LONG, TOO_CLOSE_SHORT};
    use super::*;

    /// A sequence of numbers in [0, 1) (Knuth's linear congruential generator).
    struct Dice(u64);

    impl Dice {
        fn roll(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (self.0 >> 33) as f64 / (1u64 << 31) as f64
        }
    }

    /// A lattice with any signs at its nodes and cuts anywhere on its edges, preferably just before or behind a threshold.
    fn rough_skin(lattice: &Lattice, dice: &mut Dice) -> (Skin, Vec<Cut>) {
        let inside_share = dice.roll();
        let mut skin = Skin::sample(lattice, |_| 1.0);
        skin.value.iter_mut().filter(|_| dice.roll() < inside_share).for_each(|value| *value = -1.0);
        let mut cuts = Vec::new();
        for ends in lattice.edges() {
            let [from, to] = ends.map(|node| node as usize);
            if skin.value[from] == skin.value[to] {
                continue;
            }
            let limit = if lattice.is_long(ends[0], ends[1]) { TOO_CLOSE_LONG } else { TOO_CLOSE_SHORT };
            let fraction = match dice.roll() {
                r if r < 0.4 => limit + (r - 0.2) * 1e-9,
                r if r < 0.8 => 1.0 - limit + (r - 0.6) * 1e-9,
                _ => dice.roll(),
            };
            let place = skin.place[from] + (skin.place[to] - skin.place[from]) * fraction;
            cuts.push(Cut { ends, fraction, place });
        }
        (skin, cuts)
    }

    /// Whatever the solid: 10.7° to 164.8° (Labelle & Shewchuk 2007), and the search comes within a degree of both.
    #[test]
    fn angles_are_bounded_for_any_signs_and_any_cuts() {
        let (mut smallest, mut largest) = (180.0f64, 0.0f64);
        let mut dice = Dice(1);
        let lattice = Lattice::around((Point::ZERO, Point::splat(12.0)), 1.0).unwrap();
        for _ in 0..30 {
            let (mut skin, mut cuts) = rough_skin(&lattice, &mut dice);
            warp::onto_skin(&lattice, &mut skin, &mut cuts);
            let mesh = stencil::fill(&lattice, &skin, &cuts, |_| -1.0);
            for cell in 0..mesh.cells.len() {
                let quality = mesh.cell_quality(cell);
                smallest = smallest.min(quality.smallest_dihedral.to_degrees());
                largest = largest.max(quality.largest_dihedral.to_degrees());
            }
        }
        assert!((10.7..11.7).contains(&smallest), "{smallest}");
        assert!((163.8..164.8).contains(&largest), "{largest}");
    }

    /// Every tetrahedron of the lattice is right-handed, a twelfth of a cube, and bounded by edges of the lattice.
    #[test]
    fn the_lattice_is_body_centred_cubic() {
        let lattice = Lattice::around((Point::ZERO, Point::new(2.0, 3.0, 4.0)), 1.0).unwrap();
        let edges: std::collections::BTreeSet<_> = lattice.edges().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        for cell in lattice.cells() {
            let [a, b, c, d] = cell.map(|node| lattice.position(node));
            approx::assert_relative_eq!((b - a).dot((c - a).cross(d - a)) / 6.0, 1.0 / 12.0, max_relative = 1e-12);
            for [i, j] in crate::mesh::TET_EDGES {
                assert!(edges.contains(&[cell[i].min(cell[j]), cell[i].max(cell[j])]));
                assert_eq!(lattice.is_long(cell[i], cell[j]), [i, j] == [0, 1] || [i, j] == [2, 3]);
            }
            assert_ne!(lattice.is_odd(cell[0]), lattice.is_odd(cell[1]));
            assert_ne!(lattice.is_odd(cell[2]), lattice.is_odd(cell[3]));
        }
    }
}

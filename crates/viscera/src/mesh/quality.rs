use std::fmt;

use super::{HexMesh, Point, TET_EDGES, TET_FACES, TetMesh, measure};

/// Shape of one tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetQuality {
    /// Signed volume [m³].
    pub volume: f64,
    /// Smallest angle between two faces [rad]; 70.5° in a regular tetrahedron.
    pub smallest_dihedral: f64,
    /// Largest angle between two faces [rad].
    pub largest_dihedral: f64,
    /// Three times the radius of the inner sphere over that of the outer sphere: 1 for a regular tetrahedron, 0 for a flat
    /// one, negative for an inverted one.
    pub radius_ratio: f64,
    /// Smallest distance of a corner from the opposite face [m]: what bounds the time step of explicit integration.
    pub smallest_altitude: f64,
    /// Length of the shortest edge [m].
    pub shortest_edge: f64,
    /// Length of the longest edge [m].
    pub longest_edge: f64,
}

/// The six dihedral angles of a tetrahedron [rad], by the edges [`TET_EDGES`] opposite to them; with the outward normals
/// of its faces, each as long as twice the area.
fn dihedrals(corners: [Point; 4]) -> ([f64; 6], [Point; 4]) {
    let normals = TET_FACES.map(|face| {
        let [p, q, r] = face.map(|corner| corners[corner]);
        (q - p).cross(r - p)
    });
    // By the tangent, which keeps its digits near 0° and 180°.
    (TET_EDGES.map(|[i, j]| normals[i].cross(normals[j]).norm().atan2(-normals[i].dot(normals[j]))), normals)
}

impl TetQuality {
    /// Measures a tetrahedron by its corners [m].
    pub fn of(corners: [Point; 4]) -> Self {
        let [a, b, c, d] = corners;
        let volume = (b - a).dot((c - a).cross(d - a)) / 6.0;
        let (dihedrals, normals) = dihedrals(corners);
        let mut quality = Self {
            volume,
            smallest_dihedral: f64::INFINITY,
            largest_dihedral: 0.0,
            radius_ratio: 0.0,
            smallest_altitude: f64::INFINITY,
            shortest_edge: f64::INFINITY,
            longest_edge: 0.0,
        };
        for ([i, j], dihedral) in TET_EDGES.into_iter().zip(dihedrals) {
            quality.smallest_dihedral = quality.smallest_dihedral.min(dihedral);
            quality.largest_dihedral = quality.largest_dihedral.max(dihedral);
            let length = (corners[j] - corners[i]).norm();
            quality.shortest_edge = quality.shortest_edge.min(length);
            quality.longest_edge = quality.longest_edge.max(length);
        }
        let largest_area = normals.map(|normal| 0.5 * normal.norm()).into_iter().fold(0.0, f64::max);
        quality.smallest_altitude = if largest_area > 0.0 { 3.0 * volume.abs() / largest_area } else { 0.0 };
        quality.radius_ratio = radius_ratio(corners);
        quality
    }
}

/// [`TetQuality::radius_ratio`] of a cell with these corners [m], without the rest of its shape: that takes ten times longer.
pub fn radius_ratio([a, b, c, d]: [Point; 4]) -> f64 {
    let (p, q, r) = (b - a, c - a, d - a);
    let (pq, qr, rp) = (p.cross(q), q.cross(r), r.cross(p));
    let volume = p.dot(qr) / 6.0;
    let total_area = 0.5 * (pq.norm() + qr.norm() + rp.norm() + (pq + qr + rp).norm());
    // Outer radius = √(s (s−p) (s−q) (s−r)) / 6V with p, q, r the products of opposite edges (Crelle); inner = 3V / area.
    let opposite = [(p, d - c), (q, d - b), (r, c - b)].map(|(e, f)| e.norm() * f.norm());
    let half = 0.5 * opposite.iter().sum::<f64>();
    let sixfold = (half * opposite.iter().map(|product| (half - product).max(0.0)).product::<f64>()).sqrt();
    if sixfold > 0.0 && total_area > 0.0 {
        3.0 * (3.0 * volume / total_area) * (6.0 * volume.abs() / sixfold)
    } else {
        0.0
    }
}

/// Smallest, mean and largest of a measure over all cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Smallest.
    pub smallest: f64,
    /// Mean over cells.
    pub mean: f64,
    /// Largest.
    pub largest: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut spread, mut count) = (Self { smallest: f64::INFINITY, mean: 0.0, largest: f64::NEG_INFINITY }, 0);
        for value in values {
            spread.smallest = spread.smallest.min(value);
            spread.largest = spread.largest.max(value);
            spread.mean += value;
            count += 1;
        }
        spread.mean /= f64::from(count.max(1));
        spread
    }
}

/// Shape of all tetrahedra of a mesh; prints as a table.
#[derive(Clone, Debug, PartialEq)]
pub struct QualityReport {
    /// How many cells.
    pub cells: usize,
    /// How many nodes.
    pub nodes: usize,
    /// Sum of the signed volumes [m³].
    pub total_volume: f64,
    /// Signed volumes [m³].
    pub volume: Spread,
    /// Smallest dihedral angles of the cells [rad].
    pub smallest_dihedral: Spread,
    /// Largest dihedral angles of the cells [rad].
    pub largest_dihedral: Spread,
    /// Radius ratios: 1 regular, 0 flat, negative inverted.
    pub radius_ratio: Spread,
    /// Smallest altitudes [m].
    pub smallest_altitude: Spread,
    /// Lengths of shortest edges [m].
    pub shortest_edge: Spread,
    /// Lengths of longest edges [m].
    pub longest_edge: Spread,
    /// How many of all dihedral angles lie in 0°–10°, 10°–20°, … 170°–180°.
    pub dihedral_histogram: [usize; 18],
    /// Cells without volume or with negative volume.
    pub inverted: usize,
    /// The cell with the smallest radius ratio: the first to look at.
    pub worst_cell: usize,
}

impl TetMesh {
    /// Shape of one cell.
    pub fn cell_quality(&self, cell: usize) -> TetQuality {
        TetQuality::of(self.corners(cell))
    }

    /// Shape of all cells; nothing for a mesh without cells.
    pub fn quality(&self) -> Option<QualityReport> {
        let cells: Vec<_> = (0..self.cells.len()).map(|cell| self.cell_quality(cell)).collect();
        let worst_cell = (0..cells.len()).min_by(|&a, &b| cells[a].radius_ratio.total_cmp(&cells[b].radius_ratio))?;
        let spread = |measure: fn(&TetQuality) -> f64| Spread::of(cells.iter().map(measure));
        Some(QualityReport {
            cells: cells.len(),
            nodes: self.nodes.len(),
            total_volume: cells.iter().map(|cell| cell.volume).sum(),
            volume: spread(|cell| cell.volume),
            smallest_dihedral: spread(|cell| cell.smallest_dihedral),
            largest_dihedral: spread(|cell| cell.largest_dihedral),
            radius_ratio: spread(|cell| cell.radius_ratio),
            smallest_altitude: spread(|cell| cell.smallest_altitude),
            shortest_edge: spread(|cell| cell.shortest_edge),
            longest_edge: spread(|cell| cell.longest_edge),
            dihedral_histogram: self.dihedral_histogram(),
            inverted: cells.iter().filter(|cell| cell.radius_ratio <= 0.0).count(),
            worst_cell,
        })
    }

    fn dihedral_histogram(&self) -> [usize; 18] {
        let mut histogram = [0; 18];
        for cell in 0..self.cells.len() {
            for angle in dihedrals(self.corners(cell)).0 {
                histogram[(angle.to_degrees() / 10.0).clamp(0.0, 17.0) as usize] += 1;
            }
        }
        histogram
    }
}

impl fmt::Display for QualityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cells, nodes, inverted, worst_cell, .. } = self;
        let volume = measure::volume(self.total_volume);
        writeln!(f, "{cells} tetrahedra, {nodes} nodes, {volume}, {inverted} inverted or flat")?;
        writeln!(f, "worst cell: {worst_cell} (radius ratio {:.4})", self.radius_ratio.smallest)?;
        writeln!(f, "{:<24}{:>12}{:>12}{:>12}", "", "smallest", "mean", "largest")?;
        let rows: [(&str, &Spread, f64); 7] = [
            ("volume [m³]", &self.volume, 1.0),
            ("smallest dihedral [°]", &self.smallest_dihedral, 1f64.to_degrees()),
            ("largest dihedral [°]", &self.largest_dihedral, 1f64.to_degrees()),
            ("radius ratio", &self.radius_ratio, 1.0),
            ("smallest altitude [m]", &self.smallest_altitude, 1.0),
            ("shortest edge [m]", &self.shortest_edge, 1.0),
            ("longest edge [m]", &self.longest_edge, 1.0),
        ];
        for (name, spread, unit) in rows {
            let [smallest, mean, largest] =
                [spread.smallest, spread.mean, spread.largest].map(|v| significant(v * unit));
            writeln!(f, "{name:<24}{smallest:>12}{mean:>12}{largest:>12}")?;
        }
        writeln!(f, "dihedral angles")?;
        let most = self.dihedral_histogram.iter().copied().max().unwrap_or(0).max(1);
        for (bin, &count) in self.dihedral_histogram.iter().enumerate() {
            let bar = "█".repeat((40 * count).div_ceil(most));
            writeln!(f, "{:>4}°–{:>3}° {count:>9} {bar}", 10 * bin, 10 * bin + 10)?;
        }
        Ok(())
    }
}

/// Four digits, as a power of ten where the number is small or large.
fn significant(value: f64) -> String {
    if value == 0.0 || (1e-2..1e4).contains(&value.abs()) { format!("{value:.4}") } else { format!("{value:.3e}") }
}

impl HexMesh {
    /// Scaled Jacobian of a cell: the smallest, over its corners, of the volume spanned by the three edges there, each
    /// scaled to length one. 1 for a box, 0 or less where a corner is flat or turned inside out.
    pub fn scaled_jacobian(&self, cell: usize) -> f64 {
        scaled_jacobian(&self.corners(cell))
    }

    /// Scaled Jacobians of all cells, with the worst cell; nothing for a mesh without cells.
    pub fn scaled_jacobians(&self) -> Option<(Spread, usize)> {
        let values: Vec<_> = (0..self.cells.len()).map(|cell| self.scaled_jacobian(cell)).collect();
        let worst = (0..values.len()).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
        Some((Spread::of(values.into_iter()), worst))
    }
}

/// [`HexMesh::scaled_jacobian`] of a cell with these corners [m].
pub fn scaled_jacobian(corners: &[Point; 8]) -> f64 {
    // The three edges that leave each corner, right-handed.
    const SPOKES: [[usize; 3]; 8] =
        [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];
    let at_corner = |corner: usize| {
        let [p, q, r] = SPOKES[corner].map(|end| (corners[end] - corners[corner]).normalized());
        match (p, q, r) {
            (Some(p), Some(q), Some(r)) => p.dot(q.cross(r)),
            _ => 0.0,
        }
    };
    (0..8).map(at_corner).fold(f64::INFINITY, f64::min)
}

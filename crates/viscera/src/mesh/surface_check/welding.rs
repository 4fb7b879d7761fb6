use std::collections::{HashMap, HashSet};

use super::super::{Point, SurfaceMesh};
use super::SurfaceReport;

/// Nodes closer than this part of the size are one node: single-precision files round about as coarsely.
const TOGETHER: f64 = 1e-7;

/// Merges nodes in one place, then drops triangles without area and duplicates. Also returns the original number of every
/// triangle that is left.
pub(super) fn weld(original: &SurfaceMesh, report: &mut SurfaceReport) -> (SurfaceMesh, Vec<u32>) {
    let (nodes, number_of) = merge_nodes(original, report);
    let mut surface = SurfaceMesh { nodes, triangles: Vec::with_capacity(original.triangles.len()) };
    let mut origins = Vec::with_capacity(original.triangles.len());
    let mut seen = HashSet::with_capacity(original.triangles.len());
    for (origin, corners) in original.triangles.iter().enumerate() {
        let corners = corners.map(|node| number_of[node as usize]);
        let mut key = corners;
        key.sort_unstable();
        if key[0] == key[1] || key[1] == key[2] {
            report.degenerate.push(origin as u32);
        } else if seen.insert(key) {
            surface.triangles.push(corners);
            origins.push(origin as u32);
        } else {
            report.duplicate.push(origin as u32);
        }
    }
    (surface, origins)
}

/// The nodes that triangles use, those in one place merged into the first of them; and the new number of every old node.
fn merge_nodes(original: &SurfaceMesh, report: &mut SurfaceReport) -> (Vec<Point>, Vec<u32>) {
    let mut used = vec![false; original.nodes.len()];
    original.triangles.iter().flatten().for_each(|&node| used[node as usize] = true);
    let places = || original.nodes.iter().zip(&used).filter(|(_, used)| **used).map(|(place, _)| *place);
    let far = Point::splat(f64::INFINITY);
    let (low, high) = places().fold((far, -far), |(low, high), place| (low.min(place), high.max(place)));
    let tolerance = TOGETHER * (high - low).norm();

    // A grid of cells twice as wide as the tolerance: what lies together is in the same or a neighbouring cell.
    let cell_of = |place: Point| (place - low).to_array().map(|along| (along / (2.0 * tolerance)).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let (mut nodes, mut number_of) = (Vec::<Point>::new(), vec![u32::MAX; original.nodes.len()]);
    for old in (0..original.nodes.len()).filter(|&old| used[old]) {
        let place = original.nodes[old];
        let cell = cell_of(place);
        let neighbours = (0..27).map(|n| [cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1]);
        let same = neighbours
            .filter_map(|cell| cells.get(&cell))
            .flatten()
            .copied()
            .filter(|&new| (nodes[new as usize] - place).norm() <= tolerance)
            .min();
        number_of[old] = same.unwrap_or_else(|| {
            nodes.push(place);
            let new = nodes.len() as u32 - 1;
            cells.entry(cell).or_default().push(new);
            new
        });
        report.merged_nodes += usize::from(same.is_some());
    }
    (nodes, number_of)
}

//! Cells in compact parts.

use super::Point;
use crate::math::Vec3;

/// Cells in compact parts that touch at most `most` nodes each: halved across their longest side until they do.
///
/// The numbers of a part are in ascending order.
pub(crate) fn partition<const CORNERS: usize>(nodes: &[Point], cells: &[[u32; CORNERS]], most: usize) -> Vec<Vec<u32>> {
    let centres =
        cells.iter().map(|corners| corners.iter().fold(Vec3::ZERO, |sum, &node| sum + nodes[node as usize])).collect();
    let mut halving = Halving { cells, centres, most, seen: vec![u32::MAX; nodes.len()], stamp: 0, parts: Vec::new() };
    let mut all: Vec<u32> = (0..cells.len() as u32).collect();
    if !all.is_empty() {
        halving.divide(&mut all);
    }
    halving.parts
}

struct Halving<'a, const CORNERS: usize> {
    cells: &'a [[u32; CORNERS]],
    /// Sums of the corners' places [m].
    centres: Vec<Point>,
    most: usize,
    /// The last count in which each node was met.
    seen: Vec<u32>,
    stamp: u32,
    parts: Vec<Vec<u32>>,
}

impl<const CORNERS: usize> Halving<'_, CORNERS> {
    fn divide(&mut self, part: &mut [u32]) {
        if part.len() == 1 || self.fits(part) {
            part.sort_unstable();
            self.parts.push(part.to_vec());
            return;
        }
        let centre = |cell: u32| self.centres[cell as usize];
        let (mut low, mut high) = (centre(part[0]), centre(part[0]));
        for &cell in part.iter() {
            let place = centre(cell);
            for axis in 0..3 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let size = (high - low).to_array();
        let axis = (0..3).fold(0, |longest, axis| if size[axis] > size[longest] { axis } else { longest });
        let middle = part.len() / 2;
        // By number where places are equal: the parts must not depend on how the sort goes about its work.
        part.select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
        let (left, right) = part.split_at_mut(middle);
        self.divide(left);
        self.divide(right);
    }

    /// Whether the cells touch few enough nodes.
    fn fits(&mut self, part: &[u32]) -> bool {
        self.stamp += 1;
        let mut count = 0;
        for &cell in part {
            for node in self.cells[cell as usize] {
                if std::mem::replace(&mut self.seen[node as usize], self.stamp) != self.stamp {
                    count += 1;
                }
            }
            if count > self.most {
                return false;
            }
        }
        true
    }
}

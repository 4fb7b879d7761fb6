//! Fans: tetrahedra around a common edge, each sharing a face with the next.
//!
//! n tetrahedra one by one touch 4n corners. In a fan they touch the two ends of the edge and a ring of n + 1 nodes, or of n if
//! it closes: six tetrahedra of a cube around its diagonal, 8 in place of 24.

/// The longest fan: longer ones save little and leave more lanes idle.
pub(super) const LONGEST: usize = 8;

/// The tetrahedra (axis 0, axis 1, ring i, ring i + 1), all of them oriented like the cells that they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fan {
    pub(super) axis: [u32; 2],
    pub(super) ring: Vec<u32>,
    pub(super) cells: Vec<u32>,
}

impl Fan {
    /// Whether it goes all the way around its axis, so that its ring ends where it began.
    pub(super) fn is_closed(&self) -> bool {
        self.ring.first() == self.ring.last()
    }

    /// Its nodes; where it closes, one of them twice.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.axis.iter().chain(&self.ring).copied()
    }
}

/// A cell at one of its edges: (axis 0, axis 1, from, to) is an even permutation of its corners.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Wedge {
    axis: [u32; 2],
    from: u32,
    to: u32,
    cell: u32,
}

/// Even permutations of the corners that put each of the six edges first.
const EDGES: [[usize; 4]; 6] = [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];

/// Divides tetrahedra into fans, the longest first: no two of the cells appear in one place, none is left out.
pub(super) fn fans(cells: &[[u32; 4]]) -> Vec<Fan> {
    let mut wedges: Vec<Wedge> = cells.iter().enumerate().flat_map(|(cell, corners)| wedges(cell, corners)).collect();
    wedges.sort_unstable();
    let edges: Vec<&[Wedge]> = wedges.chunk_by(|a, b| a.axis == b.axis).collect();
    let mut taken = vec![false; cells.len()];
    let mut fans = Vec::new();
    for length in (1..=LONGEST).rev() {
        for edge in edges.iter().filter(|edge| edge.len() >= length) {
            while let Some(chain) = longest_chain(edge, &taken, length) {
                for wedge in &chain {
                    taken[wedge.cell as usize] = true;
                }
                let ring = std::iter::once(chain[0].from).chain(chain.iter().map(|wedge| wedge.to)).collect();
                fans.push(Fan { axis: edge[0].axis, ring, cells: chain.iter().map(|wedge| wedge.cell).collect() });
            }
        }
    }
    fans
}

fn wedges(cell: usize, corners: &[u32; 4]) -> impl Iterator<Item = Wedge> {
    let cell = cell as u32;
    EDGES.into_iter().map(move |edge| {
        let [a, b, from, to] = edge.map(|corner| corners[corner]);
        if a < b { Wedge { axis: [a, b], from, to, cell } } else { Wedge { axis: [b, a], from: to, to: from, cell } }
    })
}

/// The longest chain of cells around an edge that are not taken, cut to `length`; none if it is shorter than that.
fn longest_chain(edge: &[Wedge], taken: &[bool], length: usize) -> Option<Vec<Wedge>> {
    let mut free: Vec<Wedge> = edge.iter().filter(|wedge| !taken[wedge.cell as usize]).copied().collect();
    let mut best = Vec::new();
    while free.len() >= length && best.len() < length {
        // A chain begins where nothing comes before; a closed ring begins anywhere.
        let begins = |wedge: &Wedge| !free.iter().any(|before| before.to == wedge.from);
        let mut next = Some(free.iter().position(begins).unwrap_or(0));
        let mut chain: Vec<Wedge> = Vec::new();
        while let Some(found) = next {
            let wedge = free.remove(found);
            chain.push(wedge);
            next = free.iter().position(|after| after.from == wedge.to);
        }
        if chain.len() > best.len() {
            best = chain;
        }
    }
    best.truncate(length);
    (best.len() == length).then_some(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TetMesh;

    #[test]
    fn each_cell_is_in_one_fan_and_turned_as_it_was() {
        for mesh in [TetMesh::box_grid([3, 2, 4], [1.0; 3]), TetMesh::cylinder(0.01, 0.05, 3, 4).unwrap()] {
            let mut met = vec![0; mesh.cells.len()];
            for fan in fans(&mesh.cells) {
                assert_eq!(fan.ring.len(), fan.cells.len() + 1);
                for (ring, &cell) in fan.ring.windows(2).zip(&fan.cells) {
                    met[cell as usize] += 1;
                    let [a, b, c, d] =
                        [fan.axis[0], fan.axis[1], ring[0], ring[1]].map(|node| mesh.nodes[node as usize]);
                    let volume = (b - a).dot((c - a).cross(d - a)) / 6.0;
                    let expected = mesh.cell_volume(cell as usize);
                    // Eight roundings of products of three edges.
                    assert!((volume - expected).abs() <= 1e-13 * expected, "cell {cell}: {volume} for {expected}");
                }
            }
            assert!(met.iter().all(|&count| count == 1), "cells in no fan or in several");
        }
    }

    #[test]
    fn the_six_tetrahedra_of_a_cube_turn_around_its_diagonal() {
        let mesh = TetMesh::box_grid([2, 2, 2], [1.0; 3]);
        assert!(fans(&mesh.cells).iter().all(|fan| fan.cells.len() == 6));
    }
}

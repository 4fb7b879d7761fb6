use std::collections::HashMap;

use super::super::{Point, TetMesh, TetQuality};
use super::lattice::{Lattice, LatticeCell};
use super::skin::{Cut, Skin};

/// Replaces every lattice tetrahedron by the part of it inside the skin.
///
/// Of one with all corners on the skin the signs say nothing: it counts where its middle is inside and its angles keep to
/// the bounds, which warping four corners does not promise.
pub(super) fn fill(lattice: &Lattice, skin: &Skin, cuts: &[Cut], distance: impl Fn(Point) -> f64) -> TetMesh {
    let lattice_nodes = skin.value.len() as u32;
    let cut_of: HashMap<[u32; 2], u32> =
        cuts.iter().zip(lattice_nodes..).map(|(cut, number)| (sorted(cut.ends), number)).collect();
    let stencil = Stencil { lattice, value: &skin.value, cut_of: &cut_of };
    let place = |node: u32| match node.checked_sub(lattice_nodes) {
        None => skin.place[node as usize],
        Some(cut) => cuts[cut as usize].place,
    };

    let mut mesh = TetMesh::default();
    let mut number_of = vec![u32::MAX; lattice_nodes as usize + cuts.len()];
    let mut pieces = Vec::with_capacity(3);
    for cell in lattice.cells() {
        if cell.iter().all(|&node| skin.value[node as usize] == 0.0) {
            let corners = cell.map(|node| skin.place[node as usize]);
            let middle = corners.into_iter().fold(Point::ZERO, |sum, corner| sum + corner) * 0.25;
            if keeps_bounds(&TetQuality::of(corners)) && distance(middle) < 0.0 {
                pieces.push(cell);
            }
        } else {
            stencil.pieces(cell, &mut pieces);
        }
        for piece in pieces.drain(..) {
            let corners = piece.map(|node| {
                let number = &mut number_of[node as usize];
                if *number == u32::MAX {
                    *number = mesh.nodes.len() as u32;
                    mesh.nodes.push(place(node));
                }
                *number
            });
            mesh.cells.push(corners);
            let last = mesh.cells.len() - 1;
            if mesh.cell_volume(last) < 0.0 {
                mesh.cells[last].swap(2, 3);
            }
        }
    }
    mesh
}

/// The bounds that all other cells keep.
fn keeps_bounds(quality: &TetQuality) -> bool {
    quality.volume > 0.0
        && quality.smallest_dihedral > 10.7f64.to_radians()
        && quality.largest_dihedral < 164.8f64.to_radians()
}

/// Which pieces of a lattice tetrahedron lie inside, by the signs at its corners.
///
/// Where a piece has a quadrilateral in a face of the lattice, its diagonal depends on that face alone, so that the two
/// tetrahedra on either side agree.
struct Stencil<'a> {
    lattice: &'a Lattice,
    value: &'a [f64],
    /// Number of the cut on an edge, counted after the lattice nodes.
    cut_of: &'a HashMap<[u32; 2], u32>,
}

impl Stencil<'_> {
    /// Appends the pieces, of either orientation.
    fn pieces(&self, cell: LatticeCell, pieces: &mut Vec<[u32; 4]>) {
        let value = |node: u32| self.value[node as usize];
        let (mut inside, mut outside, mut on_skin) = ([0; 4], [0; 4], [0; 4]);
        let (mut insides, mut outsides, mut on_skins) = (0, 0, 0);
        for node in cell {
            let (list, count) = match value(node) {
                v if v < 0.0 => (&mut inside, &mut insides),
                v if v > 0.0 => (&mut outside, &mut outsides),
                _ => (&mut on_skin, &mut on_skins),
            };
            list[*count] = node;
            *count += 1;
        }
        let cut = |a: u32, b: u32| self.cut_of[&sorted([a, b])];
        let [a, b, c, _] = inside;
        let [p, q, ..] = outside;
        match (insides, outsides) {
            (0, _) => {}
            (_, 0) => pieces.push(cell),
            (1, _) => pieces.push(cell.map(|node| if value(node) > 0.0 { cut(a, node) } else { node })),
            (2, 1) => {
                let apex = on_skin[0];
                let (near, far) = if self.diagonal_from_first(a, b, p) { (a, b) } else { (b, a) };
                pieces.push([apex, near, far, cut(far, p)]);
                pieces.push([apex, near, cut(near, p), cut(far, p)]);
            }
            (2, _) => {
                let prism = [[a, cut(a, p), cut(a, q)], [b, cut(b, p), cut(b, q)]];
                let (first, last) = (self.diagonal_from_first(a, b, p), !self.diagonal_from_first(a, b, q));
                // The quadrilateral of four cuts is skin: no neighbour minds its diagonal, but by the rule the other two
                // run alike, and only the opposite choice leaves no twisted prism.
                split_prism(prism, [first, !first, last], pieces);
            }
            _ => {
                let prism = [[a, b, c], [cut(a, p), cut(b, p), cut(c, p)]];
                let up = [(a, b), (b, c), (c, a)].map(|(from, to)| self.diagonal_from_first(from, to, p));
                split_prism(prism, up, pieces);
            }
        }
    }

    /// In the face with `a`, `b` inside and `p` outside: whether the diagonal joins `a` to the cut of `b`–`p`.
    ///
    /// It ends at the cut of a long edge where there is one. Of two short ones the parity rule chooses: at that end of the
    /// long edge `a`–`b` which is as odd as `p`. The two such faces of one tetrahedron then take opposite ends.
    fn diagonal_from_first(&self, a: u32, b: u32, p: u32) -> bool {
        if self.lattice.is_long(a, b) {
            self.lattice.is_odd(a) == self.lattice.is_odd(p)
        } else {
            self.lattice.is_long(b, p)
        }
    }
}

/// Cuts a prism between two triangles into three tetrahedra. `from_first[i]` tells for the quadrilateral over edge
/// i, i + 1 of the triangle whether its diagonal starts at corner i of the first triangle (and ends at i + 1 of the second).
/// All alike would be Schönhardt's twisted prism, which no tetrahedra fill; the callers' rules never give it.
fn split_prism([top, bottom]: [[u32; 3]; 2], from_first: [bool; 3], pieces: &mut Vec<[u32; 4]>) {
    // The corner of the first triangle at which two diagonals meet.
    let Some(i) = (0..3).find(|&i| from_first[i] && !from_first[(i + 2) % 3]) else {
        unreachable!("the diagonals {from_first:?} twist the prism, which the parity rule excludes");
    };
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    pieces.push([top[i], bottom[0], bottom[1], bottom[2]]);
    if from_first[j] {
        pieces.push([top[i], top[j], top[k], bottom[k]]);
        pieces.push([top[i], top[j], bottom[j], bottom[k]]);
    } else {
        pieces.push([top[i], top[j], top[k], bottom[j]]);
        pieces.push([top[i], top[k], bottom[j], bottom[k]]);
    }
}

/// The key of an edge.
fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

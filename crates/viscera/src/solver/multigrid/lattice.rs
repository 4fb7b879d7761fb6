//! Lattices of cubes that are cut into six tetrahedra around one diagonal (Kuhn), each twice as wide as the one before.
//!
//! Functions that are linear in these tetrahedra are nested: those of a lattice are among those of the finer one. A place takes
//! part in four nodes, and a node of the finer lattice lies on a node or amid an edge of the coarser one.
//!
//! A function that reaches across a cut would hold its banks together. Where the tissue that a node has a part in falls into pieces
//! that do not know each other within its reach, the node stands once for each: the functions are those of before, cut where the
//! tissue is, so that their number grows along cuts alone. (After Dick, Georgii, Westermann, A hexahedral multigrid approach for
//! simulating cuts in deformable objects, 2011, section 4, who double the cells of their grids.)

use super::level_matrix::LevelMatrix;
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

/// Width of the first lattice over that of the cells of the mesh. 1.7 saves a tenth of the iterations and costs twice the memory
/// of the coarse matrices; 2.5 costs a fifth more iterations.
const WIDTH: f64 = 2.0;
/// A weight below this is none: places on a face of a lattice tetrahedron, up to rounding.
const NOTHING: f64 = 1e-6;
/// Share of its nodes that the next lattice may have at most, for pieces to be kept apart: crumbs without number would never become few.
const FEWER: f64 = 0.75;

/// The nodes of a lattice that the mesh reaches: whole coordinates, ascending, the longest direction of the body first, so that
/// nodes that know each other have near numbers. At a cut several have the same.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    nodes: Vec<[i32; 3]>,
}

/// How four nodes of a lattice make the value at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share<T> {
    pub(super) nodes: [u32; 4],
    /// Not negative; their sum is 1.
    pub(super) weights: [T; 4],
}

/// How the nodes of a lattice make the values at those of the mesh.
#[derive(Clone, Debug)]
pub(super) struct Interpolation<T> {
    /// One for each node of the mesh.
    pub(super) shares: Vec<Share<T>>,
}

impl<T: Scalar> Interpolation<T> {
    /// Writes Wᵀ r to `coarse`.
    pub(super) fn restrict(&self, fine: &[Vec3<T>], coarse: &mut [Vec3<T>]) {
        coarse.fill(Vec3::ZERO);
        for (share, &value) in self.shares.iter().zip(fine) {
            for (node, weight) in share.nodes.into_iter().zip(share.weights) {
                coarse[node as usize] = value.mul_add(weight, coarse[node as usize]);
            }
        }
    }

    /// Writes W e to `fine`.
    pub(super) fn prolong(&self, coarse: &[Vec3<T>], fine: &mut [Vec3<T>]) {
        for (share, value) in self.shares.iter().zip(fine) {
            *value = Vec3::ZERO;
            for (node, weight) in share.nodes.into_iter().zip(share.weights) {
                *value = coarse[node as usize].mul_add(weight, *value);
            }
        }
    }
}

impl Lattice {
    /// The first lattice over the rest shape of tissue whose nodes know those in `neighbours`.
    pub(super) fn over<T: Scalar>(mesh: &VolumeMesh, neighbours: &[Vec<u32>]) -> (Self, Interpolation<T>) {
        let places = mesh.nodes();
        let step = WIDTH * width(mesh);
        let start = places.first().copied().unwrap_or(Vec3::ZERO);
        let low = places.iter().fold(start, |low, &place| low.min(place));
        let extent = places.iter().fold(start, |high, &place| high.max(place)) - low;
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| extent[b].total_cmp(&extent[a]));
        let corners: Vec<_> =
            places.iter().map(|&place| corners(axes.map(|axis| (place - low)[axis] / step))).collect();
        let lattice = Self::of(corners.iter().flat_map(|corners| corners.map(|(node, _)| node)));
        let nodes: Vec<_> = corners.iter().map(|corners| corners.map(|(node, _)| lattice.number(node))).collect();
        let (lattice, nodes) = lattice.apart(&nodes, |node| &neighbours[node]);
        let share = |(nodes, corners): ([u32; 4], &[([i32; 3], f64); 4])| Share {
            nodes,
            weights: corners.map(|(_, weight)| T::from_f64(weight)),
        };
        let shares = nodes.into_iter().zip(&corners).map(share).collect();
        (lattice, Interpolation { shares })
    }

    fn of(nodes: impl Iterator<Item = [i32; 3]>) -> Self {
        let mut nodes: Vec<_> = nodes.collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes }
    }

    /// How many nodes there are.
    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// The lattice of twice the width, and the two nodes of it, maybe the same, whose mean makes the value at each node of this one.
    /// `matrix` says which of these know each other.
    pub(super) fn coarser<T: Scalar>(&self, matrix: &LevelMatrix<T>) -> (Self, Vec<[u32; 2]>) {
        let ends = |node: &[i32; 3]| [node.map(|step| step.div_euclid(2)), node.map(|step| (step + 1).div_euclid(2))];
        let coarse = Self::of(self.nodes.iter().flat_map(ends));
        let parents: Vec<_> = self.nodes.iter().map(|node| ends(node).map(|end| coarse.number(end))).collect();
        let (apart, parents_apart) = coarse.apart(&parents, |node| &matrix.columns()[matrix.span(node)]);
        if apart.len() as f64 <= FEWER * self.len() as f64 { (apart, parents_apart) } else { (coarse, parents) }
    }

    /// The same nodes, once for each piece of what they have a part in, and for everything finer the numbers of `parts`, its nodes, among
    /// them. `neighbours` are what a finer thing knows, itself included; what knows nothing else belongs to any piece.
    fn apart<'a, const N: usize>(
        &self,
        parts: &[[u32; N]],
        neighbours: impl Fn(usize) -> &'a [u32],
    ) -> (Self, Vec<[u32; N]>) {
        let (starts, members) = members(self.len(), parts);
        let (mut nodes, mut apart) = (Vec::with_capacity(self.len()), parts.to_vec());
        // The last node that something finer was looked at for, and its piece there.
        let mut seen = vec![(u32::MAX, u32::MAX); parts.len()];
        let mut waiting = Vec::new();
        for (number, &place) in self.nodes.iter().enumerate() {
            let (number, members) = (number as u32, &members[starts[number]..starts[number + 1]]);
            members.iter().for_each(|&member| seen[member as usize] = (number, u32::MAX));
            let first = nodes.len() as u32;
            for &member in members {
                if seen[member as usize].1 != u32::MAX || neighbours(member as usize).len() < 2 {
                    continue;
                }
                let piece = nodes.len() as u32;
                nodes.push(place);
                seen[member as usize].1 = piece;
                waiting.push(member);
                while let Some(one) = waiting.pop() {
                    for &other in neighbours(one as usize) {
                        if seen[other as usize] == (number, u32::MAX) {
                            seen[other as usize].1 = piece;
                            waiting.push(other);
                        }
                    }
                }
            }
            if nodes.len() as u32 == first {
                nodes.push(place);
            }
            for &member in members {
                let piece = if seen[member as usize].1 == u32::MAX { first } else { seen[member as usize].1 };
                for (apart, part) in apart[member as usize].iter_mut().zip(parts[member as usize]) {
                    if part == number {
                        *apart = piece;
                    }
                }
            }
        }
        (Self { nodes }, apart)
    }

    /// The number of a node that is there.
    fn number(&self, node: [i32; 3]) -> u32 {
        self.nodes.partition_point(|other| *other < node) as u32
    }
}

/// What has a part in each of `nodes` nodes: where its list begins, with the end, and the lists.
fn members<const N: usize>(nodes: usize, parts: &[[u32; N]]) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; nodes + 1];
    parts.iter().flatten().for_each(|&node| starts[node as usize + 1] += 1);
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let (mut ends, mut members) = (starts.clone(), vec![0; starts[nodes]]);
    for (member, nodes) in parts.iter().enumerate() {
        for &node in nodes {
            members[ends[node as usize]] = member as u32;
            ends[node as usize] += 1;
        }
    }
    (starts, members)
}

/// The corners of the lattice tetrahedron around `place`, in steps of the lattice, and its barycentric coordinates: from the
/// cube's first corner along its edges, in the order of the fractions that are left.
fn corners(place: [f64; 3]) -> [([i32; 3], f64); 4] {
    let first = place.map(|step| step.floor() as i32);
    let fractions: [f64; 3] = std::array::from_fn(|axis| place[axis] - f64::from(first[axis]));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| fractions[b].total_cmp(&fractions[a]));
    let mut corners = [(first, 1.0 - fractions[order[0]]); 4];
    for step in 0..3 {
        let mut node = corners[step].0;
        node[order[step]] += 1;
        let next = if step < 2 { fractions[order[step + 1]] } else { 0.0 };
        corners[step + 1] = (node, fractions[order[step]] - next);
    }
    // Nodes without a part in any place stay out: the one of greatest weight stands in for them.
    let greatest = corners.iter().fold(corners[0], |best, corner| if corner.1 > best.1 { *corner } else { best });
    let sum: f64 = corners.iter().map(|corner| corner.1).filter(|&weight| weight > NOTHING).sum();
    corners.map(|(node, weight)| if weight > NOTHING { (node, weight / sum) } else { (greatest.0, 0.0) })
}

/// Edge of the cubes that a mesh of this fineness fills [m]: one to a hexahedron, one to six tetrahedra.
fn width(mesh: &VolumeMesh) -> f64 {
    let volume = |cell: usize| match mesh {
        VolumeMesh::Tet(mesh) => 6.0 * mesh.cell_volume(cell),
        VolumeMesh::Hex(mesh) => mesh.cell_volume(cell),
    };
    let cells = mesh.cell_count();
    ((0..cells).map(volume).sum::<f64>() / cells as f64).cbrt()
}

//! The check of a mesh on its way in: repairs what has one repair, reports what is odd, refuses what cannot be simulated.

use std::collections::HashMap;

use super::gauss::gauss_jacobians;
use super::groups::Groups;
use super::{HEX_EDGES, HEX_FACES, HexMesh, Mesh, MeshError, MeshReport, Point, TET_EDGES, TET_FACES, TetMesh};
use crate::math::Mat3;

/// A cell is flat when its quality is below this, or below what the rounding of its coordinates leaves undecided.
const FLAT: f64 = 1e-10;

/// Two nodes are at one place when they are closer than this part of the mesh's size.
const SAME_PLACE: f64 = 1e-9;

impl TetMesh {
    /// Checks the mesh and repairs it.
    ///
    /// Repaired and counted: mirrored tetrahedra (two corners are swapped), nodes of no cell (removed, with their entries in
    /// regions; later nodes are renumbered). Reported: separate parts, faces of more than two cells, different nodes at one
    /// place, slivers.
    ///
    /// # Errors
    /// No cells, a missing node, a coordinate that is not finite; flat cells, cells that name a node twice, cells that are
    /// listed twice. All cells that are wrong are named, in [`MeshError::Several`] when there is more than one.
    pub fn checked(self) -> Result<(Self, MeshReport), MeshError> {
        check(self, &TET_FACES, [0, 2, 1, 3], tetrahedron)
    }
}

impl HexMesh {
    /// Checks the mesh and repairs it, as [`TetMesh::checked`] does.
    ///
    /// # Errors
    /// As there; also [`MeshError::Twisted`].
    pub fn checked(self) -> Result<(Self, MeshReport), MeshError> {
        check(self, &HEX_FACES, [0, 3, 2, 1, 4, 7, 6, 5], hexahedron)
    }
}

/// What the corners of a cell make of it. Quality is the smallest Jacobian over that of the regular cell with the same
/// longest edge.
enum Form {
    Right { quality: f64, volume: f64 },
    Mirrored { quality: f64, volume: f64 },
    Flat,
    Twisted,
}

fn check<const CORNERS: usize, const FACE: usize>(
    mut mesh: Mesh<CORNERS, FACE>,
    faces: &[[usize; FACE]],
    mirror: [usize; CORNERS],
    form: fn([Point; CORNERS]) -> Form,
) -> Result<(Mesh<CORNERS, FACE>, MeshReport), MeshError> {
    mesh.check_indices()?;
    mesh.check_regions()?;
    let mut errors = repeated_cells(&mesh);
    let mut report = MeshReport { cells: mesh.cells.len(), flattest_quality: f64::INFINITY, ..Default::default() };
    for cell in 0..mesh.cells.len() {
        let corners = mesh.cells[cell];
        if let Some(node) = repeated_corner(corners) {
            errors.push(MeshError::RepeatedNode { cell, node: node as usize });
            continue;
        }
        let (quality, volume) = match form(mesh.corners(cell)) {
            Form::Right { quality, volume } => (quality, volume),
            Form::Mirrored { quality, volume } => {
                mesh.cells[cell] = mirror.map(|corner| corners[corner]);
                report.mirrored_cells += 1;
                (quality, volume)
            }
            Form::Flat => {
                errors.push(MeshError::Degenerate { cell, corners: corners.to_vec() });
                continue;
            }
            Form::Twisted => {
                errors.push(MeshError::Twisted { cell, corners: corners.to_vec() });
                continue;
            }
        };
        report.volume += volume;
        if quality < report.flattest_quality {
            (report.flattest_cell, report.flattest_quality) = (cell, quality);
        }
    }
    if let Some(error) = MeshError::gathered(errors) {
        return Err(error);
    }
    remove_isolated_nodes(&mut mesh, &mut report);
    report.nodes = mesh.nodes.len();
    report.components = count_components(&mesh);
    report.overshared_faces = count_overshared(&mesh, faces);
    find_coincident(&mesh.nodes, mesh.size() * SAME_PLACE, &mut report);
    Ok((mesh, report))
}

impl<const CORNERS: usize, const FACE: usize> Mesh<CORNERS, FACE> {
    /// Checks that the nodes and cells exist that regions name.
    pub(super) fn check_regions(&self) -> Result<(), MeshError> {
        for (name, region) in &self.regions {
            let missing_node = region
                .nodes
                .iter()
                .chain(region.faces.iter().flatten())
                .find(|&&node| node as usize >= self.nodes.len());
            if let Some(&node) = missing_node {
                return Err(MeshError::RegionMissingNode { region: name.clone(), node: node as usize });
            }
            if let Some(&cell) = region.cells.iter().find(|&&cell| cell as usize >= self.cells.len()) {
                return Err(MeshError::RegionMissingCell { region: name.clone(), cell: cell as usize });
            }
        }
        Ok(())
    }
}

fn repeated_corner<const CORNERS: usize>(mut corners: [u32; CORNERS]) -> Option<u32> {
    corners.sort_unstable();
    corners.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// Cells with the corners of an earlier cell, in whatever order.
fn repeated_cells<const CORNERS: usize, const FACE: usize>(mesh: &Mesh<CORNERS, FACE>) -> Vec<MeshError> {
    let sorted = |(cell, &corners): (usize, &[u32; CORNERS])| {
        let mut key = corners;
        key.sort_unstable();
        (key, cell)
    };
    let mut keys: Vec<_> = mesh.cells.iter().enumerate().map(sorted).collect();
    keys.sort_unstable();
    let alike = keys.chunk_by(|(a, _), (b, _)| a == b);
    let mut pairs: Vec<_> = alike.flat_map(|run| run[1..].iter().map(|&(_, cell)| (cell, run[0].1))).collect();
    pairs.sort_unstable();
    pairs.into_iter().map(|(cell, first)| MeshError::DuplicateCell { cell, first }).collect()
}

fn remove_isolated_nodes<const CORNERS: usize, const FACE: usize>(
    mesh: &mut Mesh<CORNERS, FACE>,
    report: &mut MeshReport,
) {
    let mut used = vec![false; mesh.nodes.len()];
    mesh.cells.iter().flatten().for_each(|&node| used[node as usize] = true);
    report.isolated_nodes = used.iter().filter(|&&used| !used).count();
    if report.isolated_nodes == 0 {
        return;
    }
    let mut left = 0;
    let new_number: Vec<u32> = used
        .iter()
        .map(|&used| {
            left += u32::from(used);
            left.wrapping_sub(1)
        })
        .collect();
    let mut each = used.iter();
    mesh.nodes.retain(|_| each.next() == Some(&true));
    mesh.cells.iter_mut().flatten().for_each(|node| *node = new_number[*node as usize]);
    for region in mesh.regions.values_mut() {
        let before = region.nodes.len() + region.faces.len();
        region.nodes.retain(|&node| used[node as usize]);
        region.faces.retain(|face| face.iter().all(|&node| used[node as usize]));
        report.region_entries_removed += before - region.nodes.len() - region.faces.len();
        region
            .nodes
            .iter_mut()
            .chain(region.faces.iter_mut().flatten())
            .for_each(|node| *node = new_number[*node as usize]);
    }
}

/// Counts parts that share no node; every node must be in a cell.
fn count_components<const CORNERS: usize, const FACE: usize>(mesh: &Mesh<CORNERS, FACE>) -> usize {
    let mut groups = Groups::new(mesh.nodes.len());
    let mut components = mesh.nodes.len();
    for corners in &mesh.cells {
        for &corner in &corners[1..] {
            components -= usize::from(groups.join(corners[0] as usize, corner as usize));
        }
    }
    components
}

fn count_overshared<const CORNERS: usize, const FACE: usize>(
    mesh: &Mesh<CORNERS, FACE>,
    faces: &[[usize; FACE]],
) -> usize {
    let sorted = |corners: &[u32; CORNERS], face: &[usize; FACE]| {
        let mut key = face.map(|corner| corners[corner]);
        key.sort_unstable();
        key
    };
    let mut keys: Vec<_> = mesh.cells.iter().flat_map(|cell| faces.iter().map(|face| sorted(cell, face))).collect();
    keys.sort_unstable();
    keys.chunk_by(|a, b| a == b).filter(|run| run.len() > 2).count()
}

/// Finds nodes within `distance` of an earlier one. Space is cut into boxes twice as wide, so that whatever is near a node
/// is in one of the boxes that its eight surroundings fall into.
fn find_coincident(nodes: &[Point], distance: f64, report: &mut MeshReport) {
    let mut in_box: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(nodes.len());
    let box_at = |place: Point| place.to_array().map(|coordinate| (coordinate / (2.0 * distance)).floor() as i64);
    for (number, &node) in nodes.iter().enumerate() {
        let near = (0..8).filter_map(|octant| {
            let step = |axis: i32| if octant >> axis & 1 == 0 { -distance } else { distance };
            in_box.get(&box_at(node + Point::new(step(0), step(1), step(2))))
        });
        let earlier = near.flatten().copied().filter(|&other| (nodes[other as usize] - node).norm() <= distance).min();
        match earlier {
            Some(other) => {
                report.coincident_nodes += 1;
                report.first_coincidence.get_or_insert(([other, number as u32], node));
            }
            None => in_box.entry(box_at(node)).or_default().push(number as u32),
        }
    }
}

/// Quality below which a cell with these corners cannot be told from a flat one: differences of coordinates are exact to
/// about ε times the coordinates, and volumes to a few times that over the longest edge.
fn undecided<const CORNERS: usize>(corners: &[Point; CORNERS], longest: f64) -> f64 {
    let largest = corners.iter().flat_map(|corner| corner.to_array()).fold(0.0, |largest: f64, x| largest.max(x.abs()));
    FLAT.max(16.0 * f64::EPSILON * largest / longest)
}

fn longest_edge<const CORNERS: usize>(corners: &[Point; CORNERS], edges: &[[usize; 2]]) -> f64 {
    edges.iter().map(|&[a, b]| (corners[b] - corners[a]).norm()).fold(0.0, f64::max)
}

/// The regular tetrahedron of edge L has det[b−a, c−a, d−a] = L³/√2.
fn tetrahedron(corners: [Point; 4]) -> Form {
    let longest = longest_edge(&corners, &TET_EDGES);
    let [a, b, c, d] = corners;
    let edges = [b - a, c - a, d - a].map(|edge| edge * longest.recip());
    let determinant = Mat3::from_columns(edges[0], edges[1], edges[2]).determinant();
    form_of([determinant * std::f64::consts::SQRT_2], determinant * longest.powi(3) / 6.0, undecided(&corners, longest))
}

/// The cube of edge L has Jacobian (L/2)³ in ξ, η, ζ ∈ [−1, 1]. It is taken at the 2×2×2 Gauss points, where elements take
/// it, so that a cell with one blunt corner is not refused.
fn hexahedron(corners: [Point; 8]) -> Form {
    let longest = longest_edge(&corners, &HEX_EDGES);
    let jacobians = gauss_jacobians(&corners);
    let volume = jacobians.iter().sum();
    form_of(jacobians.map(|jacobian| 8.0 * jacobian / longest.powi(3)), volume, undecided(&corners, longest))
}

fn form_of<const POINTS: usize>(jacobians: [f64; POINTS], volume: f64, undecided: f64) -> Form {
    let smallest = jacobians.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = jacobians.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if smallest > undecided {
        Form::Right { quality: smallest, volume }
    } else if largest < -undecided {
        Form::Mirrored { quality: -largest, volume: -volume }
    } else if smallest < -undecided && largest > undecided {
        Form::Twisted
    } else {
        Form::Flat
    }
}

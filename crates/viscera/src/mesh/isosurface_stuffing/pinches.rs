use std::collections::BTreeMap;

use super::super::TetMesh;
use super::super::groups::Groups;
use super::super::surface_check::{edge_uses, non_manifold_edges, non_manifold_nodes};

/// Opens places where the skin touches itself along an edge or in a node, so that it is a closed manifold.
///
/// They arise where a gap or a wall is about as thin as the lattice: both its sides are warped onto the same nodes. Of the
/// cells around such a place the largest connected part stays; where all are connected, the gap touches itself, and they
/// make way for it. Nodes without cells go, too.
pub(super) fn open(mesh: &mut TetMesh) {
    loop {
        let surface = mesh.surface();
        let uses = edge_uses(&surface.triangles);
        let mut places: Vec<Vec<u32>> =
            non_manifold_edges(&surface, &uses).iter().map(|edge| edge.nodes.to_vec()).collect();
        if places.is_empty() {
            places = non_manifold_nodes(&surface, &uses).into_iter().map(|node| vec![node]).collect();
        }
        if places.is_empty() {
            break;
        }
        let mut dropped = vec![false; mesh.cells.len()];
        for (place, cells) in cells_at(mesh, &places) {
            let lesser = lesser_parts(mesh, place, &cells);
            let drop = if lesser.is_empty() { cells } else { lesser };
            drop.into_iter().for_each(|cell| dropped[cell] = true);
        }
        let mut dropped = dropped.into_iter();
        mesh.cells.retain(|_| dropped.next() == Some(false));
    }
    drop_unused_nodes(mesh);
}

/// For every edge or node, the cells that have it.
fn cells_at<'a>(mesh: &TetMesh, places: &'a [Vec<u32>]) -> BTreeMap<&'a [u32], Vec<usize>> {
    let mut by_node = BTreeMap::<u32, Vec<&[u32]>>::new();
    places.iter().for_each(|place| by_node.entry(place[0]).or_default().push(place));
    let mut cells_at = BTreeMap::<_, Vec<usize>>::new();
    for (cell, corners) in mesh.cells.iter().enumerate() {
        let near = corners.iter().filter_map(|node| by_node.get(node)).flatten();
        for &place in near.filter(|place| place.iter().all(|node| corners.contains(node))) {
            cells_at.entry(place).or_default().push(cell);
        }
    }
    cells_at
}

/// Of the cells around a place, those outside the largest part that is connected by faces at the place.
fn lesser_parts(mesh: &TetMesh, place: &[u32], cells: &[usize]) -> Vec<usize> {
    let mut groups = Groups::new(cells.len());
    let mut first_with = BTreeMap::<[u32; 3], usize>::new();
    for (number, &cell) in cells.iter().enumerate() {
        for opposite in 0..4 {
            let mut face = [1, 2, 3].map(|i| mesh.cells[cell][(opposite + i) % 4]);
            face.sort_unstable();
            if place.iter().all(|node| face.contains(node)) {
                let first = *first_with.entry(face).or_insert(number);
                groups.join(first, number);
            }
        }
    }
    let roots: Vec<_> = (0..cells.len()).map(|number| groups.root(number)).collect();
    let mut volumes = vec![0.0; cells.len()];
    for (&cell, &root) in cells.iter().zip(&roots) {
        volumes[root] += mesh.cell_volume(cell);
    }
    let largest = (0..cells.len()).fold(0, |best, root| if volumes[root] > volumes[best] { root } else { best });
    cells.iter().zip(roots).filter(|&(_, root)| root != largest).map(|(&cell, _)| cell).collect()
}

fn drop_unused_nodes(mesh: &mut TetMesh) {
    let mut used = vec![false; mesh.nodes.len()];
    mesh.cells.iter().flatten().for_each(|&node| used[node as usize] = true);
    let mut kept = 0;
    let number_of: Vec<u32> = used
        .iter()
        .map(|&used| {
            kept += u32::from(used);
            kept.wrapping_sub(1)
        })
        .collect();
    let mut used = used.into_iter();
    mesh.nodes.retain(|_| used.next() == Some(true));
    mesh.cells.iter_mut().flatten().for_each(|node| *node = number_of[*node as usize]);
}

//! Facts about meshes, found without the code under test.

use std::collections::BTreeMap;

use viscera::mesh::{Point, TetMesh};

/// How often each undirected edge occurs in a set of triangles, and how often in each direction.
pub(crate) fn edge_uses(triangles: &[[u32; 3]]) -> BTreeMap<[u32; 2], [usize; 2]> {
    let mut uses = BTreeMap::<_, [usize; 2]>::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            uses.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    uses
}

/// V − E + F of a closed triangulated surface: 2 for a sphere, 0 for a torus.
///
/// Fails unless every edge has two triangles that run along it in opposite directions.
pub(crate) fn euler_characteristic(triangles: &[[u32; 3]]) -> i64 {
    let uses = edge_uses(triangles);
    assert!(uses.values().all(|uses| *uses == [1, 1]), "an edge without two opposite triangles");
    let mut nodes: Vec<u32> = triangles.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.len() as i64 - uses.len() as i64 + triangles.len() as i64
}

/// Checks that every cell has positive volume, every node a cell, and that faces match: each is shared by two cells,
/// once in each orientation, or lies on a closed surface. Returns the Euler characteristic of that surface.
pub(crate) fn assert_conforming(mesh: &TetMesh) -> i64 {
    let mut faces = BTreeMap::<[u32; 3], Vec<[u32; 3]>>::new();
    for (cell, &[a, b, c, d]) in mesh.cells.iter().enumerate() {
        assert!(mesh.cell_volume(cell) > 0.0, "cell {cell} is inverted");
        for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let smallest = (0..3).min_by_key(|&i| face[i]).unwrap();
            let rotated = [0, 1, 2].map(|i| face[(smallest + i) % 3]);
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push(rotated);
        }
    }
    for sides in faces.values() {
        assert!(sides.len() <= 2, "a face of three cells: {sides:?}");
        assert!(sides.len() == 1 || sides[0] != sides[1], "two cells on one side of {sides:?}");
    }
    let mut used = vec![false; mesh.nodes.len()];
    mesh.cells.iter().flatten().for_each(|&node| used[node as usize] = true);
    assert!(used.into_iter().all(|used| used), "a node without a cell");
    let surface: Vec<_> = faces.into_values().filter(|sides| sides.len() == 1).map(|sides| sides[0]).collect();
    euler_characteristic(&surface)
}

/// Area vector of a region's triangles: sum of half the cross products [m²].
pub(crate) fn area_vector(nodes: &[Point], faces: &[[u32; 3]]) -> Point {
    faces.iter().fold(Point::ZERO, |sum, face| {
        let [a, b, c] = face.map(|node| nodes[node as usize]);
        sum + (b - a).cross(c - a) * 0.5
    })
}

/// Order of convergence between two errors when the mesh becomes finer by `ratio`.
pub(crate) fn order(coarse: f64, fine: f64, ratio: f64) -> f64 {
    (coarse / fine).ln() / ratio.ln()
}

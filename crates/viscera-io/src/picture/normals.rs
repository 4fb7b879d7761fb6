//! Normals of corners: smooth over flat edges, sharp over creases.

use viscera::math::Vec3;

/// Per triangle and corner, the mean of the normals around the node, weighted by the angle each triangle has there
/// (Thürmer and Wüthrich 1998), over the triangles within `crease` degrees of this one. Degenerate ones give `None`.
pub(super) fn corner_normals(nodes: &[Vec3<f64>], triangles: &[[u32; 3]], crease: f64) -> Vec<Option<[Vec3<f64>; 3]>> {
    let least_cosine = crease.to_radians().cos();
    let flat: Vec<_> = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|node| nodes[node as usize]);
            (b - a).cross(c - a).normalized()
        })
        .collect();
    let mut around: Vec<Vec<(usize, f64)>> = vec![Vec::new(); nodes.len()];
    for (index, corners) in triangles.iter().enumerate().filter(|&(index, _)| flat[index].is_some()) {
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| nodes[corners[(i + k) % 3] as usize]);
            let (u, v) = (b - a, c - a);
            around[corners[i] as usize].push((index, u.cross(v).norm().atan2(u.dot(v))));
        }
    }
    let smooth = |own: Vec3<f64>, node: u32| {
        let mut sum = Vec3::ZERO;
        for &(triangle, angle) in &around[node as usize] {
            if let Some(normal) = flat[triangle].filter(|normal| normal.dot(own) >= least_cosine) {
                sum += normal * angle;
            }
        }
        sum.normalized().unwrap_or(own)
    };
    triangles.iter().zip(&flat).map(|(corners, own)| own.map(|own| corners.map(|node| smooth(own, node)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use viscera::mesh::TetMesh;

    /// A box keeps its six face normals, corners and edges included.
    #[test]
    fn box_edges_stay_sharp() {
        let surface = TetMesh::box_grid([2, 3, 2], [1.0, 2.0, 1.5]).surface();
        for corners in corner_normals(&surface.nodes, &surface.triangles, 40.0) {
            for normal in corners.expect("a box has no degenerate triangle") {
                let largest = normal.to_array().into_iter().fold(0.0_f64, |m, c| m.max(c.abs()));
                assert!(largest > 1.0 - 1e-12, "{normal:?}");
            }
        }
    }
}

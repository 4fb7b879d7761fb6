use super::Point;

/// Triangles in space: the skin of an organ, as it comes from segmentation or from a drawing program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// Positions [m].
    pub nodes: Vec<Point>,
    /// Corners of every triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl SurfaceMesh {
    /// Volume enclosed, if the surface is closed and oriented outwards [m³].
    pub fn enclosed_volume(&self) -> f64 {
        let corner = |node: u32| self.nodes[node as usize];
        self.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }
}

//! Trilinear shape functions of hexahedra and the points at which they are integrated.

use super::{HexMesh, MeshError, Point};
use crate::math::{Mat3, Vec3};

/// Gauss points in each direction of a hexahedron.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GaussRule {
    /// 2×2×2 points: full integration of a linear element, the usual choice.
    #[default]
    Two,
    /// 3×3×3 points, for comparison: on a distorted cell no rule is exact.
    Three,
}

impl GaussRule {
    /// Places ξ in [−1, 1] and weights of the rule in one direction.
    fn line(self) -> &'static [(f64, f64)] {
        const ROOT_OF_THIRD: f64 = 0.577_350_269_189_625_8;
        const ROOT_OF_THREE_FIFTHS: f64 = 0.774_596_669_241_483_4;
        match self {
            Self::Two => &[(-ROOT_OF_THIRD, 1.0), (ROOT_OF_THIRD, 1.0)],
            Self::Three => &[(-ROOT_OF_THREE_FIFTHS, 5.0 / 9.0), (0.0, 8.0 / 9.0), (ROOT_OF_THREE_FIFTHS, 5.0 / 9.0)],
        }
    }

    /// How many points the rule has in a cell.
    pub fn point_count(self) -> usize {
        self.line().len().pow(3)
    }

    /// Places and weights in the cube.
    fn points(self) -> Vec<([f64; 3], f64)> {
        let line = self.line();
        let mut points = Vec::with_capacity(line.len().pow(3));
        for &(z, wz) in line {
            for &(y, wy) in line {
                for &(x, wx) in line {
                    points.push(([x, y, z], wx * wy * wz));
                }
            }
        }
        points
    }
}

/// Corners of the reference cube [−1, 1]³, in Gmsh/VTK order.
const REFERENCE_CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// A Gauss point of a cell at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussPoint {
    /// Gradients of the eight shape functions [1/m].
    pub gradients: [Vec3<f64>; 8],
    /// Volume that the point stands for [m³], > 0.
    pub volume: f64,
}

impl HexMesh {
    /// The Gauss points of a cell, x fastest.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] where the cell is folded: a point without positive volume.
    pub fn gauss_points(&self, cell: usize, rule: GaussRule) -> Result<Vec<GaussPoint>, MeshError> {
        let corners = self.corners(cell);
        let point = |(place, weight)| {
            let local = reference_gradients(place);
            let jacobian = jacobian(&corners, &local);
            let inverse = jacobian.inverse();
            let volume = jacobian.determinant() * weight;
            if volume > 0.0 && inverse.is_finite() {
                Ok(GaussPoint { gradients: local.map(|gradient| inverse.transpose_mul(gradient)), volume })
            } else {
                Err(MeshError::Degenerate { cell, corners: self.cells[cell].to_vec() })
            }
        };
        rule.points().into_iter().map(point).collect()
    }

    /// The averages of the four edges in each of a cell's three directions [m], as columns.
    pub fn mean_edges(&self, cell: usize) -> Mat3<f64> {
        jacobian(&self.corners(cell), &reference_gradients([0.0; 3])) * 2.0
    }

    /// Gradients of the eight shape functions at the centre of a cell [1/m]; what they make of the corners is the
    /// deformation of its mean edges.
    ///
    /// # Errors
    /// [`MeshError::Degenerate`] where the mean edges lie in a plane.
    pub fn centre_gradients(&self, cell: usize) -> Result<[Vec3<f64>; 8], MeshError> {
        let local = reference_gradients([0.0; 3]);
        let inverse = jacobian(&self.corners(cell), &local).inverse();
        if inverse.is_finite() {
            Ok(local.map(|gradient| inverse.transpose_mul(gradient)))
        } else {
            Err(MeshError::Degenerate { cell, corners: self.cells[cell].to_vec() })
        }
    }

    /// Volume of a cell [m³].
    pub fn cell_volume(&self, cell: usize) -> f64 {
        hexahedron_volume(&self.corners(cell))
    }
}

/// Volume of a trilinear hexahedron [m³], folded parts negative; 2×2×2 points are exact.
pub fn hexahedron_volume(corners: &[Point; 8]) -> f64 {
    gauss_jacobians(corners).iter().sum()
}

/// Jacobians of a trilinear hexahedron at the 2×2×2 points [m³]; each point stands for as much volume.
pub(super) fn gauss_jacobians(corners: &[Point; 8]) -> [f64; 8] {
    let line = GaussRule::Two.line();
    std::array::from_fn(|point| {
        let place = [point >> 2, point >> 1 & 1, point & 1].map(|step| line[step].0);
        jacobian(corners, &reference_gradients(place)).determinant()
    })
}

/// Gradients of the eight shape functions N_a = ⅛ Π (1 + ξ_a ξ) in the reference cube.
fn reference_gradients(place: [f64; 3]) -> [Vec3<f64>; 8] {
    REFERENCE_CORNERS.map(|corner| {
        let [a, b, c] = [0, 1, 2].map(|axis| 1.0 + corner[axis] * place[axis]);
        Vec3::new(corner[0] * b * c, a * corner[1] * c, a * b * corner[2]) * 0.125
    })
}

/// ∂X/∂ξ.
fn jacobian(corners: &[Point; 8], gradients: &[Vec3<f64>; 8]) -> Mat3<f64> {
    (0..8).fold(Mat3::ZERO, |sum, a| sum + corners[a].outer(gradients[a]))
}

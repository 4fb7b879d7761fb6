//! The highest frequency of shape memory, bounded node by node.
//!
//! r_i changes by at most Σ_j a_ij |dx_j|: a_ii = 1, and of a neighbour a_ij = ‖[d]× G⁻¹ [Y_j]× − I/n‖ + g |Y_j| √(|r||d| (3 + 2 g‖F‖))
//! with G = tr S I − S and g = 1/λ_min(G), the root standing for how the rotation bends. With A_i = Σ_j a_ij,
//!
//! dx·K dx ≤ Σ_i k_i (Σ_j a_ij |dx_j|)² ≤ Σ_j |dx_j|² Σ_i k_i A_i a_ij,   ω² ≤ max_j Σ_i k_i A_i a_ij/m_j
//!
//! Close to where a rotation jumps no bound holds: g is not taken larger than neighbours so ill placed, or so close to one point, would
//! have it, and stands for ‖G⁻¹‖ then.

use super::neighbourhoods::Neighbourhoods;
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar, Sym3, Vec3};
use crate::model::Scratch;
use crate::model::frequency::FrequencyBound;

/// 1/(g ‖F‖) at least, or half of that at rest where the neighbours are worse placed then.
const ILL_PLACED: f64 = 0.1;
/// ‖F‖ over that at rest below which the neighbours are as good as in one point.
const COLLAPSED: f64 = 0.1;
/// Newton steps to the smallest eigenvalue, from below.
const ROOT_STEPS: usize = 6;

#[derive(Clone, Debug)]
pub(super) struct MemoryBound {
    nodes: Neighbourhoods<f64>,
    corners: Vec<Vec<u32>>,
    /// Mass of a corner of each cell [kg]; 0 for one that is removed.
    corner_masses: Vec<f64>,
    /// Mass of each node [kg].
    masses: Vec<f64>,
}

impl MemoryBound {
    pub(super) fn new(nodes: Neighbourhoods<f64>, density: &[f64]) -> Self {
        let corners = nodes.rest.corners.clone();
        let density = |cell: usize| density[if density.len() == 1 { 0 } else { cell }];
        let corner_masses: Vec<_> =
            nodes.rest.volumes.iter().enumerate().map(|(cell, volume)| density(cell) * volume).collect();
        let mut masses = vec![0.0; nodes.nodes.len()];
        for (corners, mass) in corners.iter().zip(&corner_masses) {
            corners.iter().for_each(|&node| masses[node as usize] += mass);
        }
        Self { nodes, corners, corner_masses, masses }
    }

    /// k of the node, and a_ij of its neighbours; none for a node without neighbours.
    fn reach<T: Scalar>(&self, node: usize, x: &[Vec3<T>]) -> Option<(f64, impl Fn(usize) -> f64)> {
        let nodes = &self.nodes;
        let at = |entry: usize| (x[nodes.neighbour(entry)] - x[node]).cast::<f64>();
        let own = &nodes.nodes[node];
        if own.share == 0.0 {
            return None;
        }
        let centre = nodes.entries(node).fold(Vec3::ZERO, |sum, entry| sum + at(entry)) * own.share;
        let (mut covariance, mut at_rest) = (Mat3::ZERO, Mat3::ZERO);
        for entry in nodes.entries(node) {
            covariance += (at(entry) - centre).outer(nodes.arms[entry]);
            at_rest += nodes.arms[entry].outer(nodes.arms[entry]);
        }
        let rotation = polar(&(covariance * own.unit * own.unit));
        let size_at_rest = at_rest.squared_norm().sqrt();
        let size = covariance.squared_norm().sqrt().max(COLLAPSED * size_at_rest);
        let least = ILL_PLACED.min(0.5 * least_stretch(&stretches(&at_rest, &Mat3::IDENTITY)) / size_at_rest);
        let matrix = stretches(&covariance, &rotation);
        let smallest = least_stretch(&matrix);
        let g = 1.0 / smallest.max(least * size);
        let (offset, share) = (own.offset, own.share);
        let bend = g * ((-centre - rotation * offset).norm() * offset.norm() * (3.0 + 2.0 * g * size)).sqrt();
        let inverse = (smallest >= least * size).then(|| Mat3::from(matrix).inverse());
        let of = move |entry: usize| {
            let arm = nodes.arms[entry];
            let turn = match inverse {
                Some(inverse) => norm(&(cross(offset) * inverse * cross(arm) - Mat3::IDENTITY * share)),
                None => share + g * offset.norm() * arm.norm(),
            };
            turn + bend * arm.norm()
        };
        bend.is_finite().then_some((own.stiffness, of))
    }
}

/// [v]×.
fn cross(v: Vec3<f64>) -> Mat3<f64> {
    Mat3 { columns: Mat3::IDENTITY.columns.map(|axis: Vec3<f64>| v.cross(axis)) }
}

/// The largest stretch of a matrix, from above.
fn norm(matrix: &Mat3<f64>) -> f64 {
    matrix.gram().largest_eigenvalue_bound().sqrt()
}

/// G = tr S I − S, S = RᵀF.
fn stretches(covariance: &Mat3<f64>, rotation: &Mat3<f64>) -> Sym3<f64> {
    let stretch = (rotation.transpose() * *covariance).symmetric_part();
    Sym3::diagonal(stretch.trace()) - stretch
}

/// The smallest eigenvalue, from below; 0 where it is negative.
fn least_stretch(matrix: &Sym3<f64>) -> f64 {
    let full = Mat3::from(*matrix);
    let (trace, minors, determinant) = (matrix.trace(), full.cofactor().trace(), full.determinant());
    if determinant <= 0.0 || minors <= 0.0 {
        return 0.0;
    }
    // From 0 to the smallest root of λ³ − tr λ² + minors λ − det Newton's method rises and never passes it.
    let mut root = 0.0;
    for _ in 0..ROOT_STEPS {
        let value = ((root - trace) * root + minors) * root - determinant;
        let slope = (3.0 * root - 2.0 * trace) * root + minors;
        if slope <= 0.0 {
            break;
        }
        root -= value / slope;
    }
    root
}

impl<T: Scalar> FrequencyBound<T> for MemoryBound {
    fn squared_frequency(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> f64 {
        let nodes = &self.nodes;
        scratch.clear_forces();
        let mut add = |node: usize, value: f64| {
            let sum = &mut scratch.forces[node][0];
            *sum += T::from_f64(value / self.masses[node]);
        };
        for node in 0..x.len() {
            let Some((stiffness, reach)) = self.reach(node, x) else { continue };
            let all = stiffness * (1.0 + nodes.entries(node).map(&reach).sum::<f64>());
            add(node, all);
            for entry in nodes.entries(node) {
                add(nodes.neighbour(entry), all * reach(entry) + nodes.nodes[node].grip);
            }
        }
        scratch.forces.iter().map(|row| row[0].to_f64()).fold(0.0, f64::max)
    }

    fn remove(&mut self, cells: &[u32]) {
        for &cell in cells {
            let mass = std::mem::take(&mut self.corner_masses[cell as usize]);
            self.corners[cell as usize].iter().for_each(|&node| self.masses[node as usize] -= mass);
        }
        self.nodes.remove(cells);
    }

    fn clone_box(&self) -> Box<dyn FrequencyBound<T>> {
        Box::new(self.clone())
    }
}

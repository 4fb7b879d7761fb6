//! Nodes that move as one rigid body.
//!
//! With y the arms from the centre of mass before the drift and v the velocities of the nodes as if each were free,
//!
//! P = Σ m v,   L = Σ m y×v,   c⁺ = c + Δt P/M,   x⁺ = c⁺ + Q y   with   Σ m y×Q y = Δt L
//!
//! The last line is the discrete rigid body of Moser and Veselov: what constraint forces along the bonds of the part make of its
//! drift, without finding them; momentum and angular momentum stay to rounding. Q is found by Newton's method. The arms are
//! those of the rest shape, turned by the rotation that fits the places before the drift best: lengths never drift.
//!
//! Source: Moser, Veselov (1991); Ryckaert, Ciccotti, Berendsen (1977) for constraints along the drift, whose limit this is.

use super::Motion;
use crate::math::rotation::polar;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::Point;

/// The most steps of Newton's method to Q.
const STEPS: usize = 30;

/// A part of a body that keeps its shape.
#[derive(Clone, Debug)]
pub(crate) struct RigidPart {
    pub(crate) nodes: Vec<u32>,
    /// Places at rest, counted from their mean [m].
    rest: Vec<Point>,
    /// Centre of mass before the drift [m].
    pub(super) centre: Point,
    /// Arms before the drift [m], exactly those at rest but turned.
    arms: Vec<Point>,
    /// M [kg] and Σ m y yᵀ [kg m²] then.
    mass: f64,
    moments: Mat3<f64>,
}

impl RigidPart {
    /// The part of these nodes; none where they lie in a line, so that no places tell how it is turned.
    pub(crate) fn new(nodes: Vec<u32>, places: &[Point]) -> Option<Self> {
        let at = |&node: &u32| places[node as usize];
        let mean = nodes.iter().map(at).fold(Vec3::ZERO, |sum, place| sum + place) / nodes.len() as f64;
        let rest: Vec<_> = nodes.iter().map(|node| at(node) - mean).collect();
        let moments = rest.iter().fold(Mat3::ZERO, |sum, &arm| sum + arm.outer(arm));
        let planar = moments.cofactor().trace() > 1e-12 * moments.trace() * moments.trace();
        let (arms, centre) = (rest.clone(), Vec3::ZERO);
        planar.then_some(Self { nodes, rest, centre, arms, mass: 0.0, moments: Mat3::ZERO })
    }

    /// Finds where the part stands before a drift.
    pub(super) fn begin<T: Scalar>(&mut self, start: &[Point], masses: &[T]) {
        let weight = |node: u32| masses[node as usize].to_f64();
        let place = |node: u32| start[node as usize];
        let (mut mass, mut sum, mut arm_sum) = (0.0, Vec3::ZERO, Vec3::ZERO);
        for (&node, &rest) in self.nodes.iter().zip(&self.rest) {
            mass += weight(node);
            sum += place(node) * weight(node);
            arm_sum += rest * weight(node);
        }
        if mass <= 0.0 {
            self.mass = 0.0;
            return;
        }
        let (centre, rest_centre) = (sum / mass, arm_sum / mass);
        let mut fit = Mat3::ZERO;
        for (&node, &rest) in self.nodes.iter().zip(&self.rest) {
            fit += (place(node) - centre).outer((rest - rest_centre) * weight(node));
        }
        let rotation = polar(&fit);
        self.moments = Mat3::ZERO;
        for ((&node, &rest), arm) in self.nodes.iter().zip(&self.rest).zip(&mut self.arms) {
            *arm = rotation * (rest - rest_centre);
            self.moments += arm.outer(*arm * weight(node));
        }
        (self.centre, self.mass) = (centre, mass);
    }

    /// P and L of the nodes' velocities.
    fn momenta<T: Scalar>(&self, velocities: &[Vec3<T>], masses: &[T]) -> (Point, Point) {
        self.nodes.iter().zip(&self.arms).fold((Vec3::ZERO, Vec3::ZERO), |(linear, angular), (&node, arm)| {
            let own = velocities[node as usize].cast::<f64>() * masses[node as usize].to_f64();
            (linear + own, angular + arm.cross(own))
        })
    }

    /// Lets the part drift as one with the momenta of its nodes. Nodes whose cells are all cut away stay behind.
    pub(super) fn drift<T: Scalar>(&self, motion: &mut Motion<'_, T>, dt: f64) {
        if self.mass <= 0.0 {
            return;
        }
        let (linear, angular) = self.momenta(motion.velocities, motion.masses);
        let (velocity, turn) = (linear / self.mass, self.turn(angular * dt));
        for (&node, &arm) in self.nodes.iter().zip(&self.arms) {
            let node = node as usize;
            if motion.masses[node] > T::ZERO {
                let turned = turn * arm;
                motion.positions[node] = (self.centre + velocity * dt + turned).cast();
                // Not from the places, whose roundings over a short sub-step are a momentum.
                motion.velocities[node] = (velocity + (turned - arm) / dt).cast();
            }
        }
    }

    /// Takes from the velocities what a rigid body standing there cannot have.
    pub(super) fn settle<T: Scalar>(&self, motion: &mut Motion<'_, T>) {
        if self.mass <= 0.0 {
            return;
        }
        let (linear, angular) = self.momenta(motion.velocities, motion.masses);
        let (velocity, spin) = (linear / self.mass, self.inertia().inverse() * angular);
        for (&node, &arm) in self.nodes.iter().zip(&self.arms) {
            if motion.masses[node as usize] > T::ZERO && spin.is_finite() {
                motion.velocities[node as usize] = (velocity + spin.cross(arm)).cast();
            }
        }
    }

    /// The velocity and spin that impulses on nodes give [m/s, 1/s].
    pub(super) fn answer(&self, start: &[Point], impulses: impl Iterator<Item = (u32, Point)>) -> (Point, Point) {
        let (mut linear, mut angular) = (Vec3::ZERO, Vec3::ZERO);
        for (node, impulse) in impulses {
            linear += impulse;
            angular += (start[node as usize] - self.centre).cross(impulse);
        }
        let spin = self.inertia().inverse() * angular;
        (linear / self.mass, if spin.is_finite() { spin } else { Vec3::ZERO })
    }

    /// tr(Σ m y yᵀ) I − Σ m y yᵀ [kg m²].
    fn inertia(&self) -> Mat3<f64> {
        Mat3::diagonal(self.moments.trace()) - self.moments
    }

    /// Q with Σ m y×Q y = `wanted` [kg m²].
    fn turn(&self, wanted: Point) -> Mat3<f64> {
        let mut q = Mat3::IDENTITY;
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            // Σ m y×Q y is the axis of Q A − A Qᵀ; it changes by (tr(QA) I − QA) δ when Q turns by δ.
            let turned = q * self.moments;
            let left = wanted - turned.double_axis();
            let step = (Mat3::diagonal(turned.trace()) - turned).inverse() * left;
            let size = step.norm();
            if !size.is_finite() || size >= last {
                break;
            }
            q = rotation(step) * q;
            last = size;
        }
        q
    }
}

/// The rotation by the vector `w` [rad], to rounding for any angle: from its half by Rodrigues' parameters.
fn rotation(w: Point) -> Mat3<f64> {
    let angle = w.norm();
    let half = if angle > 1e-8 { w * ((0.5 * angle).tan() / angle) } else { w * 0.5 };
    let scale = 2.0 / (1.0 + half.squared_norm());
    let turned = |axis: Point| axis + (half.cross(axis) + half.cross(half.cross(axis))) * scale;
    let [x, y, _] = Mat3::IDENTITY.columns.map(turned);
    let x = x / x.norm();
    let y = y - x * x.dot(y);
    let y = y / y.norm();
    Mat3::from_columns(x, y, x.cross(y))
}

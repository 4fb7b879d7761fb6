//! A closed surface whose volume stays what it is, exactly.
//!
//! V = ⅙ Σ P_i·(P_j×P_k) over its triangles,   g_i = ∂V/∂P_i = ⅙ Σ P_j×P_k
//!
//! After a drift the nodes move along u = M⁻¹ g by ℓ u, and V(x + ℓ u) is a cubic in ℓ: its root of least size makes V = V0, to
//! rounding, in one solve; ℓ g/Δt is the impulse of a pressure from inside. Another takes from the velocities after the second kick what
//! would change the volume, so that g·v = 0 (Andersen, Rattle, 1983). The g are those of the places before the
//! drift: Σ g = 0 and Σ x×g = 0 there, which are the sums that a drift keeps, so that momentum and angular momentum stay. With
//! those after it, as printed, a turning body is turned faster or slower by 2 V p ω Δt in each second.
//!
//! Source: Promayon, Baconnier, Puech (1996).

use super::cubic::least_root;
use super::rigid_part::RigidPart;
use super::{Motion, NO_PART, nearer_than_rounding};
use crate::math::{Scalar, Vec3};
use crate::mesh::{Face, Point};
use crate::solver::Filter;

/// Cells whose common volume is kept.
#[derive(Clone, Debug)]
pub(crate) struct ExactVolume {
    /// Name by which messages and observables call it.
    pub(crate) name: String,
    /// Every face of the chosen cells, and whether the cells on its two sides are chosen.
    faces: Vec<(Face, [bool; 2])>,
    /// Triangles of the surface of what is left, counter-clockwise from outside, as places in `nodes`.
    triangles: Vec<[u32; 3]>,
    /// The nodes of the surface.
    pub(super) nodes: Vec<u32>,
    /// Place of each node of the body in `nodes`; meaningful for those that are there.
    places: Vec<u32>,
    /// g of each node of the surface [m²].
    pub(super) gradient: Vec<Point>,
    /// u of each node of the surface [m²/kg].
    pub(super) directions: Vec<Point>,
}

impl ExactVolume {
    /// The volume of the `chosen` cells of a body with these faces.
    pub(crate) fn new(name: String, faces: &[Face], chosen: &[bool], nodes: usize) -> Self {
        let inside = |cell: Option<u32>| cell.is_some_and(|cell| chosen[cell as usize]);
        let sides = |face: &Face| [inside(Some(face.cells.0)), inside(face.cells.1)];
        let faces: Vec<_> =
            faces.iter().map(|face| (*face, sides(face))).filter(|(_, sides)| *sides != [false; 2]).collect();
        let most = nodes.min(3 * faces.len());
        Self {
            name,
            triangles: Vec::with_capacity(faces.len()),
            nodes: Vec::with_capacity(most),
            places: vec![0; nodes],
            gradient: vec![Vec3::ZERO; most],
            directions: vec![Vec3::ZERO; most],
            faces,
        }
    }

    /// Finds the surface of the cells that are left.
    pub(crate) fn update(&mut self, removed: &[bool]) {
        self.triangles.clear();
        self.nodes.clear();
        let Self { faces, triangles, nodes, places, .. } = self;
        for (face, chosen) in faces.iter() {
            let there = |cell: Option<u32>, chosen: bool| chosen && cell.is_some_and(|cell| !removed[cell as usize]);
            let [a, b, c] = face.nodes;
            let corners = match (there(Some(face.cells.0), chosen[0]), there(face.cells.1, chosen[1])) {
                (true, false) => [a, b, c],
                (false, true) => [a, c, b],
                _ => continue,
            };
            triangles.push(corners.map(|node| {
                let place = places[node as usize];
                if nodes.get(place as usize) != Some(&node) {
                    places[node as usize] = nodes.len() as u32;
                    nodes.push(node);
                }
                places[node as usize]
            }));
        }
    }

    /// The triangles' corners at places that `at` gives by node, from the first node: a difference of small numbers.
    fn corners<'a>(&'a self, at: impl Fn(u32) -> Point + Copy + 'a) -> impl Iterator<Item = [Point; 3]> + 'a {
        let origin = self.nodes.first().map_or(Vec3::ZERO, |&node| at(node));
        self.triangles.iter().map(move |corners| corners.map(|place| at(self.nodes[place as usize]) - origin))
    }

    /// Volume [m³], and what is uncertain of it: by rounding of the coordinates to numbers of type `T`, and of the sum over the triangles,
    /// whose steps add up like those of a random walk.
    pub(crate) fn measure<T: Scalar>(&self, at: impl Fn(u32) -> Point + Copy) -> (f64, f64) {
        let (mut six_volumes, mut sizes, mut area, mut farthest) = (0.0, 0.0, 0.0, 0.0f64);
        for [a, b, c] in self.corners(at) {
            let own = a.dot(b.cross(c));
            six_volumes += own;
            sizes += own.abs();
            area += 0.5 * (b - a).cross(c - a).norm();
        }
        let summed = f64::EPSILON * (self.triangles.len() as f64).sqrt() * sizes;
        for &node in &self.nodes {
            farthest = farthest.max(at(node).norm());
        }
        (six_volumes / 6.0, nearer_than_rounding::<T>(farthest) * area + summed / 6.0)
    }

    /// Finds g at the places before the drift, and with it u.
    pub(super) fn aim<T: Scalar>(
        &mut self,
        start: &[Point],
        masses: &[T],
        filter: &impl Fn(u32) -> Filter<T>,
        parts: (&[u32], &[RigidPart]),
    ) {
        let count = self.nodes.len();
        self.gradient[..count].fill(Vec3::ZERO);
        let origin = self.nodes.first().map_or(Vec3::ZERO, |&node| start[node as usize]);
        for &corners in &self.triangles {
            let [a, b, c] = corners.map(|place| start[self.nodes[place as usize] as usize] - origin);
            for (place, area) in corners.into_iter().zip([b.cross(c), c.cross(a), a.cross(b)]) {
                self.gradient[place as usize] += area / 6.0;
            }
        }
        let (part_of, parts) = parts;
        for (place, &node) in self.nodes.iter().enumerate() {
            if part_of[node as usize] == NO_PART {
                let free = filter(node).apply((self.gradient[place] / masses[node as usize].to_f64()).cast());
                self.directions[place] = free.cast();
            }
        }
        for (number, part) in parts.iter().enumerate() {
            let own = |place: &usize| part_of[self.nodes[*place] as usize] == number as u32;
            let pushes = (0..count).filter(own).map(|place| (self.nodes[place], self.gradient[place]));
            let (velocity, spin) = part.answer(start, pushes);
            for place in (0..count).filter(own) {
                let arm = start[self.nodes[place] as usize] - part.centre;
                self.directions[place] = velocity + spin.cross(arm);
            }
        }
    }

    /// Moves the nodes along u, so that the volume becomes `wanted` [m³]; gives ℓ [kg/m]; none where no ℓ does it. Nodes of rigid
    /// parts get the impulse alone: where they go is for their parts to find.
    pub(super) fn restore<T: Scalar>(
        &self,
        motion: &mut Motion<'_, T>,
        wanted: f64,
        dt: f64,
        part_of: &[u32],
    ) -> Option<f64> {
        let positions = &*motion.positions;
        let at = |node: u32| positions[node as usize].cast::<f64>();
        let mut c = [-6.0 * wanted, 0.0, 0.0, 0.0];
        for (&corners, [a, b, d]) in self.triangles.iter().zip(self.corners(at)) {
            let [u, v, w] = corners.map(|place| self.directions[place as usize] - self.directions[0]);
            c[0] += a.dot(b.cross(d));
            c[1] += u.dot(b.cross(d)) + v.dot(d.cross(a)) + w.dot(a.cross(b));
            c[2] += a.dot(v.cross(w)) + b.dot(w.cross(u)) + d.dot(u.cross(v));
            c[3] += u.dot(v.cross(w));
        }
        let size = least_root(c)?;
        for (place, &node) in self.nodes.iter().enumerate() {
            let node = node as usize;
            if part_of[node] == NO_PART {
                let way = self.directions[place] * size;
                motion.positions[node] = (motion.positions[node].cast::<f64>() + way).cast();
                motion.velocities[node] += (way / dt).cast();
            } else {
                motion.velocities[node] += (self.gradient[place] * (size / (dt * motion.masses[node].to_f64()))).cast();
            }
        }
        Some(size)
    }

    /// Takes from the velocities what changes the volume, g·v = 0 along u; gives the impulse over g [kg/(m s)].
    pub(super) fn still<T: Scalar>(&self, motion: &mut Motion<'_, T>, part_of: &[u32]) -> f64 {
        let (mut rate, mut mobility) = (0.0, 0.0);
        for (place, &node) in self.nodes.iter().enumerate() {
            rate += self.gradient[place].dot(motion.velocities[node as usize].cast());
            mobility += self.gradient[place].dot(self.directions[place]);
        }
        if mobility <= 0.0 {
            return 0.0;
        }
        let size = -rate / mobility;
        for (place, &node) in self.nodes.iter().enumerate() {
            let node = node as usize;
            let change = match part_of[node] {
                NO_PART => self.directions[place] * size,
                _ => self.gradient[place] * (size / motion.masses[node].to_f64()),
            };
            motion.velocities[node] += change.cast();
        }
        size
    }
}

//! Solids of revolution: instruments, arrows and dots are all lathed from a profile.

use viscera::math::Vec3;

use super::{Body, Colour, Finish};

const AROUND: usize = 24;
const QUARTER: usize = 6;

/// A closed surface made here.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(super) body: Body,
}

/// Parts of rigid instruments; an instrument is a few of them.
pub struct Tool;

impl Tool {
    /// A rod from `a` to `b` \[m\] with round ends of `radius` \[m\], in steel.
    pub fn capsule(a: [f64; 3], b: [f64; 3], radius: f64) -> Solid {
        Self::tapered(a, b, radius, radius)
    }
    /// A ball \[m\], in steel.
    pub fn sphere(centre: [f64; 3], radius: f64) -> Solid {
        Self::tapered(centre, centre, radius, radius)
    }
    /// A rod whose radius goes from `radius_a` to `radius_b` \[m\], with round ends, in steel.
    pub fn tapered(a: [f64; 3], b: [f64; 3], radius_a: f64, radius_b: f64) -> Solid {
        let length = (Vec3::from(b) - Vec3::from(a)).norm();
        let quarter = |i: usize| (i as f64 / QUARTER as f64 * std::f64::consts::FRAC_PI_2).sin_cos();
        let start = (0..=QUARTER).map(quarter).map(|(sine, cosine)| [-radius_a * cosine, radius_a * sine]);
        let end = (0..=QUARTER).map(quarter).map(|(sine, cosine)| [length + radius_b * sine, radius_b * cosine]);
        let profile: Vec<_> = start.chain(end).collect();
        Solid { body: lathe(a.into(), b.into(), &profile, 40.0) }
    }
}

impl Solid {
    /// An arrow from `start` to `end` \[m\] with a shaft of `radius` \[m\].
    pub(super) fn arrow(start: Vec3<f64>, end: Vec3<f64>, radius: f64) -> Self {
        let length = (end - start).norm();
        let head = (radius * 6.0).min(length * 0.6);
        let neck = length - head;
        let profile = [[0.0, 0.0], [0.0, radius], [neck, radius], [neck, radius * 2.6], [length, 0.0]];
        Self { body: lathe(start, end, &profile, 30.0).finish(Finish::Matte) }
    }
    /// Another colour than steel.
    pub fn colour(mut self, colour: Colour) -> Self {
        self.body = self.body.colour(colour);
        self
    }
    /// Another finish than metal.
    pub fn finish(mut self, finish: Finish) -> Self {
        self.body = self.body.finish(finish);
        self
    }
}

/// Turns `profile`, pairs (along the axis, radius) \[m\], about the axis from `a` towards `b`.
fn lathe(a: Vec3<f64>, b: Vec3<f64>, profile: &[[f64; 2]], crease: f64) -> Body {
    let axis = (b - a).normalized().unwrap_or(Vec3::new(0.0, 1.0, 0.0));
    let across = if axis.x.abs() < 0.7 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let u = axis.cross(across).normalized().unwrap_or(across);
    let v = axis.cross(u);
    let mut nodes = Vec::with_capacity(profile.len() * AROUND);
    for &[along, radius] in profile {
        for k in 0..AROUND {
            let (sine, cosine) = (k as f64 / AROUND as f64 * std::f64::consts::TAU).sin_cos();
            nodes.push(a + axis * along + (u * cosine + v * sine) * radius);
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..profile.len().saturating_sub(1) {
        for k in 0..AROUND {
            let node = |ring: usize, k: usize| (ring * AROUND + k % AROUND) as u32;
            let [p, q, r, s] = [node(ring, k), node(ring, k + 1), node(ring + 1, k + 1), node(ring + 1, k)];
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    Body::new(&nodes, &triangles).colour(Colour::STEEL).finish(Finish::Metal).crease(crease)
}

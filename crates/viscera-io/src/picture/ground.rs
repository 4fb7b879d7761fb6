//! The ground: a fine grid that gives the scale, and the soft shadow of what stands over it.

use viscera::math::Vec3;

use super::camera::View;
use super::colour::Light;
use super::facet::Facet;
use super::shade::smooth;

const SIDE: usize = 384;

/// The plane under the framed box, with the shadow that the key lamp throws on it.
pub(super) struct Ground {
    origin: Vec3<f64>,
    u: Vec3<f64>,
    v: Vec3<f64>,
    normal: Vec3<f64>,
    /// Side of a grid square \[m\].
    step: f64,
    /// Half the side of the shadow's map \[m\].
    half: f64,
    shadow: Vec<f32>,
}

impl Ground {
    /// The ground below `view`'s box, shadowed by `facets` along the direction `key` towards the lamp.
    pub(super) fn new(view: &View, facets: &[Facet], key: Vec3<f64>) -> Self {
        let normal = view.world_up;
        let lowest = view.corners().iter().fold(f64::INFINITY, |low, p| low.min(p.dot(normal)));
        let centre = (view.minimum + view.maximum) * 0.5;
        let origin = centre + normal * (lowest - 0.015 * view.size - centre.dot(normal));
        let u = view.right;
        let v = normal.cross(u);
        let mut ground = Self {
            origin,
            u,
            v,
            normal,
            step: nice_length(view.size / 5.0),
            half: view.size * 1.6,
            shadow: vec![0.0; SIDE * SIDE],
        };
        for facet in facets.iter().filter(|facet| !facet.ghost) {
            ground.darken(facet, key);
        }
        for _ in 0..3 {
            ground.blur(4);
        }
        ground
    }

    /// Marks the shadow of one facet in the map.
    fn darken(&mut self, facet: &Facet, key: Vec3<f64>) {
        let down = key.dot(self.normal).max(0.1);
        let corners = facet.corners.map(|corner| {
            let p = corner.position;
            let landed = p - key * ((p - self.origin).dot(self.normal) / down);
            self.plane(landed).map(|c| (c / self.half * 0.5 + 0.5) * SIDE as f64)
        });
        let range = |axis: usize| {
            let [a, b, c] = corners.map(|p| p[axis]);
            let limit = SIDE as f64;
            a.min(b).min(c).floor().clamp(0.0, limit) as usize..a.max(b).max(c).ceil().clamp(0.0, limit) as usize
        };
        let side = |a: [f64; 2], b: [f64; 2], x: f64, y: f64| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
        let turn = side(corners[0], corners[1], corners[2][0], corners[2][1]).signum();
        for row in range(1) {
            for column in range(0) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                if (0..3).all(|i| turn * side(corners[i], corners[(i + 1) % 3], x, y) >= 0.0) {
                    self.shadow[row * SIDE + column] = 1.0;
                }
            }
        }
    }

    /// A box blur of the map, along rows and then columns; three of them are close to a Gaussian.
    fn blur(&mut self, radius: usize) {
        for (along, across) in [(1, SIDE), (SIDE, 1)] {
            for line in 0..SIDE {
                let before: Vec<f32> = (0..SIDE).map(|i| self.shadow[line * across + i * along]).collect();
                for i in 0..SIDE {
                    let window = &before[i.saturating_sub(radius)..(i + radius + 1).min(SIDE)];
                    self.shadow[line * across + i * along] = window.iter().sum::<f32>() / (2 * radius + 1) as f32;
                }
            }
        }
    }

    /// Coordinates in the plane, from the origin \[m\].
    fn plane(&self, point: Vec3<f64>) -> [f64; 2] {
        let p = point - self.origin;
        [p.dot(self.u), p.dot(self.v)]
    }

    /// Where the line of sight through `place` meets the ground from above.
    pub(super) fn meet(&self, view: &View, place: [f64; 2]) -> Option<Vec3<f64>> {
        let (from, along) = view.ray(place);
        let descent = -along.dot(self.normal);
        let distance = (from - self.origin).dot(self.normal) / descent;
        (descent > 1e-3 && distance > 0.0).then(|| from + along * distance)
    }

    /// `background` as seen through grid and shadow at `place`.
    pub(super) fn colour(&self, view: &View, place: [f64; 2], background: Light) -> Light {
        let around = [place, [place[0] + 1.0, place[1]], [place[0], place[1] + 1.0]];
        let [Some(here), Some(right), Some(below)] = around.map(|place| self.meet(view, place)) else {
            return background;
        };
        let ([x, y], right, below) = (self.plane(here), self.plane(right), self.plane(below));
        let away = (x.hypot(y) / view.size) as f32;
        let fade = smooth(1.6, 0.5, away);
        // A line is as wide as a pixel and as dark as its share of it, so that it neither flickers nor thickens far off.
        let line = |value: f64, a: f64, b: f64| {
            let pixel = (a - value).hypot(b - value).max(f64::MIN_POSITIVE);
            let off = (value - (value / self.step).round() * self.step).abs();
            ((1.1 - off / pixel).clamp(0.0, 1.0) * (0.25 * self.step / pixel).min(1.0)) as f32
        };
        let grid = line(x, right[0], below[0]).max(line(y, right[1], below[1]));
        let shadow = self.shadow_at([x, y]);
        let tint = Vec3::new(0.62_f32, 0.60, 0.56);
        let keep = Vec3::splat(1.0) - tint * (shadow * fade * 0.80);
        Vec3::new(background.x * keep.x, background.y * keep.y, background.z * keep.z) * (1.0 - 0.22 * grid * fade)
    }

    /// The blurred map between its four nearest points.
    fn shadow_at(&self, place: [f64; 2]) -> f32 {
        let [x, y] = place.map(|c| (c / self.half * 0.5 + 0.5) * SIDE as f64 - 0.5);
        if !(x >= 0.0 && y >= 0.0 && x < SIDE as f64 - 1.0 && y < SIDE as f64 - 1.0) {
            return 0.0;
        }
        let (i, j, s, t) = (x as usize, y as usize, x.fract() as f32, y.fract() as f32);
        let at = |i: usize, j: usize| self.shadow[j * SIDE + i];
        (at(i, j) * (1.0 - s) + at(i + 1, j) * s) * (1.0 - t) + (at(i, j + 1) * (1.0 - s) + at(i + 1, j + 1) * s) * t
    }

    /// The ground's normal.
    pub(super) fn normal(&self) -> Vec3<f64> {
        self.normal
    }
}

/// The largest of 1, 2, 5 · 10ⁿ \[m\] not above `length`.
pub(super) fn nice_length(length: f64) -> f64 {
    let decade = 10.0_f64.powf((length * (1.0 + 1e-9)).log10().floor());
    let digit = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * decade <= length * (1.0 + 1e-9)).unwrap_or(1.0);
    digit * decade
}

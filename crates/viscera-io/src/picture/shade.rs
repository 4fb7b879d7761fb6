//! Light on a surface: key, fill and rim lamps in a studio, in linear light.

use viscera::math::Vec3;

use super::camera::View;
use super::colour::{Light, mix, tint};

/// How a surface answers light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Lambert's law alone: colours stay readable.
    Matte,
    /// Moist tissue: light bleeds red past the terminator, under a thin clear film.
    Wet,
    /// Polished steel: mirrors the studio.
    Metal,
}

/// The lamps, as unit directions towards them, and their strengths.
pub(super) struct Studio {
    pub(super) key: Vec3<f32>,
    lamps: [(Vec3<f32>, Light); 3],
    up: Vec3<f32>,
    sky: Light,
    floor: Light,
}

impl Studio {
    /// Key from upper left before the subject, a weak fill from the right, a cool rim from behind.
    pub(super) fn new(view: &View) -> Self {
        let towards = |right: f64, up: f64, back: f64| {
            let along = view.right * right + view.up * 0.25 * up + view.world_up * 0.75 * up - view.forward * back;
            along.normalized().unwrap_or(view.world_up).cast::<f32>()
        };
        let key = towards(-0.62, 0.95, 0.62);
        Self {
            key,
            lamps: [
                (key, Vec3::new(0.86, 0.83, 0.78)),
                (towards(0.95, 0.25, 0.55), Vec3::new(0.17, 0.19, 0.23)),
                (towards(0.35, 0.55, -0.95), Vec3::new(0.26, 0.28, 0.32)),
            ],
            up: view.world_up.cast(),
            sky: Vec3::new(0.25, 0.27, 0.30),
            floor: Vec3::new(0.15, 0.14, 0.13),
        }
    }

    /// Light towards the viewer, tone mapped, from a surface of `albedo` with unit `normal`.
    pub(super) fn shade(&self, finish: Finish, albedo: Light, normal: Vec3<f32>, viewer: Vec3<f32>) -> Light {
        tone(match finish {
            Finish::Matte => tint(albedo, self.diffuse(normal, Vec3::ZERO)),
            Finish::Wet => {
                let body = tint(albedo, self.diffuse(normal, Vec3::new(0.34, 0.10, 0.08)));
                let film = schlick(0.032, normal.dot(viewer)).min(0.22);
                body * (1.0 - film)
                    + self.mirror(normal, viewer) * (film * 0.40)
                    + self.gloss(normal, viewer, 240.0) * 0.75
                    + self.gloss(normal, viewer, 28.0) * 0.09
            }
            Finish::Metal => {
                let edge = schlick(0.0, normal.dot(viewer));
                let mirrored = tint(mix(albedo, Vec3::splat(1.0), edge), self.mirror(normal, viewer));
                mirrored * 0.95
                    + tint(albedo, self.diffuse(normal, Vec3::ZERO)) * 0.16
                    + self.gloss(normal, viewer, 60.0) * 0.5
            }
        })
    }

    /// Irradiance by Lambert's cosine; `wrap` lets each channel reach past the terminator.
    fn diffuse(&self, normal: Vec3<f32>, wrap: Light) -> Light {
        let mut sum = mix(self.floor, self.sky, 0.5 + 0.5 * normal.dot(self.up));
        for &(direction, strength) in &self.lamps {
            let cosine = normal.dot(direction);
            let channel = |wrap: f32| ((cosine + wrap) / (1.0 + wrap)).max(0.0);
            sum += tint(strength, Vec3::new(channel(wrap.x), channel(wrap.y), channel(wrap.z)));
        }
        sum
    }

    /// Highlights of the lamps (Blinn 1977).
    fn gloss(&self, normal: Vec3<f32>, viewer: Vec3<f32>, exponent: f32) -> Light {
        let mut sum = Vec3::ZERO;
        for &(direction, strength) in &self.lamps {
            let half = (direction + viewer).normalized().unwrap_or(normal);
            let lit = smooth(-0.05, 0.15, normal.dot(direction));
            sum += strength * (normal.dot(half).max(0.0).powf(exponent) * lit);
        }
        sum
    }

    /// The studio mirrored in the surface: pale walls, a darker horizon, a soft box at the key lamp.
    fn mirror(&self, normal: Vec3<f32>, viewer: Vec3<f32>) -> Light {
        let ray = normal * (2.0 * normal.dot(viewer)) - viewer;
        let height = ray.dot(self.up);
        let wall = 0.34 + 0.72 * smooth(-0.1, 0.9, height) + 0.25 * smooth(-0.15, -0.9, height);
        let horizon = 1.0 - 0.65 * smooth(0.30, 0.0, (height + 0.05).abs());
        let soft_box = 1.6 * smooth(0.72, 0.93, ray.dot(self.key));
        Vec3::splat(wall * horizon + soft_box)
    }
}

/// Fresnel's share of reflection after Schlick (1994), from `facing` at right angles to 1 at grazing.
fn schlick(facing: f32, cosine: f32) -> f32 {
    facing + (1.0 - facing) * (1.0 - cosine.clamp(0.0, 1.0)).powi(5)
}

/// 0 before `start`, 1 past `end`, smooth between; `start` may lie beyond `end`.
pub(super) fn smooth(start: f32, end: f32, x: f32) -> f32 {
    let t = ((x - start) / (end - start)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear up to the knee, then bent so that no highlight clips.
fn tone(light: Light) -> Light {
    const KNEE: f32 = 0.75;
    let bend = |x: f32| if x <= KNEE { x } else { KNEE + (1.0 - KNEE) * ((x - KNEE) / (1.0 - KNEE)).tanh() };
    Vec3::new(bend(light.x), bend(light.y), bend(light.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lambert 1760: a matte plane under one lamp reflects albedo · cos θ, and nothing past 90°.
    #[test]
    fn matte_plane_follows_lamberts_cosine() {
        let key = Vec3::new(0.0, 0.0, 1.0);
        let dark = Vec3::ZERO;
        let lamps = [(key, Vec3::splat(0.7)), (key, dark), (key, dark)];
        let studio = Studio { key, lamps, up: Vec3::new(0.0, 1.0, 0.0), sky: dark, floor: dark };
        for degrees in [0.0_f32, 20.0, 45.0, 60.0, 80.0, 100.0, 150.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let seen = studio.shade(Finish::Matte, Vec3::new(0.8, 0.5, 0.2), Vec3::new(sine, 0.0, cosine), key);
            for (found, albedo) in seen.to_array().into_iter().zip([0.8, 0.5, 0.2]) {
                assert!((found - 0.7 * albedo * cosine.max(0.0)).abs() < 1e-6, "{degrees}: {found}");
            }
        }
    }
}

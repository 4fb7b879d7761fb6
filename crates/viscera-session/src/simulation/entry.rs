//! Where the shafts of instruments enter: the points in the wall of the belly that a session chooses.

use viscera::math::Vec3;

use super::Play;
use super::tools;
use crate::message::Trocar;

/// A point lies at least this far from the middle of the bodies [radii of the ball around them].
const CLEAR: f64 = 1.15;
/// Parts of its shaft that an instrument has within the wall, at least and at most.
const WITHIN: (f64, f64) = (0.35, 0.8);
/// Points lie at least this far from each other [radii].
const APART: f64 = 0.3;
/// Where points are tried, from the tip: so far to the side, to one of up and forward.
const SIDEWAYS: [f64; 5] = [0.0, 0.5, -0.5, 1.0, -1.0];

impl Play {
    /// The point [m] that is meant for an instrument whose tip is at `tip` [m], which has the number `own` if it has one. One that is
    /// left to the session is above the bodies and towards who looks, off all other instruments' points, and near enough for the shaft.
    pub(crate) fn entry(&self, trocar: Trocar, tip: [f64; 3], own: Option<u32>) -> Option<[f64; 3]> {
        match trocar {
            Trocar::Wanted(false) => None,
            Trocar::At(point) => Some(point),
            Trocar::Wanted(true) => Some(self.chosen_entry(tip.into(), own).to_array()),
        }
    }

    fn chosen_entry(&self, tip: Vec3<f64>, own: Option<u32>) -> Vec3<f64> {
        let (centre, radius) = (Vec3::from(self.ball.0), self.ball.1);
        let others = || {
            let others = self
                .tools
                .iter()
                .enumerate()
                .filter(|(number, tool)| !tool.removed && own.is_none_or(|own| own as usize != *number));
            others.filter_map(|(number, _)| tools::trocar(&self.world, number as u32))
        };
        let is_free = |point: &Vec3<f64>| others().all(|other| (other - *point).norm() >= APART * radius);
        let points = SIDEWAYS.map(|aside| self.entry_towards(self.outward(aside), tip, centre, radius));
        points.into_iter().find(is_free).unwrap_or(points[0])
    }

    /// Up, towards who looks, and aside, of length 1.
    fn outward(&self, aside: f64) -> Vec3<f64> {
        let camera = self.camera();
        let up = Vec3::from(camera.up).normalized().unwrap_or(Vec3::new(0.0, 1.0, 0.0));
        let back = -Vec3::from(camera.look);
        // Who looks straight down looks from nowhere else.
        let towards = (back - up * back.dot(up)).normalized().unwrap_or(Vec3::ZERO);
        (up + towards * 0.9 + up.cross(towards) * aside).normalized().unwrap_or(up)
    }

    /// From the tip as far as it takes to be clear of the bodies, and the shaft bears.
    fn entry_towards(&self, outward: Vec3<f64>, tip: Vec3<f64>, centre: Vec3<f64>, radius: f64) -> Vec3<f64> {
        let (from, shaft) = (tip - centre, tools::shaft_length(radius));
        let along = from.dot(outward);
        let room = along * along - from.squared_norm() + (CLEAR * radius).powi(2);
        let way = if room > 0.0 { room.sqrt() - along } else { 0.0 };
        tip + outward * way.clamp(WITHIN.0 * shaft, WITHIN.1 * shaft)
    }
}

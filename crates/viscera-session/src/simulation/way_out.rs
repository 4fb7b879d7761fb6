//! The way of an instrument out of tissue that begins anew around it: impaled tissue hung on the tool, or no step could be made.

use viscera::instrument::ToolPose;
use viscera::math::Vec3;
use viscera::mesh::{SurfaceMesh, TriangleTree};

use super::tools::shaft_length;
use super::world::AnyWorld;

/// How far from tissue an instrument is drawn back, and how near to its trocar [radii of the bodies].
const CLEARANCE: f64 = 0.2;
const NARROWEST: f64 = 0.12;

/// The surfaces of all bodies of a world at rest.
pub(super) struct TissueAtRest {
    surfaces: Vec<TriangleTree>,
}

impl TissueAtRest {
    pub(super) fn of(world: &AnyWorld) -> Self {
        let surface = |body: usize| {
            let triangles = world.surface(body).into_iter().map(|triangle| triangle.nodes).collect();
            TriangleTree::new(&SurfaceMesh { nodes: world.rest(body).to_vec(), triangles })
        };
        Self { surfaces: (0..world.body_count()).map(surface).collect() }
    }

    /// Where the tip [m] of an instrument that is led to `pose` is when it has been drawn back along its shaft until that passes no tissue,
    /// among bodies within a ball of `radius` [m]. It comes no nearer to its trocar than that allows.
    pub(super) fn drawn_out(&self, pose: ToolPose, trocar: Option<Vec3<f64>>, radius: f64) -> Vec3<f64> {
        let ToolPose { tip, direction, .. } = pose.through(trocar);
        let shaft = shaft_length(radius);
        // From the handle on, the first tissue that the shaft meets is what the tip is deepest in.
        let handle = tip - direction * shaft;
        let hits = self.surfaces.iter().filter_map(|surface| surface.first_hit(handle, direction, 0.0));
        let Some(outermost) = hits.filter(|&hit| hit < shaft).reduce(f64::min) else { return tip };
        let most = trocar.map_or(f64::INFINITY, |trocar| (tip - trocar).norm() - NARROWEST * radius);
        tip - direction * (shaft - outermost + CLEARANCE * radius).min(most).max(0.0)
    }
}

//! A triangle on the image, with what its shading needs.

use viscera::math::Vec3;

use super::body::Body;
use super::camera::{Projected, View};
use super::colour::Light;
use super::normals::corner_normals;
use super::{Colour, Finish, viridis};

/// One corner's attributes.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) position: Vec3<f64>,
    pub(super) normal: Vec3<f64>,
    pub(super) colour: Light,
    /// Place in the colour map; used instead of `colour` where the facet has a field.
    pub(super) fraction: f64,
}

/// A triangle that can be seen.
pub(super) struct Facet {
    pub(super) image: [Projected; 3],
    pub(super) corners: [Corner; 3],
    /// Twice the signed area on the image \[pixels²\], not 0.
    pub(super) area: f64,
    pub(super) finish: Finish,
    pub(super) mapped: bool,
    pub(super) wireframe: bool,
    pub(super) ghost: bool,
}

/// What a line of sight meets.
pub(super) struct Hit {
    pub(super) position: Vec3<f64>,
    pub(super) normal: Vec3<f64>,
    pub(super) colour: Light,
    /// Distance to the nearest edge of the facet \[pixels\].
    pub(super) edge: f64,
}

impl Facet {
    /// Barycentric coordinates on the image.
    #[inline]
    pub(super) fn barycentric(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let (a, b) = (self.image[(i + 1) % 3].place, self.image[(i + 2) % 3].place);
            ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / self.area
        })
    }

    /// The surface at a place of the image, attributes corrected for perspective; the normal looks at the viewer.
    pub(super) fn at(&self, place: [f64; 2]) -> Hit {
        let flat = self.barycentric(place);
        let weighted: [f64; 3] = std::array::from_fn(|i| flat[i] * self.image[i].weight);
        let total: f64 = weighted.iter().sum();
        let share = weighted.map(|w| w / total);
        let blend = |of: fn(&Corner) -> Vec3<f64>| {
            of(&self.corners[0]) * share[0] + of(&self.corners[1]) * share[1] + of(&self.corners[2]) * share[2]
        };
        let normal = blend(|corner| corner.normal).normalized().unwrap_or(self.corners[0].normal);
        let colour = if self.mapped {
            viridis((0..3).map(|i| share[i] * self.corners[i].fraction).sum()).linear()
        } else {
            self.corners[0].colour
        };
        let edge = (0..3).fold(f64::INFINITY, |nearest, i| {
            let (a, b) = (self.image[(i + 1) % 3].place, self.image[(i + 2) % 3].place);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            nearest.min((flat[i] * self.area).abs() / length)
        });
        // On the image y points down, so a triangle seen from outside turns the other way round.
        let facing = if self.area < 0.0 { normal } else { -normal };
        Hit { position: blend(|corner| corner.position), normal: facing, colour, edge }
    }
}

/// The facets of `body` that lie before the camera.
pub(super) fn facets(body: &Body, view: &View, out: &mut Vec<Facet>) {
    // A ghost steps back a little, so that where it coincides with the body the body is what is seen.
    let back = if body.ghost { view.forward * (0.003 * view.size) } else { Vec3::ZERO };
    let image: Vec<_> = body.nodes.iter().map(|&node| view.project(node + back)).collect();
    let normals = corner_normals(&body.nodes, &body.triangles, body.crease);
    for (index, triangle) in body.triangles.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = triangle.map(|node| image[node as usize]) else { continue };
        let Some(normals) = normals[index] else { continue };
        let area = (b.place[0] - a.place[0]) * (c.place[1] - a.place[1])
            - (b.place[1] - a.place[1]) * (c.place[0] - a.place[0]);
        if area == 0.0 || !area.is_finite() {
            continue;
        }
        let bare = body.cut.get(index).copied().unwrap_or(false);
        let colour = if bare { Colour::CUT } else { body.colour }.linear();
        let corners = std::array::from_fn(|i| {
            let node = triangle[i] as usize;
            let fraction = body.field.as_ref().map_or(0.0, |field| field.fraction(field.values[node]));
            Corner { position: body.nodes[node], normal: normals[i], colour, fraction }
        });
        out.push(Facet {
            image: [a, b, c],
            corners,
            area,
            finish: body.finish,
            mapped: body.field.is_some() && !bare,
            wireframe: body.wireframe,
            ghost: body.ghost,
        });
    }
}

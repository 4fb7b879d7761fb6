//! The camera: where it stands follows from bounds, so a series keeps its frame.

use viscera::math::Vec3;

use super::PictureError;

/// A view of fixed bounds. Keep one camera for a series and nothing but the bodies moves.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    minimum: Vec3<f64>,
    maximum: Vec3<f64>,
    direction: Vec3<f64>,
    up: Vec3<f64>,
    angle: Option<f64>,
}

impl Camera {
    /// Frames the box `minimum`..`maximum` \[m\] from the front, right and above, in perspective, y up.
    pub fn framing(minimum: Vec3<f64>, maximum: Vec3<f64>) -> Self {
        let direction = Vec3::new(-0.55, -0.45, -0.75);
        Self { minimum, maximum, direction, up: Vec3::new(0.0, 1.0, 0.0), angle: Some(28.0) }
    }
    /// Looks along `direction` (any length).
    pub fn towards(mut self, direction: [f64; 3]) -> Self {
        self.direction = direction.into();
        self
    }
    /// What is up in the picture, and normal to the ground.
    pub fn up(mut self, up: [f64; 3]) -> Self {
        self.up = up.into();
        self
    }
    /// Perspective with this opening angle of the picture's height (degrees, above 0, at most 150; default 28).
    pub fn perspective(mut self, degrees: f64) -> Self {
        self.angle = Some(degrees);
        self
    }
    /// Parallel projection: lengths can be read anywhere.
    pub fn orthographic(mut self) -> Self {
        self.angle = None;
        self
    }

    /// The projection for an image of this size.
    pub(super) fn view(&self, width: usize, height: usize) -> Result<View, PictureError> {
        let extent = self.maximum - self.minimum;
        let size = extent.norm();
        let ordered = extent.x >= 0.0 && extent.y >= 0.0 && extent.z >= 0.0;
        if !(ordered && size > 0.0 && size.is_finite()) {
            return Err(PictureError::Camera { what: "box" });
        }
        let forward = self.direction.normalized().ok_or(PictureError::Camera { what: "direction" })?;
        let world_up = self.up.normalized().ok_or(PictureError::Camera { what: "up" })?;
        let right = forward.cross(world_up);
        if right.norm() < 1e-6 {
            return Err(PictureError::Camera { what: "direction (it lies along up)" });
        }
        let right = right / right.norm();
        let up = right.cross(forward);
        let slope = match self.angle {
            Some(angle) if angle > 0.0 && angle <= 150.0 => Some((angle.to_radians() / 2.0).tan()),
            Some(_) => return Err(PictureError::Camera { what: "angle" }),
            None => None,
        };
        let mut view = View {
            eye: (self.minimum + self.maximum) * 0.5,
            right,
            up,
            forward,
            world_up,
            perspective: slope.is_some(),
            focal: 1.0,
            centre: [0.0; 2],
            size,
            minimum: self.minimum,
            maximum: self.maximum,
        };
        let (wide, high) = (width as f64, height as f64);
        view.frame(slope, [0.74 * wide, 0.78 * high], [0.5 * wide, 0.51 * high], 0.5 * high);
        Ok(view)
    }
}

/// A camera resolved for one image size.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) eye: Vec3<f64>,
    pub(super) right: Vec3<f64>,
    pub(super) up: Vec3<f64>,
    pub(super) forward: Vec3<f64>,
    pub(super) world_up: Vec3<f64>,
    pub(super) perspective: bool,
    /// Pixels per unit slope (perspective) or per metre (parallel).
    focal: f64,
    /// Place of the image that looks straight ahead \[pixels\].
    centre: [f64; 2],
    /// Diagonal of the framed box \[m\]: the measure of everything that has no size of its own.
    pub(super) size: f64,
    pub(super) minimum: Vec3<f64>,
    pub(super) maximum: Vec3<f64>,
}

/// A point on the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    /// Pixels from the upper left corner.
    pub(super) place: [f64; 2],
    /// Larger is nearer; affine over the image.
    pub(super) nearness: f64,
    /// Weight that makes attributes affine over the image: 1/depth, or 1.
    pub(super) weight: f64,
}

impl View {
    /// The eight corners of the framed box.
    pub(super) fn corners(&self) -> [Vec3<f64>; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.minimum[axis] } else { self.maximum[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Steps back (perspective) or scales (parallel) until the projected box fills `room` \[pixels\], then shifts the
    /// image so that the box sits about `middle`.
    fn frame(&mut self, slope: Option<f64>, room: [f64; 2], middle: [f64; 2], half_height: f64) {
        let centre = self.eye;
        let local = self.corners().map(|corner| {
            let p = corner - centre;
            [p.dot(self.right), -p.dot(self.up), p.dot(self.forward)]
        });
        let nearest = local.iter().fold(f64::INFINITY, |near, p| near.min(p[2]));
        let span = |axis: usize, distance: Option<f64>| {
            let places = local.map(|p| p[axis] / distance.map_or(1.0, |distance| distance + p[2]));
            let low = places.iter().fold(f64::INFINITY, |low, &x| low.min(x));
            (low, places.iter().fold(f64::NEG_INFINITY, |high, &x| high.max(x)))
        };
        let overflow = |focal: f64, distance: Option<f64>| {
            let used = [0, 1].map(|axis| {
                let (low, high) = span(axis, distance);
                (high - low) * focal / room[axis]
            });
            used[0].max(used[1])
        };
        let mut distance = None;
        match slope {
            Some(slope) => {
                self.focal = half_height / slope;
                // The box shrinks steadily as the camera steps back, so halving the interval finds the place.
                let (mut near, mut far) = (0.1 * self.size - nearest, 1e4 * self.size / slope.min(1.0));
                for _ in 0..60 {
                    let half = (near * far).sqrt();
                    *if overflow(self.focal, Some(half)) > 1.0 { &mut near } else { &mut far } = half;
                }
                distance = Some(far);
            }
            None => self.focal = 1.0 / overflow(1.0, None),
        }
        self.eye = centre - self.forward * distance.unwrap_or(2.0 * self.size);
        self.centre = [0, 1].map(|axis| {
            let (low, high) = span(axis, distance);
            middle[axis] - 0.5 * (low + high) * self.focal
        });
    }

    /// The place of `point`, or `None` behind the camera or not finite.
    pub(super) fn project(&self, point: Vec3<f64>) -> Option<Projected> {
        let p = point - self.eye;
        let depth = p.dot(self.forward);
        if !p.is_finite() || (self.perspective && depth < self.size * 1e-3) {
            return None;
        }
        let (scale, nearness, weight) = match self.perspective {
            true => (self.focal / depth, 1.0 / depth, 1.0 / depth),
            false => (self.focal, -depth, 1.0),
        };
        let place = [self.centre[0] + p.dot(self.right) * scale, self.centre[1] - p.dot(self.up) * scale];
        Some(Projected { place, nearness, weight })
    }

    /// The line of sight through a place of the image: its origin and its direction (unit).
    pub(super) fn ray(&self, place: [f64; 2]) -> (Vec3<f64>, Vec3<f64>) {
        let x = (place[0] - self.centre[0]) / self.focal;
        let y = (self.centre[1] - place[1]) / self.focal;
        let side = self.right * x + self.up * y;
        if self.perspective {
            let along = self.forward + side;
            (self.eye, along / along.norm())
        } else {
            (self.eye + side, self.forward)
        }
    }

    /// Direction from `point` to the camera (unit).
    pub(super) fn towards_viewer(&self, point: Vec3<f64>) -> Vec3<f64> {
        match self.perspective {
            true => (self.eye - point).normalized().unwrap_or(-self.forward),
            false => -self.forward,
        }
    }

    /// Pixels per metre at `point`.
    pub(super) fn scale_at(&self, point: Vec3<f64>) -> f64 {
        match self.perspective {
            true => self.focal / (point - self.eye).dot(self.forward).max(self.size * 1e-3),
            false => self.focal,
        }
    }
}

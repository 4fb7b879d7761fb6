//! The picture: what is to be seen, collected.

use viscera::math::Vec3;

use super::{Body, Camera, Colour, Finish, Image, PictureError, Solid, Tool, render};

/// A picture to be drawn. Starts empty, with a ground and a scale bar.
#[derive(Clone, Debug)]
pub struct Picture {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) bodies: Vec<Body>,
    pub(super) solids: Vec<Solid>,
    pub(super) arrows: Vec<(Vec3<f64>, Vec3<f64>)>,
    pub(super) camera: Option<Camera>,
    pub(super) title: String,
    pub(super) footer: String,
    pub(super) ground: bool,
    pub(super) annotated: bool,
}

impl Picture {
    /// An empty picture of this many pixels, 1 to 16 384 a side.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            bodies: Vec::new(),
            solids: Vec::new(),
            arrows: Vec::new(),
            camera: None,
            title: String::new(),
            footer: String::new(),
            ground: true,
            annotated: true,
        }
    }
    /// Adds a body.
    pub fn body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }
    /// Adds a part of an instrument.
    pub fn tool(mut self, solid: Solid) -> Self {
        self.solids.push(solid);
        self
    }
    /// Adds a force \[N\] at `point` \[m\] as an arrow of `scale` metres per newton. A force of zero draws nothing.
    pub fn force(mut self, point: [f64; 3], force: [f64; 3], scale: f64) -> Self {
        let point = Vec3::from(point);
        self.arrows.push((point, point + Vec3::from(force) * scale));
        self
    }
    /// The camera; without one the bodies are framed as they are.
    pub fn camera(mut self, camera: Camera) -> Self {
        self.camera = Some(camera);
        self
    }
    /// The line at the top (Latin-1).
    pub fn title(mut self, title: &str) -> Self {
        self.title = title.into();
        self
    }
    /// The line at the bottom (Latin-1).
    pub fn footer(mut self, footer: &str) -> Self {
        self.footer = footer.into();
        self
    }
    /// Leaves out the ground with its grid and shadow.
    pub fn without_ground(mut self) -> Self {
        self.ground = false;
        self
    }
    /// Leaves out the scale bar and the legend.
    pub fn without_annotation(mut self) -> Self {
        self.annotated = false;
        self
    }

    /// Draws it. Triangles that are degenerate, not finite or reach behind the camera are left out.
    ///
    /// # Errors
    /// An image size out of range, a camera that cannot see, nothing finite to frame, a triangle or list that does not
    /// fit its body.
    pub fn render(&self) -> Result<Image, PictureError> {
        if !(1..=16_384).contains(&self.width) || !(1..=16_384).contains(&self.height) {
            return Err(PictureError::Size { width: self.width, height: self.height });
        }
        for (index, body) in self.bodies.iter().enumerate() {
            body.check(index)?;
        }
        let camera = self.camera.map_or_else(|| self.own_camera(), Ok)?;
        render::render(self, &camera.view(self.width, self.height)?)
    }

    /// The camera that frames every node of every triangle.
    fn own_camera(&self) -> Result<Camera, PictureError> {
        let used = self.bodies.iter().flat_map(|body| {
            body.triangles.iter().flatten().map(|&node| body.nodes[node as usize]).filter(|node| node.is_finite())
        });
        let bounds = used.fold(None, |bounds: Option<(Vec3<f64>, Vec3<f64>)>, p| {
            Some(bounds.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
        });
        let (low, high) = bounds.ok_or(PictureError::NothingToFrame)?;
        Ok(Camera::framing(low, high))
    }

    /// Everything that is drawn as a surface; `size` \[m\] measures what has no size of its own.
    pub(super) fn surfaces(&self, size: f64) -> Vec<Body> {
        let mut surfaces = self.bodies.clone();
        surfaces.extend(self.solids.iter().map(|solid| solid.body.clone()));
        for &(start, end) in
            self.arrows.iter().filter(|(start, end)| start.is_finite() && end.is_finite() && start != end)
        {
            surfaces.push(Solid::arrow(start, end, size * 0.004).colour(Colour::new(226, 120, 20)).body);
        }
        for body in &self.bodies {
            for node in
                body.fixed.iter().filter_map(|&node| body.nodes.get(node as usize)).filter(|node| node.is_finite())
            {
                let dot = Tool::sphere(node.to_array(), size * 0.006).colour(Colour::new(34, 52, 92));
                surfaces.push(dot.finish(Finish::Matte).body);
            }
        }
        surfaces
    }
}

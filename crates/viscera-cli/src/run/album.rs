//! Pictures of a run, all by one camera.

use viscera::math::Scalar;
use viscera::mesh::Point;
use viscera_io::grouped;
use viscera_io::picture::{Body, Camera, Picture, PictureError};
use viscera_scene::BuiltScene;
use viscera_scene::file::OutputFile;

use super::folder::Folder;
use super::instrument_shape;
use super::moment::{Moment, Skin};
use crate::failure::Failure;

/// The rest shape is shown behind a body that has moved by more than this part of the scene's size.
const WORTH_A_GHOST: f64 = 0.03;

/// The moments that are kept for pictures.
pub(super) struct Album {
    wanted: u64,
    steps: u64,
    moments: Vec<Moment>,
}

impl Album {
    /// An album for so many pictures, evenly over so many steps, start and end among them.
    pub(super) fn new(wanted: u64, steps: u64) -> Self {
        Self { wanted, steps, moments: Vec::new() }
    }

    /// The album of a run that goes on, with the moments that it has kept.
    pub(super) fn going_on(wanted: u64, steps: u64, moments: Vec<Moment>) -> Self {
        Self { wanted, steps, moments }
    }

    /// The moments that are kept.
    pub(super) fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// Keeps this moment if a picture is due.
    pub(super) fn look<T: Scalar>(&mut self, built: &BuiltScene<T>, step: u64) {
        let taken = self.moments.len() as u64;
        let due = match self.wanted {
            0 => return,
            1 => self.steps,
            wanted => (taken as f64 * self.steps as f64 / (wanted - 1) as f64).round() as u64,
        };
        if taken < self.wanted && step >= due {
            self.moments.push(Moment::of(built, step));
        }
    }

    /// Draws all pictures, and one of the last moment if the run ended early. Gives the names of the files.
    pub(super) fn write<T: Scalar>(
        &mut self,
        folder: &Folder,
        built: &BuiltScene<T>,
        step: u64,
    ) -> Result<Vec<String>, Failure> {
        if self.wanted > 0 && self.moments.last().is_none_or(|last| last.step != step) {
            self.moments.push(Moment::of(built, step));
        }
        let Some(view) = View::of(&self.moments, &built.file.output) else { return Ok(Vec::new()) };
        let mut names = Vec::new();
        for (number, moment) in self.moments.iter().enumerate() {
            let name = self.name(number);
            let image = view.picture(built, moment, &self.moments[0]).render().map_err(undrawn)?;
            image.save_png(folder.file(&name)).map_err(undrawn)?;
            names.push(name);
        }
        Ok(names)
    }

    /// Three pictures have names; more have numbers.
    fn name(&self, number: usize) -> String {
        match (self.wanted, number) {
            (1, _) => "end.png".to_owned(),
            (2 | 3, 0) => "start.png".to_owned(),
            (2 | 3, _) if number + 1 == self.moments.len() => "end.png".to_owned(),
            (2 | 3, _) => "middle.png".to_owned(),
            _ => format!("picture-{number:06}.png"),
        }
    }
}

/// One camera, and how large what it sees is.
struct View {
    camera: Camera,
    size: f64,
    /// From an instrument's tip to the hand that holds it.
    to_hand: Point,
    pixels: [usize; 2],
}

impl View {
    /// A view of everything that is seen at any of the moments; nothing where there is nothing to see.
    fn of(moments: &[Moment], output: &OutputFile) -> Option<Self> {
        let bounds = moments
            .iter()
            .filter_map(Moment::bounds)
            .reduce(|(low, high), (other_low, other_high)| (low.min(other_low), high.max(other_high)));
        let (low, high) = bounds?;
        let up = Point::from(output.camera.up).normalized()?;
        let look = Point::from(output.camera.look).normalized()?;
        Some(Self {
            camera: Camera::framing(low, high).towards(output.camera.look).up(output.camera.up),
            size: (high - low).norm(),
            to_hand: (up * 0.8 - look * 0.6 + look.cross(up) * 0.35).normalized()?,
            pixels: output.size.map(|side| side as usize),
        })
    }

    fn picture<T: Scalar>(&self, built: &BuiltScene<T>, moment: &Moment, start: &Moment) -> Picture {
        let [width, height] = self.pixels;
        let removed = match moment.removed {
            0 => String::new(),
            count => format!(", {} removed", grouped(count)),
        };
        let mut picture = Picture::new(width, height)
            .camera(self.camera)
            .title(built.file.title.as_deref().unwrap_or_default())
            .footer(&format!("{:.2} s   {} cells{removed}", moment.time, grouped(moment.cells)));
        // All bodies have ghosts, or none: one without would look as if it had not moved.
        let pairs = || moment.skins.iter().zip(&start.skins);
        let ghosts = pairs().any(|(skin, rest)| self.has_moved_far(skin, rest));
        for (skin, rest) in pairs() {
            // The rest shape of a cut body would hide the cut.
            if ghosts && !skin.cut.contains(&true) {
                picture = picture.body(Body::new(&rest.nodes, &rest.triangles).ghost());
            }
            picture = picture.body(Body::new(&skin.nodes, &skin.triangles).tissue().cut(&skin.cut).fixed(&skin.fixed));
        }
        for tool in &moment.tools {
            for solid in instrument_shape::solids(tool, self.to_hand, self.size) {
                picture = picture.tool(solid);
            }
        }
        picture
    }

    /// Whether a body has moved far enough for its rest shape to be seen beside it.
    fn has_moved_far(&self, skin: &Skin, rest: &Skin) -> bool {
        let limit = WORTH_A_GHOST * self.size;
        let moved = |node: &u32| (skin.nodes[*node as usize] - rest.nodes[*node as usize]).norm() > limit;
        rest.triangles.iter().flatten().any(moved)
    }
}

fn undrawn(error: PictureError) -> Failure {
    Failure::problem(error)
}

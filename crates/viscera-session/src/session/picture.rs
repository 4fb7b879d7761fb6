//! What is to be seen: the scene, the surfaces and a frame, each made once however many look on.

use std::sync::Arc;

use super::Session;
use crate::export::Row;
use crate::message::{
    Answer, BodyFrame, ColourRange, F32s, FrameMessage, InstrumentFrame, Observables, SceneMessage, SnapshotEntry,
};
use crate::parameter;
use crate::simulation::colour::Colouring;
use crate::simulation::tools;

/// Time between observations [s], which cost as much as a few steps.
const BETWEEN_OBSERVATIONS: f64 = 0.05;
/// By how much a colour scale that has become too long shrinks with each frame: a second to half of it.
const SHRINK: f64 = 0.99;

/// Bytes of a message and the number of their version.
#[derive(Clone, Debug)]
struct Part {
    version: u64,
    bytes: Arc<[u8]>,
}

/// What is to be seen now. Cheap to clone: those that look on share it.
#[derive(Clone, Debug)]
pub struct Picture {
    scene: Part,
    surfaces: Vec<Part>,
    frame: Part,
}

/// What somebody has been shown.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    scene: u64,
    surfaces: Vec<u64>,
    frame: u64,
}

impl Picture {
    /// The messages that bring somebody up to date who was shown `seen`, in order: the scene and the surfaces that changed, and the
    /// frame. However many pictures were left out before, nothing is missing.
    pub fn parts_for(&self, seen: &mut Seen) -> Vec<Arc<[u8]>> {
        let mut parts = Vec::new();
        let mut show = |part: &Part, seen: &mut u64| {
            if std::mem::replace(seen, part.version) != part.version {
                parts.push(Arc::clone(&part.bytes));
            }
        };
        show(&self.scene, &mut seen.scene);
        seen.surfaces.resize(self.surfaces.len(), 0);
        self.surfaces.iter().zip(&mut seen.surfaces).for_each(|(part, seen)| show(part, seen));
        show(&self.frame, &mut seen.frame);
        parts
    }
}

/// The parts of the last picture, and what has changed since.
pub(super) struct Gallery {
    /// Grows when bodies change their number or meshes.
    epoch: u64,
    /// The number of the last version of anything.
    version: u64,
    sequence: u64,
    scene: Option<Part>,
    /// Of each body: epoch of the scene, epoch of the surface, and the message.
    surfaces: Vec<(u64, u64, Part)>,
    is_new: bool,
    range: Option<(f64, f64)>,
    /// Time of the clock when there was an observation [s].
    observed: f64,
}

impl Default for Gallery {
    fn default() -> Self {
        Self {
            epoch: 1,
            version: 0,
            sequence: 0,
            scene: None,
            surfaces: Vec::new(),
            is_new: true,
            range: None,
            observed: f64::NEG_INFINITY,
        }
    }
}

impl Gallery {
    /// Something moved, or may have.
    pub(super) fn touch(&mut self) {
        self.is_new = true;
    }

    /// Something of what the scene message says changed.
    pub(super) fn scene_changed(&mut self) {
        self.scene = None;
        self.touch();
    }

    /// Another colouring: its scale begins anew.
    pub(super) fn colouring_changed(&mut self) {
        self.range = None;
        self.scene_changed();
    }

    /// Bodies are others than before.
    pub(super) fn new_epoch(&mut self) {
        self.epoch += 1;
        self.observed = f64::NEG_INFINITY;
        self.range = None;
        self.scene_changed();
    }

    fn part(&mut self, message: &Answer) -> Part {
        self.version += 1;
        Part { version: self.version, bytes: message.encode().into() }
    }
}

impl Session {
    /// Makes the next picture even if nothing changes: somebody new looks on, and no picture is kept.
    pub fn look_again(&mut self) {
        self.gallery.touch();
    }

    /// What is to be seen now; none where nothing has changed since the last call.
    pub fn picture(&mut self) -> Option<Picture> {
        self.make_pending_changes();
        if !std::mem::take(&mut self.gallery.is_new) {
            return None;
        }
        let scene = match self.gallery.scene.clone() {
            Some(scene) => scene,
            None => {
                let message = Answer::Scene(self.scene());
                let part = self.gallery.part(&message);
                self.gallery.scene.insert(part).clone()
            }
        };
        let surfaces = self.surface_parts();
        let frame = Answer::Frame(self.frame_message());
        let frame = self.gallery.part(&frame);
        Some(Picture { scene, surfaces, frame })
    }

    fn surface_parts(&mut self) -> Vec<Part> {
        let Self { play, gallery, .. } = self;
        let mut known = std::mem::take(&mut gallery.surfaces).into_iter();
        for (index, (world, body, surface)) in play.parts().enumerate() {
            let part = match known.next() {
                Some((scene, epoch, part)) if (scene, epoch) == (gallery.epoch, surface.epoch) => part,
                _ => {
                    let mut message = surface.message(gallery.epoch, body, world);
                    message.body = index;
                    gallery.part(&Answer::Surface(message))
                }
            };
            gallery.surfaces.push((gallery.epoch, surface.epoch, part));
        }
        gallery.surfaces.iter().map(|(.., part)| part.clone()).collect()
    }

    /// What a page hears of the scene.
    pub fn scene(&self) -> SceneMessage {
        let play = &self.play;
        let (centre, radius) = play.ball;
        let present = play.tools.iter().enumerate().filter(|(_, tool)| !tool.removed);
        let shape = |(number, tool)| tools::shape(&play.world, number as u32, tool);
        let snapshot =
            |kept: &Option<crate::simulation::Kept>| kept.as_ref().map(|kept| SnapshotEntry { time: kept.time });
        SceneMessage {
            epoch: self.gallery.epoch,
            name: play.origin.name.clone(),
            title: play.file.title.clone().unwrap_or_else(|| play.origin.name.clone()),
            step: play.world.step_length(),
            precision: match &play.world {
                crate::simulation::AnyWorld::Single(_) => "single".into(),
                crate::simulation::AnyWorld::Double(_) => "double".into(),
            },
            centre,
            radius,
            camera: play.camera(),
            bodies: play.bodies(),
            instruments: present.map(shape).collect(),
            parameters: parameter::parameters(&play.file, &play.original),
            snapshots: self.slots.iter().map(snapshot).collect(),
            ghost: play.ghost.is_some(),
            colouring: self.colouring.name().into(),
        }
    }

    fn frame_message(&mut self) -> FrameMessage {
        let present = self.play.tools.iter().enumerate().filter(|(_, tool)| !tool.removed);
        let frame = |(number, tool)| tools::frame(&self.play.world, number as u32, tool);
        let instruments: Vec<InstrumentFrame> = present.map(frame).collect();
        let observables = self.observe(&instruments);
        let by = self.colouring;
        let play = &self.play;
        let frame =
            |(world, body, surface): (&crate::simulation::AnyWorld, usize, &crate::simulation::Surface)| BodyFrame {
                epoch: surface.epoch,
                positions: F32s(world.positions(body, &surface.nodes)),
                scalars: world.scalars(body, by, &surface.nodes).map(F32s),
                seared: tools::seared(world, body, &surface.nodes).map(F32s),
            };
        let bodies: Vec<BodyFrame> = play.parts().map(frame).collect();
        self.gallery.sequence += 1;
        FrameMessage {
            scene: self.gallery.epoch,
            sequence: self.gallery.sequence,
            time: self.play.world.time(),
            steps: self.play.world.steps(),
            state: self.state,
            pace: self.clock.pace(),
            colouring: self.colour_range(&bodies),
            bodies,
            instruments,
            observables,
            request: self.last_request,
            recording: self.recorded().map(|seconds| crate::message::RecordingState { seconds }),
            replay: self.replay_state(),
        }
    }

    /// The scale of the colours: as long as it has to be at once, shorter by and by.
    fn colour_range(&mut self, bodies: &[BodyFrame]) -> ColourRange {
        let by = self.colouring;
        let scalars =
            bodies.iter().filter_map(|body| body.scalars.as_ref()).flat_map(|scalars| scalars.0.iter().copied());
        let (low, high) = by.range(scalars);
        // Of a body at rest: so little that it looks like nothing.
        let least = match by {
            Colouring::Displacement => 1e-3 * self.play.ball.1,
            Colouring::VonMises => {
                1e-3 * self
                    .play
                    .file
                    .body
                    .values()
                    .filter_map(|body| body.law.young)
                    .map(|young| young.0)
                    .fold(0.0, f64::max)
            }
            Colouring::None | Colouring::VolumeChange | Colouring::AdaptiveMode => 1e-3,
        };
        let (low, high) = (if low < 0.0 { low.min(-least) } else { low }, high.max(least));
        let (before_low, before_high) = self.gallery.range.unwrap_or((low, high));
        let (low, high) = (low.min(before_low * SHRINK), high.max(before_high * SHRINK));
        self.gallery.range = Some((low, high));
        ColourRange { by: by.name().into(), unit: by.unit().into(), low, high }
    }

    /// Numbers about each body, if it is time for some.
    fn observe(&mut self, instruments: &[InstrumentFrame]) -> Option<Vec<Observables>> {
        let wall = self.clock.wall();
        if self.is_running() && wall - self.gallery.observed < BETWEEN_OBSERVATIONS {
            return None;
        }
        self.gallery.observed = wall;
        let of_bodies = self.play.observe();
        let mut forces = vec![[0.0; 3]; self.play.tools.len()];
        instruments.iter().for_each(|tool| forces[tool.instrument as usize] = tool.force);
        let bodies = of_bodies[..self.play.world.body_count()].to_vec();
        self.history.push(Row { time: self.play.world.time(), bodies, forces });
        Some(of_bodies)
    }
}

//! Recording and replaying, step by step.

use std::collections::BTreeMap;
use std::sync::Arc;

use viscera::math::{Scalar, Vec3};
use viscera::world::World;
use viscera_scene::file::SceneFile;
use viscera_scene::{Files, Scene};

use super::Session;
use crate::message::{Bytes, Command, Level, Purpose, Refusal, ReplayState, RunState};
use crate::recording::{Agreement, BodyMark, Event, INTERVAL, MOST_EVENTS, MOST_STEPS, Mark, Recording, processor};
use crate::refuse;
use crate::simulation::{AnyWorld, Kept, Play};

/// The most that hands do before one step.
const MOST_AT_ONCE: usize = 10_000;

/// A recording that is being made.
pub(super) struct Recorder {
    recording: Recording,
    /// The scene with the parameters of its beginning.
    scene: SceneFile,
}

/// A recording that is being played.
pub(super) struct Replayer {
    recording: Recording,
    /// Steps made.
    made: u64,
    next_event: usize,
    next_mark: usize,
    /// Whether a difference in bits was told already.
    told: bool,
    agrees: bool,
}

impl Session {
    /// Notes a command that was carried out.
    pub(super) fn record(&mut self, command: impl FnOnce() -> Command) {
        let Some(Recorder { recording, .. }) = &mut self.recorder else { return };
        let (at, command) = (recording.steps, command());
        // Of the moves of one instrument before one step the last counts, and so of its trocar.
        if let Some(last) = recording.events.last_mut().filter(|last| last.at == at)
            && replaces(&command, &last.command)
        {
            last.command = command;
            return;
        }
        recording.events.push(Event { at, command });
    }

    pub(super) fn start_recording(&mut self) {
        let play = &self.play;
        let title = play.file.title.clone().unwrap_or_else(|| play.origin.name.clone());
        let text = play.file.to_toml().unwrap_or_default();
        let mut recording = Recording::new(title, play.origin.name.clone(), text, play.file.step.0);
        recording.files = play.files_in_memory();
        recording.tools = play.tools.clone();
        // A tool that was taken away stays scripted, and the scene would bring it back.
        let untouched = play.world.steps() == 0 && play.tools.iter().all(|tool| tool.scripted && !tool.removed);
        recording.state = (!untouched).then(|| Bytes(play.world.snapshot()));
        self.recorder = Some(Recorder { recording, scene: play.file.clone() });
    }

    pub(super) fn stop_recording(&mut self, request: Option<u64>) -> Result<(), Box<Refusal>> {
        let nothing = || refuse::with_help("nothing is being recorded", "`start-recording` begins");
        let Recorder { mut recording, .. } = self.recorder.take().ok_or_else(nothing)?;
        if recording.marks.last().is_none_or(|mark| mark.at != recording.steps) {
            recording.marks.push(mark(&self.play, recording.steps));
        }
        let name = format!("{}.viscera-recording", recording.scene);
        self.send_file(Purpose::Recording, name, "application/vnd.viscera-recording", recording.encode(), request);
        Ok(())
    }

    /// After a step: counts it, and marks how the state is from time to time.
    pub(super) fn mark_recording(&mut self) {
        let Some(Recorder { recording, .. }) = &mut self.recorder else { return };
        recording.steps += 1;
        if recording.steps.is_multiple_of(INTERVAL) {
            recording.marks.push(mark(&self.play, recording.steps));
        }
        if recording.steps == MOST_STEPS || recording.events.len() + MOST_AT_ONCE > MOST_EVENTS {
            self.notify(Level::Warning, "the recording has reached its greatest length and ended", "");
            // It is there: it was taken a moment ago.
            let _ = self.stop_recording(None);
        }
    }

    /// How long the recording is that is being made [s].
    pub(super) fn recorded(&self) -> Option<f64> {
        self.recorder.as_ref().map(|recorder| recorder.recording.seconds())
    }

    /// The scene as it was when the recording began that is being made.
    pub(super) fn recorded_scene(&self) -> Option<&SceneFile> {
        self.recorder.as_ref().map(|recorder| &recorder.scene)
    }

    pub(super) fn start_replay(&mut self, recording: Recording) -> Result<(), Box<Refusal>> {
        let files: BTreeMap<String, Vec<u8>> =
            recording.files.iter().map(|(name, bytes)| (name.clone(), bytes.0.clone())).collect();
        let scene = Scene::parse_with(&recording.scene, &recording.text, Files::Memory(Arc::new(files)));
        let scene = scene.map_err(|errors| Box::new(refuse::scene(&errors)))?;
        let (mut play, _) = Play::open(&recording.scene, &scene)?;
        if let Some(state) = &recording.state {
            let (file, tools, state) = (play.file.clone(), recording.tools.clone(), state.0.clone());
            play.restore(&Kept { time: 0.0, file, tools, state })?;
        }
        self.begin(play, Vec::new());
        self.state = RunState::Running;
        self.replayer = Some(Replayer { recording, made: 0, next_event: 0, next_mark: 0, told: false, agrees: true });
        Ok(())
    }

    pub(super) fn stop_replay(&mut self) -> Result<(), Box<Refusal>> {
        self.replayer.take().map(|_| ()).ok_or_else(|| refuse::because("nothing is being replayed"))
    }

    pub(super) fn replay_state(&self) -> Option<ReplayState> {
        self.replayer.as_ref().map(|Replayer { recording, made, agrees, .. }| ReplayState {
            name: recording.scene.clone(),
            seconds: *made as f64 * recording.step,
            of: recording.seconds(),
            agrees: *agrees,
        })
    }

    /// Before a step: does what was done then. Gives whether the step is to be made.
    pub(super) fn do_what_is_replayed(&mut self) -> bool {
        // Taken out, so that its commands are not refused as those of the user are.
        let Some(mut replayer) = self.replayer.take() else { return true };
        while let Some(event) =
            replayer.recording.events.get(replayer.next_event).filter(|event| event.at <= replayer.made)
        {
            replayer.next_event += 1;
            let done = self.carry_out(event.command.clone(), None);
            self.make_pending_changes();
            if let Err(refusal) = done {
                let text = format!("what was recorded at step {} cannot be done: {}", event.at, refusal.reason);
                self.notify(Level::Warning, text, refusal.help);
                replayer.agrees = false;
            }
        }
        let goes_on = replayer.made < replayer.recording.steps;
        self.replayer = Some(replayer);
        if !goes_on {
            self.end_replay();
        }
        goes_on
    }

    /// After a step: whether the state is the recorded one, where there is a mark.
    pub(super) fn check_replay(&mut self) {
        let Some(replayer) = &mut self.replayer else { return };
        replayer.made += 1;
        let marks = &replayer.recording.marks;
        let mut said = None;
        if let Some(recorded) = marks.get(replayer.next_mark).filter(|mark| mark.at == replayer.made) {
            replayer.next_mark += 1;
            let at = format!("step {} ({:.2} s)", replayer.made, replayer.made as f64 * replayer.recording.step);
            match mark(&self.play, replayer.made).agreement(recorded) {
                Agreement::Bits => {}
                Agreement::Numbers if replayer.told => {}
                Agreement::Numbers => {
                    replayer.told = true;
                    let text = format!("by {at} the bits differ from the recording, and the numbers agree");
                    said = Some((Level::Info, text, made_elsewhere(&replayer.recording)));
                }
                Agreement::None(_) if !replayer.agrees => {}
                Agreement::None(what) => {
                    (replayer.told, replayer.agrees) = (true, false);
                    let text = format!("by {at} the replay has departed from the recording: {what}");
                    said = Some((Level::Warning, text, "it was made by another version of the program".into()));
                }
            }
        }
        let over = replayer.made >= replayer.recording.steps;
        if let Some((level, text, help)) = said {
            self.notify(level, text, help);
        }
        if over {
            self.end_replay();
        }
    }

    fn end_replay(&mut self) {
        let Some(Replayer { recording, told, agrees, .. }) = self.replayer.take() else { return };
        self.state = RunState::Paused;
        let steps = recording.steps;
        let text = match (told, agrees) {
            (false, true) => format!("replayed {steps} steps to the same bits"),
            (true, true) => format!("replayed {steps} steps to the same numbers"),
            (_, false) => format!("replayed {steps} steps, with a difference"),
        };
        self.notify(Level::Info, text, "");
    }
}

/// Whether a command makes nothing of what is left of the one before it.
fn replaces(command: &Command, before: &Command) -> bool {
    use Command::{MoveInstrument, SetTrocar};
    match (before, command) {
        (MoveInstrument { instrument: before, .. }, MoveInstrument { instrument, .. })
        | (SetTrocar { instrument: before, .. }, SetTrocar { instrument, .. }) => before == instrument,
        _ => false,
    }
}

/// Why bits may differ from those recorded.
fn made_elsewhere(recording: &Recording) -> String {
    let (here, there) = (processor(), &recording.processor);
    if here == *there {
        "it was made by another version of the program".into()
    } else {
        format!("it was made on another kind of processor: {there}, and here it is {here}")
    }
}

/// How the world stands. The checksum is of places, velocities and cuts: a snapshot also tells whether somebody asked for forces.
fn mark(play: &Play, at: u64) -> Mark {
    fn of<T: Scalar>(world: &World<T>, at: u64) -> Mark {
        let mut hasher = crc32fast::Hasher::new();
        let mut bodies = Vec::new();
        for body in world.body_ids().map(|id| world.body(id)) {
            let mut sum = Vec3::ZERO;
            for (place, &rest) in body.positions().iter().zip(body.mesh().nodes()) {
                sum += place.cast::<f64>() - rest;
            }
            for number in body.positions().iter().chain(body.velocities()).flat_map(|v| v.cast::<f64>().to_array()) {
                hasher.update(&number.to_bits().to_le_bytes());
            }
            body.state().removals.cells().iter().for_each(|cell| hasher.update(&cell.to_le_bytes()));
            let (cells, displacement) = (body.cell_count() as u64, body.max_displacement());
            bodies.push(BodyMark { cells, displacement, mean: (sum / body.positions().len() as f64).to_array() });
        }
        Mark { at, checksum: hasher.finalize(), bodies }
    }
    match &play.world {
        AnyWorld::Single(world) => of(world, at),
        AnyWorld::Double(world) => of(world, at),
    }
}

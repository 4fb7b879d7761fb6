use viscera_scene::{Files, Scene};

use super::{Session, while_replaying};
use crate::dropped;
use crate::export;
use crate::library;
use crate::message::{
    Answer, Bytes, Command, Effect, Export, FileMessage, Level, Purpose, Refusal, RunState, SLOTS, Trocar, VERSION,
    Value,
};
use crate::parameter;
use crate::recording::Recording;
use crate::refuse;
use crate::simulation::colour::Colouring;
use crate::simulation::tools::{self, Hand};
use crate::simulation::{AnyWorld, Change, Play};

/// The most steps that one command makes.
const MOST_STEPS: u32 = 1000;
/// The most cells that a change of the mesh may make, so that a slip of a finger does not take all memory.
const MOST_CELLS: f64 = 3e5;
/// The most instruments that are there at once.
const MOST_INSTRUMENTS: usize = 16;
/// The most instruments that a scene may have had: each keeps its number.
const MOST_NUMBERS: usize = 256;

impl Session {
    pub(super) fn carry_out(&mut self, command: Command, request: Option<u64>) -> Result<(), Box<Refusal>> {
        if self.replayer.is_some() && command.changes_the_scene() {
            return Err(while_replaying());
        }
        if !matches!(command, Command::Set { .. } | Command::MoveInstrument { .. }) {
            self.make_pending_changes();
        }
        self.gallery.touch();
        match command {
            Command::Hello { version, .. } => hello(version),
            Command::OpenScene { name } => {
                let unknown = || {
                    let known: Vec<_> = library::scenes().map(|(name, _)| name).collect();
                    refuse::with_help(format!("there is no scene `{name}`"), format!("known: {}", known.join(", ")))
                };
                let scene = library::scene(&name).ok_or_else(unknown)?;
                self.open(&name, &scene.map_err(|errors| Box::new(refuse::scene(&errors)))?)
            }
            Command::OpenText { text, name } => {
                let name = name.unwrap_or_else(|| "scene".into());
                let scene = Scene::parse_with(&name, &text, Files::none());
                self.open(&name, &scene.map_err(|errors| Box::new(refuse::scene(&errors)))?)
            }
            Command::OpenMesh { name, bytes, unit, edge } => {
                let (title, scene) = dropped::scene(&name, bytes.0, unit, edge)?;
                // Its lines are not the user's.
                self.open(&title, &scene).map_err(|refusal| Box::new(Refusal { excerpt: None, ..*refusal }))
            }
            Command::Set { key, value } => {
                self.pending.retain(|(pending, ..)| *pending != key);
                self.pending.push((key, value, request));
                Ok(())
            }
            Command::AddInstrument { kind, tip, direction, trocar } => {
                self.add_instrument(kind, tip, direction, trocar)
            }
            Command::SetTrocar { instrument, trocar } => self.set_trocar(instrument, trocar),
            Command::RemoveInstrument { instrument } => {
                self.play.remove_tool(instrument)?;
                self.gallery.scene_changed();
                self.record(|| Command::RemoveInstrument { instrument });
                Ok(())
            }
            Command::MoveInstrument { instrument, tip, direction, roll, trigger, stamp } => {
                let hand = Hand { tip, direction, roll, trigger };
                let was_scripted = self.play.tools.get(instrument as usize).is_some_and(|tool| tool.scripted);
                self.play.lead_tool(instrument, &hand, stamp)?;
                if was_scripted {
                    self.gallery.scene_changed();
                }
                self.record(|| Command::MoveInstrument { instrument, tip, direction, roll, trigger, stamp: None });
                Ok(())
            }
            Command::Pause {} => {
                self.state = RunState::Paused;
                self.clock.forgive();
                Ok(())
            }
            Command::Play {} => {
                self.state = RunState::Running;
                self.clock.forgive();
                Ok(())
            }
            Command::Step { count } => self.step_by_hand(count),
            Command::Reset {} => {
                let file = self.play.file.clone();
                self.play.change(file, &Change::Restart)?;
                self.restarted();
                self.record(|| Command::Reset {});
                Ok(())
            }
            Command::TakeSnapshot { slot } => {
                *self.slot(slot)? = Some(self.play.keep());
                self.gallery.scene_changed();
                Ok(())
            }
            Command::RestoreSnapshot { slot } => self.restore(slot),
            Command::Colour { by } => {
                let unknown = || {
                    let known = Colouring::ALL.map(Colouring::name).join(", ");
                    refuse::with_help(format!("there is no colouring `{by}`"), format!("known: {known}"))
                };
                self.colouring = Colouring::named(&by).ok_or_else(unknown)?;
                self.gallery.colouring_changed();
                Ok(())
            }
            Command::Ghost { on } => {
                self.play.show_ghost(on)?;
                self.gallery.new_epoch();
                Ok(())
            }
            Command::StartRecording {} => {
                self.start_recording();
                Ok(())
            }
            Command::StopRecording {} => self.stop_recording(request),
            Command::Replay { name, bytes } => self.replay(name, bytes),
            Command::StopReplay {} => self.stop_replay(),
            Command::Export { what } => self.export(what, request),
        }
    }

    fn slot(&mut self, slot: usize) -> Result<&mut Option<crate::simulation::Kept>, Box<Refusal>> {
        let help = format!("slots are numbered 0 to {}", SLOTS - 1);
        self.slots.get_mut(slot).ok_or_else(|| refuse::with_help(format!("there is no slot {slot}"), help))
    }

    fn restore(&mut self, slot: usize) -> Result<(), Box<Refusal>> {
        if self.recorder.is_some() {
            return Err(refuse::with_help("a recording goes forward only", "stop it first"));
        }
        let empty = || refuse::with_help(format!("slot {slot} is empty"), "take a snapshot into it first");
        let kept = self.slot(slot)?.clone().ok_or_else(empty)?;
        self.play.restore(&kept)?;
        self.restarted();
        Ok(())
    }

    fn step_by_hand(&mut self, count: u32) -> Result<(), Box<Refusal>> {
        if !(1..=MOST_STEPS).contains(&count) {
            return Err(refuse::because(format!("{count} steps were asked for: 1 to {MOST_STEPS} can be")));
        }
        if self.state == RunState::Running {
            return Err(refuse::with_help("the simulation runs", "pause it first"));
        }
        self.asked = (self.asked + count).min(MOST_STEPS);
        Ok(())
    }

    fn add_instrument(
        &mut self,
        kind: String,
        tip: Option<[f64; 3]>,
        direction: Option<[f64; 3]>,
        trocar: Option<Trocar>,
    ) -> Result<(), Box<Refusal>> {
        if self.play.tools.iter().filter(|tool| !tool.removed).count() >= MOST_INSTRUMENTS {
            let help = "take one away first";
            return Err(refuse::with_help(format!("there are {MOST_INSTRUMENTS} instruments already"), help));
        }
        if self.play.tools.len() >= MOST_NUMBERS {
            return Err(refuse::with_help(
                format!("the scene has had {MOST_NUMBERS} instruments"),
                "open it again to begin anew",
            ));
        }
        let hand = self.in_front(tip, direction);
        let trocar = trocar.and_then(|trocar| self.play.entry(trocar, hand.tip, None));
        self.play.add_tool(&kind, &hand, trocar)?;
        self.gallery.scene_changed();
        let (tip, direction, trocar) = (Some(hand.tip), Some(hand.direction), trocar.map(Trocar::At));
        self.record(|| Command::AddInstrument { kind, tip, direction, trocar });
        Ok(())
    }

    fn set_trocar(&mut self, instrument: u32, trocar: Trocar) -> Result<(), Box<Refusal>> {
        self.play.tool(instrument)?;
        let tip = tools::tip(&self.play.world, instrument).to_array();
        let trocar = self.play.entry(trocar, tip, Some(instrument));
        self.play.set_trocar(instrument, trocar)?;
        let trocar = trocar.map_or(Trocar::Wanted(false), Trocar::At);
        self.record(|| Command::SetTrocar { instrument, trocar });
        Ok(())
    }

    /// Where an instrument comes in: in front of the bodies, pointing away from who looks, unless the user says.
    fn in_front(&self, tip: Option<[f64; 3]>, direction: Option<[f64; 3]>) -> Hand {
        let (centre, radius) = self.play.ball;
        let look = self.play.camera().look;
        let length = look.iter().map(|component| component * component).sum::<f64>().sqrt();
        let front = std::array::from_fn(|axis| centre[axis] - 1.1 * radius * look[axis] / length);
        Hand { tip: tip.unwrap_or(front), direction: direction.unwrap_or(look), roll: 0.0, trigger: 0.0 }
    }

    /// Changes a parameter.
    pub(super) fn change(&mut self, key: &str, value: &Value) -> Result<(), Box<Refusal>> {
        let mut file = self.play.file.clone();
        // A replay knows the scene as it was when the recording began.
        let original = self.recorded_scene().unwrap_or(&self.play.original);
        let (effect, notices) =
            parameter::set(&mut file, original, key, value).map_err(|not_set| refuse::parameter(key, not_set))?;
        if effect == Effect::Restarts {
            self.check_size(key, value)?;
        }
        match effect {
            Effect::Continues => {
                self.play.change(file, &Change::Continue)?;
                self.gallery.scene_changed();
            }
            Effect::Restarts => {
                self.play.change(file, &Change::Restart)?;
                self.restarted();
                self.notify(Level::Info, "the scene began again with its new mesh", "");
            }
        }
        for notice in notices {
            self.notify(Level::Warning, notice, "");
        }
        self.record(|| Command::Set { key: key.into(), value: value.clone() });
        Ok(())
    }

    /// Refuses edges that would make too many cells.
    fn check_size(&self, key: &str, value: &Value) -> Result<(), Box<Refusal>> {
        let parameters = parameter::parameters(&self.play.file, &self.play.original);
        let Some(before) = parameters.iter().find(|parameter| parameter.key == key) else { return Ok(()) };
        let (Some(body), Some(now), Some(next)) = (before.body, before.value.number(), value.number()) else {
            return Ok(());
        };
        let bodies = self.play.bodies();
        let cells = bodies[body].cells as f64 * (now / next).powi(3);
        if cells <= MOST_CELLS {
            return Ok(());
        }
        let reason = format!("edges of {next} m would make about {cells:.0} cells");
        Err(refuse::with_help(reason, format!("up to {MOST_CELLS:.0} are made here; `viscera run` takes more")))
    }

    fn export(&mut self, what: Export, request: Option<u64>) -> Result<(), Box<Refusal>> {
        let name = &self.play.origin.name;
        let (purpose, name, mime, bytes) = match what {
            Export::Observables => {
                let bodies: Vec<String> = self.play.file.body.keys().cloned().collect();
                let tools: Vec<String> = self.play.tools.iter().map(|tool| tool.name.clone()).collect();
                let text = self.history.csv(&bodies, &tools);
                (Purpose::Observables, format!("{name}.csv"), "text/csv", text.into_bytes())
            }
            Export::State => {
                let bytes = match &self.play.world {
                    AnyWorld::Single(world) => export::vtu(world),
                    AnyWorld::Double(world) => export::vtu(world),
                };
                (Purpose::State, format!("{name}.vtu"), "model/vtu", bytes.map_err(refuse::because)?)
            }
            Export::Scene => {
                let text = self.play.file.to_toml().map_err(|error| refuse::because(error.to_string()))?;
                (Purpose::Scene, format!("{name}.toml"), "application/toml", text.into_bytes())
            }
        };
        self.send_file(purpose, name, mime, bytes, request);
        Ok(())
    }

    pub(super) fn send_file(
        &mut self,
        purpose: Purpose,
        name: String,
        mime: &str,
        bytes: Vec<u8>,
        request: Option<u64>,
    ) {
        let file = FileMessage { purpose, name, mime: mime.into(), bytes: Bytes(bytes), request };
        self.answers.push(Answer::File(file));
    }

    fn replay(&mut self, name: Option<String>, bytes: Option<Bytes>) -> Result<(), Box<Refusal>> {
        let decode = |bytes: &[u8]| Recording::decode(bytes).map_err(|error| refuse::because(error.to_string()));
        let recording = match (&name, bytes) {
            (_, Some(bytes)) => decode(&bytes.0)?,
            (Some(name), None) => {
                let known = library::recordings().find(|(known, _)| known == name);
                let unknown = || refuse::because(format!("there is no recording `{name}`"));
                decode(known.ok_or_else(unknown)?.1)?
            }
            (None, None) => return Err(refuse::with_help("there is nothing to replay", "give `name` or `bytes`")),
        };
        self.start_replay(recording)
    }
}

fn hello(version: u32) -> Result<(), Box<Refusal>> {
    if version == VERSION {
        return Ok(());
    }
    let reason = format!("the page speaks version {version} of the protocol, and this program version {VERSION}");
    Err(refuse::with_help(reason, "load the page again from this program"))
}

impl Play {
    /// Every file that the scene may name, where they are in memory.
    pub(crate) fn files_in_memory(&self) -> std::collections::BTreeMap<String, Bytes> {
        match &self.origin.files {
            Files::Memory(files) => files.iter().map(|(name, bytes)| (name.clone(), Bytes(bytes.clone()))).collect(),
            Files::Folder(_) => std::collections::BTreeMap::new(),
        }
    }
}

//! An instrument in a hand at this machine, such as that of a haptic device: pages do not lead it meanwhile.

use viscera::curve::Curve;
use viscera::math::Vec3;
use viscera::world::InstrumentId;

use super::{Session, while_replaying};
use crate::message::{Command, InstrumentFrame, Level, Pace, Refusal};
use crate::refuse;
use crate::simulation::{AnyWorld, tools};

/// Who leads an instrument besides the page.
pub(super) struct InHand {
    instrument: u32,
    /// Whether a page that wanted to lead it was told.
    told: bool,
}

impl Session {
    /// Takes an instrument into a hand at this machine, which leads it by [`Session::lead`] until [`Session::let_go`] or another scene:
    /// pages are refused to move it or to take it away. Gives where it is.
    ///
    /// # Errors
    /// Where there is no such instrument, or a recording is being replayed.
    pub fn take_in_hand(&mut self, instrument: u32) -> Result<InstrumentFrame, Box<Refusal>> {
        if self.replayer.is_some() {
            return Err(while_replaying());
        }
        let missing = || refuse::with_help(format!("there is no instrument {instrument}"), "`scene` lists them");
        let frame = self.instrument(instrument).ok_or_else(missing)?;
        self.in_hand = Some(InHand { instrument, told: false });
        Ok(frame)
    }

    /// The instrument that is in a hand at this machine.
    pub fn in_hand(&self) -> Option<u32> {
        self.in_hand.as_ref().map(|in_hand| in_hand.instrument)
    }

    /// Leaves the instrument where it is; pages may lead it again.
    pub fn let_go(&mut self) {
        self.in_hand = None;
    }

    /// Says where the instrument in hand should be at the end of the next step: tip [m], direction from handle to tip, roll [rad] and
    /// trigger [0 … 1]. It is recorded as what a page says is. Without one in hand, nothing happens.
    ///
    /// # Errors
    /// Where the pose makes no sense, the instrument is not there any more, or a recording is being replayed.
    pub fn lead(&mut self, tip: [f64; 3], direction: [f64; 3], roll: f64, trigger: f64) -> Result<(), Box<Refusal>> {
        let Some(instrument) = self.in_hand() else { return Ok(()) };
        self.carry_out(Command::MoveInstrument { instrument, tip, direction, roll, trigger, stamp: None }, None)
    }

    /// Why a page may not do this, if somebody at this machine has the instrument in hand.
    pub(super) fn held_by_another(&mut self, command: &Command) -> Option<Box<Refusal>> {
        let in_hand = self.in_hand.as_mut()?;
        match command {
            Command::MoveInstrument { instrument, .. }
            | Command::SetTrocar { instrument, .. }
            | Command::RemoveInstrument { instrument }
                if *instrument == in_hand.instrument => {}
            _ => return None,
        }
        let text = format!("instrument {} is in the hand of a device at the simulator", in_hand.instrument);
        let help = "the device leads it; take another instrument";
        // A page moves a tool a hundred times a second: a person reads it once.
        if !std::mem::replace(&mut in_hand.told, true) {
            self.notify(Level::Info, text.clone(), help);
        }
        Some(refuse::with_help(text, help))
    }

    /// An instrument, as the next frame has it; none where there is no such one.
    pub fn instrument(&self, instrument: u32) -> Option<InstrumentFrame> {
        let tool = self.play.tools.get(instrument as usize).filter(|tool| !tool.removed)?;
        Some(tools::frame(&self.play.world, instrument, tool))
    }

    /// The path [m] along time [s] on which the scene leads an instrument, and for how long [s].
    pub fn path(&self, instrument: u32) -> Option<(Curve<Vec3<f64>>, f64)> {
        self.play.tools.get(instrument as usize).filter(|tool| tool.of_scene && !tool.removed)?;
        let id = InstrumentId(instrument as usize);
        let path = match &self.play.world {
            AnyWorld::Single(world) => world.instrument(id).path().clone(),
            AnyWorld::Double(world) => world.instrument(id).path().clone(),
        };
        Some((path, self.play.file.duration.0))
    }

    /// How simulated time follows the clock.
    pub fn pace(&self) -> Pace {
        self.clock.pace()
    }
}

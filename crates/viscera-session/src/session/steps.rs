use super::Session;
use crate::message::{Level, RunState};

impl Session {
    /// So much time has passed on the caller's clock [s]. Steps that are due are made by [`Session::work`].
    pub fn elapse(&mut self, seconds: f64) {
        let seconds = if seconds.is_finite() { seconds.max(0.0) } else { 0.0 };
        self.clock.elapse(seconds, self.state == RunState::Running);
    }

    /// Does what is due, at most one step; gives whether there may be more to do. Call it until it gives `false`, or until no more
    /// time is to be spent, and say that by [`Session::give_up`].
    pub fn work(&mut self) -> bool {
        self.make_pending_changes();
        if !self.is_step_due() {
            return false;
        }
        match self.state {
            RunState::Running => {}
            RunState::Paused => self.asked -= 1,
            RunState::Stopped => self.asked = 0,
        }
        self.make_step();
        true
    }

    /// Whether a step is to be made now: by the clock, or because it was asked for.
    pub fn is_step_due(&self) -> bool {
        match self.state {
            RunState::Running => self.clock.is_due(self.play.world.step_length()),
            RunState::Paused | RunState::Stopped => self.asked > 0,
        }
    }

    /// No more can be done before the next picture: what is due and will not be caught up with counts as lag.
    pub fn give_up(&mut self) {
        self.clock.give_up(self.play.world.step_length());
    }

    /// Whether the simulation follows the clock.
    pub fn is_running(&self) -> bool {
        self.state == RunState::Running
    }

    /// Whether a step was refused, and nothing goes on before somebody mends that.
    pub fn is_stopped(&self) -> bool {
        self.state == RunState::Stopped
    }

    /// Time until the next step is due [s]; none while nothing is.
    pub fn time_to_next_step(&self) -> Option<f64> {
        (self.state == RunState::Running).then(|| self.clock.time_to(self.play.world.step_length()))
    }

    fn make_step(&mut self) {
        if !self.do_what_is_replayed() {
            return;
        }
        let step = self.play.world.step_length();
        match self.play.step(&self.executor) {
            Ok(None) => {}
            Ok(Some(error)) => {
                self.notify(Level::Warning, format!("the linear model gave up: {error}"), "it can be shown again");
                self.gallery.new_epoch();
            }
            Err(error) => {
                self.state = RunState::Stopped;
                self.clock.forgive();
                self.gallery.touch();
                let help = "reset, go back to a snapshot, or change a parameter and go on";
                return self.notify(Level::Error, error.to_string(), help);
            }
        }
        if self.state == RunState::Stopped {
            self.state = RunState::Paused;
        }
        self.clock.stepped(step);
        self.gallery.touch();
        self.mark_recording();
        self.check_replay();
    }
}

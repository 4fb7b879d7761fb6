//! The bar that shows how far a run is and how fast it goes.

use indicatif::{ProgressBar, ProgressStyle};
use viscera::math::Scalar;
use viscera_io::grouped;
use viscera_scene::BuiltScene;

use super::recording::Clock;
use crate::terminal;

/// A bar on stderr; nothing where stderr is no terminal, or nothing is to be said.
pub(super) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar that begins after `done` of `steps` steps.
    pub(super) fn new(done: u64, steps: u64, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(steps).with_position(done) };
        // The template is fixed: should a later indicatif refuse it, its own default serves as well.
        if let Ok(style) = ProgressStyle::with_template("{bar:24.red/dim} {percent:>3} %  {msg}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        Self { bar }
    }

    /// Shows where the run is now.
    pub(super) fn show<T: Scalar>(&self, built: &BuiltScene<T>, clock: &Clock) {
        self.bar.inc(1);
        if self.bar.is_hidden() {
            return;
        }
        let cells: usize = built.bodies.values().map(|&id| built.world.body(id).cell_count()).sum();
        let (steps, seconds) = (self.bar.position() as f64, clock.seconds());
        let time = built.world.time();
        self.bar.set_message(format!(
            "{time:.2} of {} s  {:.0} steps/s  {:.2} × real time  {} cells",
            built.file.duration.0,
            steps / seconds,
            time / seconds,
            grouped(cells)
        ));
    }

    /// Says something above the bar.
    pub(super) fn tell(&self, line: &str) {
        self.bar.suspend(|| terminal::complain(line));
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

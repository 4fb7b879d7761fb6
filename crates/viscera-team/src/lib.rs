//! Threads that stand ready for loops of microseconds.
//!
//! A step of a simulation has hundreds of loops that take ten microseconds or less. [`Team::stand_ready`] wakes the threads once, and while it
//! runs [`Team::together`] hands a loop over and has it back within a fifth of a microsecond; a pool that takes work from queues needs
//! nearly two (EPYC Zen 5, two cores). A crate of its own, because it holds the only unsafe code of the workspace: a closure that
//! borrows from the caller is handed to threads that live longer.

mod gate;

use std::io;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};

use gate::Gate;

/// Threads that work on one thing at a time together with whoever calls.
#[derive(Debug)]
pub struct Team {
    gate: Arc<Gate>,
    others: Vec<JoinHandle<()>>,
}

impl Team {
    /// A team of `threads` threads [≥ 1], the calling one among them. They sleep until they are needed.
    ///
    /// # Errors
    /// What the operating system says where it refuses to start a thread.
    pub fn new(threads: usize) -> io::Result<Self> {
        // Threads without a core of their own would only be in each other's way if they did not let go of it.
        let patient = std::thread::available_parallelism().is_ok_and(|cores| threads <= cores.get());
        let mut team = Self { gate: Arc::new(Gate::new(patient)), others: Vec::new() };
        for number in 1..threads {
            let gate = team.gate.clone();
            let thread = Builder::new().name(format!("viscera-{number}")).spawn(move || gate.serve(number))?;
            team.others.push(thread);
        }
        Ok(team)
    }

    /// How many threads there are, the calling one among them.
    pub fn thread_count(&self) -> usize {
        self.others.len() + 1
    }

    /// Does `work` while the other threads stay awake, so that [`Team::together`] finds them ready.
    pub fn stand_ready<R>(&self, work: impl FnOnce() -> R) -> R {
        let _awake = self.gate.rouse();
        work()
    }

    /// Lets every thread that is ready call `work` with its number, 0 for the caller, and waits for those that came.
    ///
    /// None may come but the caller: `work` has to be done when a single call returns and nobody else is in one. Inside of `work`, and while
    /// another thread calls the team, there is nobody else. A panic in any of the calls goes on in the caller, when all are back.
    pub fn together(&self, work: &(dyn Fn(usize) + Sync)) {
        if self.others.is_empty() || !self.gate.take() {
            return work(0);
        }
        let _awake = self.gate.rouse_unless_awake();
        if let Some(panic) = self.gate.hold_open(work) {
            resume_unwind(panic);
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.gate.dismiss();
        for thread in self.others.drain(..) {
            // It never panics: what it calls is caught.
            let _ = thread.join();
        }
    }
}

//! Ctrl-C: the first one asks the run to end well, the second one ends it at once.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

/// Whether the user, or the system, has asked the program to stop.
#[derive(Clone, Debug)]
pub(crate) struct Interrupt {
    asked: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens for Ctrl-C, and for the request to terminate that a system sends.
    pub(crate) fn listen() -> Result<Self, Failure> {
        let asked = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&asked);
        let handler = move || {
            if seen.swap(true, Ordering::SeqCst) {
                process::exit(130);
            }
        };
        ctrlc::set_handler(handler).map_err(|error| Failure::problem(format!("Ctrl-C cannot be watched: {error}")))?;
        Ok(Self { asked })
    }

    /// Whether to stop now.
    pub(crate) fn is_asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst)
    }
}

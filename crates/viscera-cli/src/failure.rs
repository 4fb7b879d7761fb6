//! How the program ends when not well, and what it says.

use std::fmt;
use std::process::ExitCode;

use viscera_scene::SceneErrors;

/// Why a command did not do what was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The run or the check found a problem.
    Problem(String),
    /// What was given cannot be used: a missing file, a scene with a mistake, a folder that cannot be written.
    Input(String),
    /// The user stopped it.
    Interrupted(String),
}

impl Failure {
    /// What went wrong while doing what was asked.
    pub(crate) fn problem(error: impl fmt::Display) -> Self {
        Self::Problem(format!("error: {error}"))
    }

    /// What is wrong with what was given.
    pub(crate) fn input(error: impl fmt::Display) -> Self {
        Self::Input(format!("error: {error}"))
    }

    /// What is wrong with a scene: its messages bring their own heads.
    pub(crate) fn scene(errors: SceneErrors) -> Self {
        Self::Input(errors.to_string())
    }

    /// The code that the program ends with, as its help lists them.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Problem(_) => 1,
            Self::Input(_) => 2,
            Self::Interrupted(_) => 130,
        })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let (Self::Problem(text) | Self::Input(text) | Self::Interrupted(text)) = self;
        out.write_str(text)
    }
}

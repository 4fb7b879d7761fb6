//! The `viscera` program.

mod arguments;
mod bench;
mod built_in;
mod check;
mod emulated;
mod failure;
mod haptic_figures;
mod instruction_set;
mod interrupt;
mod mesh;
mod precompute;
mod profile;
mod reproduce;
mod run;
mod scenes;
mod schema;
mod serve;
mod stopwatch;
mod sweep;
mod tables;
mod terminal;
mod tissues;
mod units;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;

fn main() -> ExitCode {
    // What is piped into a file has to be there as a whole: a full disk is a failure, whatever else went well.
    match carry_out(Arguments::parse().command).and_then(|()| terminal::all_was_said()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal::complain(&failure.to_string());
            failure.exit_code()
        }
    }
}

fn carry_out(command: Option<Command>) -> Result<(), Failure> {
    match command {
        Some(Command::Run(arguments)) => run::run(&arguments),
        Some(Command::Check(arguments)) => check::check(&arguments),
        Some(Command::Precompute(arguments)) => precompute::precompute(&arguments),
        Some(Command::Profile(arguments)) => profile::profile(&arguments),
        Some(Command::Sweep(arguments)) => sweep::sweep(&arguments),
        Some(Command::Bench { command }) => bench::carry_out(&command),
        Some(Command::Reproduce(arguments)) => reproduce::reproduce(&arguments),
        Some(Command::Mesh { command }) => mesh::carry_out(&command),
        Some(Command::Scenes(arguments)) => scenes::scenes(&arguments),
        Some(Command::Tissues(arguments)) => tissues::tissues(&arguments),
        Some(Command::Serve(arguments)) => serve::serve(&arguments),
        Some(Command::Schema(arguments)) => {
            schema::schema(&arguments);
            Ok(())
        }
        // What most people want who type the name alone.
        None => serve::serve(&arguments::ServeArguments::default()),
    }
}

//! The `viscera` program.

mod arguments;
mod built_in;
mod check;
mod failure;
mod interrupt;
mod mesh;
mod run;
mod scenes;
mod terminal;
mod units;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::{CommandFactory, Parser};
use failure::Failure;

fn main() -> ExitCode {
    match carry_out(Arguments::parse().command) {
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
        Some(Command::Mesh { command }) => mesh::carry_out(&command),
        Some(Command::Scenes(arguments)) => scenes::scenes(&arguments),
        Some(Command::Schema) => {
            terminal::say(&viscera_scene::schema_text());
            Ok(())
        }
        None => {
            terminal::say(&Arguments::command().render_help().ansi().to_string());
            Ok(())
        }
    }
}

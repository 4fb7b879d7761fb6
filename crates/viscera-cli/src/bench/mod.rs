//! `viscera bench`: what this machine holds.

pub(crate) mod arguments;
mod capacity;
mod haptics;
mod organ;
mod page;
mod round;
mod search;
mod soak;

use crate::failure::Failure;
use arguments::BenchCommand;

pub(crate) fn carry_out(command: &BenchCommand) -> Result<(), Failure> {
    match command {
        BenchCommand::Capacity(arguments) => capacity::capacity(arguments),
        BenchCommand::Soak(arguments) => soak::soak(arguments),
        BenchCommand::Haptics(arguments) => haptics::haptics(arguments),
    }
}

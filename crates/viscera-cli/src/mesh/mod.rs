//! `viscera mesh`: looking at meshes, converting and making them.

pub(crate) mod arguments;
mod check;
mod convert;
mod generate;
mod info;
pub(crate) mod order;
mod reading;
mod tetrahedralize;
mod writing;

use crate::failure::Failure;
use arguments::MeshCommand;

pub(crate) fn carry_out(command: &MeshCommand) -> Result<(), Failure> {
    match command {
        MeshCommand::Info(source) => info::info(source),
        MeshCommand::Check(source) => check::check(source),
        MeshCommand::Convert { source, reorder, out } => convert::convert(source, *reorder, out),
        MeshCommand::Generate { shape, out } => generate::generate(shape, out),
        MeshCommand::Tetrahedralize { source, edge, out } => tetrahedralize::tetrahedralize(source, *edge, out),
    }
}

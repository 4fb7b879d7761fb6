use viscera::instrument::{Cautery, Grasper, InstrumentError};
use viscera::math::Scalar;
use viscera::world::{InstrumentId, World, WorldError};

use super::curve::curve;
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::InstrumentFile;

pub(super) fn add<T: Scalar>(
    world: &mut World<T>,
    file: &InstrumentFile,
    site: &Site,
) -> Result<InstrumentId, SceneErrors> {
    let way = site.key("path");
    let added = match file {
        InstrumentFile::Grasper { path, radius, close, open } => world.add_instrument(Grasper {
            path: curve(path, &way)?,
            radius: radius.0,
            close: close.0,
            open: open.map(|open| open.0),
            ..Grasper::default()
        }),
        InstrumentFile::Cautery { path, radius, on, off } => world.add_instrument(Cautery {
            path: curve(path, &way)?,
            radius: radius.0,
            on: (on.map_or(0.0, |on| on.0), off.map_or(f64::INFINITY, |off| off.0)),
            ..Cautery::default()
        }),
    };
    added.map_err(|error| match error {
        WorldError::Instrument(InstrumentError::OutOfRange { name, value, range, .. }) => {
            site.key(name).error(format!("`{name}` is {value}, and must be {range}"), "")
        }
        other => site.error(other, ""),
    })
}

use viscera::instrument::{Cautery, Grasper, InstrumentError, Jaws, Mount, Probe, Shaft};
use viscera::math::{Scalar, Vec3};
use viscera::world::{InstrumentId, World, WorldError};

use super::curve::curve;
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{InstrumentFile, JawsFile, ShaftFile};
use crate::quantity::{Angle, Length};

pub(super) fn add<T: Scalar>(
    world: &mut World<T>,
    file: &InstrumentFile,
    site: &Site,
) -> Result<InstrumentId, SceneErrors> {
    let way = site.key("path");
    let added = match file {
        InstrumentFile::Probe { path, shaft, friction, direction, trocar } => world.add_instrument(Probe {
            path: curve(path, &way)?,
            mount: mount(direction, None, trocar),
            shaft: self::shaft(shaft),
            friction: *friction,
        }),
        InstrumentFile::Grasper { path, radius, close, open, grip, jaws, shaft, friction, direction, roll, trocar } => {
            world.add_instrument(Grasper {
                path: curve(path, &way)?,
                mount: mount(direction, *roll, trocar),
                radius: radius.0,
                close: close.map_or(f64::INFINITY, |close| close.0),
                open: open.map(|open| open.0),
                jaws: jaws.as_ref().map(self::jaws),
                shaft: shaft.as_ref().map(self::shaft),
                friction: *friction,
                grip: grip.map_or(f64::INFINITY, |grip| grip.0),
            })
        }
        InstrumentFile::Cautery { path, radius, on, off, power, heat, shaft, friction, direction, trocar } => {
            let plain = Cautery::default();
            if let (None, Some(_)) = (on, off) {
                let help = "say when it is switched on, such as `on = \"0 s\"`";
                return Err(site.key("off").error("nothing switches the current on before it is switched off", help));
            }
            world.add_instrument(Cautery {
                path: curve(path, &way)?,
                mount: mount(direction, None, trocar),
                radius: radius.0,
                on: (on.map_or(plain.on.0, |on| on.0), off.map_or(plain.on.1, |off| off.0)),
                power: power.map_or(plain.power, |power| power.0),
                heat: heat.map_or(plain.heat, |heat| heat.0),
                shaft: shaft.as_ref().map(self::shaft),
                friction: *friction,
            })
        }
    };
    added.map_err(|error| match error {
        WorldError::Instrument(InstrumentError::OutOfRange { name, value, range, .. }) => {
            key(site, name).error(format!("`{name}` is {value}, and must be {range}"), "")
        }
        WorldError::NothingToCut { kind, advice } => {
            site.key("kind").error(format!("no body here can lose cells to a {kind}"), advice)
        }
        WorldError::ToolsNeedMotion => site.error(
            "the integrator `quasi-static` knows no tools with rigid parts or a bounded grip",
            "take another integrator, or a grasper with neither jaws nor shaft nor `grip`",
        ),
        other => site.error(other, ""),
    })
}

/// The key of a setting of the engine.
fn key<'a>(site: &Site<'a>, name: &str) -> Site<'a> {
    match name.split_once(' ') {
        Some(("shaft", part)) => site.key("shaft").key(part),
        Some(("jaw", part)) => site.key("jaws").key(part),
        _ if name == "opening" => site.key("jaws").key(name),
        _ => site.key(name),
    }
}

fn mount(direction: &Option<[f64; 3]>, roll: Option<Angle>, trocar: &Option<[Length; 3]>) -> Mount {
    let mount = direction.map_or_else(Mount::default, |direction| Mount::along(direction.into()));
    let trocar = trocar.map(|place| Vec3::from(place.map(|coordinate| coordinate.0)));
    Mount { roll: roll.map_or(0.0, |roll| roll.0), trocar, ..mount }
}

fn shaft(file: &ShaftFile) -> Shaft {
    Shaft { radius: file.radius.0, length: file.length.0 }
}

fn jaws(file: &JawsFile) -> Jaws {
    Jaws { length: file.length.0, radius: file.radius.0, opening: file.opening.0 }
}

//! Instruments in a scene's words. A scene's tools follow paths; what only a hand can do with one is refused.

use pyo3::PyResult;
use serde_json::Value as Json;
use viscera::instrument::{Jaws, Mount, Shaft};

use super::{curve, object, refuse, vector};
use crate::instrument::AnyInstrument;

pub(super) fn instrument(name: &str, instrument: &AnyInstrument) -> PyResult<Json> {
    let number = |value: f64| value.is_finite().then(|| Json::from(value));
    let by_hand = |what: &str, key: &str| {
        refuse(format!("`{name}` {what} by hand only; in a scene that has its time: describe it with `{key}`"))
    };
    Ok(match instrument {
        AnyInstrument::Probe(probe) => object! {
            "kind": Json::from("probe"),
            "path": curve(&probe.path, vector),
            "shaft": shaft(&probe.shaft),
            "friction": Json::from(probe.friction),
            "direction": direction(name, &probe.mount)?,
            "trocar": round(name, &probe.mount)?.trocar.map(vector),
        },
        AnyInstrument::Grasper(grasper) => object! {
            "kind": Json::from("grasper"),
            "path": curve(&grasper.path, vector),
            "radius": Json::from(grasper.radius),
            "close": number(grasper.close).ok_or_else(|| by_hand("closes", "close"))?,
            "open": grasper.open.and_then(number),
            "grip": number(grasper.grip),
            "jaws": grasper.jaws.as_ref().map(jaws),
            "shaft": grasper.shaft.as_ref().map(shaft),
            "friction": Json::from(grasper.friction),
            "direction": direction(name, &grasper.mount)?,
            "roll": (grasper.mount.roll != 0.0).then(|| Json::from(grasper.mount.roll)),
            "trocar": grasper.mount.trocar.map(vector),
        },
        AnyInstrument::Cautery(cautery) => object! {
            "kind": Json::from("cautery"),
            "path": curve(&cautery.path, vector),
            "radius": Json::from(cautery.radius),
            "on": number(cautery.on.0).ok_or_else(|| by_hand("is switched on", "on"))?,
            "off": number(cautery.on.1),
            "power": number(cautery.power),
            "heat": Json::from(cautery.heat),
            "shaft": cautery.shaft.as_ref().map(shaft),
            "friction": Json::from(cautery.friction),
            "direction": direction(name, &cautery.mount)?,
            "trocar": round(name, &cautery.mount)?.trocar.map(vector),
        },
    })
}

/// Where it points, unless that is down.
fn direction(name: &str, mount: &Mount) -> PyResult<Option<Json>> {
    match mount.direction.points() {
        [(_, constant)] => Ok((mount.direction != Mount::default().direction).then(|| vector(*constant))),
        _ => Err(refuse(format!(
            "`{name}` turns along time; in a scene an instrument points one way, or through a trocar"
        ))),
    }
}

/// A tool that a scene does not turn about its axis.
fn round<'a>(name: &str, mount: &'a Mount) -> PyResult<&'a Mount> {
    if mount.roll == 0.0 {
        Ok(mount)
    } else {
        Err(refuse(format!("`{name}` is round, and has no `roll` in a scene: leave it out")))
    }
}

fn shaft(shaft: &Shaft) -> Json {
    object! { "radius": Json::from(shaft.radius), "length": Json::from(shaft.length) }
}

fn jaws(jaws: &Jaws) -> Json {
    object! {
        "length": Json::from(jaws.length),
        "radius": Json::from(jaws.radius),
        "opening": Json::from(jaws.opening),
    }
}

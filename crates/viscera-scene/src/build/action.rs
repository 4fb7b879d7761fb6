//! Loads and actuators.

use viscera::body::{Actuator, ActuatorLine, Body, Load};
use viscera::curve::Curve;
use viscera::math::Vec3;
use viscera::mesh::{Region, VolumeMesh};

use super::curve::curve;
use super::region::{Wanted, region};
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{ActiveFibreFile, ActuatorFile, BodyFile, LoadFile};

/// The body with its actuators and loads.
pub(super) fn act(mut body: Body, file: &BodyFile, mesh: &VolumeMesh, site: &Site) -> Result<Body, SceneErrors> {
    for (index, file) in file.actuator.iter().enumerate() {
        body = body.actuator(actuator(file, mesh, &site.key("actuator").key(index))?);
    }
    for (index, file) in file.active_fibre.iter().enumerate() {
        body = body.actuator(active_fibre(file, mesh, &site.key("active-fibre").key(index))?);
    }
    for (index, file) in file.load.iter().enumerate() {
        body = body.load(load(file, mesh, &site.key("load").key(index))?);
    }
    Ok(body)
}

fn actuator(file: &ActuatorFile, mesh: &VolumeMesh, site: &Site) -> Result<Actuator, SceneErrors> {
    let from = region(&file.from, Wanted::Nodes, mesh, &site.key("from"))?;
    let to = region(&file.to, Wanted::Nodes, mesh, &site.key("to"))?;
    Ok(Actuator {
        line: ActuatorLine::Between { from, to },
        stiffness: file.stiffness.map_or(0.0, |stiffness| stiffness.0),
        length: file.length.as_ref().map_or(Ok(Curve::constant(1.0)), |length| curve(length, &site.key("length")))?,
        tension: file.force.as_ref().map_or(Ok(Curve::constant(0.0)), |force| curve(force, &site.key("force")))?,
    })
}

fn active_fibre(file: &ActiveFibreFile, mesh: &VolumeMesh, site: &Site) -> Result<Actuator, SceneErrors> {
    let region = region(&file.region, Wanted::Cells, mesh, &site.key("region"))?;
    if file.direction.iter().all(|&component| component == 0.0) {
        return Err(site.key("direction").error("a direction of length zero", "give the direction of the fibres"));
    }
    Ok(Actuator {
        line: ActuatorLine::Along { region, direction: file.direction },
        stiffness: file.young.map_or(0.0, |young| young.0),
        length: file.length.as_ref().map_or(Ok(Curve::constant(1.0)), |length| curve(length, &site.key("length")))?,
        tension: file.stress.as_ref().map_or(Ok(Curve::constant(0.0)), |stress| curve(stress, &site.key("stress")))?,
    })
}

fn load(file: &LoadFile, mesh: &VolumeMesh, site: &Site) -> Result<Load, SceneErrors> {
    let part = |wanted| region(&file.region, wanted, mesh, &site.key("region"));
    if let Some(force) = &file.force {
        return Ok(Load::Force { region: part(Wanted::Nodes)?, total: curve(force, &site.key("force"))? });
    }
    if let Some(force) = &file.force_per_node {
        let region = part(Wanted::Nodes)?;
        let each = curve(force, &site.key("force-per-node"))?;
        return Ok(Load::Force { total: times(&each, count(&region, mesh, site)?, site)?, region });
    }
    if let Some(pressure) = &file.pressure {
        return Ok(Load::Pressure { region: part(Wanted::Faces)?, pressure: curve(pressure, &site.key("pressure"))? });
    }
    if let Some(traction) = &file.traction {
        return Ok(Load::Traction { region: part(Wanted::Faces)?, traction: curve(traction, &site.key("traction"))? });
    }
    if let Some(force) = &file.body_force {
        return Ok(Load::BodyForce {
            region: part(Wanted::Cells)?,
            per_volume: curve(force, &site.key("body-force"))?,
        });
    }
    let Some(attraction) = &file.attraction else {
        let help = "give `force`, `force-per-node`, `pressure`, `traction`, `body-force` or `attraction`";
        return Err(site.error("the load has no size", help));
    };
    Ok(Load::Attraction {
        region: part(Wanted::Cells)?,
        centre: attraction.centre.map(|length| length.0),
        radius: attraction.radius.0,
        per_volume: curve(&attraction.per_volume, &site.key("attraction").key("per-volume"))?,
    })
}

fn count(region: &Region, mesh: &VolumeMesh, site: &Site) -> Result<usize, SceneErrors> {
    region.nodes(mesh).map(|nodes| nodes.len()).map_err(|error| site.key("region").error(error, ""))
}

fn times(curve: &Curve<Vec3<f64>>, count: usize, site: &Site) -> Result<Curve<Vec3<f64>>, SceneErrors> {
    let points = curve.points().iter().map(|&(time, force)| (time, force * count as f64)).collect();
    Curve::piecewise_linear(points).map_err(|error| site.key("force-per-node").error(error, ""))
}

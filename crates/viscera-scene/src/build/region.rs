use viscera::mesh::{Point, Region, RegionError, VolumeMesh};

use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{RegionFile, RegionShape};
use crate::quantity::Length;

/// What a region is wanted for.
#[derive(Clone, Copy)]
pub(super) enum Wanted {
    Nodes,
    Cells,
    Faces,
}

/// The region, which selects something in the mesh: one that does not is shown in its line, with what is near.
pub(super) fn region(file: &RegionFile, wanted: Wanted, mesh: &VolumeMesh, site: &Site) -> Result<Region, SceneErrors> {
    let region = plain(file, mesh, site)?;
    let selected: Result<usize, RegionError> = match wanted {
        Wanted::Nodes => region.nodes(mesh).map(|nodes| nodes.len()),
        Wanted::Cells => region.cells(mesh).map(|cells| cells.len()),
        Wanted::Faces => region.surface_triangles(mesh).map(|triangles| triangles.len()),
    };
    selected.map(|_| region).map_err(|error| refuse(&error, site))
}

/// The region; in a list, each entry must select something by itself, so that the one that does not is shown.
fn plain(file: &RegionFile, mesh: &VolumeMesh, site: &Site) -> Result<Region, SceneErrors> {
    let shape = match file {
        RegionFile::Name(name) => match name.as_str() {
            "all" => Region::All,
            "surface" => Region::Surface,
            group => Region::Named(group.to_owned()),
        },
        RegionFile::Union(parts) => Region::Union(each(parts, mesh, site)?),
        RegionFile::Shape(shape) => match &**shape {
            RegionShape::Box { low, high } => {
                if let Some(axis) = (0..3).find(|&axis| low[axis] > high[axis]) {
                    let message = format!("`low` is above `high` along {}", ["x", "y", "z"][axis]);
                    return Err(site.key("box").key("low").key(axis).error(message, "exchange the two"));
                }
                Region::Box { low: point(*low), high: point(*high) }
            }
            RegionShape::Sphere { centre, radius } => Region::Sphere { centre: point(*centre), radius: radius.0 },
            RegionShape::Plane { point: at, normal, thickness } => Region::Plane {
                point: point(*at),
                normal: (*normal).into(),
                thickness: thickness.map_or(0.0, |thickness| thickness.0),
            },
            RegionShape::HalfSpace { point: at, normal } => {
                Region::HalfSpace { point: point(*at), normal: (*normal).into() }
            }
            RegionShape::Nearest(place) => Region::Nearest(point(*place)),
            RegionShape::Group(name) => Region::Named(name.clone()),
            RegionShape::Nodes(list) => Region::Nodes(list.clone()),
            RegionShape::Intersection(parts) => Region::Intersection(each(parts, mesh, &site.key("intersection"))?),
        },
    };
    shape.nodes(mesh).map_err(|error| refuse(&error, site))?;
    Ok(shape)
}

fn each(parts: &[RegionFile], mesh: &VolumeMesh, site: &Site) -> Result<Vec<Region>, SceneErrors> {
    parts.iter().enumerate().map(|(index, part)| plain(part, mesh, &site.key(index))).collect()
}

fn point(lengths: [Length; 3]) -> Point {
    lengths.map(|length| length.0).into()
}

fn refuse(error: &RegionError, site: &Site) -> SceneErrors {
    // The first half says what is wrong, the rest what is near.
    let message = error.to_string();
    match message.split_once("; ") {
        Some((problem, near)) => site.error(problem, near),
        None => site.error(message, ""),
    }
}

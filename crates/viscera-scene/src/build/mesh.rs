use viscera::math::{Mat3, Vec3};
use viscera::mesh::{CubeCut, GenerateError, HexMesh, TetMesh, TubeDivisions, VolumeMesh};

use super::site::Site;
use crate::error::SceneErrors;
use crate::file::{BodyFile, CellShape, CutFile, GenerateFile, MeshFile, PlaceFile, SurfaceFile, VolumeFile};

/// More cells than this fit into no ordinary memory: 50 million tetrahedra take about 30 GB.
const MOST_CELLS: f64 = 5e7;

/// A mesh in its place, and what a person should know about where it came from.
#[derive(Clone, Debug)]
pub(super) struct PlacedMesh {
    pub(super) mesh: VolumeMesh,
    pub(super) turn: Mat3<f64>,
    pub(super) notices: Vec<String>,
}

/// Meshes of bodies that were built before: one whose file and place are still the same is not read or made again.
#[derive(Debug, Default)]
pub struct Meshes {
    known: Vec<(MeshFile, Option<PlaceFile>, PlacedMesh)>,
}

impl Meshes {
    pub(super) fn placed(&mut self, body: &BodyFile, site: &Site) -> Result<PlacedMesh, SceneErrors> {
        let known = self.known.iter().find(|(mesh, place, _)| *mesh == body.mesh && *place == body.place);
        if let Some((.., placed)) = known {
            return Ok(placed.clone());
        }
        let placed = mesh(&body.mesh, body.place.as_ref(), site)?;
        self.known.push((body.mesh.clone(), body.place.clone(), placed.clone()));
        Ok(placed)
    }
}

fn mesh(file: &MeshFile, place: Option<&PlaceFile>, body: &Site) -> Result<PlacedMesh, SceneErrors> {
    let site = body.key("mesh");
    let mut notices = Vec::new();
    let mut mesh = match file {
        MeshFile::File(file) => read_volume(file, &site, &mut notices)?,
        MeshFile::Surface(file) => fill_surface(file, &site, &mut notices)?,
        MeshFile::Generate(shape) => generate(shape, &site)?,
    };
    let turn = turn(place, &body.key("place"))?;
    let shift = place.and_then(|place| place.translate).map_or(Vec3::ZERO, |shift| shift.map(|length| length.0).into());
    let nodes = match &mut mesh {
        VolumeMesh::Tet(mesh) => &mut mesh.nodes,
        VolumeMesh::Hex(mesh) => &mut mesh.nodes,
    };
    for node in nodes {
        *node = turn * *node + shift;
    }
    Ok(PlacedMesh { mesh, turn, notices })
}

fn read_volume(file: &VolumeFile, site: &Site, notices: &mut Vec<String>) -> Result<VolumeMesh, SceneErrors> {
    let scale = file.unit.in_metres() * file.scale;
    let key = site.key("file");
    let read = match key.in_memory(&file.file)? {
        Some(bytes) => viscera_io::read_volume_bytes(&file.file, &bytes, scale),
        None => viscera_io::read_volume(site.path(&file.file), scale),
    };
    let read = read.map_err(|error| key.error(error, ""))?;
    notices.extend(read.notices.iter().map(ToString::to_string));
    notices.push(read.report.to_string());
    Ok(read.mesh)
}

fn fill_surface(file: &SurfaceFile, site: &Site, notices: &mut Vec<String>) -> Result<VolumeMesh, SceneErrors> {
    let scale = file.unit.in_metres() * file.scale;
    let key = site.key("surface");
    let read = match key.in_memory(&file.surface)? {
        Some(bytes) => viscera_io::read_mesh_bytes(&file.surface, &bytes, scale),
        None => viscera_io::read_mesh(site.path(&file.surface), scale),
    };
    let read = read.map_err(|error| key.error(error, ""))?;
    let viscera_io::ImportedMesh::Surface(surface) = read.mesh else {
        let advice = "name it with `file` instead, or give a file of triangles (STL, OBJ)";
        return Err(site.key("surface").error("the file holds a volume mesh already", advice));
    };
    notices.extend(read.notices.iter().map(ToString::to_string));
    let (mesh, report) =
        TetMesh::from_surface(&surface, file.edge.0).map_err(|error| site.key("surface").error(error, ""))?;
    notices.push(report.to_string());
    Ok(mesh.into())
}

fn generate(shape: &GenerateFile, site: &Site) -> Result<VolumeMesh, SceneErrors> {
    let refuse = |error: GenerateError| site.error(error, "");
    // Divisions that make edges of about the wanted length.
    let divide = |length: f64, edge: f64| ((length / edge).round() as usize).max(1);
    Ok(match *shape {
        GenerateFile::Box { size, cells, shape, cut } => {
            let size = size.map(|length| length.0);
            if let Some(axis) = (0..3).find(|&axis| size[axis] <= 0.0) {
                let message = format!("a side of the box is {} m, and must be above 0 m", size[axis]);
                return Err(site.key("size").key(axis).error(message, ""));
            }
            allow(cells.iter().map(|&count| f64::from(count)).product::<f64>() * 6.0, &site.key("cells"))?;
            let cells = cells.map(|count| count as usize);
            match (shape, cut) {
                (CellShape::Hexahedra, None) => HexMesh::box_grid(cells, size).into(),
                (CellShape::Hexahedra, Some(_)) => {
                    let message = "`cut` says how cubes become tetrahedra, and this box is made of hexahedra";
                    return Err(site.key("cut").error(message, "leave it out, or take `shape = \"tetrahedra\"`"));
                }
                (CellShape::Tetrahedra, None | Some(CutFile::Six)) => TetMesh::box_grid(cells, size).into(),
                (CellShape::Tetrahedra, Some(CutFile::Five)) => {
                    TetMesh::box_grid_cut(cells, size, CubeCut::Five).into()
                }
            }
        }
        GenerateFile::Cylinder { radius, height, edge } => {
            let volume = std::f64::consts::PI * radius.0.powi(2) * height.0;
            allow(6.0 * volume / edge.0.powi(3), &site.key("edge"))?;
            let (rings, layers) = (divide(radius.0, edge.0), divide(height.0, edge.0));
            TetMesh::cylinder(radius.0, height.0, rings, layers).map_err(refuse)?.into()
        }
        GenerateFile::Tube { inner_radius, outer_radius, height, edge } => {
            let middle = std::f64::consts::PI * (inner_radius.0 + outer_radius.0);
            let wall = outer_radius.0 - inner_radius.0;
            allow(6.0 * middle * wall.abs() * height.0 / edge.0.powi(3), &site.key("edge"))?;
            let divisions = TubeDivisions {
                around: divide(middle, edge.0).max(6),
                wall: divide(wall.max(0.0), edge.0),
                along: divide(height.0, edge.0),
            };
            TetMesh::tube(inner_radius.0, outer_radius.0, height.0, divisions).map_err(refuse)?.into()
        }
        GenerateFile::Trunk { height, edge } => {
            allow(1.7 * (height.0 / edge.0).powi(3), &site.key("edge"))?;
            TetMesh::trunk(height.0, edge.0).map_err(refuse)?.into()
        }
        GenerateFile::Liver { length, edge } => TetMesh::liver(length.0, edge.0).map_err(refuse)?.into(),
    })
}

/// Refuses a mesh of about so many cells before any memory is taken for it.
fn allow(cells: f64, site: &Site) -> Result<(), SceneErrors> {
    if cells <= MOST_CELLS {
        return Ok(());
    }
    let message = format!("this would make about {cells:.1e} cells");
    Err(site.error(message, format!("up to {MOST_CELLS:.0e} can be simulated: take a coarser mesh")))
}

/// The turn of a place, by Rodrigues' formula R = cos θ I + sin θ [a]× + (1 − cos θ) a aᵀ.
fn turn(place: Option<&PlaceFile>, site: &Site) -> Result<Mat3<f64>, SceneErrors> {
    let Some(rotate) = place.and_then(|place| place.rotate.as_ref()) else { return Ok(Mat3::IDENTITY) };
    let Some(axis) = Vec3::from(rotate.axis).normalized() else {
        let message = "the axis has no direction";
        return Err(site.key("rotate").key("axis").error(message, "give any vector that is not zero"));
    };
    let (sin, cos) = rotate.angle.0.sin_cos();
    let column = |unit: [f64; 3]| {
        let unit = Vec3::from(unit);
        unit * cos + axis.cross(unit) * sin + axis * (axis.dot(unit) * (1.0 - cos))
    };
    Ok(Mat3::from_columns(column([1.0, 0.0, 0.0]), column([0.0, 1.0, 0.0]), column([0.0, 0.0, 1.0])))
}

//! A mesh that a user dropped on the page becomes a scene.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use viscera::mesh::Point;
use viscera_io::{ImportedMesh, read_mesh_bytes};
use viscera_scene::{Files, Scene};

use crate::message::{MeshUnit, Refusal};
use crate::refuse;

/// What an organ measures across [m]: the unit of a file without one is the one that comes nearest.
const ORGAN: f64 = 0.15;
/// Cells across a surface that is filled, unless the user says otherwise.
const ACROSS: f64 = 16.0;
/// The most cells that a surface is filled with.
const MOST_CELLS: f64 = 3e5;
/// How much of the height is held, from below.
const HELD: f64 = 0.12;

/// A scene around the mesh: soft, heavy, held where it is lowest.
pub(crate) fn scene(
    name: &str,
    bytes: Vec<u8>,
    unit: Option<MeshUnit>,
    edge: Option<f64>,
) -> Result<(String, Scene), Box<Refusal>> {
    let path = Path::new(name);
    let read = read_mesh_bytes(path, &bytes, 1.0).map_err(|error| refuse::because(error.to_string()))?;
    let (nodes, is_surface) = match &read.mesh {
        ImportedMesh::Tet(mesh) => (&mesh.nodes, false),
        ImportedMesh::Hex(mesh) => (&mesh.nodes, false),
        ImportedMesh::Surface(mesh) => (&mesh.nodes, true),
    };
    let Some((low, high)) = bounds(nodes) else { return Err(refuse::because("the mesh has no nodes")) };
    let size = (high - low).norm();
    if !(size.is_finite() && size > 0.0) {
        return Err(refuse::with_help("all nodes of the mesh lie in one place", "export it again"));
    }
    let unit = unit.unwrap_or_else(|| likely_unit(size));
    let (unit_name, metres) = match unit {
        MeshUnit::Metre => ("m", 1.0),
        MeshUnit::Centimetre => ("cm", 1e-2),
        MeshUnit::Millimetre => ("mm", 1e-3),
    };
    let edge = edge.unwrap_or(size * metres / ACROSS);
    let sides = (high - low) * metres;
    let cells = 6.0 * sides.x * sides.y * sides.z / edge.powi(3);
    if is_surface && !(edge.is_finite() && edge > 0.0 && cells <= MOST_CELLS) {
        let reason = format!("with an edge of {edge} m the mesh would have up to {cells:.0} cells");
        return Err(refuse::with_help(reason, format!("at most {MOST_CELLS:.0} are made: take longer edges")));
    }
    // Names of files have whatever a system allows; the scene calls this one by what tells its format.
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("mesh").to_ascii_lowercase();
    let file = format!("mesh.{}", extension.chars().filter(char::is_ascii_alphanumeric).collect::<String>());
    let (key, more) = if is_surface { ("surface", format!(", edge = {edge}")) } else { ("file", String::new()) };
    let (low, high) = (low * metres, high * metres);
    let lowest = low.y + HELD * (high.y - low.y);
    let room = size * metres;
    let (box_low, box_high) = (low - Point::splat(room), high + Point::splat(room));
    let stem = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("mesh").to_owned();
    let title = serde_json::Value::from(stem.clone());
    let text = format!(
        r#"title = {title}
duration = "10 s"
step = "10 ms"
integrator = {{ kind = "backward-euler" }}

[body.organ]
mesh = {{ {key} = "{file}", unit = "{unit_name}"{more} }}
density = 1060
damping = 2
law = {{ kind = "stable-neo-hookean", young = 5e3, poisson = 0.4 }}
model = {{ kind = "total-lagrangian" }}
fix = {{ box = {{ low = [{}, {}, {}], high = [{}, {lowest}, {}] }} }}
"#,
        box_low.x, box_low.y, box_low.z, box_high.x, box_high.z
    );
    let files = Files::Memory(Arc::new(BTreeMap::from([(file, bytes)])));
    let scene = Scene::parse_with(name, &text, files).map_err(|errors| Box::new(refuse::scene(&errors)))?;
    Ok((stem, scene))
}

fn bounds(nodes: &[Point]) -> Option<(Point, Point)> {
    let first = *nodes.first()?;
    Some(nodes.iter().fold((first, first), |(low, high), &node| (low.min(node), high.max(node))))
}

/// The unit in which something of this size would be nearest to an organ.
fn likely_unit(size: f64) -> MeshUnit {
    let distance = |metres: f64| (size * metres / ORGAN).ln().abs();
    let units = [(MeshUnit::Metre, 1.0), (MeshUnit::Centimetre, 1e-2), (MeshUnit::Millimetre, 1e-3)];
    let nearest = units.into_iter().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    nearest.map_or(MeshUnit::Metre, |(unit, _)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 30 cm, as files of livers have it in each unit.
    #[test]
    fn the_unit_of_a_file_is_that_of_an_organ() {
        assert_eq!(likely_unit(0.3), MeshUnit::Metre);
        assert_eq!(likely_unit(30.0), MeshUnit::Centimetre);
        assert_eq!(likely_unit(300.0), MeshUnit::Millimetre);
    }
}

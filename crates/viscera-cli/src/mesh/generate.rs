//! `viscera mesh generate`.

use std::f64::consts::PI;
use std::path::Path;

use viscera::mesh::{CubeCut, GenerateError, HexMesh, Liver, TetMesh, TubeDivisions, VolumeMesh};
use viscera_io::grouped;

use super::arguments::{CubeParts, ShapeCommand};
use super::writing::{require_known_ending, write_volume};
use crate::failure::Failure;
use crate::terminal::say;

/// More cells than this fit into no ordinary memory: 50 million tetrahedra take about 30 GB.
const MOST_CELLS: f64 = 5e7;

pub(super) fn generate(shape: &ShapeCommand, out: &Path) -> Result<(), Failure> {
    require_known_ending(out)?;
    let mesh = make(shape)?;
    write_volume(out, &mesh)?;
    let (cells, nodes) = (grouped(mesh.cell_count()), grouped(mesh.nodes().len()));
    say(&format!("wrote {}: {cells} cells, {nodes} nodes", out.display()));
    Ok(())
}

fn make(shape: &ShapeCommand) -> Result<VolumeMesh, Failure> {
    let refuse = |error: GenerateError| Failure::input(error);
    // Divisions that make edges of about the wanted length.
    let divide = |length: f64, edge: f64| ((length / edge).round() as usize).max(1);
    Ok(match *shape {
        ShapeCommand::Box { ref size, ref cells, cut } => {
            let size = [size[0], size[1], size[2]];
            allow(cells.iter().map(|&count| f64::from(count)).product::<f64>() * 6.0)?;
            let cells = [cells[0], cells[1], cells[2]].map(|count| count as usize);
            match cut {
                CubeParts::Five => TetMesh::box_grid_cut(cells, size, CubeCut::Five).into(),
                CubeParts::Six => TetMesh::box_grid(cells, size).into(),
                CubeParts::One => HexMesh::box_grid(cells, size).into(),
            }
        }
        ShapeCommand::Cylinder { radius, height, edge } => {
            allow(6.0 * PI * radius * radius * height / edge.powi(3))?;
            TetMesh::cylinder(radius, height, divide(radius, edge), divide(height, edge)).map_err(refuse)?.into()
        }
        ShapeCommand::Tube { inner_radius, outer_radius, height, edge } => {
            let middle = PI * (inner_radius + outer_radius);
            let wall = outer_radius - inner_radius;
            allow(6.0 * middle * wall.abs() * height / edge.powi(3))?;
            let divisions = TubeDivisions {
                around: divide(middle, edge).max(6),
                wall: divide(wall.max(0.0), edge),
                along: divide(height, edge),
            };
            TetMesh::tube(inner_radius, outer_radius, height, divisions).map_err(refuse)?.into()
        }
        ShapeCommand::Trunk { height, edge } => {
            allow(1.7 * (height / edge).powi(3))?;
            TetMesh::trunk(height, edge).map_err(refuse)?.into()
        }
        ShapeCommand::Liver { length, edge, cells } => {
            let edge = match (edge, cells) {
                (Some(edge), _) => edge,
                (None, cells) => {
                    let liver = Liver::new(length).map_err(refuse)?;
                    TetMesh::edge_for_cells(&liver, cells.unwrap_or(0)).map_err(refuse)?
                }
            };
            TetMesh::liver(length, edge).map_err(refuse)?.into()
        }
    })
}

/// Refuses a mesh of about so many cells before any memory is taken for it.
fn allow(cells: f64) -> Result<(), Failure> {
    if cells <= MOST_CELLS {
        return Ok(());
    }
    Err(Failure::input(format!(
        "this would make about {cells:.1e} cells, and up to {MOST_CELLS:.0e} can be simulated: take a longer edge"
    )))
}

//! `viscera mesh info`.

use viscera::mesh::VolumeMesh;
use viscera_io::{ImportedMesh, grouped};

use super::arguments::MeshSource;
use super::order;
use super::writing::regions;
use crate::failure::Failure;
use crate::terminal::{heading, say};
use crate::units::with_prefix;

pub(super) fn info(source: &MeshSource) -> Result<(), Failure> {
    match source.read()? {
        ImportedMesh::Tet(mesh) => volume(source, mesh.into()),
        ImportedMesh::Hex(mesh) => volume(source, mesh.into()),
        ImportedMesh::Surface(mesh) => {
            let report = mesh.check().map_err(|error| source.blame(error))?;
            say(&format!("a surface of triangles\n{report}"));
            Ok(())
        }
    }
}

fn volume(source: &MeshSource, mesh: VolumeMesh) -> Result<(), Failure> {
    let (mesh, report) = source.checked(mesh)?;
    let kind = if matches!(mesh, VolumeMesh::Tet(_)) { "tetrahedra" } else { "hexahedra" };
    let (low, high) = mesh.bounds();
    let size = (high - low).to_array().map(|side| with_prefix(side, "m"));
    let parts = if report.components == 1 { "1 part".to_owned() } else { format!("{} parts", report.components) };
    say(&format!(
        "{} {kind}, {} nodes, {parts}, {:.3} cm³\nfrom {:?} to {:?} m: {} × {} × {}",
        grouped(mesh.cell_count()),
        grouped(mesh.nodes().len()),
        report.volume * 1e6,
        low.to_array(),
        high.to_array(),
        size[0],
        size[1],
        size[2],
    ));
    for remark in report.remarks() {
        say(&remark);
    }
    if let Some(remark) = order::remark(&mesh) {
        say(&format!("{remark}: `viscera mesh convert --reorder` makes steps faster"));
    }
    say(&format!("\n{}", heading("regions")));
    let regions = regions(&mesh);
    if regions.is_empty() {
        say("none");
    }
    let width = regions.iter().map(|region| region.name.chars().count()).max().unwrap_or(0);
    for region in regions {
        let counts = [(region.nodes.len(), "nodes"), (region.faces, "faces"), (region.cells.len(), "cells")];
        let counts: Vec<_> = counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, of)| format!("{} {of}", grouped(*count)))
            .collect();
        say(&format!("{:<width$}  {}", region.name, counts.join(", ")));
    }
    say(&format!("\n{}", heading("quality")));
    match &mesh {
        VolumeMesh::Tet(mesh) => mesh.quality().iter().for_each(|quality| say(&quality.to_string())),
        VolumeMesh::Hex(mesh) => {
            if let Some((jacobian, worst)) = mesh.scaled_jacobians() {
                say(&format!(
                    "scaled Jacobian (1 is a box) from {:.4} (cell {worst}) to {:.4}, mean {:.4}",
                    jacobian.smallest, jacobian.largest, jacobian.mean
                ));
            }
        }
    }
    Ok(())
}

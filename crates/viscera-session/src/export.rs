//! Files to take home.

use std::collections::VecDeque;

use viscera::body::SimulatedBody;
use viscera::math::{Scalar, Vec3};
use viscera::mesh::VolumeMesh;
use viscera::world::{BodyId, World};
use viscera_io::write::{Cells, Encoding, Field, Grid, Table, csv_text, vtu_bytes};

use crate::message::Observables;

/// How many rows of observables are kept: ten minutes at twenty a second.
const ROWS: usize = 12_000;

/// What was observed over time, the last of it.
#[derive(Default)]
pub(crate) struct History {
    rows: VecDeque<Row>,
}

/// What was observed at one time.
pub(crate) struct Row {
    /// When [s].
    pub(crate) time: f64,
    /// Of each body; ghosts come and go, and are no part of it.
    pub(crate) bodies: Vec<Observables>,
    /// Of the tissue on each tool that there was until then, by its number [N].
    pub(crate) forces: Vec<[f64; 3]>,
}

impl History {
    pub(crate) fn push(&mut self, row: Row) {
        // Back to an earlier time: what was later did not happen.
        while self.rows.back().is_some_and(|last| last.time >= row.time) {
            self.rows.pop_back();
        }
        if self.rows.len() == ROWS {
            self.rows.pop_front();
        }
        self.rows.push_back(row);
    }

    pub(crate) fn clear(&mut self) {
        self.rows.clear();
    }

    /// As CSV: time, of each body by its name what was observed, and of each tool by its name what it felt.
    pub(crate) fn csv(&self, bodies: &[String], tools: &[String]) -> String {
        const OF_BODY: [&str; 9] = [
            "kinetic energy [J]",
            "elastic energy [J]",
            "gravity energy [J]",
            "volume variation",
            "largest displacement [m]",
            "cells",
            "inverted cells",
            "worst quality",
            "non-linear nodes",
        ];
        const OF_TOOL: [&str; 3] = ["force x [N]", "force y [N]", "force z [N]"];
        let of_bodies = bodies.iter().flat_map(|name| OF_BODY.map(|column| format!("{name}: {column}")));
        let of_tools = tools.iter().flat_map(|name| OF_TOOL.map(|column| format!("{name}: {column}")));
        let mut table = Table::new(std::iter::once("time [s]".to_owned()).chain(of_bodies).chain(of_tools));
        for Row { time, bodies, forces } in &self.rows {
            let numbers = bodies.iter().flat_map(|body| {
                let counts = [body.cells, body.inverted].map(|count| count as f64);
                [
                    body.kinetic,
                    body.elastic,
                    body.gravity,
                    body.volume_variation,
                    body.largest_displacement,
                    counts[0],
                    counts[1],
                    body.worst_quality,
                    body.nonlinear_nodes as f64,
                ]
            });
            // A tool that came later felt nothing until then.
            let forces = (0..tools.len()).flat_map(|tool| forces.get(tool).copied().unwrap_or_default());
            let row: Vec<f64> = std::iter::once(*time).chain(numbers).chain(forces).collect();
            // Rows of other bodies were dropped when the scene changed.
            let _ = table.push(&row);
        }
        csv_text(&table)
    }
}

/// Every body of a world in one grid, its cells that are left: displacements, volume ratios, stress, and which body.
pub(crate) fn vtu<T: Scalar>(world: &World<T>) -> Result<Vec<u8>, String> {
    let bodies: Vec<&SimulatedBody<T>> = world.body_ids().map(|BodyId(id)| world.body(BodyId(id))).collect();
    let (mut places, mut displacements) = (Vec::new(), Vec::new());
    let (mut tets, mut hexes) = (Vec::new(), Vec::new());
    let (mut ratios, mut stresses, mut owners) = (Vec::new(), Vec::new(), Vec::new());
    for (number, body) in bodies.iter().enumerate() {
        let first = places.len() as u32;
        let now: Vec<Vec3<f64>> = body.positions().iter().map(|place| place.cast()).collect();
        displacements.extend(now.iter().zip(body.mesh().nodes()).map(|(&now, &rest)| now - rest));
        places.extend(now);
        for cell in (0..body.mesh().cell_count()).filter(|&cell| !body.state().removed[cell]) {
            match body.mesh() {
                VolumeMesh::Tet(mesh) => tets.push(mesh.cells[cell].map(|node| node + first)),
                VolumeMesh::Hex(mesh) => hexes.push(mesh.cells[cell].map(|node| node + first)),
            }
            ratios.push(body.volume_ratio(cell));
            stresses.push(body.von_mises_stress(cell));
            owners.push(number as i32);
        }
    }
    let cells = match (tets.is_empty(), hexes.is_empty()) {
        (_, true) => Cells::Tet(&tets),
        (true, false) => Cells::Hex(&hexes),
        (false, false) => return Err("bodies of tetrahedra and of hexahedra do not go into one file".into()),
    };
    let grid = Grid::new(&places, cells)
        .with_point_data(Field::vector("displacement [m]", &displacements))
        .with_cell_data(Field::scalar("volume ratio", &ratios))
        .with_cell_data(Field::scalar("von Mises stress [Pa]", &stresses))
        .with_cell_data(Field::label("body", &owners));
    vtu_bytes(&grid, Encoding::Base64).map_err(|error| error.to_string())
}

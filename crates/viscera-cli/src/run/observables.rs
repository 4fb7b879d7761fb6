//! Observables over time as CSV: one row for each step, and at most so many rows that they stay readable.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use viscera::body::KeptVolumeNow;
use viscera::math::{Scalar, Vec3};
use viscera::world::{BodyObservables, InstrumentObservables};
use viscera_io::write::{Table, WriteError, write_csv};
use viscera_scene::BuiltScene;

use super::folder::Folder;

/// A run of more steps than this has a row for every second, third, … step, and for its last moment.
const MOST_ROWS: u64 = 20_000;

/// What was measured at one moment, in the order of the scene.
#[derive(Debug, Default)]
pub(super) struct Measured {
    pub(super) bodies: Vec<BodyObservables>,
    /// The volumes that each body keeps exactly.
    pub(super) volumes: Vec<Vec<KeptVolumeNow>>,
    pub(super) instruments: Vec<InstrumentObservables>,
}

/// The rows of the table, as a checkpoint keeps them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Kept {
    rows: Vec<f64>,
    pending: Option<Vec<f64>>,
    written_rows: usize,
}

/// The table that grows.
pub(super) struct Observables {
    file: PathBuf,
    table: Table,
    last: Measured,
    /// Steps from one row to the next.
    stride: u64,
    /// The row of the last moment, where it is not in the table yet.
    pending: Option<Vec<f64>>,
    /// Whether the step that was measured last has a row.
    is_due: bool,
    written_rows: usize,
}

/// The columns of a body: their names with units, and what stands in them.
fn body_columns(of: &BodyObservables) -> Vec<(&'static str, f64)> {
    let mut columns = vec![
        ("kinetic energy [J]", of.kinetic_energy),
        ("elastic energy [J]", of.elastic_energy),
        ("gravity energy [J]", of.gravity_energy),
        ("mass [kg]", of.mass),
        ("volume [m^3]", of.volume),
        ("volume variation [1]", of.volume_variation),
        ("volume error [1]", of.volume_error),
        ("max displacement [m]", of.max_displacement),
    ];
    columns.extend(vector(["momentum x [kg m/s]", "momentum y [kg m/s]", "momentum z [kg m/s]"], of.momentum));
    columns.extend(vector(["reaction x [N]", "reaction y [N]", "reaction z [N]"], of.reaction));
    columns.extend(vector(
        ["net internal force x [N]", "net internal force y [N]", "net internal force z [N]"],
        of.net_internal_force,
    ));
    columns.extend(vector(
        ["net internal torque x [N m]", "net internal torque y [N m]", "net internal torque z [N m]"],
        of.net_internal_torque,
    ));
    columns.extend([
        ("removed cells [1]", of.removed_cells as f64),
        ("inverted cells [1]", of.inverted_cells as f64),
        ("worst quality [1]", of.worst_quality),
        ("non-linear nodes [1]", of.nonlinear_nodes as f64),
        ("at rest [1]", f64::from(u8::from(of.at_rest))),
    ]);
    columns.extend(of.interface_residual.map(|residual| ("interface residual [1]", residual)));
    columns
}

/// The columns of volumes that are kept exactly: one closed surface after the other.
fn volume_columns(of: &KeptVolumeNow) -> [(String, f64); 3] {
    let name = |what: &str| format!("{}: {what}", of.name);
    [(name("kept volume [m^3]"), of.wanted), (name("volume error [1]"), of.error), (name("pressure [Pa]"), of.pressure)]
}

/// The columns of an instrument.
fn instrument_columns(of: &InstrumentObservables) -> Vec<(&'static str, f64)> {
    let mut columns = vector(["tip x [m]", "tip y [m]", "tip z [m]"], of.tip).to_vec();
    columns.extend(vector(["force x [N]", "force y [N]", "force z [N]"], of.force));
    columns.extend([("held nodes [1]", of.held_nodes as f64), ("at work [1]", f64::from(u8::from(of.active)))]);
    columns
}

fn vector(names: [&'static str; 3], value: Vec3<f64>) -> [(&'static str, f64); 3] {
    let [x, y, z] = value.to_array();
    [(names[0], x), (names[1], y), (names[2], z)]
}

impl Observables {
    pub(super) fn new<T: Scalar>(folder: &Folder, built: &mut BuiltScene<T>) -> Self {
        let measured = measure(built);
        let names = built.bodies.keys().chain(built.instruments.keys());
        let columns = measured.columns();
        let of_things = names
            .zip(&columns)
            .flat_map(|(name, columns)| columns.iter().map(move |(column, _)| format!("{name}: {column}")));
        let header = ["time [s]".to_owned(), "sub-steps [1]".to_owned()].into_iter().chain(of_things);
        Self {
            file: folder.file("observables.csv"),
            table: Table::new(header),
            last: Measured::default(),
            stride: built.steps().div_ceil(MOST_ROWS),
            pending: None,
            is_due: false,
            written_rows: 0,
        }
    }

    /// The table of a run that goes on with these rows in it, so many of them in the file; the file is written with just these.
    pub(super) fn going_on<T: Scalar>(
        folder: &Folder,
        built: &mut BuiltScene<T>,
        kept: Kept,
    ) -> Result<Self, WriteError> {
        let mut observables = Self::new(folder, built);
        for row in kept.rows.chunks(observables.table.header().len()) {
            observables.table.push(row)?;
        }
        observables.pending = kept.pending;
        observables.write()?;
        observables.written_rows = kept.written_rows;
        Ok(observables)
    }

    /// What a checkpoint has to keep.
    pub(super) fn kept(&self) -> Kept {
        let rows = self.table.rows().flatten().copied().collect();
        Kept { rows, pending: self.pending.clone(), written_rows: self.written_rows }
    }

    /// Rows in the file, and the time of the last one [s].
    pub(super) fn written(&self) -> Option<(usize, f64)> {
        let last = self.table.rows().nth(self.written_rows.checked_sub(1)?)?;
        Some((self.written_rows, last[0]))
    }

    /// What was measured last.
    pub(super) fn last(&self) -> &Measured {
        &self.last
    }

    /// Measures the moment after `step` steps, the last of `substeps` sub-steps.
    pub(super) fn measure<T: Scalar>(&mut self, built: &mut BuiltScene<T>, step: u64, substeps: u32) {
        self.last = measure(built);
        let mut row = vec![built.world.time(), f64::from(substeps)];
        row.extend(self.last.columns().into_iter().flatten().map(|(_, value)| value));
        self.pending = Some(row);
        self.is_due = step.is_multiple_of(self.stride);
    }

    /// Takes what was measured into the table, where its step has a row. The file is written anew whenever it has grown by a
    /// quarter, so that a run that is killed leaves most of it and a long one does not write the same rows again and again.
    pub(super) fn write_if_due(&mut self) -> Result<(), WriteError> {
        if std::mem::take(&mut self.is_due) {
            self.take_pending()?;
            if 4 * self.table.row_count() > 5 * self.written_rows {
                self.write()?;
            }
        }
        Ok(())
    }

    fn take_pending(&mut self) -> Result<(), WriteError> {
        self.pending.take().map_or(Ok(()), |row| self.table.push(&row))
    }

    /// Writes all rows, and that of the last moment.
    pub(super) fn finish(&mut self) -> Result<(), WriteError> {
        self.take_pending()?;
        self.write()
    }

    /// Writes all rows.
    fn write(&mut self) -> Result<(), WriteError> {
        write_csv(&self.file, &self.table)?;
        self.written_rows = self.table.row_count();
        Ok(())
    }
}

impl Measured {
    /// The columns of each body, then of each instrument.
    fn columns(&self) -> Vec<Vec<(String, f64)>> {
        let owned = |(name, value): (&str, f64)| (name.to_owned(), value);
        let of_body = |(body, volumes): (&BodyObservables, &Vec<KeptVolumeNow>)| {
            body_columns(body).into_iter().map(owned).chain(volumes.iter().flat_map(volume_columns)).collect()
        };
        let bodies = self.bodies.iter().zip(&self.volumes).map(of_body);
        let instruments = self.instruments.iter().map(|of| instrument_columns(of).into_iter().map(owned).collect());
        bodies.chain(instruments).collect()
    }
}

fn measure<T: Scalar>(built: &mut BuiltScene<T>) -> Measured {
    let world = &mut built.world;
    Measured {
        bodies: built.bodies.values().map(|&id| world.observe(id)).collect(),
        volumes: built.bodies.values().map(|&id| world.body(id).kept_volumes().collect()).collect(),
        instruments: built.instruments.values().map(|&id| world.observe_instrument(id)).collect(),
    }
}

//! How the equilibria of a quasi-static run were found, as CSV: a row for each residual.

use std::path::PathBuf;

use viscera::math::Scalar;
use viscera::world::Integrator;
use viscera_io::write::{Table, WriteError, write_csv};
use viscera_scene::BuiltScene;

use super::folder::Folder;

/// Its name in the folder of results.
pub(super) const FILE: &str = "equilibria.csv";
/// A run of more steps than this has rows for every second, third, … step.
const MOST_STEPS: u64 = 5_000;

/// The table that grows.
pub(super) struct Equilibria {
    file: PathBuf,
    table: Table,
    /// Steps from one that has rows to the next.
    stride: u64,
    written_rows: usize,
}

impl Equilibria {
    /// The table of a quasi-static scene; none of another.
    pub(super) fn of<T: Scalar>(folder: &Folder, built: &BuiltScene<T>) -> Option<Self> {
        let Integrator::QuasiStatic(_) = built.world.config().integrator else { return None };
        let numbered: Vec<_> =
            built.bodies.keys().enumerate().map(|(number, name)| format!("{number} {name}")).collect();
        let body = format!("body [{}]", numbered.join("; "));
        let header = ["time [s]", &body, "share of the load [1]", "iteration [1]", "residual [1]"];
        Some(Self {
            file: folder.file(FILE),
            table: Table::new(header.map(str::to_owned)),
            stride: built.steps().div_ceil(MOST_STEPS),
            written_rows: 0,
        })
    }

    /// The table of a run that goes on with these rows in it.
    pub(super) fn going_on<T: Scalar>(
        folder: &Folder,
        built: &BuiltScene<T>,
        kept: &[f64],
    ) -> Result<Option<Self>, WriteError> {
        let Some(mut equilibria) = Self::of(folder, built) else { return Ok(None) };
        for row in kept.chunks(equilibria.table.header().len()) {
            equilibria.table.push(row)?;
        }
        equilibria.write()?;
        Ok(Some(equilibria))
    }

    /// What a checkpoint has to keep.
    pub(super) fn kept(&self) -> Vec<f64> {
        self.table.rows().flatten().copied().collect()
    }

    /// Takes the residuals of step number `step` into the table. The file is written anew whenever it has grown by a quarter.
    pub(super) fn record<T: Scalar>(&mut self, built: &BuiltScene<T>, step: u64) -> Result<(), WriteError> {
        if !step.is_multiple_of(self.stride) {
            return Ok(());
        }
        for (number, &id) in built.bodies.values().enumerate() {
            let steps = built.world.body(id).static_report().map_or(&[][..], |report| &report.steps);
            for load in steps {
                for (iteration, &residual) in load.residuals.iter().enumerate() {
                    self.table.push(&[built.world.time(), number as f64, load.share, iteration as f64, residual])?;
                }
            }
        }
        if 4 * self.table.row_count() > 5 * self.written_rows { self.write() } else { Ok(()) }
    }

    /// Writes all rows.
    pub(super) fn write(&mut self) -> Result<(), WriteError> {
        write_csv(&self.file, &self.table)?;
        self.written_rows = self.table.row_count();
        Ok(())
    }
}

use std::io::{self, Write};
use std::path::Path;

use super::{WriteError, write_atomically};

/// Columns of numbers with a header: observables over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    header: Vec<String>,
    values: Vec<f64>,
}

impl Table {
    /// A table without rows. Say units in the header: `time [s]`.
    pub fn new(header: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { header: header.into_iter().map(Into::into).collect(), values: Vec::new() }
    }

    /// Names of the columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// How many rows there are.
    pub fn row_count(&self) -> usize {
        self.values.len() / self.header.len().max(1)
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.header.len().max(1))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`WriteError::RowLength`] if there is not one value for each column.
    pub fn push(&mut self, row: &[f64]) -> Result<(), WriteError> {
        if row.len() != self.header.len() {
            return Err(WriteError::RowLength { row: self.row_count(), expected: self.header.len(), found: row.len() });
        }
        self.values.extend_from_slice(row);
        Ok(())
    }
}

/// Writes a table as CSV (RFC 4180): a header, then one row to a line, every number with as many digits as bring back the
/// same bits.
///
/// # Errors
/// [`WriteError::Unwritable`].
pub fn write_csv(path: impl AsRef<Path>, table: &Table) -> Result<(), WriteError> {
    write_atomically(path, |out| write_table(out, table))
}

/// The same text in memory.
pub fn csv_text(table: &Table) -> String {
    let mut bytes = Vec::new();
    // Writing into memory does not fail, and numbers and names are text.
    let _ = write_table(&mut bytes, table);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn write_table(out: &mut impl Write, table: &Table) -> io::Result<()> {
    write_line(out, table.header.iter().map(|name| quoted(name)))?;
    table.rows().try_for_each(|row| write_line(out, row.iter().map(f64::to_string)))
}

fn write_line(out: &mut impl Write, mut cells: impl Iterator<Item = String>) -> io::Result<()> {
    if let Some(first) = cells.next() {
        write!(out, "{first}")?;
    }
    cells.try_for_each(|cell| write!(out, ",{cell}"))?;
    writeln!(out)
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

use std::io::Write;
use std::path::Path;

use viscera_io::write::{WriteError, write_atomically};

use super::case::Row;

/// Writes the rows that are there, in the order of the cases, as CSV (RFC 4180).
pub(super) fn write(path: &Path, rows: &[Option<Row>]) -> Result<(), WriteError> {
    // A case that failed has fewer columns than one that was measured.
    let longest = rows.iter().flatten().max_by_key(|row| row.columns.len());
    let Some(header) = longest.map(|row| row.columns.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>()) else {
        return Ok(());
    };
    write_atomically(path, |out| {
        line(out, header.iter().map(String::as_str))?;
        rows.iter().flatten().try_for_each(|row| {
            let texts = row.columns.iter().map(|(_, text)| text.as_str());
            line(out, texts.chain(std::iter::repeat("")).take(header.len()))
        })
    })
}

fn line<'a>(out: &mut impl Write, cells: impl Iterator<Item = &'a str>) -> std::io::Result<()> {
    let cells: Vec<_> = cells.map(quoted).collect();
    writeln!(out, "{}", cells.join(","))
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

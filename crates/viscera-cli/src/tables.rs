//! Tables on the screen.

use comfy_table::{CellAlignment, Table, presets};

use crate::terminal::heading;

/// A table without frames, numbers to the right.
pub(crate) fn table(head: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING);
    table.set_header(head);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    for column in table.column_iter_mut() {
        column.set_padding((0, 2));
    }
    table
}

/// The text of a table, its head standing out. The head is marked last: escape codes would count as letters of a column.
pub(crate) fn table_text(table: &Table) -> String {
    let text = table.trim_fmt();
    match text.split_once('\n') {
        Some((head, rows)) => format!("{}\n{rows}", heading(head)),
        None => text,
    }
}

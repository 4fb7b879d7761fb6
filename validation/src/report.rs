//! Pages with tables and plots.

use std::fmt::Write as _;
use std::path::Path;

use crate::ValidationError;
use crate::plot::Plot;

/// What a study found, ready to be written.
#[derive(Clone, Debug)]
pub struct Report {
    title: &'static str,
    blocks: Vec<Block>,
}

/// A part of a page.
#[derive(Clone, Debug)]
pub enum Block {
    /// Paragraphs; a line that begins with `##` is a heading.
    Text(String),
    /// A table.
    Table(Table),
    /// A table in a file of its own, too long for the page.
    Data(Table),
    /// Curves.
    Plot(Plot),
}

/// A table with a name, which is that of its CSV file.
#[derive(Clone, Debug)]
pub struct Table {
    name: &'static str,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with its columns; the name is that of its CSV file.
    pub fn new(name: &'static str, head: &[&str]) -> Self {
        Self { name, head: head.iter().map(|&title| title.to_owned()).collect(), rows: Vec::new() }
    }

    /// Adds a row. Panics where it has not as many entries as there are columns.
    pub fn push(&mut self, row: Vec<String>) {
        assert_eq!(row.len(), self.head.len(), "a row of {} has as many entries as its head", self.name);
        self.rows.push(row);
    }

    /// The name of its CSV file, without the ending.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The titles of the columns.
    pub fn head(&self) -> &[String] {
        &self.head
    }

    /// The rows, with as many entries as there are columns.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        self.rows.iter().fold(line(&self.head) + &rule, |text, row| text + &line(row))
    }

    /// The table as CSV.
    pub fn csv(&self) -> String {
        let cell = |text: &String| if text.contains(',') { format!("\"{text}\"") } else { text.clone() };
        let line = |cells: &[String]| cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        self.rows.iter().fold(line(&self.head), |text, row| text + &line(row))
    }
}

impl Report {
    pub(crate) fn new(title: &'static str) -> Self {
        Self { title, blocks: Vec::new() }
    }

    pub(crate) fn text(mut self, text: impl Into<String>) -> Self {
        self.blocks.push(Block::Text(text.into()));
        self
    }

    pub(crate) fn table(mut self, table: Table) -> Self {
        self.blocks.push(Block::Table(table));
        self
    }

    pub(crate) fn data(mut self, table: Table) -> Self {
        self.blocks.push(Block::Data(table));
        self
    }

    pub(crate) fn plot(mut self, plot: Plot) -> Self {
        self.blocks.push(Block::Plot(plot));
        self
    }

    /// Its parts, from top to bottom.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Writes `README.md` with its tables and plots to `folder`, and gives the text of the page.
    ///
    /// # Errors
    /// [`ValidationError::File`], [`ValidationError::Plot`].
    pub fn write(&self, folder: &Path) -> Result<String, ValidationError> {
        std::fs::create_dir_all(folder).map_err(|error| ValidationError::File { path: folder.into(), error })?;
        let mut page = format!("# {}\n", self.title);
        for block in &self.blocks {
            page.push('\n');
            match block {
                Block::Text(text) => {
                    let _ = writeln!(page, "{text}");
                }
                Block::Table(table) => {
                    write_aside(folder, &format!("{}.csv", table.name), &table.csv())?;
                    page.push_str(&table.markdown());
                }
                Block::Data(table) => {
                    let file = format!("{}.csv", table.name);
                    write_aside(folder, &file, &table.csv())?;
                    let _ = writeln!(page, "All {} of them: [{file}]({file}).", table.rows.len());
                }
                Block::Plot(plot) => {
                    write_aside(folder, &format!("{}.svg", plot.name), &plot.svg()?)?;
                    let _ = writeln!(page, "![{}]({}.svg)", plot.title, plot.name);
                }
            }
        }
        write_aside(folder, "README.md", &page)?;
        Ok(page)
    }
}

/// Writes a file beside its place and moves it there when it is whole.
fn write_aside(folder: &Path, name: &str, text: &str) -> Result<(), ValidationError> {
    let (path, part) = (folder.join(name), folder.join(format!("{name}.part")));
    let written = std::fs::write(&part, text).and_then(|()| std::fs::rename(&part, &path));
    written.map_err(|error| ValidationError::File { path, error })
}

/// A number to three digits.
pub fn brief(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e3..1e6).contains(&size) => format!("{value:.0}"),
        size if (0.01..1e3).contains(&size) => {
            let digits = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.1e}"),
    }
}

/// A ratio to four decimals.
pub(crate) fn ratio(value: f64) -> String {
    format!("{value:.4}")
}

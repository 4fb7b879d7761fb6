use std::io::Write;
use std::path::{Path, PathBuf};

use super::vtu::{Encoding, Grid, escaped, write_vtu};
use super::{WriteError, write_atomically};

/// A series of moments for ParaView: a collection (.pvd) that names the file of every moment.
///
/// The collection is written anew with every moment, so ParaView can open it while the simulation runs, and what was
/// computed is not lost when it is stopped.
#[derive(Clone, Debug)]
pub struct TimeSeries {
    path: PathBuf,
    /// Time [s], number of the part, file.
    moments: Vec<(f64, usize, String)>,
}

impl TimeSeries {
    /// A series without moments; nothing is written yet.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), moments: Vec::new() }
    }

    /// A series that goes on from moments whose files are there already, one for each part; the collection is written with
    /// just these.
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn going_on(
        path: impl Into<PathBuf>,
        moments: impl IntoIterator<Item = (f64, Vec<PathBuf>)>,
    ) -> Result<Self, WriteError> {
        let mut series = Self::new(path);
        for (time, files) in moments {
            series.note(time, &files)?;
        }
        series.write_collection()?;
        Ok(series)
    }

    /// Writes the next moment: `name.pvd` gets `name-000000.vtu`, `name-000001.vtu` and so on, in its own folder.
    ///
    /// # Errors
    /// As [`write_vtu`].
    pub fn write(&mut self, time: f64, grid: &Grid, encoding: Encoding) -> Result<PathBuf, WriteError> {
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let file = self.path.with_file_name(format!("{stem}-{:06}.vtu", self.moments.len()));
        write_vtu(&file, grid, encoding)?;
        self.add(time, &file)?;
        Ok(file)
    }

    /// Adds a file that is already written, in the folder of the collection or below it, as the moment `time` [s].
    ///
    /// # Errors
    /// [`WriteError::OutsideFolder`], or [`WriteError::Unwritable`] for the collection.
    pub fn add(&mut self, time: f64, file: &Path) -> Result<(), WriteError> {
        self.add_parts(time, &[file])
    }

    /// Adds one moment that has several files, such as one for each body: ParaView shows them together, as parts 0, 1, …
    ///
    /// # Errors
    /// As [`add`](Self::add).
    pub fn add_parts(&mut self, time: f64, files: &[impl AsRef<Path>]) -> Result<(), WriteError> {
        self.note(time, files)?;
        self.write_collection()
    }

    fn note(&mut self, time: f64, files: &[impl AsRef<Path>]) -> Result<(), WriteError> {
        for (part, file) in files.iter().enumerate() {
            let file = self.relative(file.as_ref())?;
            self.moments.push((time, part, file));
        }
        Ok(())
    }

    fn write_collection(&self) -> Result<(), WriteError> {
        write_atomically(&self.path, |out| {
            writeln!(out, "<?xml version=\"1.0\"?>")?;
            writeln!(out, "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>")?;
            for (time, part, file) in &self.moments {
                let file = escaped(file);
                writeln!(out, "<DataSet timestep=\"{time}\" group=\"\" part=\"{part}\" file=\"{file}\"/>")?;
            }
            writeln!(out, "</Collection>\n</VTKFile>")
        })
    }

    /// The name of a file as seen from the folder of the collection.
    fn relative(&self, file: &Path) -> Result<String, WriteError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let relative = file
            .strip_prefix(folder)
            .map_err(|_| WriteError::OutsideFolder { file: file.to_owned(), collection: self.path.clone() })?;
        Ok(relative.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/"))
    }
}

//! The series for ParaView: one VTU for each body and frame, one PVD over all of them.

use std::fs;
use std::path::{Path, PathBuf};

use viscera::body::SimulatedBody;
use viscera::math::{Scalar, Vec3};
use viscera::mesh::{Point, VolumeMesh};
use viscera_io::write::{Cells, Encoding, Field, Grid, TimeSeries, Values, WriteError, write_vtu};
use viscera_scene::BuiltScene;
use viscera_scene::file::Precision;

use super::folder::Folder;
use crate::failure::Failure;

/// The frames of a run.
pub(super) struct Frames {
    series: TimeSeries,
    /// Where the files of each body go, without number and ending.
    stems: Vec<PathBuf>,
    interval: f64,
    precision: Precision,
    /// When the frames were that are written [s].
    times: Vec<f64>,
}

impl Frames {
    pub(super) fn new<T: Scalar>(folder: &Folder, built: &BuiltScene<T>) -> Self {
        let names = file_names(built.bodies.keys().map(String::as_str));
        Self {
            series: TimeSeries::new(folder.file("bodies.pvd")),
            stems: names.iter().map(|name| folder.file("frames").join(name)).collect(),
            interval: built.file.output.interval.0,
            precision: built.file.precision,
            times: Vec::new(),
        }
    }

    /// The frames of a run that goes on after those of these times.
    pub(super) fn going_on<T: Scalar>(
        folder: &Folder,
        built: &BuiltScene<T>,
        times: Vec<f64>,
    ) -> Result<Self, Failure> {
        let mut frames = Self::new(folder, built);
        let moments: Vec<_> = times.iter().enumerate().map(|(number, &time)| (time, frames.files(number))).collect();
        if let Some(missing) = moments.iter().flat_map(|(_, files)| files).find(|file| !file.is_file()) {
            return Err(Failure::input(format!(
                "{}: this frame was written before the checkpoint and is gone; put it back, or run without --resume to begin anew",
                missing.display()
            )));
        }
        frames.series = TimeSeries::going_on(folder.file("bodies.pvd"), moments).map_err(Failure::problem)?;
        frames.times = times;
        Ok(frames)
    }

    /// How many frames were written.
    pub(super) fn count(&self) -> usize {
        self.times.len()
    }

    /// When the frames were that are written [s].
    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    /// The files of a frame, one for each body.
    fn files(&self, number: usize) -> Vec<PathBuf> {
        let file = |stem: &PathBuf| {
            let mut file = stem.clone().into_os_string();
            file.push(format!("-{number:06}.vtu"));
            PathBuf::from(file)
        };
        self.stems.iter().map(file).collect()
    }

    /// Whether the time of the next frame has come. An interval below the step takes every step.
    pub(super) fn is_due<T: Scalar>(&self, built: &BuiltScene<T>) -> bool {
        // Frame n belongs to n intervals; a thousandth of a step is for rounding.
        let due = self.count() as f64 * self.interval;
        self.times.last().is_none_or(|&last| last < built.world.time())
            && built.world.time() >= due - 1e-3 * built.world.config().step
    }

    /// Whether the present moment is written.
    pub(super) fn is_up_to_date<T: Scalar>(&self, built: &BuiltScene<T>) -> bool {
        self.times.last() == Some(&built.world.time())
    }

    /// Writes the present moment.
    pub(super) fn write<T: Scalar>(&mut self, built: &BuiltScene<T>) -> Result<(), WriteError> {
        let files = self.files(self.count());
        let time = built.world.time();
        let mut bodies = built.bodies.values().zip(&files);
        bodies
            .try_for_each(|(&id, file)| write_body(built.world.body(id), self.precision, file))
            .and_then(|()| self.series.add_parts(time, &files))
            .inspect_err(|_| {
                // A frame is whole or not there; of those of its files that were not written there is nothing to remove.
                files.iter().for_each(|file| drop(fs::remove_file(file)));
            })?;
        self.times.push(time);
        Ok(())
    }
}

/// Names that every system takes for files, each another one.
fn file_names<'a>(bodies: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for body in bodies {
        let plain: String = body
            .chars()
            .map(|letter| if letter.is_alphanumeric() || "-_".contains(letter) { letter } else { '_' })
            .collect();
        let mut name = plain.clone();
        let mut number = 2;
        while names.contains(&name) {
            name = format!("{plain}_{number}");
            number += 1;
        }
        names.push(name);
    }
    names
}

fn write_body<T: Scalar>(body: &SimulatedBody<T>, precision: Precision, file: &Path) -> Result<(), WriteError> {
    let state = body.state();
    let rest = body.mesh().nodes();
    let positions: Vec<Point> = state.positions.iter().map(|place| place.cast()).collect();
    let displacements = positions.iter().zip(rest).map(|(&now, &rest)| now - rest);
    let point_data = [
        ("displacement [m]", Numbers::vectors(precision, displacements)),
        ("velocity [m/s]", Numbers::vectors(precision, state.velocities.iter().map(|v| v.cast()))),
        ("internal force [N]", Numbers::vectors(precision, state.internal_forces.iter().map(|f| f.cast()))),
    ];
    let left: Vec<usize> = (0..body.mesh().cell_count()).filter(|&cell| !state.removed[cell]).collect();
    let numbers: Vec<i32> = left.iter().map(|&cell| cell as i32).collect();
    let cell_data = [
        ("volume ratio", Numbers::scalars(precision, left.iter().map(|&cell| body.volume_ratio(cell)))),
        ("equivalent strain", Numbers::scalars(precision, left.iter().map(|&cell| body.equivalent_strain(cell)))),
    ];
    let write = |cells: Cells| {
        let mut grid = Grid::new(&positions, cells);
        grid.point_data.extend(point_data.iter().map(|(name, numbers)| numbers.field(name, 3)));
        grid.cell_data.extend(cell_data.iter().map(|(name, numbers)| numbers.field(name, 1)));
        grid.cell_data.push(Field::label("cell number", &numbers));
        write_vtu(file, &grid, Encoding::Raw)
    };
    match body.mesh() {
        VolumeMesh::Tet(mesh) => write(Cells::Tet(&left.iter().map(|&cell| mesh.cells[cell]).collect::<Vec<_>>())),
        VolumeMesh::Hex(mesh) => write(Cells::Hex(&left.iter().map(|&cell| mesh.cells[cell]).collect::<Vec<_>>())),
    }
}

/// Values in the precision of the run: no more digits than were computed.
enum Numbers {
    Single(Vec<f32>),
    Double(Vec<f64>),
}

impl Numbers {
    fn scalars(precision: Precision, values: impl Iterator<Item = f64>) -> Self {
        match precision {
            Precision::Single => Self::Single(values.map(|value| value as f32).collect()),
            Precision::Double => Self::Double(values.collect()),
        }
    }

    fn vectors(precision: Precision, values: impl Iterator<Item = Vec3<f64>>) -> Self {
        Self::scalars(precision, values.flat_map(Vec3::to_array))
    }

    fn field<'a>(&'a self, name: &'a str, components: usize) -> Field<'a> {
        let values = match self {
            Self::Single(values) => Values::F32(values),
            Self::Double(values) => Values::F64(values),
        };
        Field { name, components, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_of_any_name_get_files_of_their_own() {
        assert_eq!(file_names(["a/b", "a b", "leber-1", "a_b_2"].into_iter()), ["a_b", "a_b_2", "leber-1", "a_b_2_2"]);
    }
}

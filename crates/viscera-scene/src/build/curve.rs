use viscera::curve::{Curve, CurveValue};
use viscera::math::Vec3;

use super::csv;
use super::site::Site;
use crate::error::SceneErrors;
use crate::file::CurveFile;
use crate::quantity::{Force, ForceDensity, Length, Pressure, Quantity};
use crate::unit::{Dimension, TIME};

/// A value of a curve as it stands in a scene.
pub(super) trait Written: Copy {
    type Plain: CurveValue;
    const DIMENSIONS: &'static [Option<&'static Dimension>];
    fn plain(self) -> Self::Plain;
    /// From columns of a file, time first.
    fn from_row(row: &[f64]) -> Self::Plain;
}

impl<Q: Quantity> Written for [Q; 3] {
    type Plain = Vec3<f64>;
    const DIMENSIONS: &'static [Option<&'static Dimension>] =
        &[Some(&TIME), Some(Q::DIMENSION), Some(Q::DIMENSION), Some(Q::DIMENSION)];
    fn plain(self) -> Vec3<f64> {
        self.map(Q::si).into()
    }
    fn from_row(row: &[f64]) -> Vec3<f64> {
        Vec3::new(row[1], row[2], row[3])
    }
}

macro_rules! written {
    ($($quantity:ty),+) => {$(
        impl Written for $quantity {
            type Plain = f64;
            const DIMENSIONS: &'static [Option<&'static Dimension>] = &[Some(&TIME), Some(<$quantity>::DIMENSION)];
            fn plain(self) -> f64 {
                self.0
            }
            fn from_row(row: &[f64]) -> f64 {
                row[1]
            }
        }
    )+};
}

written!(Length, Pressure, Force, ForceDensity);

impl Written for f64 {
    type Plain = Self;
    const DIMENSIONS: &'static [Option<&'static Dimension>] = &[Some(&TIME), None];
    fn plain(self) -> Self {
        self
    }
    fn from_row(row: &[f64]) -> Self {
        row[1]
    }
}

pub(super) fn curve<V: Written>(file: &CurveFile<V>, site: &Site) -> Result<Curve<V::Plain>, SceneErrors> {
    let points = match file {
        CurveFile::Constant(value) => return Ok(Curve::constant(value.plain())),
        CurveFile::Keyed(points) => points.iter().map(|(time, value)| (time.0, value.plain())).collect(),
        CurveFile::File(path) => {
            let rows = csv::read(&site.key("file"), &path.file, V::DIMENSIONS)?;
            rows.iter().map(|row| (row[0], V::from_row(row))).collect()
        }
    };
    Curve::piecewise_linear(points).map_err(|error| site.error(error, "give the times in ascending order"))
}

use std::path::Path;

use serde::Deserialize;

use crate::Failure;

/// What a driver needs of `case.toml`; the rest is for the comparison.
#[derive(Clone, Debug, Deserialize)]
pub struct Case {
    /// The beam.
    pub beam: Beam,
    /// What it is made of.
    pub tissue: Tissue,
    /// What stops a motion.
    pub settle: Settle,
    /// How steps are chosen.
    pub step: Step,
}

/// The beam.
#[derive(Clone, Debug, Deserialize)]
pub struct Beam {
    /// Size along the axes [m]; the end at z = 0 is held.
    pub size: [f64; 3],
    /// Cubes along the axes.
    pub meshes: Vec<[usize; 3]>,
    /// Gravity [m/s²].
    pub gravity: [f64; 3],
}

/// An isotropic material.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Tissue {
    /// Young's modulus [Pa].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density [kg/m³].
    pub density: f64,
}

/// What stops a motion.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Settle {
    /// Rate of mass damping [1/s].
    pub damping: f64,
}

/// How steps are chosen.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Step {
    /// The longest step [s].
    pub longest: f64,
}

impl Case {
    /// Reads it.
    ///
    /// # Errors
    /// Where there is no such file, or it does not say what it should.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(toml::from_str(&text)?)
    }
}

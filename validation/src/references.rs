//! The reference cases, and the meshes that they name.

use std::path::Path;

use serde_json::Value;
use viscera::math::Vec3;
use viscera::mesh::VolumeMesh;

use crate::ValidationError;

pub(crate) type Vector = Vec3<f64>;

macro_rules! reference {
    ($file:literal) => {
        include_str!(concat!("../../crates/viscera/tests/data/references/", $file))
    };
}

pub(crate) const CLAMPED_BEAM: &str = reference!("C01_nesme_beam_40x4x2.json");
pub(crate) const TRUTH_CUBE: &str = reference!("D01_truth_cube.json");
pub(crate) const COOK: &str = reference!("D02_cook_plane_strain.json");
pub(crate) const MODES: &str = reference!("E01_modes_beam_s.json");
pub(crate) const FREE_FLIGHT: &str = reference!("E02_free_flight.json");
pub(crate) const RELEASE: &str = reference!("E03_release_from_stretch.json");
pub(crate) const CANTILEVERS: [(&str, &str); 7] = [
    ("B01: tetrahedra, g = 0.5 m/s²", reference!("B01_beam_s_tet_nu03_g05.json")),
    ("B02: tetrahedra, g = 1 m/s²", reference!("B02_beam_s_tet_nu03_g1.json")),
    ("B03: hexahedra, g = 0.5 m/s²", reference!("B03_beam_s_hex_nu03_g05.json")),
    ("B04: tetrahedra, finer", reference!("B04_beam_m_tet_nu03_g05.json")),
    ("B05: tetrahedra, force on the tip", reference!("B05_beam_s_tet_nu03_tip.json")),
    ("B06: tetrahedra with fibres", reference!("B06_beam_s_tet_ti_g05.json")),
    ("B07: corotational tetrahedra", reference!("B07_beam_s_tet_corot_g05.json")),
];

/// A case as it stands in the file, which is part of this program.
pub(crate) fn read(text: &str) -> Value {
    serde_json::from_str(text).expect("the reference cases are JSON")
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number in a reference case")
}

pub(crate) fn vector(value: &Value) -> Vector {
    Vector::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

pub(crate) fn vectors(value: &Value) -> Vec<Vector> {
    list(value).iter().map(vector).collect()
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

/// A mesh that the cases name.
///
/// # Errors
/// [`ValidationError::Mesh`] where the file is not there any more.
pub(crate) fn mesh(file: &str) -> Result<VolumeMesh, ValidationError> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/viscera/tests/data/references");
    Ok(viscera_io::read_volume(Path::new(folder).join(file), 1.0)?.mesh)
}

//! Case G05: laws in uniaxial stress, confined stretch and simple shear.

use viscera::material::{Lame, Law, NeoHookean, StVenantKirchhoff};
use viscera::math::Vec3;

use crate::support::{Matrix, Reference, assert_near, matrix, number};

/// The deformation of a case, by rows of the reference's matrices.
fn deformation(mode: &str, value: f64, lateral: f64) -> Matrix {
    let side = if mode == "uniaxial_stress" { lateral } else { 1.0 };
    let stretch = if mode == "simple_shear" { 1.0 } else { value };
    let mut f =
        Matrix::from_columns(Vec3::new(stretch, 0.0, 0.0), Vec3::new(0.0, side, 0.0), Vec3::new(0.0, 0.0, side));
    if mode == "simple_shear" {
        f.columns[1].x = value;
    }
    f
}

#[test]
fn compressible_laws_meet_closed_forms() {
    let reference = Reference::read("G05_compressible_single_element");
    let (data, tolerance) = (&reference.data, reference.tolerance());
    let lame = Lame::new(number(&data["material"]["lambda_Pa"]), number(&data["material"]["mu_Pa"])).unwrap();
    let mut compared = 0;
    for case in data["reference"].as_array().unwrap() {
        let (mode, value) = (case["mode"].as_str().unwrap(), number(&case["value"]));
        let f = deformation(mode, value, case["lateral_stretch"].as_f64().unwrap_or(1.0));
        let stress = match case["law"].as_str().unwrap() {
            "stvk" => StVenantKirchhoff::new(lame).stress(&f),
            "neo_hookean_isochoric" => NeoHookean::new(lame).stress(&f),
            _ => continue,
        };
        let expected = if mode == "uniaxial_stress" {
            // no stress on the sides
            Matrix::from_columns(Vec3::new(number(&case["P_xx_Pa"]), 0.0, 0.0), Vec3::ZERO, Vec3::ZERO)
        } else {
            matrix(&case["P_Pa"])
        };
        assert_near(&stress.columns, &expected.columns, tolerance, format!("{}, {mode} {value}", case["law"]));
        compared += 1;
    }
    assert_eq!(compared, 26, "cases of both laws");
}

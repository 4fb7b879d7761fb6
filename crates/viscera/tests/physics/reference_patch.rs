//! Cases A01–A06: a homogeneous deformation of a distorted patch, in every model that can compute it.

use viscera::material::{LawFamily, LawVisitor};
use viscera::math::Sym3;

use crate::support::{
    Evaluate, Matrix, Reference, assert_close, assert_near, inner_nodes, matrix, models_of_the_law, number, vector,
    vectors,
};

const CASES: [&str; 6] = [
    "A01_patch_linear_tet4",
    "A02_patch_linear_hex8",
    "A03_patch_stvk_tet4",
    "A04_patch_stvk_hex8",
    "A05_patch_ti_stvk_tet4",
    "A06_patch_ti_stvk_hex8",
];

/// Energy density, P and, by σ = P Fᵀ/J, Cauchy's stress; S from P = F S.
#[test]
fn laws_give_the_stress_of_the_patch() {
    struct Ask<'a>(&'a [f64], Matrix);
    impl LawVisitor for Ask<'_> {
        type Output = (f64, Matrix);
        fn visit<L: LawFamily>(self) -> (f64, Matrix) {
            let law = L::from_values(self.0);
            (law.energy(&self.1), law.stress(&self.1))
        }
    }
    for case in CASES {
        let reference = Reference::read(case);
        let (data, tolerance) = (&reference.data["reference"], reference.tolerance());
        let tissue = reference.tissue(reference.data["material"]["model"].as_str().unwrap());
        let f = matrix(&reference.data["boundary_conditions"]["deformation_gradient_F"]);
        let (energy, p) = tissue.kind().visit(Ask(tissue.values(0), f));
        let near = |actual: Matrix, key: &str| {
            assert_near(&actual.columns, &matrix(&data[key]).columns, tolerance, format!("{case}: {key}"));
        };
        let strain = |strain: Sym3<f64>, key: &str| near(strain.into(), key);

        assert_close(energy, number(&data["energy_density_Pa"]), tolerance, case);
        if case.contains("linear") {
            strain(viscera::material::small_strain(&f), "strain_small");
            near(p, "stress_cauchy_Pa");
        } else {
            strain(viscera::material::green_strain(&f), "E_green");
            near(p, "P_PK1_Pa");
            near(f.inverse() * p, "S_PK2_Pa");
            near(p * f.transpose() * (1.0 / f.determinant()), "sigma_cauchy_Pa");
            assert_close(f.determinant(), number(&data["J"]), tolerance, case);
        }
    }
}

/// Energy and nodal forces of the patch; the inner node feels nothing.
#[test]
fn models_hold_the_patch_with_the_forces_of_the_reference() {
    for case in CASES {
        let reference = Reference::read(case);
        let (data, tolerance) = (&reference.data["reference"], reference.tolerance());
        let mesh = reference.mesh();
        let conditions = &reference.data["boundary_conditions"];
        let (f, c) = (matrix(&conditions["deformation_gradient_F"]), vector(&conditions["translation_m"]));
        let x: Vec<_> = mesh.nodes().iter().map(|&node| f * node + c).collect();
        let displacements: Vec<_> = x.iter().zip(mesh.nodes()).map(|(&x, &rest)| x - rest).collect();
        assert_near(&displacements, &vectors(&data["nodal_displacement_m"]), tolerance, case);

        let expected = vectors(&data["nodal_internal_force_N"]);
        let tissue = reference.tissue(reference.data["material"]["model"].as_str().unwrap());
        for named in models_of_the_law::<f64>(&tissue, &mesh) {
            let what = format!("{case}: {}", named.name);
            let forces = named.model.forces(&x);
            assert_near(&forces, &expected, tolerance, &what);
            assert_close(named.model.energy(&x), number(&data["total_energy_J"]), tolerance, &what);
            assert_eq!(inner_nodes(&mesh), [13]);
            let scale = crate::support::largest(&expected);
            assert!(forces[13].norm() <= tolerance * scale, "{what}: force on the inner node {:?}", forces[13]);
        }
    }
}

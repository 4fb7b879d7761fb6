//! Case A07, one distorted cell of each kind, and the forces and energies of case A08.

use serde_json::Value;
use viscera::material::{Lame, StVenantKirchhoff, Tissue, TransverseStVenantKirchhoff};
use viscera::mesh::GaussRule;
use viscera::mesh::{HexMesh, TetMesh, VolumeMesh};
use viscera::model::{ForceModel, ModelRecipe, TotalLagrangian};

use crate::support::{
    Evaluate, Reference, Vector, assert_close, assert_near, models_of_the_law, number, plain, vector, vectors,
};

fn moved(mesh: &VolumeMesh, displacement: &Value) -> Vec<Vector> {
    mesh.nodes().iter().zip(vectors(displacement)).map(|(&rest, u)| rest + u).collect()
}

/// Columns of the tangent stiffness by products with unit vectors, one list of nodal vectors for each.
fn tangent(model: &dyn ForceModel<f64>, x: &[Vector]) -> Vec<Vec<Vector>> {
    let unit = |dof: usize| {
        let mut dx = vec![Vector::ZERO; x.len()];
        dx[dof / 3][dof % 3] = 1.0;
        dx
    };
    (0..3 * x.len()).map(|dof| model.product(x, &unit(dof))).collect()
}

fn check(model: &dyn ForceModel<f64>, x: &[Vector], expected: &Value, tolerance: f64, what: &str) {
    assert_near(&model.forces(x), &vectors(&expected["internal_force_N"]), tolerance, what);
    assert_close(model.energy(x), number(&expected["energy_J"]), tolerance, what);
    let Some(rows) = expected["tangent_stiffness_N_per_m"].as_array() else { return };
    let entry = |row: usize, column: usize| number(&rows[row][column]);
    let columns: Vec<Vec<Vector>> = (0..rows.len())
        .map(|j| (0..x.len()).map(|a| Vector::new(entry(3 * a, j), entry(3 * a + 1, j), entry(3 * a + 2, j))).collect())
        .collect();
    assert_near(&tangent(model, x).concat(), &columns.concat(), tolerance, format!("{what}, tangent"));
}

#[test]
fn a_single_tetrahedron_matches_in_every_model() {
    let reference = Reference::read("A07_single_elements");
    let data = &reference.data["reference"]["tet4"];
    let mesh = TetMesh::new(vectors(&data["X_m"]), vec![[0, 1, 2, 3]]);
    assert_close(mesh.volume(), number(&data["rest_volume_m3"]), reference.tolerance(), "volume");
    let mesh = VolumeMesh::from(mesh);
    let x = moved(&mesh, &data["u_m"]);
    for law in ["linear", "stvk", "ti_stvk"] {
        for named in models_of_the_law(&reference.tissue(law), &mesh) {
            check(&*named.model, &x, &data[law], reference.tolerance(), &named.name);
        }
    }
}

#[test]
fn a_single_hexahedron_matches_with_both_gauss_rules() {
    let reference = Reference::read("A07_single_elements");
    let data = &reference.data["reference"]["hex8"];
    let mesh = VolumeMesh::from(HexMesh::new(vectors(&data["X_m"]), vec![[0, 1, 2, 3, 4, 5, 6, 7]]));
    let x = moved(&mesh, &data["u_m"]);
    for law in ["linear", "stvk", "ti_stvk"] {
        for (rule, name) in [(GaussRule::Two, "gauss2"), (GaussRule::Three, "gauss3")] {
            let case = format!("{law}_{name}");
            let model = TotalLagrangian::new(reference.tissue(law)).gauss(rule).build_double(&mesh).unwrap();
            check(&*model, &x, &data[&case], reference.tolerance(), &case);
        }
    }
}

/// Case A08: forces and energy of a tetrahedron of which the reference computed them through the tables.
#[test]
fn the_tetrahedron_of_the_tables_has_their_forces_in_every_model() {
    let reference = Reference::read("A08_tensor_mass_tables");
    let tet = &reference.data["tet"];
    let mesh = VolumeMesh::from(TetMesh::new(vectors(&tet["X_m"]), vec![[0, 1, 2, 3]]));
    let x = moved(&mesh, &tet["U_m"]);
    for (law, case) in [("stvk", "isotropic"), ("ti_stvk", "transversely_isotropic")] {
        let expected = &reference.data["reference"][case];
        for named in models_of_the_law(&reference.tissue(law), &mesh) {
            assert_near(&named.model.forces(&x), &vectors(&expected["F_total_N"]), reference.tolerance(), &named.name);
            assert_close(named.model.energy(&x), number(&expected["energy_J"]), reference.tolerance(), &named.name);
        }
    }
}

/// Fibres of length one and of any other length are the same fibres, in the model as in the law.
#[test]
fn the_length_of_the_fibre_direction_does_not_matter() {
    let reference = Reference::read("A08_tensor_mass_tables");
    let (material, tet) = (&reference.data["material"], &reference.data["tet"]);
    let lame = |lambda: &str, mu: &str| Lame::new(number(&material[lambda]), number(&material[mu])).unwrap();
    let (across, along) = (lame("lambda_Pa", "mu_Pa"), lame("lambdaL_Pa", "muL_Pa"));
    let mesh = VolumeMesh::from(TetMesh::new(vectors(&tet["X_m"]), vec![[0, 1, 2, 3]]));
    let x = moved(&mesh, &tet["U_m"]);
    let direction = (vector(&material["a0"]) * -40.0).to_array();
    let tissue = Tissue::uniform(TransverseStVenantKirchhoff::new(across, direction, along).unwrap());
    let expected = &reference.data["reference"]["transversely_isotropic"];
    assert_near(&plain::<f64>(&tissue, &mesh).forces(&x), &vectors(&expected["F_total_N"]), 1e-10, "fibre times −40");

    // and they matter: without them the energy is that of the isotropic case
    let matrix = Tissue::uniform(StVenantKirchhoff::new(across));
    let expected = number(&reference.data["reference"]["isotropic"]["energy_J"]);
    assert_close(plain::<f64>(&matrix, &mesh).energy(&x), expected, 1e-10, "without fibres");
}

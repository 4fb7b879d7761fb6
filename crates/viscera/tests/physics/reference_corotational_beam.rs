//! Case B07: a corotational cantilever under its weight, bent by more than its thickness.

use viscera::mesh::VolumeMesh;
use viscera::model::{Corotational, ForceModel, ModelRecipe};

use crate::support::{Evaluate, Random, Reference, Vector, assert_close, largest, number, vector, vectors};

/// In the bent shape of the reference every free node is in balance with its weight, to what the case's tolerance of the
/// displacement is worth as a force; and the energy is that of the reference.
#[test]
fn the_bent_cantilever_of_the_reference_is_in_balance() {
    let reference = Reference::read("B07_beam_s_tet_corot_g05");
    let data = &reference.data;
    let mesh = reference.mesh();
    let displacements = vectors(&data["reference"]["nodal_displacement_m"]);
    let x: Vec<Vector> = mesh.nodes().iter().zip(&displacements).map(|(&rest, &u)| rest + u).collect();
    let model: Box<dyn ForceModel<f64>> = Corotational::new(reference.tissue("linear")).build_double(&mesh).unwrap();

    let mut loads = vec![Vector::ZERO; x.len()];
    let (density, gravity) = (number(&data["material"]["density_kg_m3"]), vector(&data["loads"]["gravity_m_s2"]));
    let VolumeMesh::Tet(tets) = &mesh else { panic!("the case is made of tetrahedra") };
    for (cell, corners) in tets.cells.iter().enumerate() {
        corners.iter().for_each(|&node| loads[node as usize] += gravity * (density * tets.cell_volume(cell) / 4.0));
    }
    let forces = model.forces(&x);
    let free = (0..x.len()).filter(|&node| mesh.nodes()[node].z > 0.0);
    let worst = free.map(|node| (forces[node] - loads[node]).norm()).fold(0.0, f64::max);
    let stiffness = largest(&model.product(&x, &Random::new(341).vectors(x.len(), 1.0)));
    let bound = reference.tolerance() * largest(&displacements) * stiffness;
    assert!(worst <= bound, "out of balance by {worst:e} N, more than {bound:e}");
    assert!(bound < 1e-3 * largest(&loads), "the bound {bound:e} would miss a missing load");
    assert_close(model.energy(&x), number(&data["reference"]["strain_energy_J"]), reference.tolerance(), "energy");
}

//! Tetrahedra integrated at the nodes: between tissues, and on cells that are stretched alike.

use viscera::body::Body;
use viscera::curve::Curve;
use viscera::material::{Lame, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::math::Mat3;
use viscera::mesh::{Region, TetMesh, VolumeMesh};
use viscera::model::{ForceModel, ModelRecipe, NodallyIntegrated, Scratch, TotalLagrangian};

use crate::reference::{Vector, bottom, displacements, settle, world};

const NEARLY_INCOMPRESSIBLE: Lame = Lame { lambda: 2.48e6, mu: 4.97e3 };

fn forces(model: &dyn ForceModel<f64>, x: &[Vector]) -> Vec<Vector> {
    let mut out = vec![Vector::ZERO; x.len()];
    model.add_forces(x, &mut Scratch::new(x.len()), &mut out);
    out
}

/// Where all cells deform alike there is nothing to average: forces and energy are those of the plain element.
#[test]
fn cells_that_deform_alike_are_those_of_the_plain_element() {
    let mesh: VolumeMesh = TetMesh::box_grid([3, 2, 2], [0.03, 0.02, 0.02]).into();
    let f = Mat3::from_rows(Vector::new(1.2, 0.1, 0.0), Vector::new(-0.2, 0.8, 0.05), Vector::new(0.0, 0.1, 1.02));
    let x: Vec<_> = mesh.nodes().iter().map(|&x| f * x + Vector::new(0.1, -0.2, 0.3)).collect();
    for tissue in [
        Tissue::uniform(NeoHookean::new(NEARLY_INCOMPRESSIBLE)),
        Tissue::uniform(StableNeoHookean::new(NEARLY_INCOMPRESSIBLE)),
    ] {
        let plain = TotalLagrangian::new(tissue.clone()).build_double(&mesh).unwrap();
        for share in [0.0, 0.01, 0.3] {
            let nodal = NodallyIntegrated::new(tissue.clone()).stabilise(share).build_double(&mesh).unwrap();
            let (expected, actual) = (forces(&*plain, &x), forces(&*nodal, &x));
            let largest = expected.iter().map(|v| v.norm()).fold(0.0, f64::max);
            let error = actual.iter().zip(&expected).map(|(&a, &e)| (a - e).norm()).fold(0.0, f64::max);
            assert!(error <= 1e-11 * largest, "{}: {error} of {largest}", tissue.kind());
            let (energy, expected) = (nodal.energy(&x), plain.energy(&x));
            assert!((energy - expected).abs() <= 1e-11 * expected, "{}: {energy} J, not {expected} J", tissue.kind());
        }
    }
}

/// Soft and stiff tissue in series, ν = 0: each half is strained alike, by its own amount. A mean over both at the nodes
/// between would soften the border; a mean for each tissue gives the plain element's answer, which is exact.
#[test]
fn strains_jump_at_the_border_of_two_tissues() {
    let mesh = TetMesh::box_grid([2, 2, 4], [0.02, 0.02, 0.04]);
    let is_stiff = |cell: usize| mesh.cells[cell].iter().any(|&node| mesh.nodes[node as usize].z > 0.0201);
    let law = |cell| StVenantKirchhoff::from_young_poisson(if is_stiff(cell) { 9e4 } else { 1e4 }, 0.0).unwrap();
    let laws: Vec<_> = (0..mesh.cells.len()).map(law).collect();
    let tissue = Tissue::per_cell(&laws).unwrap();
    let top = Region::plane([0.0, 0.0, 0.04], [0.0, 0.0, 1.0], 0.0);
    let pull = |body: Body| {
        let pull = Curve::constant(Vector::new(0.0, 0.0, 0.01));
        let (mut world, id) = world(body.fix(bottom()).prescribe(top.clone(), pull), [0.0; 3]);
        settle(&mut world, id).unwrap();
        displacements(&world, id)
    };
    let exact = pull(Body::new(mesh.clone(), 1000.0).model(TotalLagrangian::new(tissue.clone())));
    let nodal = pull(Body::new(mesh.clone(), 1000.0).model(NodallyIntegrated::new(tissue)));
    let error = exact.iter().zip(&nodal).map(|(&a, &b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(error < 1e-10 * 0.01, "{error} m");
}

#[test]
fn shares_out_of_range_hexahedra_and_small_strain_laws_are_refused() {
    let tissue = Tissue::uniform(NeoHookean::new(NEARLY_INCOMPRESSIBLE));
    let mesh: VolumeMesh = TetMesh::box_grid([1, 1, 1], [0.1, 0.1, 0.1]).into();
    let message = |recipe: NodallyIntegrated, mesh: &VolumeMesh| recipe.build_double(mesh).err().unwrap().to_string();
    let recipe = NodallyIntegrated::new(tissue);
    assert_eq!(
        message(recipe.clone().stabilise(1.5), &mesh),
        "stabilise = 1.5 is out of range: it must be zero or positive, and less than 1"
    );
    let hexes = viscera::mesh::HexMesh::box_grid([1, 1, 1], [0.1, 0.1, 0.1]).into();
    assert!(message(recipe, &hexes).contains("works on tetrahedra"));
}

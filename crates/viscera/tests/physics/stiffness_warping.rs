//! Node-wise stiffness warping, and the ghost forces that element-wise rotations do not have.

use viscera::material::{LinearElastic, Tissue};
use viscera::mesh::{TetMesh, VolumeMesh};
use viscera::model::{Corotational, ForceModel, ModelRecipe, Scratch, StiffnessWarping};

use crate::support::{Evaluate, Random, Vector, assert_near, deformed, tet_mesh};

fn tissue() -> Tissue {
    Tissue::uniform(LinearElastic::from_young_poisson(10e3, 0.3).unwrap())
}

fn models(mesh: &VolumeMesh) -> [Box<dyn ForceModel<f64>>; 2] {
    [
        StiffnessWarping::new(tissue()).build_double(mesh).unwrap(),
        Corotational::new(tissue()).build_double(mesh).unwrap(),
    ]
}

/// |Σ f| over Σ |f|.
fn relative_net_force(forces: &[Vector]) -> f64 {
    let sum = forces.iter().fold(Vector::ZERO, |sum, &force| sum + force);
    sum.norm() / forces.iter().map(|force| force.norm()).sum::<f64>()
}

/// A free bar bent to a quarter circle: nobody pushes it, yet warped nodes do.
#[test]
fn a_bent_bar_is_pushed_by_ghost_forces_that_elements_do_not_have() {
    let (length, bar) = (0.4, TetMesh::box_grid([2, 2, 8], [0.1, 0.1, 0.4]));
    let radius = length / std::f64::consts::FRAC_PI_2;
    let bend = |x: &Vector| {
        let (sine, cosine) = (x.z / radius).sin_cos();
        Vector::new(x.x, radius - (radius - x.y) * cosine, (radius - x.y) * sine)
    };
    let x: Vec<_> = bar.nodes.iter().map(bend).collect();
    let [warped, corotational] = models(&bar.into());
    let ghost = relative_net_force(&warped.forces(&x));
    assert!(ghost > 1e-3, "ghost force {ghost:e}");
    let none = relative_net_force(&corotational.forces(&x));
    assert!(none < 1e-15, "{none:e} with rotations of elements");
}

/// Where every node turns alike there is nothing to compare: the same forces as element-wise rotations.
#[test]
fn homogeneous_deformations_have_the_forces_of_corotational_elements() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(321);
    let x = deformed(&mesh, random.rotation() * random.deformation(0.3), random.vector(), 0.0, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    let [warped, corotational] = models(&mesh);
    assert_near(&warped.forces(&x), &corotational.forces(&x), 1e-12, "forces");
    assert_near(&warped.product(&x, &dx), &corotational.product(&x, &dx), 1e-12, "products");
}

/// Rotations found once serve all products, whatever forces are asked for in between.
#[test]
fn linearized_products_equal_products_from_the_positions() {
    let mesh = VolumeMesh::from(tet_mesh([2, 2, 2]));
    let mut random = Random::new(322);
    let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.005, &mut random);
    let dx = random.vectors(x.len(), 1.0);
    let [model, _] = models(&mesh);
    let mut scratch = Scratch::for_models(x.len(), std::slice::from_ref(&model));
    model.linearize(&x, &mut scratch);
    let mut unused = vec![Vector::ZERO; x.len()];
    model.add_forces(mesh.nodes(), &mut scratch, &mut unused);
    let mut product = vec![Vector::ZERO; x.len()];
    model.add_product(&x, &dx, &mut scratch, &mut product);
    assert_eq!(product, model.product(&x, &dx));
}

//! The adaptive tensor-mass model: linear where vertices hardly move, full where they do (RR-4028, section 6).

use viscera::material::{
    LawFamily, LinearElastic, StVenantKirchhoff, Tissue, TransverseLinear, TransverseStVenantKirchhoff,
};
use viscera::mesh::VolumeMesh;
use viscera::model::{ForceModel, LinearTensorMass, ModelRecipe, TensorMass};

use crate::support::{Evaluate, Random, Vector, assert_near, largest, tet_mesh};

/// A non-linear tissue and the linear one that it is at small strain.
fn tissues() -> [(Tissue, Tissue); 2] {
    let (isotropic, fibred) = (StVenantKirchhoff::example(), TransverseStVenantKirchhoff::example());
    [
        (Tissue::uniform(isotropic), Tissue::uniform(LinearElastic::from_values(&isotropic.values()))),
        (Tissue::uniform(fibred), Tissue::uniform(TransverseLinear::from_values(&fibred.values()))),
    ]
}

const THRESHOLD: f64 = 0.01;

struct Trio {
    adaptive: Box<dyn ForceModel<f64>>,
    linear: Box<dyn ForceModel<f64>>,
    full: Box<dyn ForceModel<f64>>,
}

fn trio(mesh: &VolumeMesh, (tissue, linear): (Tissue, Tissue)) -> Trio {
    Trio {
        adaptive: TensorMass::new(tissue.clone()).adaptive(THRESHOLD).build_double(mesh).unwrap(),
        linear: LinearTensorMass::new(linear).build_double(mesh).unwrap(),
        full: TensorMass::new(tissue).build_double(mesh).unwrap(),
    }
}

/// Every node moved by a length in a random direction.
fn moved(mesh: &VolumeMesh, mut length: impl FnMut(usize) -> f64) -> Vec<Vector> {
    let mut random = Random::new(101);
    let place = |(node, &rest): (usize, &Vector)| rest + random.vector().normalized().unwrap() * length(node);
    mesh.nodes().iter().enumerate().map(place).collect()
}

#[test]
fn below_the_threshold_everywhere_it_is_the_linear_model() {
    let mesh = VolumeMesh::from(tet_mesh([3, 3, 3]));
    for tissues in tissues() {
        let Trio { adaptive, linear, full } = trio(&mesh, tissues);
        let x = moved(&mesh, |_| 0.999 * THRESHOLD);
        let dx = Random::new(102).vectors(x.len(), 1.0);
        assert_near(&adaptive.forces(&x), &linear.forces(&x), 1e-14, "forces");
        assert_near(&adaptive.product(&x, &dx), &linear.product(&x, &dx), 1e-14, "products");
        let gap = full.forces(&x)[0] - linear.forces(&x)[0];
        assert!(gap.norm() > 0.01 * largest(&linear.forces(&x)), "the two models hardly differ: the test is blind");
    }
}

#[test]
fn above_the_threshold_everywhere_it_is_the_full_model() {
    let mesh = VolumeMesh::from(tet_mesh([3, 3, 3]));
    for tissues in tissues() {
        let Trio { adaptive, full, .. } = trio(&mesh, tissues);
        let x = moved(&mesh, |_| 1.001 * THRESHOLD);
        let dx = Random::new(103).vectors(x.len(), 1.0);
        assert_near(&adaptive.forces(&x), &full.forces(&x), 1e-14, "forces");
        assert_near(&adaptive.product(&x, &dx), &full.product(&x, &dx), 1e-14, "products");
    }
}

/// A node below the threshold has the linear force, whatever its neighbours do; one that is above it with all its
/// neighbours has the full one. Between them forces stay balanced and products symmetric.
#[test]
fn a_node_below_the_threshold_is_linear_and_the_border_is_balanced() {
    let mesh = VolumeMesh::from(tet_mesh([3, 3, 4]));
    for tissues in tissues() {
        let Trio { adaptive, linear, full } = trio(&mesh, tissues);
        let (low, high) = mesh.bounds();
        let far: Vec<bool> = mesh.nodes().iter().map(|node| node.z > 0.5 * (low.z + high.z)).collect();
        let x = moved(&mesh, |node| if far[node] { 1.5 * THRESHOLD } else { 0.5 * THRESHOLD });
        let mut among_far = far.clone();
        for cell in (0..mesh.cell_count()).map(|cell| mesh.cell(cell)) {
            if cell.iter().any(|&node| !far[node as usize]) {
                cell.iter().for_each(|&node| among_far[node as usize] = false);
            }
        }
        assert!(far.contains(&false) && among_far.contains(&true) && far != among_far);
        let forces = adaptive.forces(&x);
        let (linear, full) = (linear.forces(&x), full.forces(&x));
        let chosen: Vec<Vector> = (0..x.len())
            .map(|node| match (far[node], among_far[node]) {
                (false, _) => linear[node],
                (true, true) => full[node],
                (true, false) => forces[node],
            })
            .collect();
        assert_near(&forces, &chosen, 1e-14, "forces");
        let net = forces.iter().fold(Vector::ZERO, |sum, &force| sum + force);
        assert!(net.norm() <= 1e-12 * largest(&forces), "net force {net:?}");
        let mut random = Random::new(104);
        let (a, b) = (random.vectors(x.len(), 1.0), random.vectors(x.len(), 1.0));
        let work = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
        let (ab, ba) = (work(&a, &adaptive.product(&x, &b)), work(&b, &adaptive.product(&x, &a)));
        assert!((ab - ba).abs() <= 1e-12 * (work(&a, &adaptive.product(&x, &a)).abs() + ab.abs()), "{ab} and {ba}");
        for (node, &far) in far.iter().enumerate() {
            let displacement = x[node] - mesh.nodes()[node];
            assert_eq!(adaptive.is_nonlinear_at(displacement), far, "node {node}");
        }
    }
}

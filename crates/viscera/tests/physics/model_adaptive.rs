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

/// Each node has the force of the model whose side of the threshold it is on, whatever its neighbours do.
#[test]
fn each_node_follows_its_own_displacement() {
    let mesh = VolumeMesh::from(tet_mesh([3, 3, 3]));
    for tissues in tissues() {
        let Trio { adaptive, linear, full } = trio(&mesh, tissues);
        let mut random = Random::new(104);
        let far: Vec<bool> = mesh.nodes().iter().map(|_| random.below(2) == 0).collect();
        assert!(far.contains(&true) && far.contains(&false));
        let x = moved(&mesh, |node| if far[node] { 1.5 * THRESHOLD } else { 0.5 * THRESHOLD });
        let dx = random.vectors(x.len(), 1.0);
        let choose = |linear: Vec<Vector>, full: Vec<Vector>| -> Vec<Vector> {
            (0..x.len()).map(|node| if far[node] { full[node] } else { linear[node] }).collect()
        };
        assert_near(&adaptive.forces(&x), &choose(linear.forces(&x), full.forces(&x)), 1e-14, "forces");
        let products = choose(linear.product(&x, &dx), full.product(&x, &dx));
        assert_near(&adaptive.product(&x, &dx), &products, 1e-14, "products");
        for (node, &far) in far.iter().enumerate() {
            let displacement = x[node] - mesh.nodes()[node];
            assert_eq!(adaptive.is_nonlinear_at(displacement), far, "node {node}");
        }
    }
}

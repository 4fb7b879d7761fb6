//! Products that are summed on copies of the nodes, along directions that follow one another there.

use viscera::executor::Executor;
use viscera::math::Vec3;
use viscera::mesh::VolumeMesh;
use viscera::model::{Precision, Scratch};
use viscera::solver::{Filtered, Turn};

use super::support::{Random, assert_close, assert_near, deformed, models_and_penalty, tet_mesh};

/// Enough nodes for several patches.
const CELLS: [usize; 3] = [12, 8, 8];

/// They are those of the whole arrays: (M + K) p with p = z first and z + w p then, and p·(M + K) p; on threads to the same bits.
fn follow<T: Precision>(tolerance: f64) -> usize {
    let mesh = VolumeMesh::from(tet_mesh(CELLS));
    let nodes = mesh.nodes().len();
    let mut random = Random::new(83);
    let x: Vec<Vec3<T>> = deformed(&mesh, random.deformation(0.3), random.vector(), 0.001, &mut random)
        .iter()
        .map(|x| x.cast())
        .collect();
    let masses: Vec<T> = random.vectors(nodes, 50.0).iter().map(|v| T::from_f64(v.norm())).collect();
    let mut with_copies = 0;
    for named in models_and_penalty::<T>(&mesh) {
        let model = named.model.as_ref();
        let mut scratches = [Executor::serial(), Executor::threads(3).unwrap()]
            .map(|executor| Scratch::new(nodes).with_executor(executor));
        scratches.iter_mut().for_each(|scratch| model.linearize(&x, scratch));
        let mut plain = Scratch::new(nodes);
        model.linearize(&x, &mut plain);
        let mut expected_direction = vec![Vec3::ZERO; nodes];
        for weight in [None, Some(T::from_f64(0.7)), Some(T::from_f64(-0.2))] {
            let corrected: Vec<Vec3<T>> = random.vectors(nodes, 0.01).iter().map(|v| v.cast()).collect();
            for (p, &z) in expected_direction.iter_mut().zip(&corrected) {
                *p = weight.map_or(z, |weight| z + *p * weight);
            }
            let mut expected: Vec<Vec3<T>> = expected_direction.iter().zip(&masses).map(|(&p, &m)| p * m).collect();
            model.add_product(&x, &expected_direction, &mut plain, &mut expected);
            let found = scratches.each_mut().map(|scratch| {
                let (mut direction, mut product) = (vec![Vec3::ZERO; nodes], corrected.clone());
                let filtered = Filtered { held: &[], sliding: &[], filters: &[] };
                let turn = Turn { weight, direction: &mut direction, product: &mut product, filtered };
                let (patches, curvature) = model.sum_product(&x, &turn, &masses, scratch)?;
                let mut sums = vec![Vec3::ZERO; nodes];
                scratch.write_sums(patches, &mut sums);
                Some((sums, curvature))
            });
            let [Some(one), three] = found else { break };
            assert_near(&one.0, &expected, tolerance, format!("{} in {}", named.name, T::NAME));
            let pairs = expected_direction.iter().zip(&expected);
            let curvature: f64 = pairs.map(|(&p, &q)| p.cast::<f64>().dot(q.cast())).sum();
            assert_close(one.1, curvature, 100.0 * tolerance, format!("curvature, {} in {}", named.name, T::NAME));
            assert_eq!(Some(one), three, "on threads, {} in {}", named.name, T::NAME);
            with_copies += 1;
        }
    }
    with_copies
}

#[test]
fn products_on_copies_are_those_of_the_whole_body() {
    // Three directions for each law of total-Lagrangian tetrahedra, and for corotational tissue without fibres and with them.
    assert!(follow::<f64>(1e-12) > 15);
    assert!(follow::<f32>(1e-4) > 15);
}

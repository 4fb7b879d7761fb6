//! Case A10: the volume penalty on a tetrahedron that is too small, too large, and inverted.

use viscera::mesh::TetMesh;
use viscera::model::{ForceModel, VolumePenalty};

use crate::support::{Evaluate, Reference, assert_close, assert_near, number, vectors};

#[test]
fn volume_penalty_matches_shrunk_grown_and_inverted() {
    let reference = Reference::read("A10_volume_penalty");
    let (kappa, tolerance) = (number(&reference.data["parameters"]["kappa_Pa"]), reference.tolerance());
    let samples = reference.data["reference"].as_array().unwrap();
    let deltas: Vec<f64> = samples.iter().map(|sample| number(&sample["delta"])).collect();
    assert!(deltas[0] < 0.0 && deltas[1] > 0.0 && deltas[2] < -1.0, "one inverted among {deltas:?}");
    for sample in samples {
        let mesh = TetMesh::new(vectors(&sample["X_rest_m"]), vec![[0, 1, 2, 3]]);
        let x = vectors(&sample["x_m"]);
        let model: Box<dyn ForceModel<f64>> = Box::new(VolumePenalty::new(&mesh, kappa).unwrap());
        // the file lists the force on the nodes, the engine what holds them
        let holding: Vec<_> = vectors(&sample["force_on_nodes_N"]).into_iter().map(|force| -force).collect();
        let what = format!("delta = {}", number(&sample["delta"]));
        assert_near(&model.forces(&x), &holding, tolerance, &what);
        assert_close(model.energy(&x), number(&sample["energy_J"]), tolerance, &what);
    }
}

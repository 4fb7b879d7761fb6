//! Trajectories that another program computed.

use serde_json::Value;
use viscera::body::Body;
use viscera::dynamics::implicit::{Implicit, Scheme};
use viscera::mesh::TetMesh;
use viscera::model::TotalLagrangian;
use viscera::solver::Stop;

use super::support::*;

fn file(name: &str) -> String {
    std::fs::read_to_string(format!("{}/tests/data/references/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// The beam of 10 × 10 × 40 cm that the cases share; Gmsh 2.2, where a tetrahedron's line ends with its four nodes.
fn beam() -> Body {
    let text = file("beam_s_tet4.msh");
    let section = |begin: &str, end: &str| -> Vec<Vec<f64>> {
        let lines = text.lines().skip_while(move |line| *line != begin).skip(2).take_while(move |line| *line != end);
        lines.map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect()
    };
    let nodes = section("$Nodes", "$EndNodes").iter().map(|row| Vector::new(row[1], row[2], row[3])).collect();
    let cells = section("$Elements", "$EndElements")
        .iter()
        .filter(|row| row[1] == 4.0)
        .map(|row| std::array::from_fn(|corner| row[row.len() - 4 + corner] as u32 - 1))
        .collect();
    Body::new(TetMesh::new(nodes, cells), 1000.0).model(TotalLagrangian::new(tissue()))
}

fn vectors(value: &Value) -> Vec<Vector> {
    let number = |value: &Value| value.as_f64().unwrap();
    let rows = value.as_array().unwrap().iter();
    rows.map(|row| Vector::new(number(&row[0]), number(&row[1]), number(&row[2]))).collect()
}

/// Newton to 1e-10, linear solves to 1e-6: tight against the error of the step.
fn settings(scheme: Scheme) -> Implicit {
    Implicit { linear: Stop::Tolerance { relative: 1e-6, at_most: 1000 }, ..full(scheme, 1e-10) }
}

/// E02: a turning beam in free flight. Momentum and the path of the centre of mass are exact; the shape errs by what a scheme
/// of second order errs at these steps, four times less at half the step.
#[test]
fn free_flight_follows_the_reference() {
    let case: Value = serde_json::from_str(&file("E02_free_flight.json")).unwrap();
    let target = &case["reference"][1];
    let displacements = vectors(&target["nodal_displacement_m"]);
    let error = |steps: usize| {
        let (mut world, id) = implicit_world(NO_GRAVITY, 0.1 / steps as f64, settings(Scheme::EnergyMomentum), beam());
        let spin = Vector::new(3.0, 1.0, -2.0);
        let centre = Vector::new(0.05, 0.05, 0.2);
        world.body_mut(id).set_velocities(|x| Vector::new(0.4, 0.2, 1.0) + spin.cross(x - centre));
        run(&mut world, steps);
        let seen = world.observe(id);
        let momenta = [
            (seen.momentum, vectors(&serde_json::json!([case["initial"]["invariants"]["linear_momentum"]]))[0]),
            (
                seen.angular_momentum,
                vectors(&serde_json::json!([case["initial"]["invariants"]["angular_momentum_about_origin"]]))[0],
            ),
        ];
        for (found, exact) in momenta {
            assert!((found - exact).norm() < 1e-9 * exact.norm(), "{found:?}, not {exact:?}");
        }
        let energy = (seen.kinetic_energy + seen.elastic_energy) / 2.703541666667 - 1.0;
        assert!(energy.abs() < 1e-9, "energy off by {energy:e}");
        let mesh = beam_nodes(&world, id);
        let shape: Vec<Vector> = mesh.iter().zip(&displacements).map(|(&rest, &u)| rest + u).collect();
        distance(world.body(id).positions(), &shape)
    };
    let (coarse, fine) = (error(10), error(20));
    assert!(fine < 3e-5 && coarse / fine > 3.4, "{coarse:e} m at 10 ms, {fine:e} m at 5 ms");
}

fn beam_nodes(world: &viscera::world::World<f64>, id: viscera::world::BodyId) -> Vec<Vector> {
    world.body(id).mesh().nodes().to_vec()
}

/// E03: the beam, held at one end, is let go from an axial stretch of 15 %. Energy to 1e-6 as the case asks of schemes that
/// conserve it, backward Euler always losing some, and the tip where the reference has it, to second order.
#[test]
fn release_from_stretch_follows_the_reference() {
    let case: Value = serde_json::from_str(&file("E03_release_from_stretch.json")).unwrap();
    let reference = &case["reference"];
    let tip_node = reference["tip_node_0based"].as_u64().unwrap() as usize;
    let tips = vectors(&reference["tip_displacement_m"]);
    let initial = case["initial"]["energy_J"].as_f64().unwrap();
    // Up to 0.0625 s: five of the twenty moments, before the motion is that of many modes out of step.
    let error = |per_moment: usize| {
        let step = 0.0125 / per_moment as f64;
        let (mut world, id) = implicit_world(NO_GRAVITY, step, settings(Scheme::EnergyMomentum), beam().fix(root()));
        world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1.15 * x.z));
        let rest = world.body(id).mesh().nodes()[tip_node];
        let mut worst = 0.0f64;
        for expected in &tips[..5] {
            run(&mut world, per_moment);
            worst = worst.max((world.body(id).positions()[tip_node] - rest - *expected).norm());
        }
        let seen = world.observe(id);
        let drift = (seen.kinetic_energy + seen.elastic_energy) / initial - 1.0;
        assert!(drift.abs() < 1e-6, "energy off by {drift:e}");
        worst
    };
    let (coarse, fine) = (error(4), error(8));
    assert!(fine < 3e-4 && coarse / fine > 3.4, "{coarse:e} m at 3.1 ms, {fine:e} m at 1.6 ms");
}

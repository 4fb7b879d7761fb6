use viscera::body::{Body, Muscle};
use viscera::curve::Curve;
use viscera::material::{LinearElastic, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::{Corotational, MassSpring};
use viscera::world::{World, WorldConfig};

use crate::support::{DENSITY, bar, between, run, tissue, tumbling, world};

/// A plate of 20 × 10 × 1 cm with a muscle on its upper side.
fn plate(young: f64, stiffness: f64, activation: Curve<f64>) -> Body {
    let tissue = Tissue::uniform(LinearElastic::from_young_poisson(young, 0.0).unwrap());
    let region = Region::plane([0.0, 0.0, 0.01], [0.0, 0.0, 1.0], 0.0);
    Body::new(TetMesh::box_grid([8, 4, 1], [0.2, 0.1, 0.01]), DENSITY).model(Corotational::new(tissue)).muscle(Muscle {
        region,
        stiffness,
        contraction: 0.3,
        activation,
    })
}

/// Held where it is, a sheet of squares cut in two pulls across every line with 3/2 S c a per metre: S c of the edges across the line,
/// S c/2 of the diagonals.
#[test]
fn an_isometric_muscle_pulls_with_its_stiffness_times_its_contraction() {
    let activation = Curve::piecewise_linear(vec![(0.0, 0.0), (1.0, 1.0)]).unwrap();
    let (mut world, id) = world::<f64>([0.0; 3], plate(5e3, 40.0, activation).fix(Region::All));
    for time in [0.5, 1.0] {
        run(&mut world, 0.5);
        let forces = world.external_forces(id).to_vec();
        let nodes = world.body(id).mesh().nodes();
        let across: f64 = forces.iter().zip(nodes).filter(|(_, x)| x.x < 0.06).map(|(force, _)| force.x).sum();
        let expected = 1.5 * 40.0 * 0.3 * time * 0.1;
        assert!((across / expected - 1.0).abs() < 1e-12, "{across} N, not {expected} N");
    }
}

/// With nothing to hold it, a muscle shortens until its edges have their length at rest, 1 − c a of it.
#[test]
fn a_free_muscle_shortens_by_its_contraction() {
    // Muscle a thousand times as stiff as the plate under it.
    let (mut world, id) = world::<f64>([0.0; 3], plate(20.0, 200.0, Curve::constant(0.5)).damping(20.0));
    let corner = |world: &World<f64>, place: [f64; 3]| {
        let nodes = Region::nearest(place).nodes(world.body(id).mesh()).unwrap();
        world.body(id).positions()[nodes[0] as usize]
    };
    run(&mut world, 3.0);
    let length = (corner(&world, [0.2, 0.0, 0.01]) - corner(&world, [0.0, 0.0, 0.01])).norm() / 0.2;
    assert!((length - 0.85).abs() < 0.01, "{length} of its length");
    assert!(world.observe(id).momentum.norm() < 1e-12);
}

/// What a muscle pulls at one end it pulls at the other: a free body that twitches keeps momentum and angular momentum.
#[test]
fn a_twitching_body_keeps_momentum_and_angular_momentum() {
    let activation = Curve::piecewise_linear(vec![(0.0, 0.0), (0.2, 1.0), (0.4, 0.0)]).unwrap();
    let muscle = Muscle { region: between(0.1, 0.2), stiffness: 60.0, contraction: 0.4, activation };
    let (mut world, id) =
        world::<f64>([0.0; 3], Body::new(bar(), DENSITY).model(MassSpring::new(tissue())).muscle(muscle));
    world.body_mut(id).set_velocities(tumbling);
    let start = world.observe(id);
    run(&mut world, 0.2);
    assert!(world.observe(id).elastic_energy > 1e-3, "{} J", world.observe(id).elastic_energy);
    run(&mut world, 0.4);
    let seen = world.observe(id);
    assert!((seen.momentum - start.momentum).norm() < 1e-12 * start.momentum.norm());
    assert!((seen.angular_momentum - start.angular_momentum).norm() < 1e-11 * start.angular_momentum.norm());
}

#[test]
fn muscles_out_of_range_are_refused() {
    let refusal = |muscle: Muscle| {
        let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
        let body = Body::new(bar(), DENSITY).name("bar").model(MassSpring::new(tissue()));
        world.add(body.muscle(muscle)).unwrap_err().to_string()
    };
    let sound = || Muscle { region: Region::All, stiffness: 10.0, contraction: 0.3, activation: Curve::constant(1.0) };
    let message = refusal(Muscle { contraction: 1.0, ..sound() });
    assert_eq!(
        message,
        "body `bar`: muscle contraction = 1 is out of range: it must be zero or positive, and less than 1"
    );
    let message = refusal(Muscle { activation: Curve::constant(1.5), ..sound() });
    assert_eq!(message, "body `bar`: muscle activation = 1.5 is out of range: it must be between 0 and 1");
    let message = refusal(Muscle { region: Region::nearest([0.0; 3]), ..sound() });
    assert!(message.contains("a muscle: the region") && message.contains("no whole face"), "{message}");
}

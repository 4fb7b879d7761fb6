//! Bodies that are grown together.

use viscera::mesh::Region;
use viscera::world::{Attachment, AttachmentId, BodyId, World, WorldError};

use super::support::*;

fn side(name: &str) -> Region {
    Region::Named(name.into())
}

/// A block of coarse cells above one of fine cells, the lower side of the first grown to the upper one of the second, whose mesh does
/// not match, half a millimetre apart.
fn grown(
    gravity: [f64; 3],
    upper: impl Fn(viscera::body::Body) -> viscera::body::Body,
) -> (World<f64>, [BodyId; 2], AttachmentId) {
    let mut world = world::<f64>(gravity, 5e-3, EXPLICIT);
    let above = world.add(upper(block([2, 2, 2], [0.04, 0.03, 0.04], Vector::ZERO, 20e3)).name("above")).unwrap();
    let low = Vector::new(0.003, -0.0305, 0.002);
    let below = world.add(block([3, 3, 3], [0.034, 0.03, 0.036], low, 20e3).name("below")).unwrap();
    let attachment = Attachment { body: below, region: side("y-max"), to: above };
    let id = world.attach(attachment).unwrap();
    (world, [above, below], id)
}

/// What hangs from an organ that is held is felt in the attachment as its weight.
#[test]
fn a_body_that_hangs_from_another_pulls_with_its_weight() {
    let (mut world, [_, below], attachment) = grown(GRAVITY, |body| body.fix(side("y-max")).damping(30.0));
    for _ in 0..400 {
        world.step().unwrap();
    }
    let weight = Vector::from(GRAVITY) * world.observe(below).mass;
    // The lower block is undamped: its swing goes through the upper one.
    assert_vector(world.attachment_force(attachment), -weight, 1e-2);
}

/// Thrown and spinning, two bodies that are grown together keep momentum and angular momentum of both.
#[test]
fn two_bodies_that_are_grown_together_keep_their_momenta() {
    let (mut world, ids, _) = grown([0.0; 3], |body| body);
    for id in ids {
        world.body_mut(id).set_velocities(|x| Vector::new(0.3, -0.1, 0.2) + Vector::new(1.0, 2.0, 3.0).cross(x));
    }
    let sums = |world: &mut World<f64>| {
        let of = ids.map(|id| world.observe(id));
        (of[0].momentum + of[1].momentum, of[0].angular_momentum + of[1].angular_momentum)
    };
    let (momentum, angular) = sums(&mut world);
    for _ in 0..60 {
        world.step().unwrap();
    }
    let (momentum_after, angular_after) = sums(&mut world);
    assert_vector(momentum_after, momentum, 1e-12);
    assert_vector(angular_after, angular, 1e-10);
    // And they have not come apart: a node of the lower one is as far from one of the upper one as it was at rest.
    let pair =
        [(ids[0], Vector::new(0.02, 0.0, 0.02)), (ids[1], Vector::new(0.0143, -0.0005, 0.014))].map(|(id, at)| {
            let nodes = world.body(id).mesh().nodes();
            let node =
                (0..nodes.len()).min_by(|&a, &b| (nodes[a] - at).norm().total_cmp(&(nodes[b] - at).norm())).unwrap();
            (nodes[node], world.body(id).positions()[node])
        });
    let ratio = (pair[0].1 - pair[1].1).norm() / (pair[0].0 - pair[1].0).norm();
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
}

#[test]
fn nonsense_is_refused() {
    let body = |low: f64, name: &str| block([1, 1, 1], [0.02; 3], Vector::new(0.0, low, 0.0), 1e4).name(name);
    let attach = |body, to| Attachment { body, region: side("y-min"), to };
    let mut world = world::<f64>(GRAVITY, 5e-3, EXPLICIT);
    let [a, b] = [world.add(body(0.0, "liver")).unwrap(), world.add(body(0.2, "stomach")).unwrap()];
    assert_eq!(world.attach(attach(a, a)).unwrap_err(), WorldError::AttachedToItself { body: "liver".into() });
    let far = world.attach(attach(b, a)).unwrap_err();
    let WorldError::TooFarToAttach { distance, .. } = far else { panic!("{far}") };
    assert!((distance - 0.18).abs() < 1e-12);
}

/// A cut through the tied cells parts the bodies, and nothing else breaks.
#[test]
fn a_cut_along_the_seam_parts_the_bodies() {
    let (mut world, [above, below], attachment) = grown(GRAVITY, |body| body.fix(side("y-max")).damping(30.0));
    for _ in 0..5 {
        world.step().unwrap();
    }
    let nodes = world.body(below).mesh().nodes();
    let lies_above =
        |&cell: &u32| world.body(below).mesh().cell(cell as usize).iter().any(|&n| nodes[n as usize].y > -0.001);
    let cells: Vec<u32> = (0..world.body(below).mesh().cell_count() as u32).filter(lies_above).collect();
    world.remove_cells(below, &cells).unwrap();
    let before = world.observe(below);
    for _ in 0..10 {
        world.step().unwrap();
    }
    assert_eq!(world.attachment_force(attachment), Vector::ZERO);
    let fallen = (world.observe(below).momentum - before.momentum) / before.mass;
    assert!((fallen.y / (-9.81 * 0.05) - 1.0).abs() < 1e-9, "{fallen:?}");
    assert!(world.body(above).max_displacement() < 0.01);
}

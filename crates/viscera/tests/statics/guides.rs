//! Nodes that are held in some directions only: symmetry planes, rollers, plates that slide.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::material::{Lame, NeoHookean, StVenantKirchhoff, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::solver::Iterative;

use crate::reference::{Vector, settle, world};

const SIZE: [f64; 3] = [0.02, 0.03, 0.05];

/// A turn by a third of a circle about no axis of the box.
fn turned(v: Vector) -> Vector {
    let axis = Vector::new(1.0, 2.0, 2.0) / 3.0;
    let (cos, sin) = (-0.5, 0.75_f64.sqrt());
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// An eighth of a bar, on its three planes of symmetry.
fn eighth(turn: impl Fn(Vector) -> Vector) -> Body {
    let mut mesh = TetMesh::box_grid([2, 2, 3], SIZE);
    mesh.nodes.iter_mut().for_each(|node| *node = turn(*node));
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(1e4, 0.3).unwrap());
    let mut body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(tissue));
    for axis in 0..3 {
        let normal = turn(unit(axis)).to_array();
        body = body.slide(Region::plane([0.0; 3], normal, 1e-9), normal);
    }
    body
}

fn unit(axis: usize) -> Vector {
    let mut unit = Vector::ZERO;
    unit[axis] = 1.0;
    unit
}

/// Uniaxial stress: pulled to a stretch l, StVK narrows to l_s² = 1 − ν (l² − 1) and pulls with P = E l (l² − 1)/2 per rest
/// area; whichever way the bar lies in space.
#[test]
fn an_eighth_of_a_bar_on_its_planes_of_symmetry_narrows_freely() {
    let stretch: f64 = 1.3;
    let narrow = (1.0 - 0.3 * (stretch * stretch - 1.0)).sqrt();
    for turn in [|v: Vector| v, turned] {
        let normal = turn(unit(2));
        let top = Region::plane((normal * SIZE[2]).to_array(), normal.to_array(), 1e-9);
        let pull = Curve::constant((stretch - 1.0) * SIZE[2]);
        let body = eighth(turn).prescribe_along(top, normal.to_array(), pull);
        let (mut world, id) = world(body, [0.0; 3]);
        settle(&mut world, id).unwrap();
        let body = world.body(id);
        let mut force = 0.0;
        for (node, &rest) in body.mesh().nodes().iter().enumerate() {
            let parts = [(0, narrow), (1, narrow), (2, stretch)]
                .map(|(axis, by)| turn(unit(axis)) * turn(unit(axis)).dot(rest) * by);
            let expected = parts[0] + parts[1] + parts[2];
            assert!((body.positions()[node] - expected).norm() < 1e-10 * SIZE[2], "node {node}");
            if rest.dot(normal) > SIZE[2] * (1.0 - 1e-9) {
                force += body.state().internal_forces[node].dot(normal);
            }
        }
        let expected = 1e4 * stretch * (stretch * stretch - 1.0) / 2.0 * SIZE[0] * SIZE[1];
        assert!((force - expected).abs() < 1e-9 * expected, "{force} N, not {expected} N");
        assert!(world.observe(id).reaction.norm() < 2.0 * expected);
    }
}

/// Under a pressure p on its three outer sides a neo-Hookean block shrinks alike in all directions, to −p = κ (J − 1): the
/// pressure follows the surface, and with its stiffness Newton's method converges quadratically. Its last steps take
/// residuals r to less than r^1.7; without, they would fall by a constant factor.
#[test]
fn a_pressure_on_a_block_converges_quadratically_to_the_closed_form() {
    let lame = Lame::from_young_poisson(1e4, 0.3).unwrap();
    let bulk = lame.lambda + 2.0 / 3.0 * lame.mu;
    let ratio: f64 = 0.7;
    let mut body = Body::new(TetMesh::box_grid([2, 2, 3], SIZE), 1000.0)
        .model(TotalLagrangian::new(Tissue::uniform(NeoHookean::new(lame))));
    for axis in 0..3 {
        let normal = unit(axis).to_array();
        body = body.slide(Region::plane([0.0; 3], normal, 1e-9), normal);
        let side = Region::plane((unit(axis) * SIZE[axis]).to_array(), normal, 1e-9);
        // σ = κ (J − 1)
        body = body.load(Load::Pressure { region: side, pressure: Curve::constant(bulk * (1.0 - ratio)) });
    }
    let (mut world, id) = world(body, [0.0; 3]);
    let settings = QuasiStatic { tolerance: 1e-12, ..QuasiStatic::default() };
    let report = world.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
    for (&now, &rest) in world.body(id).positions().iter().zip(world.body(id).mesh().nodes()) {
        assert!((now - rest * ratio.cbrt()).norm() < 1e-10 * SIZE[2], "{now:?} from {rest:?}");
    }
    let residuals = &report.steps[0].residuals;
    assert!(report.steps.len() == 1 && residuals.len() <= 8, "{report:?}");
    let quadratic = |pair: &&[f64]| pair[0] < 1e-2 && pair[0] > 1e-7;
    assert!(residuals.windows(2).filter(quadratic).all(|pair| pair[1] < pair[0].powf(1.7)), "{residuals:?}");
}

#[test]
fn a_guide_without_a_direction_is_refused() {
    let mut world = viscera::world::World::<f64>::new(viscera::world::WorldConfig::default()).unwrap();
    let body = eighth(|v| v).slide(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 1e-9), [0.0; 3]);
    let message = world.add(body).unwrap_err().to_string();
    assert!(message.contains("a guide's normal = 0 is out of range"), "{message}");
}

//! Where a load is more than a law can bear, settings that make no sense, and bodies that nothing holds.

use viscera::body::{Body, Load};
use viscera::curve::Curve;
use viscera::dynamics::quasi_static::{QuasiStatic, StaticError};
use viscera::material::{LawFamily, LinearElastic, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::mesh::{Region, TetMesh};
use viscera::model::TotalLagrangian;
use viscera::solver::Iterative;

use crate::reference::{Vector, assert_displaced, bottom, displacements, mesh, settle, world};

fn beam(law: impl LawFamily) -> Body {
    Body::new(mesh("beam_s_tet4.msh"), 1000.0).model(TotalLagrangian::new(Tissue::uniform(law))).fix(bottom())
}

/// At E = 10 kPa, ν = 0.3 the root of this beam gives way at 1.06 m/s² (Newton in numpy, load steps of 0.03): the error
/// says so, and the body stays in the last equilibrium. Stable neo-Hookean bears twice that.
#[test]
fn st_venant_kirchhoff_gives_way_where_others_found_no_equilibrium_either() {
    let gravity = [0.0, -2.0, 0.0];
    let (mut weak, id) = world(beam(StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap()), gravity);
    let error = settle(&mut weak, id).unwrap_err();
    let StaticError::NoEquilibrium { load_factor, failed_factor, law, volume_ratio, .. } = &error else {
        panic!("{error}")
    };
    assert!((1.0..1.15).contains(&(2.0 * load_factor)), "{error}");
    assert!(failed_factor - load_factor < 2.0 / 256.0, "{error}");
    assert_eq!(*law, "st-venant-kirchhoff");
    assert!(*volume_ratio > 0.0 && error.to_string().contains("stable-neo-hookean"), "{error}");
    let seen = weak.observe(id);
    let carried = 2.0 * 0.004 * 1000.0 * load_factor;
    assert!((seen.net_internal_force.norm()) < 1e-9 && seen.inverted_cells == 0);
    assert!(carried > 3.9, "{carried} N of 8 N are carried");

    let (mut strong, id) = world(beam(StableNeoHookean::from_young_poisson(10e3, 0.3).unwrap()), gravity);
    settle(&mut strong, id).unwrap();
    assert_eq!(strong.observe(id).inverted_cells, 0);
}

/// A small load bends the beam alike under every law: a thousandth of the load of case B01, whose large displacements are
/// 15 cm, so that strains are 1e-4 of what they are there.
#[test]
fn small_loads_bend_the_beam_alike_under_every_law() {
    let gravity = [0.0, -5e-4, 0.0];
    let (mut yardstick, id) = world(beam(LinearElastic::from_young_poisson(10e3, 0.3).unwrap()), gravity);
    let report = settle(&mut yardstick, id).unwrap();
    assert_eq!((report.steps.len(), report.iterations()), (1, 1));
    let expected = displacements(&yardstick, id);
    let compare = |body: Body, what: &str| {
        let (mut world, id) = world(body, gravity);
        settle(&mut world, id).unwrap();
        assert_displaced(&displacements(&world, id), &expected, 2e-3, what);
    };
    compare(beam(StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap()), "St Venant-Kirchhoff");
    compare(beam(NeoHookean::from_young_poisson(10e3, 0.3).unwrap()), "neo-Hookean");
    compare(beam(StableNeoHookean::from_young_poisson(10e3, 0.3).unwrap()), "stable neo-Hookean");

    // and one linear solve with the stiffness at rest is linear elasticity, whatever the law
    let law = StableNeoHookean::from_young_poisson(10e3, 0.3).unwrap();
    let (mut small, id) = world(beam(law), gravity);
    let settings = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
    small.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
    assert_displaced(&displacements(&small, id), &expected, 1e-9, "small strain");
}

/// A bar of 1 × 1 × 2 cm, drawn to one and a half times its length with free sides on rollers that the symmetry of one
/// cell column gives: it ends where it is told to, its force balances, and it goes back to rest.
#[test]
fn prescribed_displacements_are_reached_and_undone() {
    let mesh = TetMesh::box_grid([2, 2, 4], [0.01, 0.01, 0.02]);
    let law = StableNeoHookean::from_young_poisson(10e3, 0.45).unwrap();
    let top = Region::plane([0.0, 0.0, 0.02], [0.0, 0.0, 1.0], 0.0);
    let path = Curve::piecewise_linear(vec![(0.0, Vector::new(0.0, 0.0, 0.01)), (1.0, Vector::ZERO)]).unwrap();
    let body =
        Body::new(mesh, 1000.0).model(TotalLagrangian::new(Tissue::uniform(law))).fix(bottom()).prescribe(top, path);
    let (mut world, id) = world(body, [0.0; 3]);
    let report = settle(&mut world, id).unwrap();
    assert!(report.steps.iter().all(|step| step.residuals[step.residuals.len() - 1] <= 1e-12), "{report:?}");
    let (stretched, seen) = (displacements(&world, id), world.observe(id));
    assert!((stretched.iter().map(|u| u.z).fold(0.0, f64::max) - 0.01).abs() < 1e-15);
    assert!(seen.reaction.norm() < 1e-10 && seen.elastic_energy > 0.0, "{seen:?}");

    let settings = QuasiStatic { tolerance: 1e-12, ..QuasiStatic::default() };
    settings.solve(world.body_mut(id), [0.0; 3], 1.0, &mut Iterative::new(1e-13)).unwrap();
    let left = displacements(&world, id).iter().map(|u| u.norm()).fold(0.0, f64::max);
    assert!(left <= 1e-12 * 0.01, "{left:e} m from rest");
}

/// Cells of a stable neo-Hookean block that were thrown about, many of them inside out, come back to rest.
#[test]
fn scrambled_nodes_come_back_to_rest() {
    let law = StableNeoHookean::from_young_poisson(10e3, 0.45).unwrap();
    let mesh = TetMesh::box_grid([3, 3, 3], [0.03, 0.03, 0.03]);
    let body = Body::new(mesh, 1000.0).model(TotalLagrangian::new(Tissue::uniform(law))).fix(bottom());
    let (mut world, id) = world(body, [0.0; 3]);
    let throw = |x: f64, y: f64, z: f64| 0.015 * (1e4 * x + 3.1e4 * y + 7.3e4 * z).sin();
    world
        .body_mut(id)
        .set_positions(|x| x + Vector::new(throw(x.x, x.y, x.z), throw(x.z, x.x, x.y), throw(x.y, x.z, x.x)));
    assert!(world.observe(id).inverted_cells > 20, "{}", world.observe(id).inverted_cells);
    let settings = QuasiStatic { iterations: 200, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Iterative::default()).unwrap();
    let left = displacements(&world, id).iter().map(|u| u.norm()).fold(0.0, f64::max);
    assert!(left <= 1e-9, "{left:e} m from rest");
}

/// A pressure p on the end of a bar of length L, sides free: it shortens by about pL/E, and the reaction balances it.
#[test]
fn a_pressure_on_the_end_is_balanced_by_the_reaction() {
    let mesh = TetMesh::box_grid([2, 2, 8], [0.01, 0.01, 0.04]);
    let law = StableNeoHookean::from_young_poisson(10e3, 0.3).unwrap();
    let top = Region::plane([0.0, 0.0, 0.04], [0.0, 0.0, 1.0], 0.0);
    let body = Body::new(mesh, 1000.0)
        .model(TotalLagrangian::new(Tissue::uniform(law)))
        .fix(bottom())
        .load(Load::Pressure { region: top, pressure: Curve::constant(100.0) });
    let (mut world, id) = world(body, [0.0; 3]);
    let settings = QuasiStatic { tolerance: 1e-10, iterations: 100, ..QuasiStatic::default() };
    world.settle(id, &settings, &mut Iterative::new(1e-13)).unwrap();
    let shortened = -displacements(&world, id).iter().map(|u| u.z).fold(0.0, f64::min);
    // 1 % of strain; the glued bottom stiffens it a little
    assert!((0.9..1.05).contains(&(shortened / (0.04 * 100.0 / 10e3))), "{shortened} m");
    let reaction = world.observe(id).reaction;
    assert!((reaction.z - 100.0 * 1e-4).abs() < 0.02 * 1e-2 && reaction.z > 0.0, "{reaction:?}");
}

#[test]
fn what_cannot_be_solved_is_refused() {
    let law = StVenantKirchhoff::from_young_poisson(10e3, 0.3).unwrap();
    let free =
        Body::new(mesh("beam_s_tet4.msh"), 1000.0).name("beam").model(TotalLagrangian::new(Tissue::uniform(law)));
    let (mut world, id) = world(free, [0.0; 3]);
    let message = settle(&mut world, id).unwrap_err().to_string();
    let expected = "nothing holds body `beam`: fix or prescribe some of its nodes; a free body has no equilibrium";
    assert_eq!(message, expected);
    let settings = QuasiStatic { tolerance: f64::NAN, ..QuasiStatic::default() };
    let message = world.settle(id, &settings, &mut Iterative::default()).unwrap_err().to_string();
    assert_eq!(message, "tolerance = NaN is out of range: it must be positive");
}

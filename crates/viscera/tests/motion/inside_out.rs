//! Bodies that are turned inside out: laws that see it bring them back, and of those that do not a user is told.

use viscera::body::Body;
use viscera::material::{LawFamily, LawKind, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue};
use viscera::mesh::{HexMesh, TetMesh};
use viscera::model::{NodallyIntegrated, TotalLagrangian};
use viscera::world::{BodyId, World};

use crate::support::{DENSITY, Vector, world};

/// A cube of 10 cm, held by nothing, damped near critically, in its mirror image.
fn mirrored(body: Body) -> (World<f64>, BodyId) {
    let mut world = world::<f64>([0.0; 3], 2e-2);
    let id = world.add(body.damping(50.0)).unwrap();
    world.body_mut(id).set_positions(|x| Vector::new(-x.x, x.y, x.z));
    (world, id)
}

fn tissue<L: LawFamily>(law: L) -> Tissue {
    Tissue::uniform(law)
}

fn cube(model: impl viscera::model::ModelRecipe + 'static) -> Body {
    Body::new(TetMesh::box_grid([2, 2, 2], [0.1; 3]), DENSITY).model(model)
}

/// No cell is inverted, and no edge differs from that at rest by a millionth of the size: whatever the pose.
fn assert_is_in_rest_shape(world: &World<f64>, id: BodyId) {
    let body = world.body(id);
    let mesh = body.mesh();
    for cell in 0..mesh.cell_count() {
        assert!(body.volume_ratio(cell) > 0.0, "cell {cell} is inside out");
        for (i, &a) in mesh.cell(cell).iter().enumerate() {
            for &b in &mesh.cell(cell)[..i] {
                let length = |x: &[Vector]| (x[a as usize] - x[b as usize]).norm();
                let change = length(body.positions()) - length(mesh.nodes());
                assert!(change.abs() < 1e-6 * mesh.size(), "cell {cell}: {change:e} m");
            }
        }
    }
}

/// St Venant–Kirchhoff tissue is at rest in a mirror, and says which law would turn it back; in its rest shape it says nothing.
#[test]
fn tissue_that_is_blind_to_reflections_says_so_and_names_the_law_that_is_not() {
    let law = StVenantKirchhoff::from_young_poisson(10e3, 0.4).unwrap();
    let (mut world, id) = mirrored(cube(TotalLagrangian::new(tissue(law))));
    for _ in 0..20 {
        world.step().unwrap();
    }
    let seen = world.observe(id);
    assert_eq!((seen.inverted_cells, seen.removed_cells), (48, 0));
    let found = seen.inside_out.expect("48 cells are inside out");
    assert_eq!((found.cells, found.first, found.instead), (48, 0, LawKind::StableNeoHookean));
    assert_eq!(
        found.to_string(),
        "48 cells are inside out (cell 0 is the first), and they stay so: the law `st-venant-kirchhoff` cannot tell a cell \
         from its mirror image; take the law `stable-neo-hookean`, which turns cells back"
    );
    world.remove_cells(id, &(0..5).chain(6..48).collect::<Vec<_>>()).unwrap();
    let last = world.observe(id).inside_out.expect("cell 5 is inside out");
    assert!(last.to_string().starts_with("1 cell is inside out (cell 5 is the first), and it stays so"), "{last}");

    world.body_mut(id).set_positions(|x| Vector::new(-x.x, x.y, x.z));
    assert_eq!(world.observe(id).inside_out, None);
}

/// Laws that see reflections bring the mirror image back to the rest shape, to a millionth of the size.
#[test]
fn tissue_that_sees_reflections_comes_back_from_its_mirror_image() {
    let stable = StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap();
    let plain = NeoHookean::from_young_poisson(10e3, 0.4).unwrap();
    for body in [
        cube(TotalLagrangian::new(tissue(stable))),
        cube(TotalLagrangian::new(tissue(plain))),
        cube(NodallyIntegrated::new(tissue(stable))),
    ] {
        let (mut world, id) = mirrored(body);
        assert_eq!(world.observe(id).inside_out, None, "not for good");
        for _ in 0..60 {
            world.step().unwrap();
        }
        assert_is_in_rest_shape(&world, id);
    }
}

/// A bar of stable neo-Hookean tissue let go at `stretch` times its length.
fn stretched(stretch: f64) -> (World<f64>, BodyId) {
    let law = StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap();
    let mesh = TetMesh::box_grid([1, 1, 2], [0.1; 3]);
    let mut world = world::<f64>([0.0; 3], 2e-2);
    let id = world.add(Body::new(mesh, DENSITY).model(TotalLagrangian::new(tissue(law))).damping(50.0)).unwrap();
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, stretch * x.z));
    (world, id)
}

#[test]
fn tissue_let_go_at_thirty_times_its_length_comes_back() {
    let (mut world, id) = stretched(30.0);
    for _ in 0..60 {
        world.step().unwrap();
    }
    assert_is_in_rest_shape(&world, id);
}

/// From farther the tissue is faster by far on the way than at both ends, and its way is one of many that rounding chooses from: some end
/// folded, with no cell inside out. But sub-steps follow, every step is made, and it comes to rest.
#[test]
fn tissue_let_go_at_a_thousand_times_its_length_comes_to_rest() {
    for stretch in [100.0, 300.0, 1000.0, 1000.0 + 1e-6, 1000.0 + 2e-6] {
        let (mut world, id) = stretched(stretch);
        let first = world.step().unwrap();
        assert!(first.retries > 0, "planned on the way: {first:?}");
        for _ in 0..60 {
            world.step().unwrap();
        }
        let fastest = world.body(id).velocities().iter().map(|v| v.norm()).fold(0.0, f64::max);
        assert!(fastest < 1e-6, "{stretch}: {fastest} m/s");
    }
}

/// Hexahedra that nothing holds, let go at a thousand times their length, fly into each other within a sub-step, and out again beyond all bounds:
/// with sub-steps in which no cell is strained by more than a tenth they come back.
#[test]
fn hexahedra_let_go_at_a_thousand_times_their_length_come_back() {
    let law = StableNeoHookean::from_young_poisson(10e3, 0.4).unwrap();
    let body = Body::new(HexMesh::box_grid([2, 2, 2], [0.1; 3]), DENSITY).model(TotalLagrangian::new(tissue(law)));
    let mut world = world::<f64>([0.0; 3], 2e-2);
    let id = world.add(body.damping(50.0)).unwrap();
    world.body_mut(id).set_positions(|x| Vector::new(x.x, x.y, 1000.0 * x.z));
    for _ in 0..100 {
        world.step().unwrap();
    }
    assert_is_in_rest_shape(&world, id);
}

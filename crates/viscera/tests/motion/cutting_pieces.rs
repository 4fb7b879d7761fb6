//! Cells are removed while a body moves: mass, nodes and pieces.

use viscera::body::{Body, LoosePieces, NodeMotion};
use viscera::mesh::TetMesh;
use viscera::model::{LinearTensorMass, ModelRecipe, Precision, TensorMass, TotalLagrangian};
use viscera::world::{BodyId, World, WorldError};

use crate::support::{
    DENSITY, Vector, assert_relative, assert_vector, free_bar, in_both_precisions, linear, side, stvk, world,
};

/// Cells of the bar whose centre lies between two heights [m].
fn slice<T: Precision>(world: &World<T>, id: BodyId, from: f64, to: f64) -> Vec<u32> {
    let mesh = world.body(id).mesh();
    let height = |cell: usize| mesh.cell(cell).iter().map(|&node| mesh.nodes()[node as usize].z).sum::<f64>() / 4.0;
    (0..mesh.cell_count()).filter(|&cell| (from..to).contains(&height(cell))).map(|cell| cell as u32).collect()
}

/// Mass goes with the cells, ρ V of each, and what no cell needs any longer stands still.
fn removed_cells_take_their_mass_along_and_their_nodes_stop<T: Precision>(tolerance: f64) {
    let recipes: [Box<dyn ModelRecipe>; 3] = [
        Box::new(TotalLagrangian::new(stvk(5e3, 0.4))),
        Box::new(TensorMass::new(stvk(5e3, 0.4))),
        Box::new(LinearTensorMass::new(linear(5e3, 0.4))),
    ];
    for recipe in recipes {
        let mut world = world::<T>([0.0, -9.81, 0.0], 5e-3);
        let mesh = TetMesh::box_grid([2, 2, 8], [0.04, 0.04, 0.16]);
        let id = world.add(Body::new(mesh, DENSITY).boxed_model(recipe).keep_volume(5e3).fix(side("z-min"))).unwrap();
        for _ in 0..10 {
            world.step().unwrap();
        }
        // The two top layers of cells: a quarter of the bar, and the nodes above 12 cm have nothing left.
        let cells = slice(&world, id, 0.12, 0.16);
        let before = world.observe(id).mass;
        assert_eq!(world.remove_cells(id, &cells).unwrap(), cells.len());
        assert_eq!(world.remove_cells(id, &cells).unwrap(), 0, "gone cells go only once");
        assert_relative(world.observe(id).mass, 0.75 * before, tolerance);
        let stopped = world.body(id).positions().to_vec();
        for _ in 0..10 {
            world.step().unwrap();
        }
        let seen = world.observe(id);
        assert_eq!(seen.removed_cells, cells.len());
        assert_relative(seen.mass, 0.75 * before, tolerance);
        let body = world.body(id);
        for (node, rest) in body.mesh().nodes().iter().enumerate() {
            let above = rest.z > 0.121;
            assert_eq!(body.state().motions[node] == NodeMotion::Retired, above, "node {node} at rest at {rest:?}");
            if above {
                assert_eq!(body.positions()[node], stopped[node]);
            }
        }
    }
}
in_both_precisions!(removed_cells_take_their_mass_along_and_their_nodes_stop, f32: 1e-6, f64: 1e-12);

/// Cut in two, the held part stays and the other falls: its centre of mass moves with v₀t − gt²/2 from then on.
#[test]
fn a_piece_cut_loose_falls_freely() {
    let mut world = world::<f64>([0.0, -9.81, 0.0], 5e-3);
    let id = world.add(free_bar().fix(side("z-min"))).unwrap();
    for _ in 0..10 {
        world.step().unwrap();
    }
    let gap = slice(&world, id, 0.06, 0.08);
    world.remove_cells(id, &gap).unwrap();
    assert_eq!(world.body(id).piece_count(), 2);

    let centre = |world: &World<f64>| {
        let body = world.body(id);
        let above = (0..body.positions().len()).filter(|&node| body.mesh().nodes()[node].z > 0.079);
        let (mut mass, mut place, mut momentum) = (0.0, Vector::ZERO, Vector::ZERO);
        for node in above {
            let m = body.state().masses[node];
            mass += m;
            place += body.positions()[node] * m;
            momentum += body.velocities()[node] * m;
        }
        (place / mass, momentum / mass)
    };
    let ((place, velocity), start) = (centre(&world), world.time());
    for _ in 0..40 {
        world.step().unwrap();
        let t = world.time() - start;
        let fallen = velocity * t + Vector::new(0.0, -0.5 * 9.81 * t * t, 0.0);
        assert_vector(centre(&world).0 - place, fallen, 1e-10);
    }
}

/// Where loose pieces are dropped, exactly what nothing holds is removed with the cut; a piece that two ends hold stays.
#[test]
fn a_loose_piece_is_dropped_and_a_held_one_is_not() {
    for (held, dropped_too) in [(&["z-min"][..], true), (&["z-min", "z-max"][..], false)] {
        let mut world = world::<f64>([0.0, -9.81, 0.0], 5e-3);
        let body = held.iter().fold(free_bar(), |body, name| body.fix(side(name)));
        let id = world.add(body.loose_pieces(LoosePieces::Drop)).unwrap();
        let gap = slice(&world, id, 0.06, 0.08);
        let loose = slice(&world, id, 0.08, 0.16);
        let expected = gap.len() + if dropped_too { loose.len() } else { 0 };
        assert_eq!(world.remove_cells(id, &gap).unwrap(), expected);
        for cell in loose {
            assert_eq!(world.body(id).state().removed[cell as usize], dropped_too, "cell {cell}, held at {held:?}");
        }
        world.step().unwrap();
    }
}

/// The surface of what is left is closed: every edge is run through once in each direction.
#[test]
fn the_surface_after_a_cut_is_closed_and_faces_outwards() {
    let mut world = world::<f64>([0.0; 3], 5e-3);
    let id = world.add(free_bar()).unwrap();
    let gap = slice(&world, id, 0.05, 0.07);
    world.remove_cells(id, &gap).unwrap();
    let surface = world.body(id).surface();
    assert!(surface.iter().any(|triangle| triangle.cut) && surface.iter().any(|triangle| !triangle.cut));
    let mut runs = std::collections::BTreeMap::<(u32, u32), i32>::new();
    for [a, b, c] in surface.iter().map(|triangle| triangle.nodes) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *runs.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    assert!(runs.values().all(|&sum| sum == 0), "the surface has a border");
    // Divergence theorem: the volume inside it is that of the cells that are left.
    let at = |node: u32| world.body(id).positions()[node as usize];
    let inside: f64 = surface.iter().map(|t| at(t.nodes[0]).dot(at(t.nodes[1]).cross(at(t.nodes[2]))) / 6.0).sum();
    assert_relative(inside, world.observe(id).volume, 1e-12);
}

/// A body whose every cell is gone does nothing, and does it without complaint.
#[test]
fn a_body_can_be_cut_away_altogether() {
    let mut world = world::<f64>([0.0, -9.81, 0.0], 5e-3);
    let id = world.add(free_bar()).unwrap();
    let all = slice(&world, id, 0.0, 1.0);
    world.remove_cells(id, &all).unwrap();
    world.step().unwrap();
    let seen = world.observe(id);
    assert_eq!((seen.mass, seen.volume, seen.kinetic_energy), (0.0, 0.0, 0.0));
    assert!(world.body(id).surface().is_empty());
}

/// A number that the body does not have is refused by name, and nothing is removed.
#[test]
fn a_cell_that_is_not_there_is_refused() {
    let mut world = world::<f64>([0.0; 3], 5e-3);
    let id = world.add(free_bar()).unwrap();
    let cells = world.body(id).cell_count();
    let error = world.remove_cells(id, &[0, cells as u32]).unwrap_err();
    assert_eq!(error, WorldError::MissingCell { body: "body".into(), cell: cells as u32, cells });
    assert_eq!(world.body(id).cell_count(), cells);
}

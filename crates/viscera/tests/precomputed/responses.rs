//! What is pre-computed is the static solution: for any nodes that are imposed, positions and reactions are those of a solve in full.

use std::sync::atomic::{AtomicUsize, Ordering};

use viscera::executor::Executor;
use viscera::mesh::VolumeMesh;
use viscera::model::precomputed::{ContactError, ContactSystem};
use viscera::solver::{Envelope, Iterative};

use crate::support::{
    Random, Vector, difference, displacements, hexahedra, in_full, prescribed, responses, solved, standing, tetrahedra,
};

/// `count` handles in no order, and up to a centimetre for each.
fn imposed(handles: &[u32], count: usize, random: &mut Random) -> (Vec<u32>, Vec<Vector>) {
    let mut nodes = handles.to_vec();
    for place in 0..count {
        let other = place + ((0.5 + 0.5 * random.number()) * (nodes.len() - place) as f64) as usize;
        nodes.swap(place, other.min(handles.len() - 1));
    }
    nodes.truncate(count);
    let ways = nodes.iter().map(|_| random.vector() * 0.01).collect();
    (nodes, ways)
}

fn assert_equal_to_the_full_solve(mesh: &VolumeMesh, is_hex: bool) {
    let responses = responses(&standing(mesh.clone()));
    let mut random = Random::new();
    let mut system = ContactSystem::with_room(20);
    for count in [1, 3, 20] {
        let (nodes, ways) = imposed(responses.handles(), count, &mut random);
        let mut found = vec![Vector::ZERO; responses.node_count()];
        system.impose(&responses, &nodes).unwrap();
        system.displace(&responses, &ways, &mut found);

        let body = prescribed(in_full(standing(mesh.clone()), is_hex), &nodes, &ways);
        let (mut world, id) = solved(body, [0.0; 3]);
        let apart = difference(&found, &displacements(&world, id));
        assert!(apart < 1e-8, "{count} nodes: displacements differ by {apart:.1e}");
        let reactions = world.internal_forces(id);
        let wanted: Vec<_> = nodes.iter().map(|&node| reactions[node as usize]).collect();
        let forces: Vec<_> = (0..count).map(|place| system.force(place)).collect();
        let apart = difference(&forces, &wanted);
        assert!(apart < 1e-8, "{count} nodes: reactions differ by {apart:.1e}");
    }
}

#[test]
fn imposed_nodes_of_tetrahedra_equal_the_full_static_solve() {
    assert_equal_to_the_full_solve(&tetrahedra(), false);
}

#[test]
fn imposed_nodes_of_hexahedra_equal_the_full_static_solve() {
    assert_equal_to_the_full_solve(&hexahedra(), true);
}

/// The order in which nodes are named changes nothing but roundings.
#[test]
fn imposed_nodes_may_come_in_any_order() {
    let responses = responses(&standing(tetrahedra()));
    let (nodes, ways) = imposed(responses.handles(), 20, &mut Random::new());
    let answer = |nodes: &[u32], ways: &[Vector]| {
        let (mut system, mut found) = (ContactSystem::default(), vec![Vector::ZERO; responses.node_count()]);
        system.impose(&responses, nodes).unwrap();
        system.displace(&responses, ways, &mut found);
        found
    };
    let forwards = answer(&nodes, &ways);
    let (back, back_ways): (Vec<_>, Vec<_>) = nodes.iter().zip(&ways).rev().map(|(&n, &w)| (n, w)).unzip();
    assert!(difference(&answer(&back, &back_ways), &forwards) < 1e-11);
}

/// Betti and Maxwell: what a force at k does at i, the same force at i does at k.
#[test]
fn responses_are_reciprocal() {
    let responses = responses(&standing(tetrahedra()));
    let handles = responses.handles();
    let largest = responses.response(handles[0], 0).squared_norm().sqrt();
    for (i, &node) in handles.iter().enumerate() {
        for (k, &other) in handles.iter().enumerate() {
            let apart = responses.response(node, k) - responses.response(other, i).transpose();
            assert!(apart.squared_norm().sqrt() < 1e-11 * largest, "nodes {node} and {other}");
        }
    }
}

#[test]
fn responses_have_the_same_bits_on_any_number_of_threads_and_progress_counts_every_handle() {
    let body = standing(tetrahedra());
    let alone = responses(&body);
    for threads in [1, 2, 8] {
        let (calls, last) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let progress = |done: usize, of: usize| {
            assert_eq!(of, alone.handles().len());
            calls.fetch_add(1, Ordering::Relaxed);
            last.fetch_max(done, Ordering::Relaxed);
        };
        let executor = Executor::threads(threads).unwrap();
        let together = body.precompute(&mut Envelope::default(), &executor, &progress).unwrap();
        assert!(together == alone, "{threads} threads");
        assert_eq!((calls.into_inner(), last.into_inner()), (alone.handles().len(), alone.handles().len()));
    }
}

/// Two solvers that share nothing but the matrix.
#[test]
fn conjugate_gradients_find_the_same_responses() {
    let body = standing(hexahedra());
    let factored = responses(&body);
    let iterated = body.precompute(&mut Iterative::new(1e-13), &Executor::serial(), &|_, _| ()).unwrap();
    let all = |of: &viscera::model::precomputed::Responses| {
        let column = |handle: usize| (0..of.node_count() as u32).map(move |node| (node, handle));
        let blocks = (0..of.handles().len()).flat_map(column).map(|(node, handle)| of.response(node, handle));
        blocks.flat_map(|block| block.columns).collect::<Vec<_>>()
    };
    assert!(difference(&all(&iterated), &all(&factored)) < 1e-10);
}

#[test]
fn nodes_without_a_response_and_nodes_named_twice_are_refused() {
    let responses = responses(&standing(tetrahedra()));
    let mut system = ContactSystem::default();
    let fixed = (0..responses.node_count() as u32).find(|&node| responses.handle_of(node).is_none()).unwrap();
    let free = responses.handles()[0];
    assert_eq!(system.impose(&responses, &[free, fixed]), Err(ContactError::NoResponse { node: fixed }));
    assert_eq!(system.impose(&responses, &[free, free]), Err(ContactError::NotIndependent { node: free }));
    assert_eq!(system.impose(&responses, &[free]), Ok(()));
}

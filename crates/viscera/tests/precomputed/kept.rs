//! Responses that are kept: the same when they are read again, and refused where they are those of another body.

use std::sync::Arc;

use viscera::body::{Body, BodyError};
use viscera::mesh::{Region, TetMesh};
use viscera::model::precomputed::{Responses, ResponsesError};
use viscera::model::{ModelError, Precomputed};
use viscera::world::{Integrator, WorldError};

use crate::support::{bottom, loose, responses, standing, tetrahedra, tissue, world};

#[test]
fn responses_are_the_same_when_they_are_read_again() {
    let kept = responses(&standing(tetrahedra()));
    let bytes = kept.to_bytes();
    let read = Responses::from_bytes(&bytes).unwrap();
    assert!(read == kept && read.to_bytes() == bytes);
    assert_eq!(bytes.len(), 44 + kept.bytes());
}

/// Every way in which a body can be another one than the responses were computed for, and what the refusal names.
#[test]
fn stale_responses_are_refused_with_what_differs() {
    let kept = Arc::new(responses(&standing(tetrahedra())));
    let fits = |body: Body, young: f64| {
        let model = Precomputed::new(tissue(young)).responses(kept.clone());
        world([0.0; 3], Integrator::default()).add(body.model(model)).map(|_| ())
    };
    let stale = |what| {
        let source = ModelError::Responses(ResponsesError::Stale { what });
        Err(WorldError::Body(BodyError::Model { body: "block".into(), source }))
    };
    assert_eq!(fits(standing(tetrahedra()), 6e3), Ok(()));
    assert_eq!(fits(standing(tetrahedra()), 6.0001e3), stale("tissue"));
    assert_eq!(fits(loose(tetrahedra()).fix(bottom()).fix(Region::Nodes(vec![40])), 6e3), stale("set of held nodes"));
    assert_eq!(
        fits(loose(tetrahedra()).slide(bottom(), [0.0, 0.0, 1.0]).fix(Region::Nodes(vec![0, 1, 2])), 6e3),
        stale("set of held nodes")
    );
    let mut moved = match tetrahedra() {
        viscera::mesh::VolumeMesh::Tet(mesh) => mesh,
        viscera::mesh::VolumeMesh::Hex(_) => TetMesh::default(),
    };
    let last = moved.nodes.len() - 1;
    moved.nodes[last].x += 1e-9;
    assert_eq!(fits(standing(moved.into()), 6e3), stale("mesh"));
}

#[test]
fn bytes_that_are_damaged_or_of_something_else_are_refused() {
    let bytes = responses(&standing(tetrahedra())).to_bytes();
    let read = |bytes: &[u8]| Responses::from_bytes(bytes).map(|_| ());
    for length in [11, 12, 43, 44, bytes.len() / 2, bytes.len() - 1] {
        assert_eq!(read(&bytes[..length]), Err(ResponsesError::Damaged { length }));
    }
    assert_eq!(read(&bytes[..9]), Err(ResponsesError::NotResponses));
    assert_eq!(read(b"viscera\0\0\0 and more of it"), Err(ResponsesError::NotResponses));
    let with = |place: usize, value: u8| {
        let mut other = bytes.clone();
        other[place] = value;
        let content = other.len() - 4;
        let checksum = crc32fast::hash(&other[..content]);
        other[content..].copy_from_slice(&checksum.to_le_bytes());
        other
    };
    assert_eq!(read(&with(10, 9)), Err(ResponsesError::OtherVersion { found: 9, known: 1 }));
    // Another count of nodes, with a checksum that is right.
    assert_eq!(read(&with(24, 1)), Err(ResponsesError::Damaged { length: bytes.len() }));
    let mut flipped = bytes.clone();
    flipped[1000] ^= 1;
    assert_eq!(read(&flipped), Err(ResponsesError::Damaged { length: bytes.len() }));
}

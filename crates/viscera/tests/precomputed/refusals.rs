//! What a pre-computed body cannot do is refused when it is added.

use viscera::body::{Body, BodyError};
use viscera::material::{StVenantKirchhoff, Tissue};
use viscera::model::precomputed::ResponsesError;
use viscera::model::{ModelError, ModelKind, Precomputed};
use viscera::world::{Attachment, Integrator, WorldError};

use crate::support::{in_full, loose, standing, tetrahedra, top, world};

fn refusal(body: Body) -> BodyError {
    match world([0.0; 3], Integrator::default()).add(body) {
        Err(WorldError::Body(error)) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_floating_body_has_no_answer() {
    let source = ModelError::Responses(ResponsesError::NothingHolds);
    assert_eq!(refusal(loose(tetrahedra())), BodyError::Model { body: "block".into(), source });
}

#[test]
fn a_body_that_rests_has_no_damping_and_no_volume_penalty() {
    let name = |body: Body| match refusal(body) {
        BodyError::OutOfRange { name, .. } => name,
        other => panic!("{other}"),
    };
    assert_eq!(name(standing(tetrahedra()).damping(1.0)), "damping");
    assert_eq!(name(standing(tetrahedra()).stiffness_damping(1e-3)), "stiffness damping");
    assert_eq!(name(standing(tetrahedra()).keep_volume(1e3)), "keep-volume");
}

#[test]
fn a_law_that_is_not_linear_is_refused() {
    let tissue = Tissue::uniform(StVenantKirchhoff::from_young_poisson(5e3, 0.4).unwrap());
    let message = refusal(standing(tetrahedra()).model(Precomputed::new(tissue))).to_string();
    assert!(message.contains("take the law `linear`"), "{message}");
}

/// A cut would change every response, and impulses that hold bodies together move none of the nodes.
#[test]
fn a_precomputed_body_is_neither_cut_nor_attached() {
    let mut world = world([0.0; 3], Integrator::default());
    let id = world.add(standing(tetrahedra())).unwrap();
    let moving = world.add(in_full(standing(tetrahedra()), false).name("moving")).unwrap();
    match world.remove_cells(id, &[0]) {
        Err(WorldError::ModelCannotBeCut { model: ModelKind::Precomputed, .. }) => {}
        other => panic!("{other:?}"),
    }
    let refused = world.attach(Attachment { body: moving, region: top(), to: id });
    let model = ModelKind::Precomputed;
    assert_eq!(refused, Err(WorldError::AttachedToPrecomputed { body: "block".into(), model }));
}

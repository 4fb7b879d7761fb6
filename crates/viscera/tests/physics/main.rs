//! The physics of laws and force models: against numbers that others computed, and against what must hold for any of them.
//!
//! `law_*` and `model_*` run over the registries by themselves: a new law or model is tested with no further line.
//! `reference_*` compare with the cases in `tests/data/references`.

mod body_deformation;
mod body_placement;
mod body_stress;
mod corotational;
mod corotational_motion;
mod law_derivatives;
mod law_lanes;
mod law_rest;
mod law_symmetry;
mod math;
mod model_adaptive;
mod model_assembly;
mod model_balance;
mod model_copies;
mod model_equality;
mod model_gradient;
mod model_invariance;
mod model_lanes;
mod model_refusal;
mod model_removal;
mod model_slivers;
mod reference_compressible;
mod reference_corotational_beam;
mod reference_patch;
mod reference_single_elements;
mod reference_volume_penalty;
mod rotation;
mod stiffness_warping;
mod support;
mod topology;

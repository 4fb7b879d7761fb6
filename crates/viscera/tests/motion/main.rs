//! Bodies in motion: the explicit scheme against closed forms, and what a world promises about its steps.
//!
//! `dynamics_*` compare with theory, `reference_*` with computations of others, `cutting_*` and `world_*` hold what a
//! user relies on, in both precisions where rounding could tell them apart.

mod cutting_cautery;
mod cutting_pieces;
mod dynamics_chain;
mod dynamics_free_flight;
mod dynamics_loads;
mod dynamics_statics;
mod grasper;
mod guides;
mod inside_out;
mod reference_cylinder;
mod reference_tube;
mod strides;
mod support;
mod threads;
mod world_invariance;
mod world_refusal;
mod world_snapshot;
mod world_snapshot_bytes;
mod world_stable_step;
mod world_stages;

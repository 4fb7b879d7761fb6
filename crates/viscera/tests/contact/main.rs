//! Rigid tools and soft tissue: what one does to the other, in explicit and in implicit steps.

mod attachment;
mod cautery;
mod friction;
mod grip;
mod hand;
mod kinds;

mod support;
mod thin;
mod tied;
mod trocar;
mod undo;
mod weight;

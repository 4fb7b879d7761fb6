//! Equilibria: against discrete solutions that other programs computed on the same meshes, and at the limit of what a law
//! can bear.

mod guides;
mod limits;
mod locking;
mod reference;
mod references;
mod responses;
mod steps;

//! Implicit steps and the solver under them: orders of accuracy, what is conserved, what is the same, what is refused.

mod accuracy;
mod allocation;
mod conservation;
mod multigrid;
mod practice;
mod reference;
mod sameness;
mod solver;
mod support;
mod torture;

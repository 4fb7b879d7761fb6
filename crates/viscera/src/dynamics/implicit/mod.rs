//! Implicit steps: the forces at the end of a step, or in its middle, decide it, so that stiff tissue bears long steps.
//!
//! All schemes share one form. With δ = x⁺ − x, each node has a place and a velocity that it would reach without forces,
//! δ̂ and v̂, and three numbers r, s, θ, which make the scheme:
//!
//! a = r/Δt² (δ − δ̂),   v⁺ = v̂ + s/Δt (δ − δ̂),   y = x + θ δ,   v_θ = (1 − θ) v + θ v⁺
//!
//! M a + F(y) + C v_θ = R(y),   C = α K(y) + β M
//!
//! Newton's method solves that, with the matrix (r/Δt² + θ s β/Δt) M + θ (1 + α s/Δt) K(y), and θ times the
//! stiffness of actuators and force fields. Not in the matrix: the change of α K
//! with the place, the stiffness of pressures that follow the surface, and the asymmetric part of the energy–momentum
//! scheme, all of which vanish with Δt; the equation that is solved has them. One iteration of backward Euler from δ = 0 is
//! the linearised step of Baraff and Witkin,
//!
//! (M + Δt C + Δt² K) Δv = Δt (R − F(x) − Δt K v − C v),   v + Δv = δ/Δt
//!
//! Bodies that ties hold together are solved as one (`group.rs`): every place that Newton's method tries fulfils the ties.
//!
//! Source: Baraff, Witkin, Large steps in cloth simulation (1998); Nesme et al. (2005).

mod backward_euler;
mod balance;
mod bdf2;
mod correction;
mod energy;
mod energy_momentum;
mod group;
mod memory;
mod newmark;
mod newton;
mod potential;
mod report;
mod scheme;
mod settings;
mod step;
mod tangent;
mod ties;
mod tools;

pub(crate) use group::{Interval, Refused, advance};
pub use memory::ImplicitMemory;
pub use report::ImplicitReport;
pub use scheme::Scheme;
pub use settings::{Implicit, MatrixForm, Newton, Preconditioning};
pub(crate) use ties::ImplicitTies;

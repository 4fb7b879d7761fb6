//! A bar of one column of hexahedra without lateral contraction moves like a chain of masses and springs, for which the
//! scheme's motion is known to the last digit.
//!
//! With n cells of length h and c² = E/ρ: ω_k = (2c/h) sin((2k−1)π/4n), u_j = sin((2k−1)πj/2n) for the end j = 0 held.

use viscera::body::Body;
use viscera::mesh::HexMesh;
use viscera::model::TotalLagrangian;
use viscera::world::{BodyId, World};

use crate::support::{DENSITY, Vector, assert_relative, linear, side, world_of_single_substeps};

const CELLS: usize = 16;
const LENGTH: f64 = 0.4; // m
const YOUNG: f64 = 10e3; // Pa
const STEP: f64 = 2e-3; // s
const AMPLITUDE: f64 = 1e-3; // m

/// The bar, stretched into the shape of its mode `k` (1, 2, …).
fn chain(k: usize, damping: f64) -> (World<f64>, BodyId) {
    let mut world = world_of_single_substeps(STEP);
    let mesh = HexMesh::box_grid([1, 1, CELLS], [0.025, 0.025, LENGTH]);
    let body = Body::new(mesh, DENSITY).model(TotalLagrangian::new(linear(YOUNG, 0.0))).damping(damping);
    let id = world.add(body.fix(side("z-min"))).unwrap();
    let wave = (2 * k - 1) as f64 * std::f64::consts::PI / (2.0 * LENGTH);
    world.body_mut(id).set_positions(|x| x + Vector::new(0.0, 0.0, AMPLITUDE * (wave * x.z).sin()));
    (world, id)
}

/// Angular frequency of mode `k` of the chain [rad/s].
fn frequency(k: usize) -> f64 {
    let wave_speed = (YOUNG / DENSITY).sqrt();
    let angle = (2 * k - 1) as f64 * std::f64::consts::PI / (4 * CELLS) as f64;
    2.0 * wave_speed * CELLS as f64 / LENGTH * angle.sin()
}

/// Displacement of the free end [m].
fn tip(world: &World<f64>, id: BodyId) -> f64 {
    let body = world.body(id);
    let last = body.positions().len() - 1;
    body.positions()[last].z - body.mesh().nodes()[last].z
}

/// Undamped: u = A cos(Ω t) with sin(ΩΔt/2) = ωΔt/2, to rounding over 500 steps.
#[test]
fn a_mode_swings_at_the_frequency_of_the_scheme() {
    for k in [1, 2, 5] {
        let (mut world, id) = chain(k, 0.0);
        let sign = tip(&world, id).signum();
        let omega = 2.0 / STEP * (0.5 * frequency(k) * STEP).asin();
        for _ in 0..500 {
            world.step().unwrap();
            let expected = sign * AMPLITUDE * (omega * world.time()).cos();
            let error = (tip(&world, id) - expected).abs() / AMPLITUDE;
            assert!(error < 1e-10, "mode {k} at {} s: {error:.2e}", world.time());
        }
    }
}

/// A rod of length L held at one end sounds at c/4L; 16 cells and 2 ms are within a thousandth of that.
#[test]
fn the_first_period_is_that_of_an_organ_pipe() {
    let (mut world, id) = chain(1, 0.0);
    let mut crossings = Vec::new();
    while crossings.len() < 5 {
        let (before, time) = (tip(&world, id), world.time());
        world.step().unwrap();
        let after = tip(&world, id);
        if before * after < 0.0 {
            crossings.push(time + STEP * before / (before - after));
        }
    }
    let period = (crossings[4] - crossings[0]) / 2.0;
    assert_relative(period, 4.0 * LENGTH / (YOUNG / DENSITY).sqrt(), 1e-3);
}

/// The damped motion is that of the papers' central differences (RR-4028, eq. 11, with the sign of γ corrected), which
/// know a past position and no velocity: (1/Δt² + γ/2Δt) u⁺ = (2/Δt² − ω²) u − (1/Δt² − γ/2Δt) u⁻.
#[test]
fn the_velocity_form_makes_the_steps_of_the_papers_central_differences() {
    for damping in [0.7, 8.0, 60.0] {
        let (mut world, id) = chain(1, damping);
        let (square, gamma) = (1.0 / (STEP * STEP), damping / (2.0 * STEP));
        let stiffness = frequency(1).powi(2);
        // At rest at the beginning: u⁻ = u⁺ − 2Δt·0.
        let (mut past, mut now) = (0.0, tip(&world, id));
        for step in 0..300 {
            let next = if step == 0 {
                now - 0.5 * stiffness * STEP * STEP * now
            } else {
                ((2.0 * square - stiffness) * now - (square - gamma) * past) / (square + gamma)
            };
            (past, now) = (now, next);
            world.step().unwrap();
            assert!((tip(&world, id) - now).abs() < 1e-10 * AMPLITUDE, "damping {damping}, step {step}");
        }
    }
}

/// A weakly damped mode dies down as exp(−γt/2); the scheme's own rate, ½ ln((1 + γΔt/2)/(1 − γΔt/2))/Δt, is γ/2 to
/// (γΔt)²/12.
#[test]
fn damping_takes_half_its_rate_from_the_amplitude() {
    let damping = 2.0;
    let (mut world, id) = chain(1, damping);
    // The first height is no peak of the swing: it is where it was let go.
    let mut peaks: Vec<(f64, f64)> = Vec::new();
    let (mut before, mut now) = (tip(&world, id), tip(&world, id));
    while peaks.len() < 7 {
        world.step().unwrap();
        let next = tip(&world, id);
        if now.abs() > before.abs() && now.abs() >= next.abs() {
            // The parabola through three points gives the height between them.
            let height = now - (next - before).powi(2) / (8.0 * (next - 2.0 * now + before));
            let offset = 0.5 * (before - next) / (next - 2.0 * now + before);
            peaks.push((world.time() + (offset - 1.0) * STEP, height.abs()));
        }
        (before, now) = (now, next);
    }
    let (first, last) = (peaks[0], peaks[6]);
    let rate = (first.1 / last.1).ln() / (last.0 - first.0);
    assert_relative(rate, damping / 2.0, 1e-4);
}

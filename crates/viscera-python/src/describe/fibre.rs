//! Fibres in a scene's words.
//!
//! A law keeps of its fibres the unit direction and κ_a = (λL − λ)/2 + μL − μ; a scene has a direction of any length, λL and μL, of which
//! the same numbers are computed again, with their rounding. So a direction and a stiffness are looked for, among those that differ in
//! their last digits, of which the very same come out: a scene that is written runs to the same bits.

use pyo3::PyResult;
use serde_json::Value as Json;
use viscera::material::{Fibre, Lame};
use viscera::math::Vec3;

use super::{object, refuse, vector};

/// How many neighbours of a number on either side are tried.
const NEIGHBOURS: i64 = 8;
/// How many lengths of the direction are tried.
const LENGTHS: u32 = 400;

pub(super) fn fibre(matrix: Lame, direction: Vec3<f64>, stiffness: f64) -> PyResult<Json> {
    let gives = |direction: Vec3<f64>, along: Lame| Fibre::new(direction.to_array(), along, matrix).ok();
    let near = |value: f64, steps: i64| f64::from_bits(value.to_bits().wrapping_add_signed(steps));
    let all = || (0..=2 * NEIGHBOURS).map(|step| if step % 2 == 0 { step / 2 } else { -(step + 1) / 2 });
    let along =
        all().flat_map(|of_lambda| all().map(move |of_mu| (of_lambda, of_mu))).find_map(|(of_lambda, of_mu)| {
            let along = Lame { lambda: near(matrix.lambda + 2.0 * stiffness, of_lambda), mu: near(matrix.mu, of_mu) };
            gives(direction, along).is_some_and(|fibre| fibre.stiffness == stiffness).then_some(along)
        });
    let written = along.and_then(|along| {
        let lengths = (0..LENGTHS).map(|step| 1.0 + f64::from(step) / f64::from(LENGTHS));
        let direction = lengths
            .map(|length| direction * length)
            .find(|&longer| gives(longer, along).is_some_and(|fibre| fibre.direction == direction))?;
        Some(object! {
            "direction": vector(direction),
            "lambda": Json::from(along.lambda),
            "mu": Json::from(along.mu),
        })
    });
    written.ok_or_else(|| {
        refuse(format!(
            "no fibres in a scene's words have the stiffness {stiffness:?} Pa and the direction {direction:?} to the last digit: give them \
             fewer digits"
        ))
    })
}

//! The force between two samples.
//!
//! With the last two samples (t, P, F) at n and n−1, at the time t and the place P of the tool:
//!
//! * hold: F_n;
//! * in time: F_n + (F_n − F_{n−1}) (t − t_n)/(t_n − t_{n−1});
//! * in position: F_n + (F_n − F_{n−1}) ((P − P_n)·(P_n − P_{n−1}))/|P_n − P_{n−1}|²;
//! * linearised: F_n − K (P − P_n), where K says along the last way what the samples said.
//!
//! Source of the first three: Picinbono, Lombardo, *Extrapolation: a solution for force feedback?*, 1999/2000. Their error over a
//! hand that moves smoothly: of hold ∝ Δt, of the others ∝ Δt², of position none where tissue is linear and pulled along a line.
//!
//! A stiffness that comes with the samples is that of tissue at rest. A hand that moves feels inertia and damping as well: with
//! that stiffness alone the error was ∝ Δt, six times that of a learnt one at 8 ms, measured on a liver (`validation/results/extrapolation`).
//! So it is corrected along the last way, as a learnt one is, and says more than that across.

use crate::{Contact, Matrix, Sample, SampleError, Vector};

/// How the force goes on after the last sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Extrapolation {
    /// It stays as it is: a staircase that the hand feels as a rattle, and that gives it energy.
    Hold,
    /// As it has changed with time. Goes on when the hand stops.
    Time,
    /// As it has changed with place, along the last way of the tool; knows nothing of other directions.
    Position,
    /// As the stiffness at the contact says, in all directions: that of the sample, or the one before it, corrected by the samples
    /// (Broyden's update, Math. Comp. 19, 1965) so that along the last way it says what [`Extrapolation::Position`] says.
    #[default]
    Linearised,
    /// The sample itself: the tissue is stepped in every period of the channel. A sample that is not of this period counts as missing.
    Direct,
}

impl Extrapolation {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Hold, Self::Time, Self::Position, Self::Linearised, Self::Direct];

    /// Its name, as commands and tables have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Time => "time",
            Self::Position => "position",
            Self::Linearised => "linearised",
            Self::Direct => "direct",
        }
    }
}

/// What is known of the tissue around the tool since the last sample.
#[derive(Clone, Debug)]
pub struct LocalModel {
    extrapolation: Extrapolation,
    /// How far to go on, in distances between the last two samples.
    reach: f64,
    /// Stiffness above which no slope is believed [N/m].
    stiffest: f64,
    /// Way of the tool [m] that is told from none.
    resolution: f64,
    last: Option<Sample>,
    before: Option<Sample>,
    /// That of the samples, corrected by their forces, or learnt from these alone [N/m].
    stiffness: Matrix,
}

impl LocalModel {
    /// Knows nothing yet. It goes at most `reach` [> 0] times as far as from the last sample but one to the last, in time or in
    /// position; believes no stiffness above `stiffest` [N/m, > 0]; ways of the tool that are not longer than `resolution` [m, ≥ 0]
    /// teach it little.
    pub fn new(extrapolation: Extrapolation, reach: f64, stiffest: f64, resolution: f64) -> Self {
        Self { extrapolation, reach, stiffest, resolution, last: None, before: None, stiffness: Matrix::ZERO }
    }

    /// The last sample.
    pub fn last(&self) -> Option<&Sample> {
        self.last.as_ref()
    }

    /// Takes a sample. One of the same time as the last takes its place.
    ///
    /// # Errors
    /// [`SampleError`]; the model stays as it was.
    pub fn push(&mut self, sample: Sample) -> Result<(), SampleError> {
        sample.check()?;
        match self.last {
            Some(last) if sample.time < last.time => {
                return Err(SampleError::Backwards { time: sample.time, before: last.time });
            }
            Some(last) if sample.time > last.time => self.before = Some(last),
            _ => {}
        }
        self.last = Some(sample);
        self.learn(sample);
        Ok(())
    }

    /// K ← K + (−ΔF − K d) dᵀ/|d|², so that K d = −ΔF along the last way d of the tool; across it K is that of the sample, or as before.
    fn learn(&mut self, sample: Sample) {
        let is_free = |sample: &Sample| sample.contact == Contact::Pressing && sample.force.squared_norm() <= 0.0;
        if is_free(&sample) {
            self.stiffness = Matrix::ZERO;
            return;
        }
        if let Some(known) = sample.stiffness {
            self.stiffness = self.believable(known);
            // On the way in, a part of the way was free.
            if self.before.as_ref().is_some_and(is_free) {
                return;
            }
        }
        let Some((way, change)) = self.change() else { return };
        let unknown = -(change + self.stiffness * way);
        self.stiffness += unknown.outer(self.weighted(way));
        self.stiffness = self.believable(self.stiffness);
    }

    /// From the last sample but one to the last: way [m] and change of force [N].
    fn change(&self) -> Option<(Vector, Vector)> {
        let (last, before) = (self.last?, self.before?);
        Some((last.position - before.position, last.force - before.force))
    }

    /// d/|d|², for ways well above the resolution; below it goes to zero, as what is read there is noise.
    fn weighted(&self, way: Vector) -> Vector {
        let squared = way.squared_norm() + self.resolution * self.resolution;
        if squared > 0.0 { way / squared } else { Vector::ZERO }
    }

    /// The same stiffness, or less of it where it is above what is believed.
    fn believable(&self, stiffness: Matrix) -> Matrix {
        // Frobenius' norm is the largest stiffness of a contact that resists in one direction, and above it otherwise.
        let norm = stiffness.squared_norm().sqrt();
        if norm > self.stiffest { stiffness * (self.stiffest / norm) } else { stiffness }
    }

    /// The force of the tissue on the tool [N] at the time `now` [s] with the tool at `position` [m]; none before the first sample.
    pub fn force(&self, now: f64, position: Vector) -> Option<Vector> {
        let last = self.last?;
        let force = last.force + self.further(&last, now, position);
        // A push that comes to its end is over: tissue that is not held does not pull.
        let turned = last.contact == Contact::Pressing && force.dot(last.force) <= 0.0;
        Some(if turned { Vector::ZERO } else { force })
    }

    /// What has been added to the force since the sample.
    fn further(&self, last: &Sample, now: f64, position: Vector) -> Vector {
        let away = position - last.position;
        match (self.extrapolation, self.change(), self.before) {
            (Extrapolation::Time, Some((_, change)), Some(before)) => {
                change * ((now - last.time) / (last.time - before.time)).clamp(0.0, self.reach)
            }
            (Extrapolation::Position, Some((way, change)), _) => {
                let weighted = self.weighted(way);
                let slope = change.norm() * weighted.norm();
                let share = if slope > self.stiffest { self.stiffest / slope } else { 1.0 };
                change * (share * away.dot(weighted).clamp(-self.reach, self.reach))
            }
            (Extrapolation::Linearised, _, _) => -(self.stiffness * away),
            _ => Vector::ZERO,
        }
    }
}

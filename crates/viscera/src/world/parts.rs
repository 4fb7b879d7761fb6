//! In which parts an implicit step is made, and made again.

/// How a step is made again that is not solved, or that throws tissue across a hump: in twice as many parts up to 64, and where those do not do
/// either, with shorter ones to begin with. Tissue that is let go from far off balance is thrown within the first of them, and its parts need be short
/// only until it has turned: free, integrated at the nodes and stretched 1010 times, it needed the 512th part of 20 ms there, and no more than the 16th after.
pub(super) const DIVISIONS: [Division; 11] = [
    Division::equal(0),
    Division::equal(1),
    Division::equal(2),
    Division::equal(3),
    Division::equal(4),
    Division::equal(5),
    Division::equal(OFTEN),
    Division { halvings: OFTEN, doublings: 3 },
    Division { halvings: OFTEN, doublings: 6 },
    Division { halvings: OFTEN, doublings: 9 },
    Division { halvings: 9, doublings: 6 },
];
/// From this one on solvers take all the time that they may need.
pub(super) const PATIENT: usize = OFTEN as usize;
/// Halvings that make 64 parts.
const OFTEN: u32 = 6;

/// How a step is divided.
#[derive(Clone, Copy)]
pub(super) struct Division {
    /// How often into halves.
    halvings: u32,
    /// The first part again into so many and one, of which each is as long as all before it.
    doublings: u32,
}

impl Division {
    const fn equal(halvings: u32) -> Self {
        Self { halvings, doublings: 0 }
    }
}

/// The parts of a step.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    /// Equal ones.
    equal: u32,
    doublings: u32,
}

impl Parts {
    /// So many, and those divided; into more than 64 each only up to as many as one would be divided into, as fast tools ask for 256.
    pub(super) fn new(parts: u32, Division { halvings, doublings }: Division) -> Self {
        Self { equal: (parts << halvings.min(OFTEN)).max(1 << halvings), doublings }
    }

    pub(super) fn count(self) -> u32 {
        self.equal + self.doublings
    }

    /// The share of the step that is over at the beginning of a part, or at the end of the last: up to the first equal part in powers of ½.
    pub(super) fn start(self, part: u32) -> f64 {
        let equal = f64::from(self.equal);
        match part {
            0 => 0.0,
            _ if part <= self.doublings => 0.5_f64.powi((self.doublings + 1 - part) as i32) / equal,
            _ => f64::from(part - self.doublings) / equal,
        }
    }

    /// Length of a part [s] in a step of `step` [s].
    pub(super) fn length(self, part: u32, step: f64) -> f64 {
        // The first and the second are of one length.
        let halves = if part > self.doublings { 0 } else { self.doublings - part.saturating_sub(1) };
        step / f64::from(self.equal) * 0.5_f64.powi(halves as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_a_step_whole() {
        for division in DIVISIONS {
            for parts in [1, 3, 256] {
                let parts = Parts::new(parts, division);
                assert_eq!((parts.start(0), parts.start(parts.count())), (0.0, 1.0));
                for part in 0..parts.count() {
                    let length = parts.start(part + 1) - parts.start(part);
                    let error = (parts.length(part, 2.0) - 2.0 * length).abs();
                    assert!(length > 0.0 && error < 1e-15, "part {part} of {}: {length}", parts.count());
                }
            }
        }
    }
}

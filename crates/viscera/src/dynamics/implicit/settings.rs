use super::Scheme;
use super::newton::{INSTEAD, PATIENCE};
use crate::solver::Stop;

/// The most iterations of any kind: each is noted, in memory that is set aside at the start.
const MOST_ITERATIONS: u32 = 1_000_000;

/// Settings of implicit steps. By default linearised backward Euler, without a matrix in memory, to 1e-4 in at most 100
/// iterations: what play needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Implicit {
    /// How a step is formed.
    pub scheme: Scheme,
    /// How the non-linear equations of a step are solved.
    pub newton: Newton,
    /// When the conjugate gradient ends, in every iteration of Newton's method.
    pub linear: Stop,
    /// Whether the matrix is put together.
    pub matrix: MatrixForm,
    /// What makes the conjugate gradient fast.
    pub preconditioner: Preconditioning,
}

/// How the non-linear equations of a step are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Newton {
    /// One linear solve at the beginning of the step; where that meets negative curvature or goes astray, up to forty with a
    /// line search.
    #[default]
    Linearised,
    /// Newton's method with a line search.
    Full {
        /// The residual force has to fall below this share of the forces that balance [> 0, < 1], or below what rounding
        /// of the positions makes of them.
        relative: f64,
        /// The most iterations [1 to 1e6]. A step that needs more is made in parts; one whose 64th part, and shorter ones, need four times as many is undone
        /// and is an error, unless it has come to rest on a crease of its energy
        /// ([`ForceModel::has_creases`](crate::model::ForceModel::has_creases)). Where forces have no energy
        /// ([`ForceModel::has_potential`](crate::model::ForceModel::has_potential)) there may be no solution at all: parts that have none are
        /// linearised, and the report says that they have not converged.
        at_most: u32,
    },
}

/// How products with the matrix are computed; the answer is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MatrixForm {
    /// Element by element, never assembled.
    #[default]
    Free,
    /// From assembled rows of 3×3 blocks: worth it where a solve takes many iterations.
    Assembled,
}

/// What makes the conjugate gradient fast; the answer is the same within its tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preconditioning {
    /// The blocks on the matrix's diagonal: nearly free, and the number of iterations grows with the number of cells along the body, or
    /// along the way of a wave in one step where that is shorter.
    #[default]
    BlockJacobi,
    /// Multigrid on lattices over the body ([`Multigrid`](crate::solver::Multigrid)): their number hardly grows with that of the
    /// cells. One takes as long as six of the other, and each linear solve fifty more to begin with: it pays
    /// where block-Jacobi takes more than some 150. That is so for steps in which waves cross more than thirty cells
    /// or so, and for all that comes to rest.
    Multigrid,
}

impl Newton {
    /// The most iterations, in one of the last attempts at a step or one before.
    pub(super) fn at_most(self, is_patient: bool) -> u32 {
        match self {
            Self::Linearised => INSTEAD.1,
            Self::Full { at_most, .. } if is_patient => PATIENCE * at_most,
            Self::Full { at_most, .. } => at_most,
        }
    }
}

impl Default for Implicit {
    fn default() -> Self {
        Self {
            scheme: Scheme::default(),
            newton: Newton::default(),
            linear: Stop::Tolerance { relative: 1e-4, at_most: 100 },
            matrix: MatrixForm::default(),
            preconditioner: Preconditioning::default(),
        }
    }
}

impl Implicit {
    /// The scheme with Newton's method carried to 1e-8 in at most 30 iterations, and linear solves to 1e-6: for accuracy.
    pub fn accurate(scheme: Scheme) -> Self {
        Self {
            scheme,
            newton: Newton::Full { relative: 1e-8, at_most: 30 },
            linear: Stop::Tolerance { relative: 1e-6, at_most: 2000 },
            matrix: MatrixForm::Free,
            preconditioner: Preconditioning::default(),
        }
    }

    /// When linear solves end: `patient` ones of full equations with a goal have more iterations to it.
    pub(super) fn stop(&self, patient: bool) -> Stop {
        match self.linear {
            Stop::Tolerance { relative, at_most } if patient && self.newton != Newton::Linearised => {
                Stop::Tolerance { relative, at_most: PATIENCE * at_most }
            }
            linear => linear,
        }
    }

    /// The first setting that makes no sense: its name, its value, what would do.
    pub(crate) fn first_out_of_range(&self) -> Option<(&'static str, f64, &'static str)> {
        let share = |value: f64| value > 0.0 && value < 1.0;
        let (counts, range) = (1..=MOST_ITERATIONS, "from 1 to a million");
        if let Newton::Full { relative, at_most } = self.newton {
            if !share(relative) {
                return Some(("newton tolerance", relative, "between 0 and 1"));
            }
            if !counts.contains(&at_most) {
                return Some(("newton iterations", f64::from(at_most), range));
            }
        }
        if let Stop::Tolerance { relative, .. } = self.linear
            && !share(relative)
        {
            return Some(("linear tolerance", relative, "between 0 and 1"));
        }
        if !counts.contains(&self.linear.at_most()) {
            return Some(("linear iterations", f64::from(self.linear.at_most()), range));
        }
        self.scheme.first_out_of_range()
    }
}

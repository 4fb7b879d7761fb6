//! Bodies whose equations are solved together: one alone, or those that ties hold together.

use super::balance::{Balance, Squares};
use super::correction::Solve;
use super::memory::ImplicitMemory;
use super::scheme::Numbers;
use super::step::Step;
use super::tools::Guess;
use super::{Implicit, ImplicitReport, Newton};
use crate::body::SimulatedBody;
use crate::dynamics::Drive;
use crate::dynamics::tied::{TiedBodies, Together};
use crate::math::Scalar;
use crate::stage::Stages;

/// How many times nodes that slip through jaws are let go in a step; the first time sees nearly all of them.
const SLIPS: u32 = 4;

/// The time that a step takes, and what drives bodies in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval<'a, T> {
    /// Time at its beginning [s]; at its end, that of `drive`.
    pub(crate) from: f64,
    /// Its length [s].
    pub(crate) dt: f64,
    /// Whether it is the first part of a step of the world.
    pub(crate) is_first: bool,
    pub(crate) drive: &'a Drive<'a, T>,
}

/// Why a step is not to be taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refused {
    /// Its equations are not solved.
    Unsolved,
    /// It gained energy from nobody.
    GainedEnergy,
}

/// Advances bodies that are solved together, in memory of their own, by one step; of all `bodies` of a world and the memory of each.
/// Gives why it is not to be taken as well, if so. The last attempts take more: a linearised step that gains some energy, and one in place of
/// full equations that may have no solution.
pub(crate) fn advance<T: Scalar>(
    (bodies, memories): (&mut [SimulatedBody<T>], &mut [ImplicitMemory<T>]),
    together: Together<'_, T>,
    settings: &Implicit,
    interval: Interval<'_, T>,
    is_patient: bool,
    stages: Stages,
) -> (ImplicitReport, Option<Refused>) {
    let numbers = settings.scheme.numbers(false);
    let mut group = Group {
        bodies,
        memories,
        together,
        settings,
        numbers,
        interval,
        is_patient,
        stages,
        went_astray: false,
        stands_in: false,
        may_climb: !is_patient,
        imbalance: 0.0,
    };
    group.agree_on_past();
    group.begin();
    let mut report = group.solve();
    for _ in 0..SLIPS {
        if !group.any(|step| step.slip()) {
            break;
        }
        group.each(|step| step.start_again());
        report = report.then(group.solve());
    }
    let refused = group.refused(&report);
    group.each(|step| step.finish());
    group.finish_ties();
    (report, refused)
}

/// Bodies that are solved together, in one implicit step.
pub(super) struct Group<'a, T: Scalar> {
    bodies: &'a mut [SimulatedBody<T>],
    memories: &'a mut [ImplicitMemory<T>],
    pub(super) together: Together<'a, T>,
    pub(super) settings: &'a Implicit,
    pub(super) numbers: Numbers,
    pub(super) interval: Interval<'a, T>,
    /// Whether this is one of the last attempts at this step, which take more iterations and more of what is found.
    pub(super) is_patient: bool,
    pub(super) stages: Stages<'a>,
    /// Whether a linearised step had to be solved in full instead.
    pub(super) went_astray: bool,
    /// Whether a linearised step stands in for full equations that were not solved.
    pub(super) stands_in: bool,
    /// Whether the first iterations of Newton's method may climb.
    pub(super) may_climb: bool,
    /// Share of the forces that a linearised step left without balance.
    pub(super) imbalance: f64,
}

/// Tied bodies, all bodies of their world, and the memory of each.
type AllTied<'a, T> = (&'a mut TiedBodies<T>, &'a mut [SimulatedBody<T>], &'a mut [ImplicitMemory<T>]);

impl<T: Scalar> Group<'_, T> {
    /// How many bodies there are.
    pub(super) fn count(&self) -> usize {
        match &self.together {
            Together::Alone(_) => 1,
            Together::Tied(tied) => tied.bodies.len(),
        }
    }

    /// The part of one of them.
    pub(super) fn member(&mut self, member: usize) -> Step<'_, T> {
        let number = match &self.together {
            Together::Alone(number) => *number,
            Together::Tied(tied) => tied.bodies[member],
        };
        let Interval { from, dt, drive, .. } = self.interval;
        let (body, memory) = (&mut self.bodies[number], &mut self.memories[number]);
        Step {
            body,
            memory,
            settings: self.settings,
            numbers: self.numbers,
            from,
            dt,
            drive,
            is_patient: self.is_patient,
            stages: self.stages,
        }
    }

    /// The tied bodies, with all bodies of the world and their memories; none for one alone.
    pub(super) fn tied(&mut self) -> Option<AllTied<'_, T>> {
        match &mut self.together {
            Together::Alone(_) => None,
            Together::Tied(tied) => Some((&mut **tied, &mut *self.bodies, &mut *self.memories)),
        }
    }

    pub(super) fn each(&mut self, mut act: impl FnMut(&mut Step<'_, T>)) {
        (0..self.count()).for_each(|member| act(&mut self.member(member)));
    }

    /// Whether it is so for any; all are asked.
    pub(super) fn any(&mut self, mut ask: impl FnMut(&mut Step<'_, T>) -> bool) -> bool {
        let mut any = false;
        self.each(|step| any |= ask(step));
        any
    }

    fn sum(&mut self, of: impl Fn(&mut Step<'_, T>) -> Squares) -> Squares {
        let mut sums = of(&mut self.member(0));
        for member in 1..self.count() {
            let own = of(&mut self.member(member));
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        sums
    }

    /// A scheme over two steps needs the past of all of them.
    fn agree_on_past(&mut self) {
        let unknown = self.any(|step| !step.body.state.past.is_known);
        self.each(|step| step.body.state.past.is_known &= !unknown);
        self.numbers = self.settings.scheme.numbers(!unknown);
    }

    fn begin(&mut self) {
        self.each(|step| step.begin());
        self.begin_ties();
        self.each(|step| step.coast());
    }

    /// Solves the step as it was asked for, in the last attempts in two ways. Forces without a potential jump where cells turn inside out, and full
    /// equations may have no solution there however short the step: it is linearised then, and not converged. With one, no iteration climbs, and
    /// only where that finds no good solution, as along narrow valleys that bend, some may.
    fn solve(&mut self) -> ImplicitReport {
        let newton = self.settings.newton;
        let Newton::Full { relative, .. } = newton else { return self.solve_linearised() };
        let report = self.solve_in_full(relative, newton.at_most(self.is_patient));
        if !self.is_patient {
            return report;
        }
        if self.any(|step| !step.has_potential()) {
            return if report.converged { report } else { report.then(self.stand_in()) };
        }
        if self.potential().is_none() || (report.converged && !self.has_gained()) {
            return report;
        }
        self.may_climb = true;
        self.each(|step| step.start_again());
        report.then(self.solve_in_full(relative, newton.at_most(true)))
    }

    /// A linearised step in place of full equations that were not solved.
    fn stand_in(&mut self) -> ImplicitReport {
        self.stands_in = true;
        self.each(|step| step.start_again());
        let linearised = self.solve_linearised();
        let residual = if self.went_astray { linearised.residual } else { self.imbalance };
        ImplicitReport { converged: false, residual, ..linearised }
    }

    /// Why what was solved is not to be taken, if so.
    fn refused(&mut self, report: &ImplicitReport) -> Option<Refused> {
        let is_linearised = self.settings.newton == Newton::Linearised;
        if !(report.converged || is_linearised || self.stands_in) {
            return Some(Refused::Unsolved);
        }
        self.has_gained().then_some(Refused::GainedEnergy)
    }

    /// The forces where the bodies are and what they lack to balance, besides those of ties.
    pub(super) fn evaluate(&mut self) -> Balance {
        let squares = self.sum(|step| step.evaluate());
        self.weigh(squares)
    }

    /// What the forces lack to balance, besides those of ties.
    pub(super) fn find_lack(&mut self) -> Balance {
        let squares = self.sum(|step| step.find_lack());
        self.weigh(squares)
    }

    fn weigh(&mut self, [lack, inertial, external, internal]: Squares) -> Balance {
        let lack = self.leave_to_ties().unwrap_or(lack);
        Balance::of([lack, inertial, external, internal])
    }

    /// Solves for the corrections of δ, which hold the guess.
    pub(super) fn correct(&mut self) -> Solve {
        if self.any(|step| step.assemble()) {
            // Now that the springs have their stiffness, their forces belong to what is to be balanced.
            self.find_lack();
        }
        match self.together {
            Together::Alone(_) => self.member(0).solve(),
            Together::Tied(_) => self.solve_tied(),
        }
    }

    /// Whether tools touch anew when nodes go where `guess` says.
    pub(super) fn meet_tools(&mut self, guess: Guess) -> bool {
        self.any(|step| step.meet_tools(guess))
    }

    /// Sets what driven nodes still have to go; gives whether all are where they have to be.
    pub(super) fn go_on(&mut self) -> bool {
        !self.any(|step| !step.go_on())
    }

    /// Work of what the forces lack to balance against the corrections [J].
    pub(super) fn work(&mut self) -> f64 {
        (1..self.count()).fold(self.member(0).work(), |sum, member| sum + self.member(member).work())
    }

    /// δ grows by `length` corrections.
    pub(super) fn move_by(&mut self, length: f64) {
        self.each(|step| step.move_by(length));
    }
}

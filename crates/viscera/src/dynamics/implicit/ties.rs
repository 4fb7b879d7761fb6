//! Ties in implicit steps: bodies side by side in one linear system, by the projected preconditioned conjugate gradient.
//!
//! With D the blocks on the diagonal of the matrix A and Π = I − Gᵀ (G D⁻¹ Gᵀ)⁻¹ G D⁻¹, which takes out of forces what the ties take, it
//! is the conjugate gradient for Π A x = Π b, from an x that fulfils the ties, with the preconditioner D: every direction D⁻¹ Π r fulfils
//! them too. As residuals are projected in each iteration, they hold no part of the ties' forces, whose rounding would drown the rest.
//!
//! Source: Gould, Hribar, Nocedal, On the solution of equality constrained quadratic programming problems arising in optimization (2001),
//! sections 3 and 6.

use super::correction::Solve;
use super::group::Group;
use super::memory::ImplicitMemory;
use super::tangent::Tangent;
use super::{Implicit, Newton};
use crate::body::{NodeMotion, SimulatedBody};
use crate::dynamics::tied::{TiedBodies, TiedNode, mobility_of_mass};
use crate::math::{Scalar, Vec3};
use crate::mesh::Point;
use crate::solver::{
    BlockJacobi, ConjugateGradient, Ending, Filter, FilteredNodes, LinearOperator, PlacedTies, Problem,
};
use crate::stage::{Stage, Stages};

/// Memory for bodies that ties hold together, one after the other.
#[derive(Debug)]
pub(crate) struct ImplicitTies<T> {
    /// Where the nodes of each body begin; at last, how many there are.
    starts: Vec<usize>,
    /// The equations over the blocks of the matrix.
    by_matrix: PlacedTies,
    preconditioner: BlockJacobi<T>,
    conjugate_gradient: ConjugateGradient<T>,
    rhs: Vec<Vec3<T>>,
    correction: Vec<Vec3<T>>,
    prescribed: Vec<Vec3<T>>,
    product: Vec<Vec3<T>>,
    masses: Vec<T>,
    filters: Vec<Filter<T>>,
    filtered_nodes: FilteredNodes,
    /// −λ of each tie at the beginning of the step, in the forces that were evaluated last, and in the linear system that was solved last [N].
    forces: [Vec<Point>; 3],
    /// Impulse on the node of each tie in the step [N s].
    impulses: Vec<Point>,
}

const BEGINNING: usize = 0;
const EVALUATED: usize = 1;
const LINEAR: usize = 2;

impl<T: Scalar> ImplicitTies<T> {
    /// Memory for `tied` among the bodies of a world.
    pub(crate) fn new(tied: &TiedBodies<T>, bodies: &[SimulatedBody<T>], settings: &Implicit) -> Self {
        let mut starts = vec![0];
        for &number in &tied.bodies {
            starts.push(starts[starts.len() - 1] + bodies[number].mesh.nodes().len());
        }
        let nodes = starts[starts.len() - 1];
        let (zeros, none) = (|| vec![Vec3::ZERO; nodes], || vec![Point::ZERO; tied.ties.len()]);
        Self {
            by_matrix: tied.placed(&starts),
            starts,
            preconditioner: BlockJacobi::new(nodes),
            conjugate_gradient: ConjugateGradient::new(nodes, settings.linear.at_most()),
            rhs: zeros(),
            correction: zeros(),
            prescribed: zeros(),
            product: zeros(),
            masses: vec![T::ZERO; nodes],
            filters: vec![Filter::Free; nodes],
            filtered_nodes: FilteredNodes::with_room(nodes),
            forces: [none(), none(), none()],
            impulses: none(),
        }
    }

    /// Lays the systems of the bodies side by side, each times the factor by which it was divided.
    fn gather(&mut self, numbers: &[usize], memories: &[ImplicitMemory<T>]) {
        for (member, &number) in numbers.iter().enumerate() {
            let (span, memory) = (self.starts[member]..self.starts[member + 1], &memories[number]);
            self.rhs[span.clone()].copy_from_slice(&memory.lack);
            self.correction[span.clone()].copy_from_slice(&memory.correction);
            self.prescribed[span.clone()].copy_from_slice(&memory.prescribed);
            self.filters[span.clone()].copy_from_slice(&memory.filters);
            for (mass, &own) in self.masses[span.clone()].iter_mut().zip(&memory.matrix.masses) {
                *mass = own * memory.matrix.stiffness;
            }
            self.preconditioner.take(span.start, &memory.preconditioner, T::ONE / memory.matrix.stiffness);
        }
        self.filtered_nodes.list(&self.filters, 0..self.filters.len() as u32);
        let known = self.filters.iter().zip(&self.prescribed);
        self.correction.iter_mut().zip(known).for_each(|(x, (filter, &z))| *x = filter.merge(*x, z));
    }

    /// Moves the correction by the least that brings tied places together at the end of the step.
    fn close(&mut self, numbers: &[usize], nodes: &[TiedNode], memories: &[ImplicitMemory<T>]) {
        self.by_matrix.fulfil(&mut self.correction, |number| {
            let TiedNode { member, node } = nodes[number];
            let memory = &memories[numbers[member]];
            memory.start[node].cast::<f64>() + memory.increment[node].cast()
        });
    }
}

impl<T: Scalar> TiedBodies<T> {
    /// Hears of the impulses on the node of each tie in the implicit step that was made last [N s], with the number of its attachment.
    pub(crate) fn each_impulse(&self, mut give: impl FnMut(usize, Point)) {
        let impulses = self.implicit.iter().flat_map(|ties| &ties.impulses);
        self.attachments.iter().zip(impulses).for_each(|(&(attachment, _), &impulse)| give(attachment, impulse));
    }

    /// Takes out of what the forces lack what ties give, by the motion that forces would make of the masses.
    fn take_out(
        &mut self,
        bodies: &[SimulatedBody<T>],
        memories: &mut [ImplicitMemory<T>],
        kind: usize,
        filter: impl Fn(&SimulatedBody<T>, &ImplicitMemory<T>, usize) -> Filter<T>,
    ) {
        let (numbers, nodes) = (&self.bodies, &self.nodes);
        self.by_mass.update(|number| {
            let TiedNode { member, node } = nodes[number];
            let (body, memory) = (&bodies[numbers[member]], &memories[numbers[member]]);
            mobility_of_mass(body.state.masses[node], &filter(body, memory, node))
        });
        self.by_mass.resolve_forces(|number| memories[numbers[nodes[number].member]].lack[nodes[number].node].cast());
        for (number, &TiedNode { member, node }) in nodes.iter().enumerate() {
            let lack = &mut memories[numbers[member]].lack[node];
            *lack = (lack.cast::<f64>() - self.by_mass.force(number)).cast();
        }
        let forces = self.implicit.iter_mut().flat_map(|ties| &mut ties.forces[kind]);
        forces.zip(self.by_mass.multipliers()).for_each(|(force, &multiplier)| *force = -multiplier);
    }
}

impl<T: Scalar> Group<'_, T> {
    /// Takes what ties give at the beginning out of the accelerations there, where the scheme has them.
    pub(super) fn begin_ties(&mut self) {
        let needs_acceleration = self.settings.scheme.needs_acceleration();
        let Some((tied, bodies, memories)) = self.tied() else { return };
        if let Some(ties) = &mut tied.implicit {
            ties.impulses.fill(Point::ZERO);
            ties.forces[BEGINNING].fill(Point::ZERO);
        }
        if needs_acceleration {
            tied.take_out(bodies, memories, BEGINNING, |body, _, node| body.free_directions(node));
        }
    }

    /// Takes what ties give out of what the forces lack to balance; gives the square of what is left [N²], none for one body alone.
    pub(super) fn leave_to_ties(&mut self) -> Option<f64> {
        let stages = self.stages;
        let (tied, bodies, memories) = self.tied()?;
        stages.run(Stage::Attachments, || {
            tied.take_out(bodies, memories, EVALUATED, |_, memory, node| memory.filters[node])
        });
        let of_body = |&number: &usize| {
            let memory = &memories[number];
            let free = memory.filters.iter().zip(&memory.lack).map(|(filter, &lack)| filter.apply(lack));
            free.map(|lack| lack.squared_norm().to_f64()).sum::<f64>()
        };
        Some(tied.bodies.iter().map(of_body).sum())
    }

    /// Velocities at the end fulfil the ties too, but for rounding and what the bodies began with: that is taken out. Counts up impulses.
    pub(super) fn finish_ties(&mut self) {
        let (share, dt) = (self.numbers.impulse, self.interval.dt);
        let Some((tied, bodies, memories)) = self.tied() else { return };
        let (numbers, nodes, by_mass) = (&tied.bodies, &tied.nodes, &mut tied.by_mass);
        by_mass.resolve(|number| bodies[numbers[nodes[number].member]].state.velocities[nodes[number].node].cast());
        for (number, &TiedNode { member, node }) in nodes.iter().enumerate() {
            let velocity = &mut bodies[numbers[member]].state.velocities[node];
            *velocity = (velocity.cast::<f64>() - by_mass.mobility(number) * by_mass.force(number)).cast();
        }
        let is_linear = memories[numbers[0]].is_linear;
        let Some(ties) = &mut tied.implicit else { return };
        let (beginning, end) = (&ties.forces[BEGINNING], &ties.forces[if is_linear { LINEAR } else { EVALUATED }]);
        let impulses = ties.impulses.iter_mut().zip(by_mass.multipliers());
        for ((impulse, &multiplier), (&beginning, &end)) in impulses.zip(beginning.iter().zip(end)) {
            *impulse = (beginning * (1.0 - share) + end * share) * dt - multiplier;
        }
    }

    /// Solves for the corrections of δ of all, which hold the guess, in one system.
    pub(super) fn solve_tied(&mut self) -> Solve {
        let (stop, stages, is_full) = (self.settings.linear, self.stages, self.settings.newton != Newton::Linearised);
        let nothing = Solve { iterations: 0, residual: 0.0, converged: true, negative_curvature: false, rounding: 0.0 };
        let Some((tied, bodies, memories)) = self.tied() else { return nothing };
        let TiedBodies { bodies: numbers, nodes, by_mass, implicit: Some(ties), .. } = tied else { return nothing };
        let (numbers, nodes) = (&numbers[..], &nodes[..]);
        let executor = bodies[numbers[0]].scratch.executor.clone();
        stages.run(Stage::Attachments, || {
            ties.gather(numbers, memories);
            let preconditioner = &ties.preconditioner;
            ties.by_matrix.update(by_mass, |place| preconditioner.inverse(place).cast());
            ties.close(numbers, nodes, memories);
        });
        let ImplicitTies {
            starts,
            by_matrix,
            preconditioner,
            conjugate_gradient,
            rhs,
            correction,
            prescribed,
            masses,
            filters,
            filtered_nodes,
            ..
        } = &mut *ties;
        let mut matrix = SideBySide { bodies, memories, numbers, starts, by_matrix, stages };
        matrix.take_out(rhs);
        let filtered = filtered_nodes.with(filters);
        let problem = Problem { rhs, filtered, prescribed, masses, executor: &executor };
        let report = stages.run(Stage::LinearSolve, || {
            conjugate_gradient.solve(&mut matrix, preconditioner, &problem, stop, correction)
        });
        ties.close(numbers, nodes, memories);
        for (member, &number) in numbers.iter().enumerate() {
            let span = ties.starts[member]..ties.starts[member + 1];
            memories[number].correction.copy_from_slice(&ties.correction[span]);
            memories[number].conjugate_gradient.note_history_of(&ties.conjugate_gradient);
        }
        if !is_full {
            ties.find_linear_forces(numbers, bodies, memories, stages);
        }
        let square = |&number: &usize| memories[number].rounding.powi(2);
        Solve {
            iterations: report.iterations,
            residual: report.residual,
            converged: stop.accepts(report.ending),
            negative_curvature: report.ending == Ending::NegativeCurvature,
            rounding: numbers.iter().map(square).sum::<f64>().sqrt(),
        }
    }
}

impl<T: Scalar> ImplicitTies<T> {
    /// What ties give in the linear system at its solution, and what holds driven nodes there.
    fn find_linear_forces(
        &mut self,
        numbers: &[usize],
        bodies: &mut [SimulatedBody<T>],
        memories: &mut [ImplicitMemory<T>],
        stages: Stages,
    ) {
        let ImplicitTies { starts, by_matrix, correction, product, forces: [_, evaluated, linear], .. } = &mut *self;
        let mut matrix = SideBySide { bodies, memories, numbers, starts, by_matrix, stages };
        matrix.times(correction, product);
        for (member, &number) in numbers.iter().enumerate() {
            let product = &mut product[starts[member]..starts[member + 1]];
            product.iter_mut().zip(&memories[number].lack).for_each(|(product, &lack)| *product = lack - *product);
        }
        let multipliers = by_matrix.take_out(product);
        for ((linear, &evaluated), &multiplier) in linear.iter_mut().zip(&*evaluated).zip(multipliers) {
            *linear = evaluated - multiplier;
        }
        for (member, &number) in numbers.iter().enumerate() {
            if bodies[number].state.motions.iter().any(|motion| matches!(motion, NodeMotion::Held(_))) {
                let left = &product[starts[member]..starts[member + 1]];
                memories[number].reactions.iter_mut().zip(left).for_each(|(reaction, &left)| *reaction = -left);
            }
        }
    }
}

/// The matrices of the bodies side by side, with what ties take out of their products.
struct SideBySide<'a, T: Scalar> {
    bodies: &'a mut [SimulatedBody<T>],
    memories: &'a mut [ImplicitMemory<T>],
    numbers: &'a [usize],
    starts: &'a [usize],
    by_matrix: &'a mut PlacedTies,
    stages: Stages<'a>,
}

impl<T: Scalar> SideBySide<'_, T> {
    /// A x.
    fn times(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        for (member, &number) in self.numbers.iter().enumerate() {
            let span = self.starts[member]..self.starts[member + 1];
            let (body, memory) = (&mut self.bodies[number], &mut self.memories[number]);
            let out = &mut out[span.clone()];
            Tangent::of(body, &mut memory.matrix, self.stages).apply(&x[span], out);
            if memory.matrix.stiffness != T::ONE {
                out.iter_mut().for_each(|out| *out = *out * memory.matrix.stiffness);
            }
        }
    }

    /// Π f.
    fn take_out(&mut self, forces: &mut [Vec3<T>]) {
        self.stages.run(Stage::Attachments, || {
            self.by_matrix.take_out(forces);
        });
    }
}

impl<T: Scalar> LinearOperator<T> for SideBySide<'_, T> {
    fn apply(&mut self, x: &[Vec3<T>], out: &mut [Vec3<T>]) {
        self.times(x, out);
        self.take_out(out);
    }
}

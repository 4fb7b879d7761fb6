//! The linear system of one iteration of Newton's method.

use super::step::Step;
use super::tangent::Tangent;
use crate::body::NodeMotion;
use crate::contact::Contacts;
use crate::executor::{Executor, NodeBlocks, ReadBlocks, node_blocks};
use crate::math::{Mat3, Scalar, Sym3, Vec3, dispatch, dispatch_level};
use crate::model::BlockSink;
use crate::solver::{BlockJacobi, BlockMatrix, Ending, Filter, LinearOperator, Multigrid, Problem};
use crate::stage::Stage;

/// How many roundings of the positions, through the stiffness of each node, count as no residual at all.
const ROUNDINGS: f64 = 8.0;

/// What one linear solve did.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solve {
    pub(super) iterations: u32,
    pub(super) residual: f64,
    pub(super) converged: bool,
    pub(super) negative_curvature: bool,
    /// Forces that rounding of the positions makes [N].
    pub(super) rounding: f64,
}

impl<T: Scalar> Step<'_, T> {
    /// Puts together the linear system of Newton's method over the factor of the stiffness, which saves its product with every vector; all but
    /// its right-hand side. Gives whether tools touch, whose springs have their stiffness now and change what is to be balanced.
    pub(super) fn assemble(&mut self) -> bool {
        self.body.linearize(self.stages);
        let (numbers, dt) = (self.numbers, self.dt);
        let (alpha, beta) = (self.body.stiffness_damping.to_f64(), self.body.damping.to_f64());
        let stiffness = T::from_f64(numbers.place * (1.0 + alpha * numbers.velocity / dt));
        let mass_factor =
            T::from_f64(numbers.inertia / (dt * dt) + numbers.place * numbers.velocity * beta / dt) / stiffness;
        let (state, memory) = (&self.body.state, &mut *self.memory);
        let matrix = &mut memory.matrix;
        matrix.stiffness = stiffness;
        matrix.external_time = self.from + numbers.place * (self.drive.end - self.from);
        // They are not damped as the tissue is.
        matrix.external_share = 1.0 / (1.0 + alpha * numbers.velocity / dt);
        let external = matrix.external(&self.body.loads, &self.body.actuators);
        let executor = self.body.scratch.executor.clone();
        let masses = (NodeBlocks(&mut matrix.masses), ReadBlocks(&state.masses));
        executor.each(node_blocks(state.masses.len()), masses, &|_, (NodeBlocks(masses), ReadBlocks(nodal))| {
            masses.iter_mut().zip(nodal).for_each(|(mass, &nodal)| *mass = nodal * mass_factor);
        });
        let contacts = &mut self.body.contacts;
        let touches = !contacts.is_empty();
        let filtered = memory.filtered_nodes.with(&memory.filters);
        memory.rounding = self.stages.run(Stage::Preconditioner, || {
            let is_diagonal = matrix.assembled.is_none() && memory.multigrid.is_none();
            let alone = if let [model] = &state.models[..] { Some(model) } else { None };
            let alone = alone.filter(|_| is_diagonal && !touches && external.is_empty());
            if let Some(patches) = alone.and_then(|model| model.sum_diagonal(&state.positions, &mut self.body.scratch))
            {
                let find = |block: usize, found: &mut [Sym3<T>]| {
                    self.body.scratch.write_blocks_of_block(patches, block, found)
                };
                memory.preconditioner.invert_found(&find, &matrix.masses, filtered, &executor);
                return rounding(memory.preconditioner.traces(), &state.positions, &executor);
            }
            memory.preconditioner.clear();
            if is_diagonal {
                let blocks = memory.preconditioner.blocks_mut();
                for model in &state.models {
                    model.add_diagonal(&state.positions, &mut self.body.scratch, blocks);
                }
                if touches {
                    set_stiffness(contacts, blocks, stiffness, &matrix.masses, &memory.filters);
                    contacts.add_blocks(stiffness.to_f64(), |row, column, block| {
                        memory.preconditioner.add(row, column, block)
                    });
                }
            } else {
                let mut sink = Sinks {
                    diagonal: &mut memory.preconditioner,
                    multigrid: memory.multigrid.as_mut(),
                    matrix: matrix.assembled.as_mut(),
                };
                if let Some(multigrid) = &mut sink.multigrid {
                    multigrid.follow(&self.body.mesh, state.reach(), &state.removed);
                }
                sink.clear();
                for model in &state.models {
                    model.add_blocks(&state.positions, &mut self.body.scratch, &mut sink);
                }
                if touches {
                    set_stiffness(contacts, sink.diagonal.blocks_mut(), stiffness, &matrix.masses, &memory.filters);
                    contacts.add_blocks(stiffness.to_f64(), |row, column, block| sink.add(row, column, block));
                }
            }
            external.for_diagonal(&state.positions, |node, block| memory.preconditioner.add(node, node, block));
            memory.preconditioner.invert(&matrix.masses, filtered, &executor);
            rounding(memory.preconditioner.traces(), &state.positions, &executor)
        });
        memory.least_rounding = memory.least_rounding.min(memory.rounding);
        touches
    }

    /// Solves for the correction of δ, which holds the guess.
    pub(super) fn solve(&mut self) -> Solve {
        let stop = self.settings.stop(self.is_patient && self.has_potential());
        let executor = self.body.scratch.executor.clone();
        let memory = &mut *self.memory;
        let rhs = (NodeBlocks(&mut memory.rhs), ReadBlocks(&memory.lack));
        let stiffness = memory.matrix.stiffness;
        executor.each(node_blocks(memory.lack.len()), rhs, &|_, (NodeBlocks(rhs), ReadBlocks(lack))| {
            let factor = T::ONE / stiffness;
            dispatch!(dispatch_level(), _simd => rhs.iter_mut().zip(lack).for_each(|(rhs, &lack)| *rhs = lack * factor));
        });
        let is_held = |motion: &NodeMotion| matches!(motion, NodeMotion::Held(_));
        let is_dragged = !self.drive.frames.is_empty() && self.body.state.motions.iter().any(is_held);
        let mut tangent = Tangent::of(self.body, &mut memory.matrix, self.stages);
        let masses = tangent.masses;
        let problem = Problem {
            rhs: &memory.rhs,
            filtered: memory.filtered_nodes.with(&memory.filters),
            prescribed: &memory.prescribed,
            masses,
            executor: &executor,
        };
        let (diagonal, solver) = (&mut memory.preconditioner, &mut memory.conjugate_gradient);
        let report = self.stages.run(Stage::LinearSolve, || match &mut memory.multigrid {
            Some(multigrid) => {
                let mut cycle = multigrid.set_up(&mut tangent, diagonal, &memory.filters, masses, &executor);
                solver.solve(&mut tangent, &mut cycle, &problem, stop, &mut memory.correction)
            }
            None => solver.solve(&mut tangent, diagonal, &problem, stop, &mut memory.correction),
        });
        if is_dragged {
            tangent.apply(&memory.correction, &mut memory.reactions);
            for (reaction, &rhs) in memory.reactions.iter_mut().zip(&memory.rhs) {
                *reaction = (*reaction - rhs) * stiffness;
            }
        }
        Solve {
            iterations: report.iterations,
            residual: report.residual,
            converged: stop.accepts(report.ending),
            negative_curvature: report.ending == Ending::NegativeCurvature,
            rounding: memory.rounding,
        }
    }
}

/// Blocks go to the diagonal, and to the coarse matrices and the matrix where there are any.
struct Sinks<'a, T> {
    diagonal: &'a mut BlockJacobi<T>,
    multigrid: Option<&'a mut Multigrid<T>>,
    matrix: Option<&'a mut BlockMatrix<T>>,
}

impl<T: Scalar> Sinks<'_, T> {
    fn clear(&mut self) {
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.clear();
        }
        if let Some(matrix) = &mut self.matrix {
            matrix.clear();
        }
    }
}

impl<T: Scalar> BlockSink<T> for Sinks<'_, T> {
    fn add(&mut self, row: u32, column: u32, block: Mat3<T>) {
        self.diagonal.add(row, column, block);
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.add(row, column, block);
        }
        if let Some(matrix) = &mut self.matrix {
            matrix.add(row, column, block);
        }
    }
}

/// Gives new contacts the stiffness that belongs to the blocks on the diagonal.
fn set_stiffness<T: Scalar>(
    contacts: &mut Contacts,
    blocks: &[Mat3<T>],
    stiffness: T,
    masses: &[T],
    filters: &[Filter<T>],
) {
    contacts.set_stiffness(|node| {
        let node = node as usize;
        let diagonal = (blocks[node].trace().abs() / T::from_f64(3.0) + masses[node]).to_f64() * stiffness.to_f64();
        (filters[node] != Filter::Held && diagonal > 0.0).then_some(diagonal)
    });
}

/// ε |K_pp| |x_p| over all nodes, in the Euclidean norm: the forces that rounding of the positions makes.
fn rounding<T: Scalar>(traces: &[T], positions: &[Vec3<T>], executor: &Executor) -> f64 {
    let data = (ReadBlocks(traces), ReadBlocks(positions));
    let work = |_, (ReadBlocks(traces), ReadBlocks(x)): (ReadBlocks<'_, T>, ReadBlocks<'_, Vec3<T>>)| dispatch!(dispatch_level(), _simd => squares(traces, x));
    let squares = executor.fold(node_blocks(positions.len()), data, &work, &|a, b| a + b).unwrap_or(0.0);
    ROUNDINGS * T::EPSILON.to_f64() * squares.sqrt()
}

/// Σ (tr/3)² |x|², in double precision since the squares of stiffnesses leave single precision; eight sums are as fast as one.
#[inline(always)]
fn squares<T: Scalar>(traces: &[T], x: &[Vec3<T>]) -> f64 {
    const SUMS: usize = 8;
    let square = |trace: T, x: Vec3<T>| (trace.to_f64() / 3.0).powi(2) * x.cast::<f64>().squared_norm();
    let ((traces, last_traces), (x, last_x)) = (traces.as_chunks::<SUMS>(), x.as_chunks::<SUMS>());
    let mut sums = [0.0; SUMS];
    for (traces, x) in traces.iter().zip(x) {
        for i in 0..SUMS {
            sums[i] += square(traces[i], x[i]);
        }
    }
    let rest: f64 = last_traces.iter().zip(last_x).map(|(&trace, &x)| square(trace, x)).sum();
    rest + sums.iter().sum::<f64>()
}

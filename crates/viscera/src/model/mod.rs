//! Force models: how a law and a mesh become nodal forces. One model is one file or folder; `registry.rs` is the only list of them.

mod block_sink;
mod block_table;
mod checked_cell;
pub mod corotational;
mod error;
pub mod frequency;
pub mod hybrid;
mod kernel_bound;
mod lane_vector;
pub mod linear_tensor_mass;
pub mod mass_spring;
pub mod nodally_integrated;
mod patch;
mod penalty_frequency;
mod precision;
pub mod precomputed;
mod recipe;
mod registry;
mod sections;
pub mod shape_memory;
pub mod tensor_mass;
mod tet_loop;
pub mod total_lagrangian;
pub mod volume_penalty;

pub use crate::solver::BlockSink;
use block_sink::DiagonalSink;
pub use corotational::{Corotational, StiffnessWarping};
pub use error::ModelError;
pub use hybrid::Hybrid;
pub use linear_tensor_mass::LinearTensorMass;
pub use mass_spring::MassSpring;
pub use nodally_integrated::NodallyIntegrated;
pub use patch::Patches;
pub use precision::Precision;
pub use precomputed::Precomputed;
pub use recipe::ModelRecipe;
pub(crate) use recipe::{GenericRecipe, recipe};
pub use registry::{Claims, ModelInfo, ModelKind};
pub use shape_memory::ShapeMemory;
pub use tensor_mass::TensorMass;
pub use total_lagrangian::TotalLagrangian;
pub use volume_penalty::VolumePenalty;

use self::frequency::FrequencyBound;
use self::sections::{SectionScratch, SectionSums, add_rows, fill};
use crate::executor::Executor;
use crate::math::{Mat3, Scalar, Sym3, Vec3, large_pages};
use crate::solver::Turn;

/// Nodal forces of a body, their energy and their derivative, at given node positions.
///
/// A model is built for one mesh and knows its rest shape. Positions, forces and products are arrays with one vector per
/// node of that mesh; calls with other lengths are a programming error and panic. Nothing is allocated after building.
pub trait ForceModel<T: Scalar>: Send + Sync {
    /// Name in scenes and messages.
    fn name(&self) -> &'static str;

    /// Adds the internal forces +∂W/∂x [N] at positions `x` [m] to `out`: what holds the nodes. The force that the
    /// tissue exerts on them is the negative.
    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]);

    /// Sums those forces on copies of the nodes in `scratch`, and says where the copies are: who goes through the nodes next adds them up on
    /// the way. None, and nothing is done, in a model that knows no copies.
    fn sum_forces(&self, _x: &[Vec3<T>], _scratch: &mut Scratch<T>) -> Option<&Patches> {
        None
    }

    /// The same, and the bound of ω_max² at `x` [1/s²] on the way. None, and nothing is done, in a model that does not know this `bound`.
    fn sum_forces_and_bound(
        &self,
        _x: &[Vec3<T>],
        _bound: &dyn FrequencyBound<T>,
        _scratch: &mut Scratch<T>,
    ) -> Option<(&Patches, f64)> {
        None
    }

    /// Prepares for products at `x` [m]: a model computes here, once, what all of them share, and keeps it in `scratch`.
    /// Products and blocks up to the next call have to be at that `x`, with the same cells. Most models have nothing to
    /// prepare.
    fn linearize(&self, _x: &[Vec3<T>], _scratch: &mut Scratch<T>) {}

    /// How many numbers [`ForceModel::linearize`] keeps in the scratch.
    fn linearization_len(&self) -> usize {
        0
    }

    /// [`ForceModel::linearize`] and [`ForceModel::add_forces`] together, for models to which that is less work than one after the other.
    fn linearize_and_add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        if let Some(patches) = self.linearize_and_sum_forces(x, scratch) {
            scratch.add_sums(patches, out);
        } else {
            self.linearize(x, scratch);
            self.add_forces(x, scratch, out);
        }
    }

    /// The same with the forces on copies of the nodes, as [`ForceModel::sum_forces`] leaves them.
    fn linearize_and_sum_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) -> Option<&Patches> {
        if self.linearization_len() == 0 { self.sum_forces(x, scratch) } else { None }
    }

    /// Adds K(x) dx [N], the derivative of the internal forces at `x` along `dx` [m], to `out`.
    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]);

    /// The same with the derivative itself, in a model whose other products leave some of it out to cost less and never be negative.
    fn add_exact_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.add_product(x, dx, scratch, out);
    }

    /// Sums (M + K(x)) p on copies of the nodes in `scratch`, with `masses` M scaled as stiffnesses [N/m] and the direction p that `turn` is on its
    /// way to; says where the copies are, and gives p·(M + K(x)) p. Directions follow one another: a model keeps the last one with the copies.
    /// None, and nothing is done, in a model that knows no copies.
    fn sum_product(
        &self,
        _x: &[Vec3<T>],
        _turn: &Turn<'_, T>,
        _masses: &[T],
        _scratch: &mut Scratch<T>,
    ) -> Option<(&Patches, f64)> {
        None
    }

    /// Gives K(x) [N/m] to `sink`, block by block; blocks of the same two nodes add up.
    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>);

    /// Adds the blocks of K(x) on the diagonal [N/m], one for each node, to `out`.
    fn add_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Mat3<T>]) {
        match self.sum_diagonal(x, scratch) {
            Some(patches) => patches.add_up_blocks(&scratch.executor, &scratch.sums, out),
            None => self.add_blocks(x, scratch, &mut DiagonalSink(out)),
        }
    }

    /// Sums them on copies of the nodes in `scratch`, as [`ForceModel::sum_forces`] does forces.
    fn sum_diagonal(&self, _x: &[Vec3<T>], _scratch: &mut Scratch<T>) -> Option<&Patches> {
        None
    }

    /// Forces for the energy–momentum step, where the model has them.
    fn mean_forces(&self) -> Option<&dyn MeanForces<T>> {
        None
    }

    /// Stored energy W(x) [J].
    fn energy(&self, x: &[Vec3<T>]) -> f64;

    /// Whether the forces are the gradient of that energy everywhere: what a step gains of it then tells of the step.
    fn has_potential(&self) -> bool {
        true
    }

    /// Whether that energy has creases, at which the forces jump: where it is least there, they do not balance.
    fn has_creases(&self) -> bool {
        false
    }

    /// Takes cells out of the body; their force, energy and stiffness are gone for good. A cell that is out already is
    /// left alone.
    fn remove(&mut self, cells: &[u32]);

    /// Whether the node follows the full law at displacement `u` [m]; false where an adaptive model is linear.
    fn is_nonlinear_at(&self, _displacement: Vec3<T>) -> bool {
        true
    }

    /// How many rows of the scratch it sums forces and blocks in.
    fn sum_rows(&self) -> usize {
        0
    }

    /// How many rings of cells around a node its force depends on: 1, unless the model averages over neighbours.
    fn rings(&self) -> usize {
        1
    }

    /// Nodes that all know each other's forces, however far they are apart.
    fn coupled(&self) -> &[u32] {
        &[]
    }

    /// Size of the numbers that one evaluation of the forces reads from the model [bytes].
    fn bytes(&self) -> usize;

    /// A copy, for snapshots: a cut changes the model.
    fn clone_box(&self) -> Box<dyn ForceModel<T>>;
}

/// Forces between two places that account for the energy between them.
pub trait MeanForces<T> {
    /// Adds the forces F [N] with (to − from)·F = W(to) − W(from) to `out`; they have neither net force nor torque about the
    /// places in the middle.
    fn add_mean_forces(&self, from: &[Vec3<T>], to: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]);
}

/// Memory that models use while they compute and that means nothing between calls: nodal arrays, four numbers to a node,
/// so that lanes load and store whole rows.
#[derive(Clone, Debug, Default)]
pub struct Scratch<T> {
    /// Places or displacements; the fourth number is the model's own.
    pub(crate) nodal: Vec<[T; 4]>,
    /// Directions of a derivative.
    pub(crate) direction: Vec<[T; 4]>,
    /// Sums of forces.
    pub(crate) forces: Vec<[T; 4]>,
    /// Sums of forces and blocks on the copies of nodes in patches.
    sums: Vec<[T; 4]>,
    /// What a model keeps for products; the one model of a body that does.
    pub(crate) linearization: Vec<T>,
    /// Whether it has been filled.
    pub(crate) is_linearized: bool,
    /// Who computes.
    pub(crate) executor: Executor,
}

impl<T: Scalar> Scratch<T> {
    /// Scratch for a body of `nodes` nodes.
    pub fn new(nodes: usize) -> Self {
        let rows = || large_pages::filled(nodes, [T::ZERO; 4]);
        Self {
            nodal: rows(),
            direction: rows(),
            forces: rows(),
            sums: Vec::new(),
            linearization: Vec::new(),
            is_linearized: false,
            executor: Executor::serial(),
        }
    }

    /// Lets the threads of `executor` compute.
    pub fn with_executor(self, executor: Executor) -> Self {
        Self { executor, ..self }
    }

    /// Scratch for a body of `nodes` nodes, with room for all that its models keep: nothing is allocated later.
    pub fn for_models(nodes: usize, models: &[Box<dyn ForceModel<T>>]) -> Self {
        let kept = models.iter().map(|model| model.linearization_len()).max().unwrap_or(0);
        let sums = models.iter().map(|model| model.sum_rows()).max().unwrap_or(0);
        let (linearization, sums) = (large_pages::filled(kept, T::ZERO), large_pages::filled(sums, [T::ZERO; 4]));
        Self { linearization, sums, ..Self::new(nodes) }
    }

    /// Rows of the copies of nodes, as they were summed last.
    pub(crate) fn summed(&self) -> &[[T; 4]] {
        &self.sums
    }

    /// Writes to each node of `out` the sum of what [`ForceModel::sum_forces`] left on its copies.
    pub fn write_sums(&self, patches: &Patches, out: &mut [Vec3<T>]) {
        patches.write_up(&self.executor, &self.sums, out);
    }

    /// Adds them to `out`.
    pub(crate) fn add_sums(&self, patches: &Patches, out: &mut [Vec3<T>]) {
        patches.add_up(&self.executor, &self.sums, out);
    }

    /// Writes those of a block of nodes.
    pub(crate) fn write_sums_of_block(&self, patches: &Patches, block: usize, out: &mut [Vec3<T>]) {
        patches.write_up_block(block, &self.sums, out);
    }

    /// Writes to each of a block of nodes the sum of what [`ForceModel::sum_diagonal`] left on its copies.
    pub(crate) fn write_blocks_of_block(&self, patches: &Patches, block: usize, out: &mut [Sym3<T>]) {
        patches.write_up_blocks(block, &self.sums, out);
    }

    /// `len` rows to sum in, and beside them what was kept for products; scratch made for the body's models has the room already.
    pub(crate) fn sums(&mut self, len: usize) -> (Sums<'_, T>, &[T]) {
        let (sums, linearization) = self.sums_and_linearization(len, self.linearization.len());
        (sums, linearization)
    }

    /// The same with room for `kept` numbers that products will need.
    pub(crate) fn sums_and_linearization(&mut self, len: usize, kept: usize) -> (Sums<'_, T>, &mut [T]) {
        if self.sums.len() < len {
            self.sums.resize(len, [T::ZERO; 4]);
        }
        self.linearization.resize(kept, T::ZERO);
        (Sums { executor: &self.executor, rows: &mut self.sums[..len] }, &mut self.linearization)
    }

    /// What loops in sections read, with `len` rows to sum in on the way to the forces; scratch made for the body's models has the
    /// room already.
    pub(crate) fn sections(&mut self, len: usize) -> SectionScratch<'_, T> {
        if self.sums.len() < len {
            self.sums.resize(len, [T::ZERO; 4]);
        }
        let Self { nodal, direction, forces, sums: rows, linearization, executor, .. } = self;
        SectionScratch { nodal, direction, linearization, sums: SectionSums { executor, rows, forces } }
    }

    /// Fills the places with `x` and clears the forces.
    pub(crate) fn start(&mut self, x: &[Vec3<T>]) {
        fill(&self.executor, &mut self.nodal, x);
        self.clear_forces();
    }

    /// Clears the forces.
    pub(crate) fn clear_forces(&mut self) {
        patch::clear(&mut self.forces);
    }

    /// Fills the directions with `dx`.
    pub(crate) fn start_direction(&mut self, dx: &[Vec3<T>]) {
        fill(&self.executor, &mut self.direction, dx);
    }

    /// Room for `len` numbers that a model keeps; scratch made for the body's models has it already.
    pub(crate) fn room_for_linearization(&mut self, len: usize) -> &mut [T] {
        self.linearization.resize(len, T::ZERO);
        &mut self.linearization
    }

    /// Who computes, the places, and room for `len` numbers that products will need; scratch made for the body's models has it
    /// already.
    pub(crate) fn start_linearization(&mut self, len: usize) -> (&Executor, &[[T; 4]], &mut [T]) {
        self.linearization.resize(len, T::ZERO);
        self.is_linearized = true;
        (&self.executor, &self.nodal, &mut self.linearization)
    }

    /// Adds the forces to `out`.
    pub(crate) fn finish(&self, out: &mut [Vec3<T>]) {
        add_rows(&self.executor, &self.forces, out);
    }
}

/// Who sums, and where.
pub(crate) struct Sums<'a, T> {
    pub(crate) executor: &'a Executor,
    pub(crate) rows: &'a mut [[T; 4]],
}

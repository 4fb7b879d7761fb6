use std::sync::Arc;

use super::Condensation;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::VolumeMesh;
use crate::model::{ForceModel, Scratch};
use crate::solver::BlockSink;

/// Number of a cell that does not move.
const PRECOMPUTED: u32 = u32::MAX;

/// The forces of a hybrid body: those of the part that moves, and S u_B on the boundary of the rest. None on followers.
pub(super) struct HybridModel<T: Scalar> {
    moving: Box<dyn ForceModel<T>>,
    condensation: Arc<Condensation>,
    /// S [N/m], row after row, and the boundary at rest [m].
    stiffness: Arc<Vec<Mat3<T>>>,
    rest: Arc<Vec<Vec3<T>>>,
    /// The number of each cell in the part that moves.
    numbers: Arc<Vec<u32>>,
    /// Memory for such numbers.
    removed: Vec<u32>,
}

impl<T: Scalar> HybridModel<T> {
    pub(super) fn new(moving: Box<dyn ForceModel<T>>, condensation: Arc<Condensation>, mesh: &VolumeMesh) -> Self {
        let mut numbers = vec![PRECOMPUTED; mesh.cell_count()];
        let cells = condensation.dynamic_cells();
        cells.iter().enumerate().for_each(|(number, &cell)| numbers[cell as usize] = number as u32);
        let rest = condensation.boundary().iter().map(|&node| mesh.nodes()[node as usize].cast()).collect();
        Self {
            removed: Vec::with_capacity(cells.len()),
            stiffness: Arc::new(condensation.stiffness_as()),
            rest: Arc::new(rest),
            numbers: Arc::new(numbers),
            moving,
            condensation,
        }
    }

    /// Adds S v on the boundary; `along` gives v by place and node.
    fn add_stiffness_times(&self, along: impl Fn(usize, usize) -> Vec3<T>, out: &mut [Vec3<T>]) {
        let boundary = self.condensation.boundary();
        for (row, &node) in self.stiffness.chunks_exact(boundary.len().max(1)).zip(boundary) {
            let places = row.iter().zip(boundary).enumerate();
            let force =
                places.fold(Vec3::ZERO, |sum, (place, (&block, &node))| sum + block * along(place, node as usize));
            out[node as usize] += force;
        }
    }
}

impl<T: Scalar> ForceModel<T> for HybridModel<T> {
    fn name(&self) -> &'static str {
        super::Hybrid::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.moving.add_forces(x, scratch, out);
        self.add_stiffness_times(|place, node| x[node] - self.rest[place], out);
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        self.moving.linearize(x, scratch);
    }

    fn linearization_len(&self) -> usize {
        self.moving.linearization_len()
    }

    fn linearize_and_add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.moving.linearize_and_add_forces(x, scratch, out);
        self.add_stiffness_times(|place, node| x[node] - self.rest[place], out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.moving.add_product(x, dx, scratch, out);
        self.add_stiffness_times(|_, node| dx[node], out);
    }

    fn add_exact_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.moving.add_exact_product(x, dx, scratch, out);
        self.add_stiffness_times(|_, node| dx[node], out);
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.moving.add_blocks(x, scratch, sink);
        let boundary = self.condensation.boundary();
        for (row, blocks) in self.stiffness.chunks_exact(boundary.len().max(1)).enumerate() {
            for (column, &block) in blocks.iter().enumerate() {
                if row == column || !sink.keeps_diagonal_only() {
                    sink.add(boundary[row], boundary[column], block);
                }
            }
        }
    }

    fn has_potential(&self) -> bool {
        self.moving.has_potential()
    }

    fn has_creases(&self) -> bool {
        self.moving.has_creases()
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let boundary = self.condensation.boundary();
        let u = |place: usize| (x[boundary[place] as usize] - self.rest[place]).cast::<f64>();
        let mut twice = 0.0;
        for row in 0..boundary.len() {
            let force = (0..boundary.len())
                .fold(Vec3::ZERO, |sum, column| sum + self.condensation.stiffness(row, column) * u(column));
            twice += u(row).dot(force);
        }
        self.moving.energy(x) + 0.5 * twice
    }

    /// Cells of the pre-computed part stay.
    fn remove(&mut self, cells: &[u32]) {
        self.removed.clear();
        let numbers = cells.iter().map(|&cell| self.numbers[cell as usize]);
        self.removed.extend(numbers.filter(|&number| number != PRECOMPUTED));
        self.moving.remove(&self.removed);
    }

    fn is_nonlinear_at(&self, displacement: Vec3<T>) -> bool {
        self.moving.is_nonlinear_at(displacement)
    }

    fn sum_rows(&self) -> usize {
        self.moving.sum_rows()
    }

    fn rings(&self) -> usize {
        self.moving.rings()
    }

    fn coupled(&self) -> &[u32] {
        self.condensation.boundary()
    }

    fn bytes(&self) -> usize {
        self.moving.bytes() + size_of_val(&self.stiffness[..])
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(Self {
            moving: self.moving.clone_box(),
            condensation: self.condensation.clone(),
            stiffness: self.stiffness.clone(),
            rest: self.rest.clone(),
            numbers: self.numbers.clone(),
            removed: Vec::with_capacity(self.removed.capacity()),
        })
    }
}

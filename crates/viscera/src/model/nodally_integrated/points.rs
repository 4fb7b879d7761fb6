//! The nodes as points of integration: each sees the nodes around it through the gradients g_ab of its mean deformation.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use super::batch::{Batch, MAX_PARAMETERS, Point};
use super::rest::{Neighbour, Neighbourhood, Rest};
use crate::material::{Law, LawFamily, Tissue};
use crate::math::{Mat3, Part, Scalar, Simd, Vec3, dispatch, dispatch_level};
use crate::mesh::TetMesh;
use crate::model::block_table::BlockTable;
use crate::model::lane_vector::nothing;
use crate::model::sections::{SectionScratch, Sections};
use crate::model::{ModelError, Scratch};

/// Points whose numbers of neighbours are sorted together, in batches: it fills the lanes, and a wider window would
/// take neighbours apart.
const WINDOW: usize = 16;

/// Points in batches of lanes, of the law `L`.
#[derive(Debug)]
pub(super) struct NodalPoints<T: Scalar, L> {
    /// The neighbours of batch b are the entries `starts[b]..starts[b + 1]`, the node itself first. Lanes with fewer
    /// repeat it with a gradient of zero.
    pub(super) starts: Vec<u32>,
    /// Entry after entry, a node for each lane.
    nodes: Vec<u32>,
    pub(super) sections: Arc<Sections>,
    /// Entry after entry, x, y, z of g_ab [1/m] for each lane.
    gradients: Vec<T>,
    /// Entry after entry, what the cells of the point add to the spring k_ab [N/m], for each lane.
    springs: Vec<T>,
    /// V_a [m³], s μ V_a [J], then the law's parameters.
    pub(super) constants: BlockTable<T>,
    rest: Arc<Rest>,
    /// Which cells are gone.
    removed: Vec<bool>,
    /// Points that have lost a cell and are not written yet; none, between calls.
    touched: Vec<bool>,
    /// Memory for the neighbours of a point: cuts ask for none.
    around: Vec<Neighbour>,
    law: PhantomData<L>,
}

impl<T: Scalar, L> Clone for NodalPoints<T, L> {
    fn clone(&self) -> Self {
        Self {
            starts: self.starts.clone(),
            nodes: self.nodes.clone(),
            sections: Arc::clone(&self.sections),
            gradients: self.gradients.clone(),
            springs: self.springs.clone(),
            constants: self.constants.clone(),
            rest: Arc::clone(&self.rest),
            removed: self.removed.clone(),
            touched: self.touched.clone(),
            around: self.around.clone(),
            law: PhantomData,
        }
    }
}

impl<T: Scalar, L: LawFamily> NodalPoints<T, L> {
    /// The points of `mesh`, where `share` is s μ of a cell [Pa].
    pub(super) fn new(mesh: &TetMesh, tissue: &Tissue, share: impl Fn(usize) -> f64) -> Result<Self, ModelError> {
        let (mut rest, mut points) = Rest::new(mesh, tissue, share)?;
        for window in points.chunks_mut(WINDOW * T::LANES) {
            window.sort_by_key(|around| std::cmp::Reverse(around.nodes.len()));
        }
        rest.number_points(&points);
        let longest = points.iter().map(|around| around.nodes.len()).max().unwrap_or(0);
        let mut model = Self {
            starts: vec![0],
            nodes: Vec::new(),
            sections: Arc::default(),
            gradients: Vec::new(),
            springs: Vec::new(),
            constants: BlockTable::new(T::LANES, points.len(), 2 + L::PARAMETERS.len(), T::ZERO),
            rest: Arc::new(rest),
            removed: vec![false; mesh.cells.len()],
            touched: vec![false; points.len()],
            around: vec![Neighbour::UNCOUNTED; longest],
            law: PhantomData,
        };
        points.chunks(T::LANES).for_each(|batch| model.push_batch(batch));
        let bounds: Vec<_> = model.starts.iter().map(|&start| start as usize * T::LANES).collect();
        model.sections = Arc::new(Sections::new(mesh.nodes.len(), &model.nodes, &bounds));
        model.gradients = vec![T::ZERO; 3 * model.nodes.len()];
        model.springs = vec![T::ZERO; model.nodes.len()];
        for row in 0..model.constants.padded_rows() {
            // Padding repeats the last point, with a volume of zero.
            let point = row.min(points.len() - 1);
            let values = tissue.values(model.rest.example(point));
            let numbers = [0.0; 2].into_iter().chain(values.iter().copied());
            model.constants.set_row(row, numbers.map(T::from_f64));
            model.write(row, point);
        }
        Ok(model)
    }

    /// Makes room for a batch, as long as its longest list.
    fn push_batch(&mut self, batch: &[Neighbourhood]) {
        let longest = batch.iter().map(|around| around.nodes.len()).max().unwrap_or(0);
        for entry in 0..longest {
            let at = |lane: usize| {
                let Neighbourhood { point, nodes } = &batch[lane.min(batch.len() - 1)];
                nodes.get(entry).copied().unwrap_or(point.node)
            };
            self.nodes.extend((0..T::LANES).map(at));
        }
        self.starts.push((self.nodes.len() / T::LANES) as u32);
    }

    /// Writes volume, gradients and springs of a point into a row.
    fn write(&mut self, row: usize, point: usize) {
        let (first, lane) = (self.starts[row / T::LANES] as usize, row % T::LANES);
        let end = self.starts[row / T::LANES + 1] as usize;
        let node = |entry: usize| self.nodes[(first + entry) * T::LANES + lane];
        let length = 1 + (1..end - first).take_while(|&entry| node(entry) != node(0)).count();
        let around = &mut self.around[..length];
        around.fill(Neighbour::UNCOUNTED);
        let volume = self.rest.weigh(point, &self.removed, around);
        let is_padding = row != point;
        let (share, weight) = (self.rest.share(point), if is_padding { 0.0 } else { 1.0 });
        *self.constants.get_mut(row, 0) = T::from_f64(weight * volume);
        *self.constants.get_mut(row, 1) = T::from_f64(weight * share * volume);
        for (entry, &Neighbour { gradient, spring }) in around.iter().enumerate() {
            let entry = first + entry;
            let spring = if entry == first { 0.0 } else { weight * share * spring };
            self.springs[entry * T::LANES + lane] = T::from_f64(spring);
            // A point that has lost all its cells keeps its gradients: its deformation stays as harmless as it was.
            if volume > 0.0 {
                for axis in 0..3 {
                    self.gradients[(3 * entry + axis) * T::LANES + lane] = T::from_f64(gradient[axis] / volume);
                }
            }
        }
    }

    /// Takes cells out: the points of their corners are weighed again, whatever the size of the mesh.
    pub(super) fn remove_cells(&mut self, cells: &[u32]) {
        let rest = Arc::clone(&self.rest);
        for &cell in cells {
            self.removed[cell as usize] = true;
            rest.points_of(cell as usize).for_each(|point| self.touched[point] = true);
        }
        for &cell in cells {
            for point in rest.points_of(cell as usize) {
                if std::mem::replace(&mut self.touched[point], false) {
                    self.write(point, point);
                }
            }
        }
    }

    pub(super) fn table_bytes(&self) -> usize {
        let entries = size_of_val(self.nodes.as_slice()) + size_of_val(self.springs.as_slice());
        entries + self.sections.bytes() + size_of_val(self.gradients.as_slice()) + self.constants.bytes()
    }

    /// Rows that forces are summed in; blocks on the diagonal take two for each.
    pub(super) fn section_rows(&self) -> usize {
        2 * self.sections.sum_rows()
    }

    pub(super) fn add_nodal_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let SectionScratch { nodal, mut sums, .. } = scratch.sections(self.section_rows());
        self.sections.add(&mut sums, &|batches, rows| {
            dispatch!(dispatch_level(), simd => self.add_forces_with(simd, nodal, batches, rows));
        });
        scratch.finish(out);
    }

    /// The entries of a batch.
    #[inline(always)]
    pub(super) fn batch(&self, number: usize) -> Batch<'_, T> {
        let (start, end) = (self.starts[number] as usize * T::LANES, self.starts[number + 1] as usize * T::LANES);
        Batch {
            nodes: &self.nodes[start..end],
            rows: self.sections.rows(start..end),
            gradients: &self.gradients[3 * start..3 * end],
            springs: &self.springs[start..end],
        }
    }

    #[inline(always)]
    fn add_forces_with<S: Simd>(&self, simd: S, x: &[[T; 4]], batches: Range<usize>, out: &mut [[T; 4]]) {
        let mut kept = [nothing(); 4];
        for number in batches {
            let batch = self.batch(number);
            for part in Part::all::<T>(simd) {
                let point = Point::<T::Lanes<S>>::load::<T, S, L>(part, self.constants.block(number));
                let (f, pull) = batch.around::<S>(part, x);
                batch.spread::<S>(part, (point.stress::<L>(&f), pull), &mut kept, out);
            }
        }
    }

    /// Sum of the energies [J], point by point in double precision.
    pub(super) fn nodal_energy(&self, x: &[Vec3<T>]) -> f64 {
        let at_point = |row: usize| {
            let (batch, lane) = (row / T::LANES, row % T::LANES);
            let entries = self.starts[batch] as usize..self.starts[batch + 1] as usize;
            let displacement = |entry: usize| {
                let node = self.nodes[entry * T::LANES + lane] as usize;
                x[node].cast::<f64>() - self.rest.mesh.nodes[node]
            };
            let own = displacement(entries.start);
            let (mut h, mut springs) = (Mat3::ZERO, 0.0);
            for entry in entries {
                let gradient = [0, 1, 2].map(|axis| self.gradients[(3 * entry + axis) * T::LANES + lane].to_f64());
                let apart = displacement(entry) - own;
                h += apart.outer(Vec3::from(gradient));
                springs += self.springs[entry * T::LANES + lane].to_f64() * apart.squared_norm();
            }
            let constant = |column: usize| self.constants.get(row, column).to_f64();
            let mut values = [0.0; MAX_PARAMETERS];
            (0..L::PARAMETERS.len()).for_each(|column| values[column] = constant(2 + column));
            let law = <L as LawFamily>::at::<f64>(&values[..L::PARAMETERS.len()]);
            // half of each spring, whose other end has the other half
            constant(0) * law.energy(&(Mat3::IDENTITY + h)) - 0.5 * constant(1) * h.squared_norm() + 0.25 * springs
        };
        (0..self.constants.rows()).map(at_point).sum()
    }
}

//! The nodes as points of integration: each sees the nodes around it through the gradients g_ab of its mean deformation.

use std::marker::PhantomData;

use fearless_simd::{Simd, dispatch};

use super::super::block_table::BlockTable;
use super::super::tet_loop::{RestTet, gather_corner};
use super::super::Scratch;
use super::stabiliser;
use crate::material::{Law, LawFamily, Tissue};
use crate::math::{Lanes, Mat3, Real, Scalar, Vec3, dispatch_level};
use crate::mesh::{TetMesh, cells_of_nodes};

/// Points whose numbers of neighbours are sorted together, in batches: it fills the lanes, and a wider window would
/// take neighbours apart.
const WINDOW: usize = 32;
/// The most parameters of a law.
const MAX_PARAMETERS: usize = 8;

/// Points in batches of lanes, of the law `L`. A point is a node and one of the tissues around it.
#[derive(Debug)]
pub(super) struct NodalPoints<T: Scalar, L> {
    /// The neighbours of batch b are the entries `starts[b]..starts[b + 1]`, the node itself first. Lanes with fewer
    /// repeat it with a gradient of zero.
    starts: Vec<u32>,
    /// Entry after entry, a node for each lane.
    nodes: Vec<u32>,
    /// Entry after entry, x, y, z of g_ab [1/m] for each lane.
    gradients: Vec<T>,
    /// V_a [m³], s μ V_a [J], then the law's parameters.
    constants: BlockTable<T>,
    rest: Rest,
    law: PhantomData<L>,
}

/// What the gradients are computed from when cells are removed.
#[derive(Clone, Debug)]
struct Rest {
    mesh: TetMesh,
    cells_at_nodes: (Vec<u32>, Vec<u32>),
    removed: Vec<bool>,
    /// Which tissue a cell is of.
    tissues: Vec<u32>,
    /// s μ of each tissue [Pa].
    shares: Vec<f64>,
    /// Node and tissue of each point.
    points: Vec<(u32, u32)>,
}

impl<T: Scalar, L> Clone for NodalPoints<T, L> {
    fn clone(&self) -> Self {
        Self {
            starts: self.starts.clone(),
            nodes: self.nodes.clone(),
            gradients: self.gradients.clone(),
            constants: self.constants.clone(),
            rest: self.rest.clone(),
            law: PhantomData,
        }
    }
}

impl Rest {
    /// The points of `mesh`, where `share` is s μ of a cell [Pa]; and a cell of each tissue.
    fn new(mesh: &TetMesh, tissue: &Tissue, share: impl Fn(usize) -> f64) -> (Self, Vec<usize>) {
        let cells = mesh.cells.len();
        let mut examples: Vec<usize> = Vec::new();
        let mut tissues = vec![0; cells];
        if tissue.is_uniform() {
            examples.push(0);
        } else {
            let bits = |cell: usize| tissue.values(cell).iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            let mut known = std::collections::BTreeMap::new();
            for (cell, number) in tissues.iter_mut().enumerate() {
                *number = *known.entry(bits(cell)).or_insert_with(|| {
                    examples.push(cell);
                    examples.len() as u32 - 1
                });
            }
        }
        let cells_at_nodes = cells_of_nodes(mesh);
        let mut rest = Self {
            mesh: TetMesh::new(mesh.nodes.clone(), mesh.cells.clone()),
            cells_at_nodes,
            removed: vec![false; cells],
            tissues,
            shares: examples.iter().map(|&cell| share(cell)).collect(),
            points: Vec::new(),
        };
        for node in 0..mesh.nodes.len() as u32 {
            let mut around: Vec<u32> = rest.cells_at(node).map(|cell| rest.tissues[cell]).collect();
            around.sort_unstable();
            around.dedup();
            rest.points.extend(around.into_iter().map(|tissue| (node, tissue)));
        }
        (rest, examples)
    }

    fn cells_at(&self, node: u32) -> impl Iterator<Item = usize> + '_ {
        let (starts, cells) = &self.cells_at_nodes;
        let span = starts[node as usize] as usize..starts[node as usize + 1] as usize;
        cells[span].iter().map(|&cell| cell as usize).filter(|&cell| !self.removed[cell])
    }

    /// Nodes of the cells of a point, its own first.
    fn neighbours(&self, point: usize) -> Vec<u32> {
        let (node, tissue) = self.points[point];
        let cells = self.cells_at(node).filter(|&cell| self.tissues[cell] == tissue);
        let mut around: Vec<u32> = cells.flat_map(|cell| self.mesh.cells[cell]).filter(|&other| other != node).collect();
        around.sort_unstable();
        around.dedup();
        around.insert(0, node);
        around
    }

    /// V_a, and V_a g_ab of each of `neighbours`.
    fn weigh(&self, point: usize, neighbours: &[u32]) -> (f64, Vec<Vec3<f64>>) {
        let (node, tissue) = self.points[point];
        let mut volume = 0.0;
        let mut sums = vec![Vec3::ZERO; neighbours.len()];
        for cell in self.cells_at(node).filter(|&cell| self.tissues[cell] == tissue) {
            let rest = RestTet::measure(&self.mesh, cell);
            let share = rest.volume / 4.0;
            volume += share;
            for (corner, gradient) in self.mesh.cells[cell].into_iter().zip(rest.gradients()) {
                if let Some(entry) = neighbours.iter().position(|&other| other == corner) {
                    sums[entry] += gradient * share;
                }
            }
        }
        (volume, sums)
    }
}

impl<T: Scalar, L: LawFamily> NodalPoints<T, L> {
    /// The points of `mesh`, where `share` is s μ of a cell [Pa].
    pub(super) fn new(mesh: &TetMesh, tissue: &Tissue, share: impl Fn(usize) -> f64) -> Self {
        let (mut rest, examples) = Rest::new(mesh, tissue, share);
        let mut lists: Vec<(Vec<u32>, (u32, u32))> =
            (0..rest.points.len()).map(|point| (rest.neighbours(point), rest.points[point])).collect();
        for window in lists.chunks_mut(WINDOW * T::LANES) {
            window.sort_by_key(|(neighbours, _)| std::cmp::Reverse(neighbours.len()));
        }
        rest.points = lists.iter().map(|&(_, point)| point).collect();
        let mut model = Self {
            starts: vec![0],
            nodes: Vec::new(),
            gradients: Vec::new(),
            constants: BlockTable::new(T::LANES, lists.len(), 2 + L::PARAMETERS.len(), T::ZERO),
            rest,
            law: PhantomData,
        };
        for batch in lists.chunks(T::LANES) {
            let longest = batch.iter().map(|(list, _)| list.len()).max().unwrap_or(0);
            for entry in 0..longest {
                let at = |lane: usize| {
                    let (list, (node, _)) = &batch[lane.min(batch.len() - 1)];
                    list.get(entry).copied().unwrap_or(*node)
                };
                model.nodes.extend((0..T::LANES).map(at));
            }
            model.starts.push((model.nodes.len() / T::LANES) as u32);
        }
        model.gradients = vec![T::ZERO; 3 * model.nodes.len()];
        for row in 0..model.constants.padded_rows() {
            let point = row.min(lists.len() - 1);
            let values = tissue.values(examples[model.rest.points[point].1 as usize]);
            let numbers = [0.0; 2].into_iter().chain(values.iter().copied());
            model.constants.set_row(row, numbers.map(T::from_f64));
            model.write(row, point);
        }
        model
    }

    /// Writes volume and gradients of a point into a row; a row of padding keeps a volume of zero.
    fn write(&mut self, row: usize, point: usize) {
        let (batch, lane) = (row / T::LANES, row % T::LANES);
        let entries = self.starts[batch] as usize..self.starts[batch + 1] as usize;
        let mut list: Vec<u32> = entries.clone().map(|entry| self.nodes[entry * T::LANES + lane]).collect();
        let length = 1 + list[1..].iter().take_while(|&&node| node != list[0]).count();
        list.truncate(length);
        let (volume, sums) = self.rest.weigh(point, &list);
        let there = row == point && volume > 0.0;
        let volume_here = if there { volume } else { 0.0 };
        let share = self.rest.shares[self.rest.points[point].1 as usize];
        *self.constants.get_mut(row, 0) = T::from_f64(volume_here);
        *self.constants.get_mut(row, 1) = T::from_f64(share * volume_here);
        // A point that has lost all its cells keeps its gradients: its deformation stays as harmless as it was.
        if volume > 0.0 {
            for (entry, sum) in entries.zip(sums) {
                for axis in 0..3 {
                    self.gradients[(3 * entry + axis) * T::LANES + lane] = T::from_f64(sum[axis] / volume);
                }
            }
        }
    }

    pub(super) fn remove(&mut self, cells: &[u32]) {
        let mut touched = vec![false; self.rest.mesh.nodes.len()];
        for &cell in cells {
            self.rest.removed[cell as usize] = true;
            self.rest.mesh.cells[cell as usize].into_iter().for_each(|node| touched[node as usize] = true);
        }
        for point in 0..self.rest.points.len() {
            if touched[self.rest.points[point].0 as usize] {
                self.write(point, point);
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.gradients.as_slice()) + self.constants.bytes()
    }

    pub(super) fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let Scratch { nodal, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_with::<_, false>(simd, nodal, nodal, forces));
        scratch.finish(out);
    }

    pub(super) fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        let Scratch { nodal, direction, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_with::<_, true>(simd, nodal, direction, forces));
        scratch.finish(out);
    }

    /// Nodes and gradients of each batch, with its constants.
    fn batches(&self) -> impl Iterator<Item = (&[u32], &[T], &[T])> {
        self.starts.windows(2).zip(self.constants.blocks()).map(|(span, constants)| {
            let (start, end) = (span[0] as usize * T::LANES, span[1] as usize * T::LANES);
            (&self.nodes[start..end], &self.gradients[3 * start..3 * end], constants)
        })
    }

    #[inline(always)]
    fn add_with<S: Simd, const TANGENT: bool>(&self, simd: S, x: &[[T; 4]], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        for (nodes, gradients, constants) in self.batches() {
            let point = Point::<T::Lanes<S>>::load::<T, S, L>(simd, constants);
            let f = mean_gradient::<T, S>(simd, x, nodes, gradients);
            let stress = if TANGENT {
                point.tangent::<L>(&f, &mean_gradient::<T, S>(simd, dx, nodes, gradients))
            } else {
                point.stress::<L>(&f)
            };
            let mut sum = Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO));
            for (nodes, gradient) in entries::<T>(nodes, gradients).skip(1) {
                let force = stress * load_gradient::<T, S>(simd, gradient);
                sum += force;
                T::Lanes::<S>::scatter_add(force.to_array(), nodes, out);
            }
            T::Lanes::<S>::scatter_add((-sum).to_array(), &nodes[..T::LANES], out);
        }
    }

    /// Sum of the energies [J], point by point in double precision.
    pub(super) fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let at_point = |row: usize| {
            let (batch, lane) = (row / T::LANES, row % T::LANES);
            let entries = self.starts[batch] as usize..self.starts[batch + 1] as usize;
            let place = |entry: usize| x[self.nodes[entry * T::LANES + lane] as usize].cast::<f64>();
            let origin = place(entries.start);
            let mut f = Mat3::ZERO;
            for entry in entries {
                let gradient = [0, 1, 2].map(|axis| self.gradients[(3 * entry + axis) * T::LANES + lane].to_f64());
                f += (place(entry) - origin).outer(Vec3::from(gradient));
            }
            let constant = |column: usize| self.constants.get(row, column).to_f64();
            let mut values = [0.0; MAX_PARAMETERS];
            (0..L::PARAMETERS.len()).for_each(|column| values[column] = constant(2 + column));
            let law = <L as LawFamily>::at::<f64>(&values[..L::PARAMETERS.len()]);
            constant(0) * law.energy(&f) - constant(1) * stabiliser::energy(&f)
        };
        (0..self.constants.rows()).map(at_point).sum()
    }
}

/// Volume, share and law of a batch of points.
struct Point<R> {
    volume: R,
    share: R,
    parameters: [R; MAX_PARAMETERS],
}

impl<R: Real> Point<R> {
    #[inline(always)]
    fn load<T, S, L>(simd: S, constants: &[T]) -> Self
    where
        T: Scalar<Lanes<S> = R>,
        S: Simd,
        R: Lanes<T, S>,
        L: LawFamily,
    {
        let constant = |column: usize| R::load(simd, &constants[column * T::LANES..]);
        let mut parameters = [R::splat(simd, T::ZERO); MAX_PARAMETERS];
        for column in 0..L::PARAMETERS.len() {
            parameters[column] = constant(2 + column);
        }
        Self { volume: constant(0), share: constant(1), parameters }
    }

    /// V P(F̄) of the law, less the share of the cells.
    #[inline(always)]
    fn stress<L: LawFamily>(&self, f: &Mat3<R>) -> Mat3<R> {
        let law = L::at(&self.parameters[..L::PARAMETERS.len()]);
        law.stress(f) * self.volume - stabiliser::stress(f) * self.share
    }

    #[inline(always)]
    fn tangent<L: LawFamily>(&self, f: &Mat3<R>, df: &Mat3<R>) -> Mat3<R> {
        let law = L::at(&self.parameters[..L::PARAMETERS.len()]);
        law.tangent(f, df) * self.volume - stabiliser::tangent(f, df) * self.share
    }
}

/// The entries of a batch: a node, and x, y, z of a gradient, for each lane.
#[inline(always)]
fn entries<'a, T: Scalar>(nodes: &'a [u32], gradients: &'a [T]) -> impl Iterator<Item = (&'a [u32], &'a [T])> {
    nodes.chunks_exact(T::LANES).zip(gradients.chunks_exact(3 * T::LANES))
}

#[inline(always)]
fn load_gradient<T: Scalar, S: Simd>(simd: S, gradient: &[T]) -> Vec3<T::Lanes<S>> {
    let component = |axis: usize| T::Lanes::<S>::load(simd, &gradient[axis * T::LANES..]);
    Vec3::new(component(0), component(1), component(2))
}

/// Σ_b (v_b − v_a) g_abᵀ: of places F̄, of directions its derivative. The differences keep digits that v alone would lose.
#[inline(always)]
fn mean_gradient<T: Scalar, S: Simd>(simd: S, v: &[[T; 4]], nodes: &[u32], gradients: &[T]) -> Mat3<T::Lanes<S>> {
    let own = gather_corner::<T, S>(simd, v, nodes, 0);
    let zero = Vec3::splat(T::Lanes::<S>::splat(simd, T::ZERO));
    let mut sum = Mat3::from_columns(zero, zero, zero);
    for (nodes, gradient) in entries::<T>(nodes, gradients).skip(1) {
        sum += (gather_corner::<T, S>(simd, v, nodes, 0) - own).outer(load_gradient::<T, S>(simd, gradient));
    }
    sum
}

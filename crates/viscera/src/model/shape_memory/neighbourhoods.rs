use std::collections::BTreeMap;
use std::sync::Arc;

use super::memory::{Remembered, well_shaped};
use crate::material::Tissue;
use crate::math::{Mat3, Scalar, Sym3, Vec3};
use crate::mesh::{HEX_EDGES, Point, TET_EDGES, VolumeMesh};
use crate::model::ModelError;
use crate::model::checked_cell::checked_volume;

/// How firmly all neighbours of a node together are held in their shape, of how firmly the node is held among them. With a tenth a bar that
/// was turned inside out was still on its way after three seconds, with this it is back.
const GRIP: f64 = 1.0;

/// Who remembers whom: the neighbours of every node, with what the rest shape says of them.
#[derive(Clone, Debug)]
pub(super) struct Neighbourhoods<T> {
    pub(super) rest: Arc<Rest>,
    /// Of each neighbour, how many cells are left that join the two; it counts as long as there are any.
    joined: Vec<u32>,
    /// Y of each neighbour: from the centroid of all of them, at rest [m].
    pub(super) arms: Vec<Vec3<T>>,
    /// What each node remembers.
    pub(super) nodes: Vec<OfNode<T>>,
    removed: Vec<bool>,
}

/// What a node remembers.
#[derive(Clone, Copy, Debug)]
pub(super) struct OfNode<T> {
    /// 1/n; 0 for a node without neighbours.
    pub(super) share: T,
    pub(super) offset: Vec3<T>,
    pub(super) stiffness: T,
    pub(super) grip: T,
    pub(super) shape: T,
    /// One over the longest of its arms, by their largest component [1/m].
    pub(super) unit: T,
}

/// What a cut does not change.
#[derive(Debug)]
pub(super) struct Rest {
    places: Vec<Point>,
    /// The neighbours of node n are those in `neighbours[starts[n]..starts[n + 1]]`, ascending.
    pub(super) starts: Vec<u32>,
    pub(super) neighbours: Vec<u32>,
    /// Where the node stands in the list of each neighbour.
    pub(super) back: Vec<u32>,
    /// The pairs of each cell, `per_cell` of them, as their two entries in `neighbours`.
    pairs: Vec<[u32; 2]>,
    per_cell: usize,
    /// Cells at each node: those of node n are `cells[cell_starts[n]..cell_starts[n + 1]]`.
    cell_starts: Vec<u32>,
    cells: Vec<u32>,
    pub(super) corners: Vec<Vec<u32>>,
    /// Volume at a corner of each cell [m³], and Young's modulus times that [N m].
    pub(super) volumes: Vec<f64>,
    stiffnesses: Vec<f64>,
}

impl<T: Scalar> Neighbourhoods<T> {
    pub(super) fn new(mesh: &VolumeMesh, tissue: &Tissue) -> Result<Self, ModelError> {
        let rest = Rest::new(mesh, tissue)?;
        let (nodes, entries) = (rest.places.len(), rest.neighbours.len());
        let mut joined = vec![0; entries];
        rest.pairs.iter().flatten().for_each(|&entry| joined[entry as usize] += 1);
        let nothing = OfNode {
            share: T::ZERO,
            offset: Vec3::ZERO,
            stiffness: T::ZERO,
            grip: T::ZERO,
            shape: T::ONE,
            unit: T::ONE,
        };
        let mut own = Self {
            rest: Arc::new(rest),
            joined,
            arms: vec![Vec3::ZERO; entries],
            nodes: vec![nothing; nodes],
            removed: vec![false; mesh.cell_count()],
        };
        (0..nodes).for_each(|node| own.remember(node));
        Ok(own)
    }

    /// The entries of the neighbours that a node has left.
    pub(super) fn entries(&self, node: usize) -> impl Iterator<Item = usize> + Clone + '_ {
        let Rest { starts, .. } = &*self.rest;
        (starts[node] as usize..starts[node + 1] as usize).filter(|&entry| self.joined[entry] > 0)
    }

    /// Finds anew what a node remembers, from the cells that are left.
    fn remember(&mut self, node: usize) {
        let rest = self.rest.clone();
        let place = |entry: usize| rest.places[rest.neighbours[entry] as usize];
        let count = self.entries(node).count();
        let own = &mut self.nodes[node];
        if count == 0 {
            (own.share, own.stiffness) = (T::ZERO, T::ZERO);
            return;
        }
        let share = 1.0 / count as f64;
        let centre = self.entries(node).fold(Vec3::ZERO, |sum, entry| sum + (place(entry) - rest.places[node])) * share;
        let arm = |entry: usize| place(entry) - rest.places[node] - centre;
        let longest = self
            .entries(node)
            .flat_map(|entry| arm(entry).to_array())
            .fold(0.0, |most: f64, part| most.max(part.abs()));
        let unit = if longest > 0.0 { 1.0 / longest } else { 1.0 };
        let mut covariance = Sym3::diagonal(0.0);
        for entry in rest.starts[node] as usize..rest.starts[node + 1] as usize {
            if self.joined[entry] > 0 {
                covariance = covariance + Sym3::square(arm(entry) * unit);
                self.arms[entry] = arm(entry).cast();
            }
        }
        let gradient = Sym3::diagonal(covariance.trace()) - covariance;
        let (volume, stiffness) = rest.around(node, &self.removed);
        let stiffness = stiffness / volume.cbrt().powi(2);
        self.nodes[node] = OfNode {
            share: T::from_f64(share),
            offset: (-centre).cast(),
            stiffness: T::from_f64(stiffness),
            grip: T::from_f64(GRIP * stiffness * share),
            shape: T::from_f64(well_shaped(&Mat3::from(covariance), &gradient)),
            unit: T::from_f64(unit),
        };
    }

    /// Takes cells out; nodes that lose neighbours or volume remember what is left.
    pub(super) fn remove(&mut self, cells: &[u32]) {
        let rest = self.rest.clone();
        for &cell in cells {
            let cell = cell as usize;
            if std::mem::replace(&mut self.removed[cell], true) {
                continue;
            }
            let pairs = &rest.pairs[cell * rest.per_cell..(cell + 1) * rest.per_cell];
            pairs.iter().flatten().for_each(|&entry| self.joined[entry as usize] -= 1);
            rest.corners[cell].iter().for_each(|&node| self.remember(node as usize));
        }
    }

    /// Size of the stored numbers [bytes].
    pub(super) fn bytes(&self) -> usize {
        let Rest { neighbours, back, .. } = &*self.rest;
        size_of_val(self.arms.as_slice())
            + size_of_val(self.nodes.as_slice())
            + size_of_val(self.joined.as_slice())
            + size_of_val(neighbours.as_slice())
            + size_of_val(back.as_slice())
    }
}

impl<T: Scalar> OfNode<T> {
    pub(super) fn remembered<R>(&self, lift: impl Fn(T) -> R) -> Remembered<R> {
        let Vec3 { x, y, z } = self.offset;
        let offset = Vec3 { x: lift(x), y: lift(y), z: lift(z) };
        Remembered {
            offset,
            stiffness: lift(self.stiffness),
            grip: lift(self.grip),
            unit: lift(self.unit),
            shape: lift(self.shape),
        }
    }
}

impl Rest {
    fn new(mesh: &VolumeMesh, tissue: &Tissue) -> Result<Self, ModelError> {
        mesh.check_indices()?;
        let edges = match mesh {
            VolumeMesh::Tet(_) => TET_EDGES.to_vec(),
            VolumeMesh::Hex(_) => HEX_EDGES.to_vec(),
        };
        let (nodes, cells) = (mesh.nodes().len(), mesh.cell_count());
        let mut entries = BTreeMap::new();
        let pair = |corners: &[u32], [a, b]: [usize; 2]| [corners[a], corners[b]];
        for corners in (0..cells).map(|cell| mesh.cell(cell)) {
            for [a, b] in edges.iter().map(|&edge| pair(corners, edge)) {
                entries.extend([((a, b), 0), ((b, a), 0)]);
            }
        }
        entries.values_mut().enumerate().for_each(|(number, entry)| *entry = number as u32);
        let mut starts = vec![0; nodes + 1];
        entries.keys().for_each(|&(node, _)| starts[node as usize + 1] += 1);
        (0..nodes).for_each(|node| starts[node + 1] += starts[node]);
        let both = |[a, b]: [u32; 2]| [entries[&(a, b)], entries[&(b, a)]];
        let (mut cell_starts, mut at_nodes) = (vec![0; nodes + 1], vec![Vec::new(); nodes]);
        let (mut volumes, mut stiffnesses) = (Vec::new(), Vec::new());
        for cell in 0..cells {
            let corners = mesh.cell(cell);
            corners.iter().for_each(|&node| at_nodes[node as usize].push(cell as u32));
            volumes.push(checked_volume(mesh, cell)? / corners.len() as f64);
            stiffnesses.push(volumes[cell] * tissue.at_rest(cell).lame.young());
        }
        for (node, own) in at_nodes.iter().enumerate() {
            cell_starts[node + 1] = cell_starts[node] + own.len() as u32;
        }
        Ok(Self {
            places: mesh.nodes().to_vec(),
            neighbours: entries.keys().map(|&(_, neighbour)| neighbour).collect(),
            back: entries.keys().map(|&(node, neighbour)| entries[&(neighbour, node)]).collect(),
            pairs: (0..cells)
                .flat_map(|cell| edges.iter().map(move |&edge| (cell, edge)))
                .map(|(cell, edge)| both(pair(mesh.cell(cell), edge)))
                .collect(),
            per_cell: edges.len(),
            starts,
            cell_starts,
            cells: at_nodes.into_iter().flatten().collect(),
            corners: (0..cells).map(|cell| mesh.cell(cell).to_vec()).collect(),
            volumes,
            stiffnesses,
        })
    }

    /// Volume at a node [m³], and Young's modulus times that [N m], of the cells that are left.
    fn around(&self, node: usize, removed: &[bool]) -> (f64, f64) {
        let cells = &self.cells[self.cell_starts[node] as usize..self.cell_starts[node + 1] as usize];
        let left = cells.iter().map(|&cell| cell as usize).filter(|&cell| !removed[cell]);
        left.fold((0.0, 0.0), |(volume, stiffness), cell| {
            (volume + self.volumes[cell], stiffness + self.stiffnesses[cell])
        })
    }
}

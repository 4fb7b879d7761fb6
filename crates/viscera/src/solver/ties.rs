//! Equations that tie nodes together, G x = 0, and the factors of G M⁻¹ Gᵀ.
//!
//! With mobilities M⁻¹, what a unit of force or impulse moves each node, λ = (G M⁻¹ Gᵀ)⁻¹ G v makes v − M⁻¹ Gᵀ λ fulfil the ties at the
//! least cost ½ Σ v·M v, and of forces r, with v = M⁻¹ r, it leaves r − Gᵀ λ, what the ties do not take. One factorisation serves as long
//! as the mobilities stay.
//!
//! The factors L Lᵀ lie within the envelope of the matrix, ties in the order of Cuthill and McKee: those of a seam know only their
//! neighbours. Where every mobility is the same in all directions, one factor serves the three of them. A tie that says what those before it
//! say already, or of which nothing moves, is left out: its pivot is what its equation differs from theirs.

use super::dense_cholesky::dot;
use super::envelope::ring_order;
use crate::math::{Mat3, Vec3};

/// A tie that differs from those before it by less than this share of its mobility is left out: in single precision the rounding of
/// places would be as large.
const LEAST_PIVOT: f64 = 1e-8;
/// Nodes of a tie.
const NODES: usize = 5;

/// One equation: Σ w_i x_i = 0 over its nodes, which are numbers in the list of nodes that ties know.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tie {
    pub(crate) nodes: [u32; NODES],
    pub(crate) weights: [f64; NODES],
}

/// The equations of all ties that share nodes.
#[derive(Clone, Debug)]
pub(crate) struct TieEquations {
    ties: Vec<Tie>,
    /// The ties at each node, and with which weight.
    at_nodes: Vec<Vec<(u32, f64)>>,
    /// Ties in the order of the unknowns, and the place of each tie in it.
    order: Vec<u32>,
    places: Vec<u32>,
    /// First place that each one knows.
    firsts: Vec<usize>,
    /// What the factors are of; none for a node that is gone, with which its ties end.
    mobilities: Vec<Option<Mat3<f64>>>,
    /// Unknowns of a tie: 1, if one factor serves all directions, or 3.
    width: usize,
    /// L row after row, each from its first column to before the diagonal; where each row begins.
    values: Vec<f64>,
    starts: Vec<usize>,
    /// 1/L_ii; zero for what is left out.
    inverse: Vec<f64>,
    /// Memory for the unknowns in their order.
    unknowns: Vec<Vec3<f64>>,
    numbers: Vec<f64>,
    multipliers: Vec<Vec3<f64>>,
    nodal: Vec<Vec3<f64>>,
}

impl TieEquations {
    /// The equations of `ties` between so many nodes. All memory is asked for here.
    pub(crate) fn new(ties: Vec<Tie>, nodes: usize) -> Self {
        let mut at_nodes = vec![Vec::new(); nodes];
        for (number, tie) in ties.iter().enumerate() {
            for (&node, &weight) in tie.nodes.iter().zip(&tie.weights) {
                at_nodes[node as usize].push((number as u32, weight));
            }
        }
        let neighbours: Vec<Vec<u32>> = ties
            .iter()
            .map(|tie| {
                let shared = tie.nodes.iter().flat_map(|&node| at_nodes[node as usize].iter().map(|&(tie, _)| tie));
                let mut shared: Vec<u32> = shared.collect();
                shared.sort_unstable();
                shared.dedup();
                shared
            })
            .collect();
        let order = ring_order(&neighbours, |_| true);
        let mut places = vec![0; ties.len()];
        order.iter().enumerate().for_each(|(place, &tie)| places[tie as usize] = place as u32);
        let first = |&tie: &u32| neighbours[tie as usize].iter().map(|&other| places[other as usize] as usize).min();
        let firsts: Vec<usize> = order.iter().map(|tie| first(tie).unwrap_or(0)).collect();
        let count = ties.len();
        let room: usize = firsts.iter().enumerate().map(|(place, first)| 9 * (place - first) + 3).sum();
        Self {
            ties,
            at_nodes,
            order,
            places,
            firsts,
            mobilities: vec![None; nodes],
            width: 1,
            values: Vec::with_capacity(room),
            starts: Vec::with_capacity(3 * count + 1),
            inverse: vec![0.0; 3 * count],
            unknowns: vec![Vec3::ZERO; count],
            numbers: vec![0.0; 3 * count],
            multipliers: vec![Vec3::ZERO; count],
            nodal: vec![Vec3::ZERO; nodes],
        }
    }

    /// Takes the mobilities M⁻¹ of the nodes, none for one that is gone, and factors anew where they are others than before.
    pub(crate) fn update(&mut self, mobility: impl Fn(usize) -> Option<Mat3<f64>>) {
        let mut changed = self.starts.is_empty();
        for (node, known) in self.mobilities.iter_mut().enumerate() {
            let new = mobility(node);
            changed |= new != *known;
            *known = new;
        }
        if changed {
            self.factor();
        }
    }

    /// Whether a node is there.
    pub(super) fn knows(&self, node: usize) -> bool {
        self.mobilities[node].is_some()
    }

    /// M⁻¹ of a node; zero for one that is gone.
    pub(crate) fn mobility(&self, node: usize) -> Mat3<f64> {
        self.mobilities[node].unwrap_or(Mat3::ZERO)
    }

    /// λ for the v of the nodes.
    pub(crate) fn resolve(&mut self, value: impl Fn(usize) -> Vec3<f64>) {
        for (node, nodal) in self.nodal.iter_mut().enumerate() {
            *nodal = value(node);
        }
        self.find_multipliers();
    }

    /// λ for v = M⁻¹ r, with the forces r on the nodes.
    pub(crate) fn resolve_forces(&mut self, force: impl Fn(usize) -> Vec3<f64>) {
        for (node, (nodal, mobility)) in self.nodal.iter_mut().zip(&self.mobilities).enumerate() {
            *nodal = mobility.map_or(Vec3::ZERO, |mobility| mobility * force(node));
        }
        self.find_multipliers();
    }

    fn find_multipliers(&mut self) {
        for (place, &tie) in self.order.iter().enumerate() {
            let Tie { nodes, weights } = self.ties[tie as usize];
            let terms = nodes.iter().zip(weights);
            self.unknowns[place] = terms.fold(Vec3::ZERO, |sum, (&node, w)| sum + self.nodal[node as usize] * w);
        }
        if self.width == 1 {
            self.solve_alike();
        } else {
            self.solve_blocks();
        }
        for (tie, &place) in self.places.iter().enumerate() {
            self.multipliers[tie] = self.unknowns[place as usize];
        }
        for (nodal, ties) in self.nodal.iter_mut().zip(&self.at_nodes) {
            *nodal = ties.iter().fold(Vec3::ZERO, |sum, &(tie, w)| sum + self.multipliers[tie as usize] * w);
        }
    }

    /// λ of each tie, as it was found last.
    pub(crate) fn multipliers(&self) -> &[Vec3<f64>] {
        &self.multipliers
    }

    /// Gᵀ λ at a node, as it was found last.
    pub(crate) fn force(&self, node: usize) -> Vec3<f64> {
        self.nodal[node]
    }

    fn factor(&mut self) {
        let alike = |mobility: &Mat3<f64>| *mobility == Mat3::diagonal(mobility.columns[0].x);
        self.width = if self.mobilities.iter().flatten().all(alike) { 1 } else { 3 };
        let width = self.width;
        self.starts.clear();
        self.starts.push(0);
        let mut size = 0;
        for (place, first) in self.firsts.iter().enumerate() {
            for axis in 0..width {
                size += width * (place - first) + axis;
                self.starts.push(size);
            }
        }
        self.values.clear();
        self.values.resize(size, 0.0);
        for place in 0..self.order.len() {
            self.add_row(place);
        }
        self.eliminate();
    }

    /// G M⁻¹ Gᵀ of a tie and those before it into the values, its diagonal into `inverse`.
    fn add_row(&mut self, place: usize) {
        let (width, first) = (self.width, self.firsts[place]);
        let is_whole = |tie: &Tie| tie.nodes.iter().all(|&node| self.mobilities[node as usize].is_some());
        let tie = self.ties[self.order[place] as usize];
        self.inverse[width * place..width * (place + 1)].fill(0.0);
        if !is_whole(&tie) {
            return;
        }
        for (&node, own) in tie.nodes.iter().zip(tie.weights) {
            let Some(mobility) = self.mobilities[node as usize] else { continue };
            for &(other, weight) in &self.at_nodes[node as usize] {
                let column = self.places[other as usize] as usize;
                if column > place || !is_whole(&self.ties[other as usize]) {
                    continue;
                }
                for (across, numbers) in mobility.columns.iter().take(width).enumerate() {
                    for (along, &number) in numbers.to_array().iter().take(width).enumerate() {
                        let (row, column, value) =
                            (width * place + along, width * column + across, own * weight * number);
                        if column == row {
                            self.inverse[row] += value;
                        } else if column < row {
                            self.values[self.starts[row] + column - width * first] += value;
                        }
                    }
                }
            }
        }
    }

    /// Row after row: L_ij = (S_ij − L_i·L_j)/L_jj.
    fn eliminate(&mut self) {
        for row in 0..self.starts.len() - 1 {
            let first = self.width * self.firsts[row / self.width];
            let (above, own) = self.values.split_at_mut(self.starts[row]);
            let own = &mut own[..row - first];
            for column in first..row {
                let of_column = self.width * self.firsts[column / self.width];
                let other = &above[self.starts[column]..self.starts[column + 1]];
                let shared = first.max(of_column);
                let sum = dot(&own[shared - first..column - first], &other[shared - of_column..column - of_column]);
                own[column - first] = (own[column - first] - sum) * self.inverse[column];
            }
            let diagonal = self.inverse[row];
            let pivot = diagonal - dot(own, own);
            self.inverse[row] = if pivot > LEAST_PIVOT * diagonal { 1.0 / pivot.sqrt() } else { 0.0 };
        }
    }

    /// Solves for the three directions at once, with the one factor that they share.
    fn solve_alike(&mut self) {
        for row in 0..self.unknowns.len() {
            let (before, own) = self.unknowns.split_at_mut(row);
            let entries = &self.values[self.starts[row]..self.starts[row + 1]];
            let known = entries.iter().zip(&before[self.firsts[row]..]);
            own[0] = (own[0] - known.fold(Vec3::ZERO, |sum, (&l, &x)| sum + x * l)) * self.inverse[row];
        }
        for row in (0..self.unknowns.len()).rev() {
            let (before, own) = self.unknowns.split_at_mut(row);
            let entries = &self.values[self.starts[row]..self.starts[row + 1]];
            own[0] = own[0] * self.inverse[row];
            before[self.firsts[row]..].iter_mut().zip(entries).for_each(|(x, &l)| *x -= own[0] * l);
        }
    }

    fn solve_blocks(&mut self) {
        let x = &mut self.numbers;
        for (numbers, unknown) in x.chunks_exact_mut(3).zip(&self.unknowns) {
            numbers.copy_from_slice(&unknown.to_array());
        }
        for row in 0..x.len() {
            let (before, own) = x.split_at_mut(row);
            let entries = &self.values[self.starts[row]..self.starts[row + 1]];
            own[0] = (own[0] - dot(entries, &before[3 * self.firsts[row / 3]..])) * self.inverse[row];
        }
        for row in (0..x.len()).rev() {
            let (before, own) = x.split_at_mut(row);
            let entries = &self.values[self.starts[row]..self.starts[row + 1]];
            own[0] *= self.inverse[row];
            before[3 * self.firsts[row / 3]..].iter_mut().zip(entries).for_each(|(x, l)| *x -= own[0] * l);
        }
        for (unknown, numbers) in self.unknowns.iter_mut().zip(x.chunks_exact(3)) {
            *unknown = Vec3::new(numbers[0], numbers[1], numbers[2]);
        }
    }
}

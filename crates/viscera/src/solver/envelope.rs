use super::dense_cholesky::{LEAST_PIVOT, dot};
use super::{Filter, LinearSolver, SolverError, System};
use crate::math::Vec3;

/// K = L Lᵀ within the envelope of K: each row from its first entry to the diagonal, the nodes in an order that keeps rows short.
///
/// For bodies of a few thousand unknowns, and wherever a dependency for it is too much: 4 000 unknowns of an organ keep about a
/// million numbers. Its cost grows with n·b², b the length of a row; beyond ten thousand unknowns a sparse factorisation is far ahead.
///
/// Sources: Cuthill, McKee (1969) and George, Liu, Computer solution of large sparse positive definite systems (1981), chapter 4, for
/// the order and the starting node.
#[derive(Clone, Debug, Default)]
pub struct Envelope {
    /// Nodes that are not wholly held, in the order of the unknowns.
    order: Vec<u32>,
    /// The place of each node in that order; `NONE` for one that is held.
    places: Vec<u32>,
    /// First column of each row.
    firsts: Vec<usize>,
    /// Where each row starts in the values; it ends with its diagonal.
    starts: Vec<usize>,
    values: Vec<f64>,
    is_factored: bool,
}

const NONE: u32 = u32::MAX;

impl LinearSolver for Envelope {
    fn factorises(&self) -> bool {
        true
    }

    fn analyse(&mut self, system: &System) {
        self.order = reverse_cuthill_mckee(system);
        self.places = vec![NONE; system.nodes()];
        for (place, &node) in self.order.iter().enumerate() {
            self.places[node as usize] = place as u32;
        }
        self.firsts.clear();
        self.starts.clear();
        self.starts.push(0);
        for (place, &node) in self.order.iter().enumerate() {
            let earlier = system.matrix.row(node as usize).map(|(other, _)| self.places[other as usize]);
            let first = 3 * earlier.fold(place as u32, u32::min) as usize;
            for row in 3 * place..3 * place + 3 {
                self.firsts.push(first);
                self.starts.push(self.starts[row] + row + 1 - first);
            }
        }
        self.values.clear();
        self.is_factored = false;
    }

    fn factor(&mut self, system: &System) -> Result<(), SolverError> {
        self.is_factored = false;
        let size = self.starts.last().copied().unwrap_or(0);
        self.values.clear();
        self.values.try_reserve(size).map_err(|_| SolverError::OutOfMemory)?;
        self.values.resize(size, 0.0);
        self.fill(system);
        self.eliminate()?;
        self.is_factored = true;
        Ok(())
    }

    fn solve(&self, _system: &System, right: &mut [Vec3<f64>]) -> Result<(), SolverError> {
        if !self.is_factored {
            return Err(SolverError::NotPositiveDefinite);
        }
        let mut x: Vec<f64> = self.order.iter().flat_map(|&node| right[node as usize].to_array()).collect();
        for row in 0..x.len() {
            let (first, values) = (self.firsts[row], self.row(row));
            let (before, diagonal) = values.split_at(row - first);
            x[row] = (x[row] - dot(before, &x[first..row])) / diagonal[0];
        }
        for row in (0..x.len()).rev() {
            let (first, values) = (self.firsts[row], self.row(row));
            let (before, diagonal) = values.split_at(row - first);
            let own = x[row] / diagonal[0];
            x[row] = own;
            x[first..row].iter_mut().zip(before).for_each(|(x, value)| *x -= own * value);
        }
        right.fill(Vec3::ZERO);
        for (&node, x) in self.order.iter().zip(x.chunks_exact(3)) {
            right[node as usize] = Vec3::new(x[0], x[1], x[2]);
        }
        Ok(())
    }
}

impl Envelope {
    /// Entries of a row, from its first to the diagonal.
    fn row(&self, row: usize) -> &[f64] {
        &self.values[self.starts[row]..self.starts[row + 1]]
    }

    fn fill(&mut self, system: &System) {
        let held = system.mean_diagonal();
        for (place, &node) in self.order.iter().enumerate() {
            for (other, _) in system.matrix.row(node as usize) {
                let column = self.places[other as usize];
                if column == NONE || column as usize > place {
                    continue;
                }
                let block = system.block(node as usize, other as usize, held);
                for (axis, across) in block.columns.iter().enumerate() {
                    for (along, &value) in across.to_array().iter().enumerate() {
                        let (row, column) = (3 * place + along, 3 * column as usize + axis);
                        if column <= row {
                            self.values[self.starts[row] + column - self.firsts[row]] = value;
                        }
                    }
                }
            }
        }
    }

    /// Row after row: L_ij = (K_ij − L_i·L_j)/L_jj.
    fn eliminate(&mut self) -> Result<(), SolverError> {
        for row in 0..self.firsts.len() {
            let first = self.firsts[row];
            let (above, own) = self.values.split_at_mut(self.starts[row]);
            let own = &mut own[..=row - first];
            for column in first..row {
                let of_column = self.firsts[column];
                let other = &above[self.starts[column]..self.starts[column + 1]];
                let shared = first.max(of_column);
                let sum = dot(&own[shared - first..column - first], &other[shared - of_column..column - of_column]);
                own[column - first] = (own[column - first] - sum) / other[column - of_column];
            }
            let (before, diagonal) = own.split_at_mut(row - first);
            let pivot = diagonal[0] - dot(before, before);
            if pivot <= LEAST_PIVOT * diagonal[0] || !pivot.is_finite() {
                return Err(SolverError::NotPositiveDefinite);
            }
            diagonal[0] = pivot.sqrt();
        }
        Ok(())
    }
}

/// Nodes that are not wholly held, in an order that keeps rows short.
fn reverse_cuthill_mckee(system: &System) -> Vec<u32> {
    let is_free = |node: u32| system.filters[node as usize] != Filter::Held;
    let neighbours: Vec<Vec<u32>> = (0..system.nodes())
        .map(|node| system.matrix.row(node).map(|(other, _)| other).filter(|&other| is_free(other)).collect())
        .collect();
    ring_order(&neighbours, is_free)
}

/// Those that count, ring after ring from one at an end of each piece, and all of that backwards. Only they are anybody's neighbours.
pub(super) fn ring_order(neighbours: &[Vec<u32>], counts: impl Fn(u32) -> bool) -> Vec<u32> {
    let mut order: Vec<u32> = Vec::new();
    let mut is_known = vec![false; neighbours.len()];
    for node in (0..neighbours.len() as u32).filter(|&node| counts(node)) {
        if is_known[node as usize] {
            continue;
        }
        // From the end of the rings around one end, twice: they are long and narrow then.
        let mut start = node;
        for _ in 0..2 {
            start = rings(start, neighbours, &mut is_known.clone()).last().copied().unwrap_or(start);
        }
        order.extend(rings(start, neighbours, &mut is_known));
    }
    order.reverse();
    order
}

/// The nodes of a piece ring after ring, within one those with few neighbours first.
fn rings(start: u32, neighbours: &[Vec<u32>], is_known: &mut [bool]) -> Vec<u32> {
    let mut order = vec![start];
    is_known[start as usize] = true;
    let mut next = 0;
    while let Some(&node) = order.get(next) {
        let begin = order.len();
        for &other in &neighbours[node as usize] {
            if !std::mem::replace(&mut is_known[other as usize], true) {
                order.push(other);
            }
        }
        order[begin..].sort_by_key(|&node| neighbours[node as usize].len());
        next += 1;
    }
    order
}

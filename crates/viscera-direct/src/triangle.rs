use viscera::math::Mat3;
use viscera::solver::{Filter, System};

/// The lower triangle of a system by compressed columns, rows ascending, the diagonal first in each column.
#[derive(Default)]
pub(crate) struct Triangle {
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

/// The nodes below the diagonal that share a block with `node`. What is held altogether shares none: no fill comes of it.
fn below(system: &System, node: usize) -> impl Iterator<Item = usize> + '_ {
    let is_held = |node: usize| system.filters[node] == Filter::Held;
    let others = system.matrix.row(node).map(|(other, _)| other as usize);
    others.filter(move |&other| other > node && !is_held(node) && !is_held(other))
}

impl Triangle {
    pub(crate) fn new(system: &System) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for node in 0..system.nodes() {
            let others: Vec<usize> = below(system, node).collect();
            for axis in 0..3 {
                rows.extend((axis..3).map(|row| 3 * node + row));
                rows.extend(others.iter().flat_map(|other| 3 * other..3 * other + 3));
                starts.push(rows.len());
            }
        }
        let values = vec![0.0; rows.len()];
        Self { starts, rows, values }
    }

    /// Fills in the values of a system with the same pattern.
    pub(crate) fn fill(&mut self, system: &System) {
        let held = system.mean_diagonal();
        let mut place = 0;
        let mut push = |value: f64| {
            self.values[place] = value;
            place += 1;
        };
        for node in 0..system.nodes() {
            let own = system.block(node, node, held);
            let others: Vec<Mat3<f64>> = below(system, node).map(|other| system.block(other, node, held)).collect();
            for axis in 0..3 {
                let column = own.columns[axis].to_array();
                column[axis..].iter().for_each(|&value| push(value));
                others.iter().flat_map(|other| other.columns[axis].to_array()).for_each(&mut push);
            }
        }
    }
}

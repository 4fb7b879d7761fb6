//! Which cells still hang together: pieces are connected through shared nodes.

use crate::body::{NodeMotion, SimulatedBody};
use crate::math::Scalar;

/// Label of a node that no piece has reached.
const UNREACHED: u32 = 0;

impl<T: Scalar> SimulatedBody<T> {
    /// How many separate pieces the body is in.
    pub fn piece_count(&self) -> usize {
        let nodes = self.state.motions.len();
        let (mut labels, mut queue) = (vec![UNREACHED; nodes], vec![0; nodes]);
        self.label_pieces(&mut labels, &mut queue).0 as usize
    }

    /// Fills `loose` with the cells of pieces that nothing holds: no fixed, prescribed or held node. Where nothing holds
    /// the body at all, the piece with most nodes stays.
    pub(super) fn find_loose_cells(&mut self, loose: &mut Vec<u32>) {
        let mut memory = std::mem::take(&mut self.pieces);
        let (labels, queue) = memory.split_at_mut(self.state.motions.len());
        labels.fill(UNREACHED);
        let mut kept = 1;
        let mut held = false;
        for node in 0..labels.len() {
            if !matches!(self.state.motions[node], NodeMotion::Free | NodeMotion::Retired) {
                held = true;
                self.flood(labels, queue, node as u32, kept);
            }
        }
        if !held {
            kept = self.label_pieces(labels, queue).1;
        }
        let is_loose = |cell: usize| !self.state.removed[cell] && labels[self.mesh.cell(cell)[0] as usize] != kept;
        loose.clear();
        loose.extend((0..self.mesh.cell_count()).filter(|&cell| is_loose(cell)).map(|cell| cell as u32));
        self.pieces = memory;
    }

    /// Labels the nodes of all pieces with 1, 2, …; gives their number and the label of the one with most nodes.
    fn label_pieces(&self, labels: &mut [u32], queue: &mut [u32]) -> (u32, u32) {
        let (mut pieces, mut largest, mut largest_size) = (0, 0, 0);
        for node in 0..labels.len() {
            if labels[node] == UNREACHED && self.state.cells_at_node[node] > 0 {
                pieces += 1;
                let size = self.flood(labels, queue, node as u32, pieces);
                if size > largest_size {
                    (largest, largest_size) = (pieces, size);
                }
            }
        }
        (pieces, largest)
    }

    /// Labels every node that hangs together with `seed` and has no label yet; gives how many these are.
    fn flood(&self, labels: &mut [u32], queue: &mut [u32], seed: u32, label: u32) -> usize {
        if labels[seed as usize] != UNREACHED {
            return 0;
        }
        let (starts, cells) = &self.cells_at_nodes;
        labels[seed as usize] = label;
        queue[0] = seed;
        let (mut done, mut reached) = (0, 1);
        while done < reached {
            let node = queue[done] as usize;
            done += 1;
            for &cell in &cells[starts[node] as usize..starts[node + 1] as usize] {
                if self.state.removed[cell as usize] {
                    continue;
                }
                for &neighbour in self.mesh.cell(cell as usize) {
                    if labels[neighbour as usize] == UNREACHED {
                        labels[neighbour as usize] = label;
                        queue[reached] = neighbour;
                        reached += 1;
                    }
                }
            }
        }
        reached
    }
}

//! What changes the mesh while it runs: cells are removed, buffers keep their size.

mod pieces;
mod searing;

use crate::body::{LoosePieces, NodeMotion, SimulatedBody};
use crate::math::{Scalar, Vec3};
use crate::mesh::VolumeMesh;

impl<T: Scalar> SimulatedBody<T> {
    /// Removes cells, and with them what hangs on them: mass, stiffness, loads on their faces, nodes left without a cell,
    /// and pieces come loose where the body drops those. Cells that are gone already are passed over.
    ///
    /// `removable` is emptied; memory beyond it is not needed.
    pub(crate) fn remove_cells(&mut self, removable: &mut Vec<u32>) {
        self.take_out(removable);
        if self.loose_pieces == LoosePieces::Drop && !removable.is_empty() {
            self.find_loose_cells(removable);
            self.take_out(removable);
        }
        removable.clear();
    }

    /// Why no tool burns cells away, and what to take instead; none where one does.
    pub(crate) fn no_burning(&self) -> Option<&'static str> {
        let hexahedra =
            matches!(self.mesh, VolumeMesh::Hex(_)).then_some("hexahedra do not burn; make a body of tetrahedra");
        self.model.info().no_cutting.or(hexahedra)
    }

    /// Removes the cells in the list that are still there and can be cut away, and leaves just these in it.
    fn take_out(&mut self, cells: &mut Vec<u32>) {
        cells.retain(|&cell| self.can_lose(cell) && !std::mem::replace(&mut self.state.removed[cell as usize], true));
        let state = &mut self.state;
        if cells.is_empty() {
            return;
        }
        for &cell in cells.iter() {
            let corner_mass = self.corner_masses[cell as usize];
            for &node in self.mesh.cell(cell as usize) {
                let node = node as usize;
                state.cells_at_node[node] -= 1;
                state.masses[node] = T::from_f64(state.masses[node].to_f64() - corner_mass);
                if state.cells_at_node[node] == 0 {
                    state.motions[node] = NodeMotion::Retired;
                    state.velocities[node] = Vec3::ZERO;
                    state.masses[node] = T::ZERO;
                }
            }
        }
        state.removed_count += cells.len();
        state.removals.push(cells);
        for model in &mut state.models {
            model.remove(cells);
        }
        self.frequency.remove(cells);
        state.positions_changed();
        self.cut_volumes();
        self.update_actions();
        self.cut_skin(cells);
    }
}

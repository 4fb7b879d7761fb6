//! Heat that removes cells.

use crate::body::SimulatedBody;
use crate::math::Scalar;

impl<T: Scalar> SimulatedBody<T> {
    /// Shares `energy` [J] among `cells` by their volume, and leaves those in the list that have taken in `heat` [J/m³]. Their nodes,
    /// and as far as they are on the way there those of the others, are seared.
    pub(crate) fn heat_up(&mut self, cells: &mut Vec<u32>, energy: f64, heat: f64) {
        let volume: f64 = cells.iter().map(|&cell| self.cell_volumes[cell as usize]).sum();
        let share = energy / volume;
        let state = &mut self.state;
        cells.retain(|&cell| {
            let (cell, needed) = (cell as usize, heat * self.cell_volumes[cell as usize]);
            let taken = (state.heat[cell].to_f64() + share * self.cell_volumes[cell]).min(needed);
            state.heat[cell] = T::from_f64(taken);
            for &node in self.mesh.cell(cell) {
                let seared = &mut state.seared[node as usize];
                *seared = if *seared < T::from_f64(taken / needed) { T::from_f64(taken / needed) } else { *seared };
            }
            taken >= needed
        });
    }
}

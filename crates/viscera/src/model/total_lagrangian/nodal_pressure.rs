//! Tetrahedra that do not lock: the pressure of nearly incompressible tissue from volumes averaged at the nodes.
//!
//! A law of the form ψ(F; λ) = ψ(F; λ_s) + ½ (λ − λ_s) (J − 1)² keeps its part with λ_s in the cells. The rest acts on the
//! nodes, with a quarter of each cell's volume at each of its corners:
//!
//! W = Σ_e V_e ψ(F_e; λ_s) + Σ_a ½ (v_a − V_a)²/C_a,   v_a = Σ v_e/4,   V_a = Σ V_e/4,   C_a = Σ V_e/(4 (λ_e − λ_s))
//! p_a = (v_a − V_a)/C_a,   ∂W/∂D_e = V_e P(F_e; λ_s) Dm⁻ᵀ + ¼ Σ_a p_a cof D/6
//!
//! There are about six tetrahedra to a node, so six constraints become one. C_a averages compliances where tissues meet.
//! By Jensen's inequality no mode is stiffer than that of the plain element, whose stable step holds.
//!
//! λ_s > 0 keeps cells from changing their volume against each other, which the nodes do not see.
//!
//! Source: Bonet, Burton, Commun. Numer. Meth. Engng 14 (1998), 437; Joldes, Wittek, Miller, Commun. Numer. Meth. Engng 25
//! (2009), 137; the share left in the cells: Puso, Solberg, Int. J. Numer. Meth. Engng 67 (2006), 841.

use fearless_simd::{Simd, dispatch};

use super::super::block_table::BlockTable;
use super::super::tet_loop::{TetKernel, TetLoop, gather_edges_and_sum, load_constants, scatter_forces};
use super::super::{ForceModel, Scratch};
use super::TotalLagrangian;
use crate::math::{Lanes, Mat3, Scalar, Vec3, dispatch_level};
use crate::mesh::{TetMesh, cells_of_nodes};

/// λ_s/μ, the most of λ that stays in the cells: that of ν = ⅓.
pub(super) const KEPT: f64 = 2.0;

/// What the nodes know.
#[derive(Clone, Debug)]
pub(super) struct NodalPressure<T: Scalar, K> {
    tets: TetLoop<T, K>,
    /// 1/24 for a cell, 0 for one that is removed.
    present: BlockTable<T>,
    /// V_a [m³] and 1/C_a [Pa/m³]; zero at a node without cells.
    nodes: Vec<[T; 2]>,
    cells_at_nodes: (Vec<u32>, Vec<u32>),
    corners: Vec<[u32; 4]>,
    /// V_e/4 [m³] and V_e/(4 (λ_e − λ_s)) [m³/Pa].
    shares: Vec<[f64; 2]>,
}

impl<T: Scalar, K: TetKernel> NodalPressure<T, K> {
    /// Nodes around the cells `tets`, with λ_e − λ_s [Pa] of each cell.
    pub(super) fn new(tets: TetLoop<T, K>, mesh: &TetMesh, moduli: impl Fn(usize) -> f64) -> Self {
        let cells = mesh.cells.len();
        let share = |cell: usize| {
            let quarter = mesh.cell_volume(cell) / 4.0;
            [quarter, quarter / moduli(cell)]
        };
        let mut present = BlockTable::new(T::LANES, cells, 1, T::ZERO);
        (0..cells).for_each(|cell| *present.get_mut(cell, 0) = T::from_f64(1.0 / 24.0));
        let mut model = Self {
            tets,
            present,
            nodes: vec![[T::ZERO; 2]; mesh.nodes.len()],
            cells_at_nodes: cells_of_nodes(mesh),
            corners: mesh.cells.clone(),
            shares: (0..cells).map(share).collect(),
        };
        (0..model.nodes.len()).for_each(|node| model.weigh(node));
        model
    }

    fn cells_at(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let (starts, cells) = &self.cells_at_nodes;
        let around = &cells[starts[node] as usize..starts[node + 1] as usize];
        around.iter().map(|&cell| cell as usize).filter(|&cell| self.present.get(cell, 0) > T::ZERO)
    }

    /// Sums up V_a and C_a.
    fn weigh(&mut self, node: usize) {
        let (mut volume, mut compliance) = (0.0, 0.0);
        for cell in self.cells_at(node) {
            volume += self.shares[cell][0];
            compliance += self.shares[cell][1];
        }
        let stiffness = if compliance > 0.0 { 1.0 / compliance } else { 0.0 };
        self.nodes[node] = [T::from_f64(volume), T::from_f64(stiffness)];
    }

    /// Adds v_e/4, and its derivative along `dx`, to the corners.
    #[inline(always)]
    fn add_volumes<S: Simd, const TANGENT: bool>(&self, simd: S, x: &[[T; 4]], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        let zero = T::Lanes::<S>::splat(simd, T::ZERO);
        for (nodes, present) in self.tets.corners.blocks().zip(self.present.blocks()) {
            let present = T::Lanes::<S>::load(simd, present);
            let (d, _) = gather_edges_and_sum(simd, x, nodes);
            let cofactor = d.cofactor();
            let volume = d.columns[0].dot(cofactor.columns[0]) * present;
            let change =
                if TANGENT { cofactor.contract(gather_edges_and_sum(simd, dx, nodes).0) * present } else { zero };
            for corner in 0..4 {
                let corners = &nodes[corner * T::LANES..(corner + 1) * T::LANES];
                T::Lanes::<S>::scatter_add([volume, change, zero], corners, out);
            }
        }
    }

    /// Turns volumes into pressures, which travel as the fourth number of places and directions.
    fn press(&self, scratch: &mut Scratch<T>) {
        let Scratch { nodal, direction, forces } = scratch;
        for (node, &[volume, stiffness]) in self.nodes.iter().enumerate() {
            nodal[node][3] = (forces[node][0] - volume) * stiffness;
            direction[node][3] = forces[node][1] * stiffness;
            forces[node] = [T::ZERO; 4];
        }
    }

    #[inline(always)]
    fn add_with<S: Simd, const TANGENT: bool>(&self, simd: S, x: &[[T; 4]], dx: &[[T; 4]], out: &mut [[T; 4]]) {
        let tables = self.tets.corners.blocks().zip(self.tets.constants.blocks()).zip(self.present.blocks());
        for ((nodes, constants), present) in tables {
            let constants = load_constants::<T, S, K>(simd, constants);
            let constants = &constants[..K::CONSTANTS];
            let present = T::Lanes::<S>::load(simd, present);
            let (d, pressure) = gather_edges_and_sum(simd, x, nodes);
            let pressure = pressure * present;
            let forces = if TANGENT {
                let (dd, change) = gather_edges_and_sum(simd, dx, nodes);
                K::product(constants, &d, &dd) + d.cofactor_along(dd) * pressure + d.cofactor() * (change * present)
            } else {
                K::forces(constants, &d) + d.cofactor() * pressure
            };
            scatter_forces(simd, forces, nodes, out);
        }
    }
}

impl<T: Scalar, K: TetKernel> ForceModel<T> for NodalPressure<T, K> {
    fn name(&self) -> &'static str {
        TotalLagrangian::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        let Scratch { nodal, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_volumes::<_, false>(simd, nodal, nodal, forces));
        self.press(scratch);
        let Scratch { nodal, forces, .. } = scratch;
        dispatch!(dispatch_level(), simd => self.add_with::<_, false>(simd, nodal, nodal, forces));
        scratch.finish(out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        scratch.start(x);
        scratch.start_direction(dx);
        let Scratch { nodal, direction, forces } = scratch;
        dispatch!(dispatch_level(), simd => self.add_volumes::<_, true>(simd, nodal, direction, forces));
        self.press(scratch);
        let Scratch { nodal, direction, forces } = scratch;
        dispatch!(dispatch_level(), simd => self.add_with::<_, true>(simd, nodal, direction, forces));
        scratch.finish(out);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        let volume = |cell: usize| {
            let [a, b, c, d] = self.corners[cell].map(|node| x[node as usize].cast::<f64>());
            Mat3::from_columns(b - a, c - a, d - a).determinant() / 24.0
        };
        let at_node = |node: usize| {
            let [rest, stiffness] = self.nodes[node].map(T::to_f64);
            let change = self.cells_at(node).map(volume).sum::<f64>() - rest;
            0.5 * stiffness * change * change
        };
        self.tets.energy(x) + (0..self.nodes.len()).map(at_node).sum::<f64>()
    }

    fn remove(&mut self, cells: &[u32]) {
        self.tets.remove(cells);
        for &cell in cells {
            *self.present.get_mut(cell as usize, 0) = T::ZERO;
        }
        for &cell in cells {
            self.corners[cell as usize].into_iter().for_each(|node| self.weigh(node as usize));
        }
    }

    fn rings(&self) -> usize {
        2
    }

    fn bytes(&self) -> usize {
        self.tets.bytes() + self.present.bytes() + size_of_val(self.nodes.as_slice())
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

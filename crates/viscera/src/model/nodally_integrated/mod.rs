//! Tetrahedra that neither lock nor stiffen: the law is asked at the nodes, at the mean deformation of the cells around.
//!
//! F̄_a = Σ_e V_e/4 F_e / V_a,   V_a = Σ_e V_e/4            (the cells e of node a)
//! W = Σ_a V_a [ψ(F̄_a) − s ψ_c(F̄_a)] + Σ_e V_e s ψ_c(F_e)
//!
//! The law's whole ψ is averaged, its shape part too. There are six to ten tetrahedra to a node, so that many constraints
//! of incompressibility become one; and the mean of the strains takes away most of what linear tetrahedra are too stiff by
//! in bending and shear, which averaging volumes alone leaves ([Bonet and Burton]; 6.4 % too much force on a cube of 10³
//! cells where this has 0.9 %). The share s = 0.05 of the shear stiffness that stays in the cells resists the motions whose
//! mean strain vanishes at every node. Where cells deform alike, F_e = F̄_a, and W is that of the plain element exactly.
//!
//! As F̄_a = Σ_b x_b g_abᵀ with fixed g_ab, forces have neither a sum nor a torque, and are the gradient of W. By Jensen's
//! inequality no mode of small strain is stiffer than that of the plain element, whose stable step holds.
//!
//! A node between tissues has a mean for each: strains jump where the law does. So a tissue that differs from cell to cell
//! has nothing to average over, and locks as plain cells do.
//!
//! Source: Dohrmann, Heinstein, Jung, Key, Witkowski, Int. J. Numer. Meth. Engng 47 (2000), 1549; the share left in the
//! cells: Puso, Solberg, Int. J. Numer. Meth. Engng 67 (2006), 841.
//! [Bonet and Burton]: Commun. Numer. Meth. Engng 14 (1998), 437.

mod points;
mod stabiliser;

use self::points::NodalPoints;
use self::stabiliser::Stabiliser;
use super::registry::Claims;
use super::tet_loop::TetLoop;
use super::{ForceModel, ModelError, ModelInfo, ModelKind, ModelRecipe, Scratch};
use crate::material::{
    LawFamily, LawKind, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseStVenantKirchhoff,
};
use crate::math::{Scalar, Vec3};
use crate::mesh::{TetMesh, VolumeMesh};

/// s, the share of the shear modulus that stays in the cells.
const SHARE: f64 = 0.05;

/// Nodally integrated tetrahedra of any objective law.
#[derive(Clone, Debug, PartialEq)]
pub struct NodallyIntegrated {
    tissue: Tissue,
}

impl NodallyIntegrated {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "nodally-integrated",
        purpose: "tetrahedra that do not lock: nearly incompressible tissue, and thin parts that bend",
        hexahedra: false,
        laws: &[
            LawKind::StVenantKirchhoff,
            LawKind::TransverseStVenantKirchhoff,
            LawKind::NeoHookean,
            LawKind::StableNeoHookean,
        ],
    };

    pub(crate) fn claims(law: LawKind, _hexahedra: bool) -> Claims {
        Claims { of_the_law: false, ..Claims::of_law(law) }
    }

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }

    fn build<T: Scalar>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        let (model, law) = (ModelKind::NodallyIntegrated, self.tissue.kind());
        let VolumeMesh::Tet(mesh) = mesh else { return Err(ModelError::UnsupportedCells { model }) };
        match law {
            LawKind::StVenantKirchhoff => self.of_law::<T, StVenantKirchhoff>(mesh),
            LawKind::TransverseStVenantKirchhoff => self.of_law::<T, TransverseStVenantKirchhoff>(mesh),
            LawKind::NeoHookean => self.of_law::<T, NeoHookean>(mesh),
            LawKind::StableNeoHookean => self.of_law::<T, StableNeoHookean>(mesh),
            LawKind::LinearElastic | LawKind::TransverseLinear => {
                let advice = "its means of rotated cells would be strained; take a law of large rotations, such as `neo-hookean`";
                Err(ModelError::UnsupportedLaw { model, law, advice })
            }
        }
    }

    fn of_law<T: Scalar, L: LawFamily>(&self, mesh: &TetMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let share = |cell: usize| SHARE * self.tissue.at_rest(cell).lame.mu;
        let cells = TetLoop::new(mesh, |rest| Stabiliser::constants(rest, share(rest.cell)))?;
        let points = NodalPoints::<T, L>::new(mesh, &self.tissue, share);
        Ok(Box::new(NodalTets { cells, points }))
    }
}

impl ModelRecipe for NodallyIntegrated {
    fn kind(&self) -> ModelKind {
        ModelKind::NodallyIntegrated
    }

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build_single(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f32>>, ModelError> {
        self.build(mesh)
    }

    fn build_double(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<f64>>, ModelError> {
        self.build(mesh)
    }
}

/// The law at the nodes, a share of the shear stiffness in the cells.
#[derive(Clone, Debug)]
struct NodalTets<T: Scalar, L> {
    cells: TetLoop<T, Stabiliser>,
    points: NodalPoints<T, L>,
}

impl<T: Scalar, L: LawFamily> ForceModel<T> for NodalTets<T, L> {
    fn name(&self) -> &'static str {
        NodallyIntegrated::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.cells.add_forces(x, scratch, out);
        self.points.add_forces(x, scratch, out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.cells.add_product(x, dx, scratch, out);
        self.points.add_product(x, dx, scratch, out);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        self.cells.energy(x) + self.points.energy(x)
    }

    fn remove(&mut self, cells: &[u32]) {
        self.cells.remove(cells);
        self.points.remove(cells);
    }

    fn rings(&self) -> usize {
        2
    }

    fn bytes(&self) -> usize {
        self.cells.bytes() + self.points.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

//! Tetrahedra that neither lock nor stiffen: the law is asked at the nodes, at the mean deformation of the cells around.
//!
//! F̄_a = Σ_e V_e/4 F_e / V_a,   V_a = Σ_e V_e/4            (the cells e of node a)
//! W = Σ_a V_a ψ(F̄_a) + s μ/2 (Σ_e V_e |F_e|² − Σ_a V_a |F̄_a|²)
//!
//! The law's whole ψ is averaged, its shape part too. There are six to ten tetrahedra to a node, so that many constraints
//! of incompressibility become one; and the mean of the strains takes away most of what linear tetrahedra are too stiff by
//! in bending and shear, which averaging volumes alone leaves (Bonet, Burton 1998: 6.4 % too much force on a cube of 10³
//! cells where this has 0.3 %). The second term is what cells differ by around a node, so that they cannot move against each
//! other unseen: never negative (Jensen), nothing where cells deform alike, and then W is that of the plain element exactly.
//!
//! As F̄_a = Σ_b (x_b − x_a) g_abᵀ with fixed g_ab, and Σ_e V_e |F_e|² is a sum of springs between neighbours, all is one
//! loop over nodes and neighbours; forces have neither a sum nor a torque, and are the gradient of W. No mode of small strain
//! is stiffer than that of the plain element (Jensen again), whose stable step holds.
//!
//! A node between tissues has a mean for each: strains jump where the law does. So a tissue that differs from cell to cell
//! has nothing to average over, and locks as plain cells do.
//!
//! Source: Dohrmann, Heinstein, Jung, Key, Witkowski, Int. J. Numer. Meth. Engng 47 (2000), 1549; the share left in the
//! cells: Puso, Solberg, Int. J. Numer. Meth. Engng 67 (2006), 841, here without the law.

mod batch;
mod diagonal;
mod points;
mod rest;
mod tangent;

use self::points::NodalPoints;
use super::registry::Claims;
use super::{BlockSink, ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, Scratch, recipe};
use crate::material::{
    LawFamily, LawKind, NeoHookean, StVenantKirchhoff, StableNeoHookean, Tissue, TransverseStVenantKirchhoff,
};
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{TetMesh, VolumeMesh};

/// s, the share of the shear modulus that stays in the cells, unless another is asked for.
const SHARE: f64 = 0.01;

/// Nodally integrated tetrahedra of any objective law.
#[derive(Clone, Debug, PartialEq)]
pub struct NodallyIntegrated {
    tissue: Tissue,
    share: f64,
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
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    pub(crate) fn claims(law: LawKind, _hexahedra: bool) -> Claims {
        Claims { of_the_law: false, ..Claims::of_law(law) }
    }

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, share: SHARE }
    }

    /// The share s of the shear modulus that stays in the cells [≥ 0, < 1]; 0.01 by default. More resists wrinkles that are as
    /// short as the cells, as a point load makes them, and stiffens the whole: 0.05 doubles their frequency, and adds 0.9 % to
    /// the force on a glued cube of 10³ cells that is compressed by 18 %.
    pub fn stabilise(mut self, share: f64) -> Self {
        self.share = share;
        self
    }

    fn of_law<T: Scalar, L: LawFamily>(&self, mesh: &TetMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let share = |cell: usize| self.share * self.tissue.at_rest(cell).lame.mu;
        Ok(Box::new(NodalPoints::<T, L>::new(mesh, &self.tissue, share)?))
    }
}

impl GenericRecipe for NodallyIntegrated {
    const KIND: ModelKind = ModelKind::NodallyIntegrated;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        if !(0.0..1.0).contains(&self.share) {
            let (name, range) = ("stabilise", "zero or positive, and less than 1");
            return Err(ModelError::OutOfRange { name, value: self.share, range });
        }
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
}

recipe!(NodallyIntegrated);

impl<T: Scalar, L: LawFamily> ForceModel<T> for NodalPoints<T, L> {
    fn name(&self) -> &'static str {
        NodallyIntegrated::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.add_nodal_forces(x, scratch, out);
    }

    fn linearization_len(&self) -> usize {
        self.kept_len()
    }

    fn linearize(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>) {
        self.keep_deformations(x, scratch);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.add_nodal_product(x, dx, scratch, out);
    }

    fn add_blocks(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, sink: &mut dyn BlockSink<T>) {
        self.add_nodal_blocks(x, scratch, sink);
    }

    fn add_diagonal(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Mat3<T>]) {
        self.add_nodal_diagonal(x, scratch, out);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        self.nodal_energy(x)
    }

    fn remove(&mut self, cells: &[u32]) {
        self.remove_cells(cells);
    }

    fn rings(&self) -> usize {
        2
    }

    fn sum_rows(&self) -> usize {
        self.section_rows()
    }

    fn bytes(&self) -> usize {
        self.table_bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

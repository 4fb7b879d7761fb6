//! Total-Lagrangian elements: forces straight from the law at the deformation gradient, over the rest shape.
//!
//! f_p = Σ_e V P(F) α_p, one point for a tetrahedron, 2×2×2 Gauss points for a hexahedron. St Venant–Kirchhoff and
//! stable neo-Hookean tetrahedra use the metric form, in which F never appears: about 200 and 125 flops an element.

mod direct;
mod hex;
mod metric;
mod nodal_pressure;
mod stable_neo_hookean;

use self::direct::Direct;
use self::hex::HexLoop;
use self::metric::{StVenantKirchhoffMetric, TransverseMetric};
use self::nodal_pressure::NodalPressure;
use self::stable_neo_hookean::StableNeoHookeanMetric;
use super::tet_loop::{TetKernel, TetLoop};
use super::{ForceModel, ModelError, ModelInfo, ModelKind, ModelRecipe, Scratch};
use crate::material::{LawFamily, LawKind, LawVisitor, NeoHookean, StableNeoHookean, Tissue};
use crate::math::{Scalar, Vec3};
use crate::mesh::{GaussRule, TetMesh, VolumeMesh};

/// The direct model of any law, on tetrahedra or hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct TotalLagrangian {
    tissue: Tissue,
    rule: GaussRule,
    plain: bool,
    nodal_pressure: bool,
}

impl TotalLagrangian {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "total-lagrangian",
        purpose: "the fastest full model, for every law, on tetrahedra and hexahedra",
        hexahedra: true,
        laws: LawKind::ALL,
    };

    /// A model of `tissue`.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue, rule: GaussRule::Two, plain: false, nodal_pressure: false }
    }

    /// Integrates hexahedra with another rule than 2×2×2 points. Tetrahedra need one point in any case.
    pub fn gauss(self, rule: GaussRule) -> Self {
        Self { rule, ..self }
    }

    /// Computes F and P(F) in so many words where a faster form of the same law exists: the reference for that form.
    pub fn plain(self) -> Self {
        Self { plain: true, ..self }
    }

    /// Averages volumes at the nodes, so that tetrahedra of nearly incompressible tissue do not lock. For `neo-hookean` and
    /// `stable-neo-hookean` tissue on tetrahedra, with ν above ⅓: below, there is nothing to average.
    pub fn nodal_pressure(self) -> Self {
        Self { nodal_pressure: true, ..self }
    }

    /// The tissue of the cells, with the λ that is left to them: all of it, or 2μ at most beside nodal pressures.
    fn cell_values(&self, cell: usize) -> Vec<f64> {
        let mut values = self.tissue.values(cell).to_vec();
        values[0] -= self.nodal_modulus(cell);
        values
    }

    /// λ − λ_s [Pa]; zero without nodal pressures.
    fn nodal_modulus(&self, cell: usize) -> f64 {
        let rest = self.tissue.at_rest(cell).lame;
        if self.nodal_pressure { (rest.lambda - nodal_pressure::KEPT * rest.mu).max(0.0) } else { 0.0 }
    }

    /// The model of these cells, and of nodal pressures if they are asked for.
    fn of_tets<T: Scalar, K: TetKernel>(
        &self,
        mesh: &TetMesh,
        constants: impl Fn(&super::tet_loop::RestTet) -> Vec<f64>,
    ) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        let model = tets::<T, K>(mesh, constants)?;
        Ok(if self.nodal_pressure {
            Box::new(NodalPressure::new(model.tets, mesh, |cell| self.nodal_modulus(cell)))
        } else {
            model.boxed()
        })
    }

    /// Nodal pressures want a law whose energy has λ/2 (J − 1)², and tetrahedra.
    fn check_nodal_pressure(&self, mesh: &VolumeMesh) -> Result<(), ModelError> {
        let law = self.tissue.kind();
        if self.nodal_pressure && !matches!(law, LawKind::NeoHookean | LawKind::StableNeoHookean) {
            let advice = "nodal pressures need a law of det F; take `neo-hookean` or `stable-neo-hookean`";
            return Err(ModelError::UnsupportedLaw { model: ModelKind::TotalLagrangian, law, advice });
        }
        match mesh {
            VolumeMesh::Hex(_) if self.nodal_pressure => Err(ModelError::NodalPressureOnHexahedra),
            _ => Ok(()),
        }
    }
}

impl<T: Scalar> ModelRecipe<T> for TotalLagrangian {
    fn kind(&self) -> ModelKind {
        ModelKind::TotalLagrangian
    }

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        self.check_nodal_pressure(mesh)?;
        let law = self.tissue.kind();
        match mesh {
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::StVenantKirchhoff => {
                tets(mesh, |rest| StVenantKirchhoffMetric::constants(rest, &self.tissue.at_rest(rest.cell)))
                    .map(|model: TetModel<T, StVenantKirchhoffMetric>| model.boxed())
            }
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::TransverseStVenantKirchhoff => {
                tets(mesh, |rest| TransverseMetric::constants(rest, &self.tissue.at_rest(rest.cell)))
                    .map(|model: TetModel<T, TransverseMetric>| model.boxed())
            }
            VolumeMesh::Tet(mesh) if !self.plain && law == LawKind::StableNeoHookean => self
                .of_tets::<T, StableNeoHookeanMetric>(mesh, |rest| {
                    StableNeoHookeanMetric::constants(rest, &self.cell_values(rest.cell))
                }),
            // one by one, not for any law: every kernel of every law is compiled for every instruction set
            VolumeMesh::Tet(mesh) if self.nodal_pressure && law == LawKind::NeoHookean => self
                .of_tets::<T, Direct<NeoHookean>>(mesh, |rest| {
                    Direct::<NeoHookean>::constants(rest, &self.cell_values(rest.cell))
                }),
            VolumeMesh::Tet(mesh) if self.nodal_pressure => self.of_tets::<T, Direct<StableNeoHookean>>(mesh, |rest| {
                Direct::<StableNeoHookean>::constants(rest, &self.cell_values(rest.cell))
            }),
            _ => law.visit(Build { recipe: self, mesh, scalar: std::marker::PhantomData }),
        }
    }
}

/// Builds the plain element of whichever law it is.
struct Build<'a, T> {
    recipe: &'a TotalLagrangian,
    mesh: &'a VolumeMesh,
    scalar: std::marker::PhantomData<T>,
}

impl<T: Scalar> LawVisitor for Build<'_, T> {
    type Output = Result<Box<dyn ForceModel<T>>, ModelError>;

    fn visit<L: LawFamily>(self) -> Self::Output {
        let tissue = &self.recipe.tissue;
        match self.mesh {
            VolumeMesh::Tet(mesh) => tets(mesh, |rest| Direct::<L>::constants(rest, tissue.values(rest.cell)))
                .map(|model: TetModel<T, Direct<L>>| model.boxed()),
            VolumeMesh::Hex(mesh) => Ok(Box::new(HexLoop::<T, L>::new(mesh, tissue, self.recipe.rule)?)),
        }
    }
}

fn tets<T: Scalar, K: TetKernel>(
    mesh: &TetMesh,
    constants: impl Fn(&super::tet_loop::RestTet) -> Vec<f64>,
) -> Result<TetModel<T, K>, ModelError> {
    Ok(TetModel { tets: TetLoop::new(mesh, constants)? })
}

/// Total-Lagrangian tetrahedra with the kernel `K`.
#[derive(Clone, Debug)]
struct TetModel<T: Scalar, K> {
    tets: TetLoop<T, K>,
}

impl<T: Scalar, K: TetKernel> TetModel<T, K> {
    fn boxed(self) -> Box<dyn ForceModel<T>> {
        Box::new(self)
    }
}

impl<T: Scalar, K: TetKernel> ForceModel<T> for TetModel<T, K> {
    fn name(&self) -> &'static str {
        TotalLagrangian::INFO.name
    }

    fn add_forces(&self, x: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_forces(x, scratch, out);
    }

    fn add_product(&self, x: &[Vec3<T>], dx: &[Vec3<T>], scratch: &mut Scratch<T>, out: &mut [Vec3<T>]) {
        self.tets.add_product(x, dx, scratch, out);
    }

    fn energy(&self, x: &[Vec3<T>]) -> f64 {
        self.tets.energy(x)
    }

    fn remove(&mut self, cells: &[u32]) {
        self.tets.remove(cells);
    }

    fn bytes(&self) -> usize {
        self.tets.bytes()
    }

    fn clone_box(&self) -> Box<dyn ForceModel<T>> {
        Box::new(self.clone())
    }
}

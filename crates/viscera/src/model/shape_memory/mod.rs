//! Shape memory: every node knows its place among its neighbours, and is drawn there.
//!
//! T_i = c_i + R_i d_i,   W = Σ_i ½ k_i |x_i − T_i|² + Σ_i ½ g_i Σ_j |y_j − R_i Y_j|²,   g_i = k_i/n
//!
//! The neighbours of node i are those that share an edge of a cell with it, c_i their centroid, and R_i the rotation that
//! fits their rest places to where they are best: the polar rotation of Σ_j y_j Y_jᵀ, with y_j and Y_j counted from the
//! centroids now and at rest. d_i is where the node stood from the centroid at rest. For neighbours in a plane, such as the three of
//! a corner, R_i is as well defined: det R_i = +1 tells the two sides of the plane apart.
//!
//! The force k_i (T_i − x_i) on a node has its opposite on the neighbours. Shared equally, it would leave a torque; as the
//! gradient of W it leaves none:
//!
//! f_i = k_i (x_i − T_i),   f_j = −f_i/n + R_i (s_i × Y_j) + g_i (y_j − R_i Y_j),   (tr S I − S) s_i = (R_iᵀ f_i) × d_i,   S = R_iᵀ Σ_j y_j Y_jᵀ
//!
//! Where neighbours are squeezed into a line, or turned inside out alike along two axes, R_i jumps, and W with it. There
//! Y_j gives way to R_iᵀ y_j on both sides of the last equation: such forces still balance, and stay bounded, but have no energy.
//!
//! The second sum of W holds the neighbours in their shape. As R_i is where it is least, a change of R_i adds nothing to its gradient,
//! and where R_i jumps it has a kink and no step. It is what turns inner nodes back that are inside out among neighbours that are so too, at
//! whose centroid they stand on either side.
//!
//! k_i = (Σ_c E_c V_c)/V^⅔ with the corners' shares V_c of the cells around the node, V their sum: E V^⅓ in uniform tissue. This
//! is no law of matter: how much is resisted hangs on the mesh, and a change of volume is no dearer than one of shape.
//!
//! Bars that were pushed through their own foot, or of which every node was put to a random place, come back whole, where a net of springs
//! stays folded.
//!
//! Source: Promayon, Baconnier, Puech (1996), and Nesme, Marchal, Promayon, Chabanas, Payan, Faure (2005), section 4, for
//! points that remember their place among their neighbours; frame and balance are ours, as the papers give neither. Müller, Heidelberger,
//! Teschner, Gross (2005) for the shape of neighbours under the rotation that fits them best.

mod bound;
mod memory;
mod model;
mod neighbourhoods;

use self::bound::MemoryBound;
use self::neighbourhoods::Neighbourhoods;
use super::frequency::FrequencyBound;
use super::penalty_frequency::with_penalty;
use super::{ForceModel, GenericRecipe, ModelError, ModelInfo, ModelKind, Precision, recipe};
use crate::material::{LawKind, Tissue};
use crate::math::Scalar;
use crate::mesh::VolumeMesh;

/// Nodes that remember their place among their neighbours, on tetrahedra or hexahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeMemory {
    tissue: Tissue,
}

impl ShapeMemory {
    pub(crate) const INFO: ModelInfo = ModelInfo {
        name: "shape-memory",
        purpose: "discrete: nodes return to their place among their neighbours, where springs stay folded; no law of matter",
        hexahedra: true,
        laws: &[LawKind::LinearElastic],
        moves: true,
        no_implicit: None,
        no_cutting: None,
        tool_limits: None,
    };

    /// A model of `tissue`, of which Young's modulus counts.
    pub fn new(tissue: Tissue) -> Self {
        Self { tissue }
    }

    fn neighbourhoods<T: Scalar>(&self, mesh: &VolumeMesh) -> Result<Neighbourhoods<T>, ModelError> {
        self.tissue.check_count(mesh.cell_count())?;
        let advice = "its actuators know Young's modulus alone; take the law `linear`, or the model `total-lagrangian`";
        Self::KIND.check_law(self.tissue.kind(), advice)?;
        Neighbourhoods::new(mesh, &self.tissue)
    }
}

impl GenericRecipe for ShapeMemory {
    const KIND: ModelKind = ModelKind::ShapeMemory;

    fn tissue(&self) -> &Tissue {
        &self.tissue
    }

    fn build<T: Precision>(&self, mesh: &VolumeMesh) -> Result<Box<dyn ForceModel<T>>, ModelError> {
        Ok(Box::new(self.neighbourhoods::<T>(mesh)?))
    }

    fn bound<T: Precision>(
        &self,
        mesh: &VolumeMesh,
        density: &[f64],
        keep_volume: f64,
    ) -> Result<Box<dyn FrequencyBound<T>>, ModelError> {
        let own = MemoryBound::new(self.neighbourhoods(mesh)?, density);
        with_penalty(Box::new(own), mesh, density, keep_volume)
    }
}

recipe!(ShapeMemory);

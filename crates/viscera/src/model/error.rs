use super::ModelKind;
use super::precomputed::ResponsesError;
use crate::material::{LawKind, MaterialError};
use crate::mesh::{MeshError, RegionError};

/// Why a model cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The model computes something else than the law asks for.
    #[error("the model `{model}` cannot compute the law `{law}`: {advice}")]
    UnsupportedLaw {
        /// The model.
        model: ModelKind,
        /// The law.
        law: LawKind,
        /// What to do.
        advice: &'static str,
    },
    /// The model is not made for this kind of cell.
    #[error(
        "the model `{model}` works on tetrahedra, and the mesh is made of hexahedra; take `total-lagrangian`, or tetrahedra"
    )]
    UnsupportedCells {
        /// The model.
        model: ModelKind,
    },
    /// A setting of the model is out of range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        range: &'static str,
    },
    /// The region that is to move selects nothing, or cannot.
    #[error("the part that moves: {0}")]
    Region(Box<RegionError>),
    /// There are no responses for the body.
    #[error(transparent)]
    Responses(#[from] ResponsesError),
    /// The tissue does not fit the mesh.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// The mesh is not fit for simulation.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

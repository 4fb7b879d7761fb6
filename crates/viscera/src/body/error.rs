use crate::mesh::{MeshError, RegionError};
use crate::model::{ModelError, ModelKind};

/// Why a body cannot be added to a world.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodyError {
    /// No force model was chosen.
    #[error(
        "body `{body}` has no force model; give it one with `.model(…)`, for example `TotalLagrangian::new(tissue)`"
    )]
    NoModel {
        /// Name of the body.
        body: String,
    },
    /// A setting is out of range.
    #[error("body `{body}`: {name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// Name of the body.
        body: String,
        /// Name of the setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        range: &'static str,
    },
    /// Densities are given for another number of cells.
    #[error("body `{body}`: {given} densities are given for {cells} cells; give one for each cell, or one for all")]
    WrongDensityCount {
        /// Name of the body.
        body: String,
        /// How many densities were given.
        given: usize,
        /// How many cells there are.
        cells: usize,
    },
    /// A node belongs to no cell, so it would have no mass.
    #[error("body `{body}`: node {node} belongs to no cell; remove it (`TetMesh::checked` does)")]
    IsolatedNode {
        /// Name of the body.
        body: String,
        /// The node.
        node: usize,
    },
    /// The volume-keeping force is made for tetrahedra.
    #[error("body `{body}`: `keep-volume` works on tetrahedra, and the mesh is made of hexahedra")]
    KeepVolumeOnHexahedra {
        /// Name of the body.
        body: String,
    },
    /// The model refuses the tissue or the mesh.
    #[error("body `{body}`: {source}")]
    Model {
        /// Name of the body.
        body: String,
        /// What it says.
        source: ModelError,
    },
    /// What is pre-computed answers in proportion to what acts on it.
    #[error(
        "body `{body}`: the model `{model}` knows neither volumes kept exactly nor rigid parts nor muscles nor actuators; take a model that moves all of the body, such as `corotational`"
    )]
    LinearModel {
        /// Name of the body.
        body: String,
        /// The model.
        model: ModelKind,
    },
    /// A node of a rigid part is fixed, prescribed or guided.
    #[error(
        "body `{body}`: node {node} of a rigid part is fixed or moved as well; leave it out of one of the two regions, or fix the whole part instead of making it rigid"
    )]
    HeldRigidPart {
        /// Name of the body.
        body: String,
        /// The node.
        node: usize,
    },
    /// A node is in two rigid parts.
    #[error("body `{body}`: node {node} is in two rigid parts; make one of the two, or leave it out of one")]
    OverlappingRigidParts {
        /// Name of the body.
        body: String,
        /// The node.
        node: usize,
    },
    /// The nodes of a rigid part do not tell how it is turned.
    #[error("body `{body}`: the {nodes} nodes of a rigid part lie in a line; take a region with three that do not")]
    RigidPartInLine {
        /// Name of the body.
        body: String,
        /// How many there are.
        nodes: usize,
    },
    /// A region selects nothing, or cannot.
    #[error("body `{body}`, {purpose}: {source}")]
    Region {
        /// Name of the body.
        body: String,
        /// What the region is for.
        purpose: &'static str,
        /// What is wrong with it.
        source: Box<RegionError>,
    },
    /// The mesh is not fit for simulation.
    #[error("body `{body}`: {source}")]
    Mesh {
        /// Name of the body.
        body: String,
        /// What is wrong with it.
        source: MeshError,
    },
}

/// What is wrong with a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The mesh has no cells, so there is nothing to simulate.
    #[error("the mesh has no cells; export the volume, not only points or curves")]
    Empty,
    /// A cell names a node that the mesh does not have.
    #[error("cell {cell} names node {node}, but the mesh has only {nodes} nodes; the file is damaged or was cut off")]
    MissingNode {
        /// Cell, from 0.
        cell: usize,
        /// The node that it names, from 0.
        node: usize,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("node {node} lies at ({}, {}, {}), which is not a finite place; repair the file that it came from", position[0], position[1], position[2])]
    NotFinite {
        /// Node, from 0.
        node: usize,
        /// Its coordinates [m].
        position: [f64; 3],
    },
    /// The cell has no volume: its corners lie in a plane. Usually two nodes were merged by the exporter.
    #[error(
        "cell {cell} has no volume (its corners {corners:?} lie in a plane); remove it or re-export the mesh without merging nodes"
    )]
    Degenerate {
        /// Cell, from 0.
        cell: usize,
        /// Its corners.
        corners: Vec<u32>,
    },
}

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
    /// A cell names one node at two of its corners.
    #[error(
        "cell {cell} names node {node} twice, so it has no volume; remove the cell or re-export the mesh without merging nodes"
    )]
    RepeatedNode {
        /// Cell, from 0.
        cell: usize,
        /// The node, from 0.
        node: usize,
    },
    /// Two cells have the same corners, so their tissue would count twice.
    #[error("cell {cell} has the same corners as cell {first}; remove one of them")]
    DuplicateCell {
        /// Cell, from 0.
        cell: usize,
        /// The earlier cell, from 0.
        first: usize,
    },
    /// The hexahedron is turned inside out in one part and not in another. Usually its corners are listed in another order.
    #[error(
        "cell {cell} is twisted (its corners {corners:?} give volume of both signs); list the bottom face counter-clockwise seen from inside, then the top face in the same order"
    )]
    Twisted {
        /// Cell, from 0.
        cell: usize,
        /// Its corners.
        corners: Vec<u32>,
    },
    /// A region names a node that the mesh does not have.
    #[error("region `{region}` names node {node}, which the mesh does not have; number its nodes anew")]
    RegionMissingNode {
        /// Name of the region.
        region: String,
        /// The node, from 0.
        node: usize,
    },
    /// A region names a cell that the mesh does not have.
    #[error("region `{region}` names cell {cell}, which the mesh does not have; number its cells anew")]
    RegionMissingCell {
        /// Name of the region.
        region: String,
        /// The cell, from 0.
        cell: usize,
    },
    /// More than one thing is wrong.
    #[error("{} things are wrong with the mesh:{}", .0.len(), listed(.0))]
    Several(
        /// Each of them.
        Vec<MeshError>,
    ),
}

impl MeshError {
    /// One error for all; nothing if there are none.
    pub(super) fn gathered(mut errors: Vec<Self>) -> Option<Self> {
        match errors.len() {
            0 | 1 => errors.pop(),
            _ => Some(Self::Several(errors)),
        }
    }
}

/// The first ten, one to a line, and how many there are besides.
fn listed(errors: &[MeshError]) -> String {
    const SHOWN: usize = 10;
    let mut text: String = errors.iter().take(SHOWN).map(|error| format!("\n  {error}")).collect();
    if errors.len() > SHOWN {
        text.push_str(&format!("\n  … and {} more", errors.len() - SHOWN));
    }
    text
}

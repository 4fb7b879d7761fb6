use super::Responses;
use crate::math::Vec3;
use crate::solver::DenseCholesky;

/// The small system of the nodes that are imposed: Σ_l C_kl f_l = u*_k. It is factored when the nodes change; the same nodes at other
/// places cost one solve.
#[derive(Clone, Debug, Default)]
pub struct ContactSystem {
    nodes: Vec<u32>,
    /// Numbers of their handles.
    handles: Vec<usize>,
    matrix: DenseCholesky,
    numbers: Vec<f64>,
}

/// Why nodes cannot be imposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ContactError {
    /// The node lies inside the body, or is held already.
    #[error("node {node} has no responses: it lies inside, or is held already; impose free nodes of the surface")]
    NoResponse {
        /// The node.
        node: u32,
    },
    /// The node is named twice, or free in some directions only.
    #[error("node {node} cannot be imposed in all directions: it is named twice, or slides; name free nodes once")]
    NotIndependent {
        /// The node.
        node: u32,
    },
}

impl ContactSystem {
    /// A system with room for so many nodes: no more memory is asked for up to that.
    pub fn with_room(nodes: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(nodes),
            handles: Vec::with_capacity(nodes),
            matrix: DenseCholesky::with_room(3 * nodes),
            numbers: Vec::with_capacity(3 * nodes),
        }
    }

    /// The nodes that are imposed, in the order in which they were given.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Imposes these nodes from now on, in whichever order.
    ///
    /// # Errors
    /// [`ContactError`]; no node is imposed then.
    pub fn impose(&mut self, responses: &Responses, nodes: &[u32]) -> Result<(), ContactError> {
        if self.nodes == nodes {
            return Ok(());
        }
        self.nodes.clear();
        self.handles.clear();
        self.matrix.clear();
        for &node in nodes {
            let handle = responses.handle_of(node).ok_or(ContactError::NoResponse { node });
            let handle = handle.inspect_err(|_| self.handles.clear())?;
            self.handles.push(handle);
        }
        let (handles, mut row_reached) = (&self.handles, 0);
        let entry = |row: usize, column: usize| {
            row_reached = row;
            let block = responses.response(nodes[row / 3], handles[column / 3]);
            block.columns[column % 3][row % 3]
        };
        if self.matrix.factor(3 * nodes.len(), entry).is_err() {
            self.handles.clear();
            return Err(ContactError::NotIndependent { node: nodes[row_reached / 3] });
        }
        self.nodes.extend_from_slice(nodes);
        Ok(())
    }

    /// Finds the forces [N] that displace the imposed nodes by these vectors [m], and adds what all nodes do under them to
    /// `displacements`. Panics for another number of vectors than there are imposed nodes.
    pub fn displace(&mut self, responses: &Responses, imposed: &[Vec3<f64>], displacements: &mut [Vec3<f64>]) {
        self.find_forces(imposed);
        for (place, &handle) in self.handles.iter().enumerate() {
            responses.displace(handle, self.force(place), displacements);
        }
    }

    /// Finds the forces alone.
    pub(crate) fn find_forces(&mut self, imposed: &[Vec3<f64>]) {
        assert_eq!(imposed.len(), self.nodes.len(), "one displacement is needed for each imposed node");
        self.numbers.clear();
        self.numbers.extend(imposed.iter().flat_map(|u| u.to_array()));
        self.matrix.solve(&mut self.numbers);
    }

    /// The force on the imposed node at this place of the list [N]: what holds it, and what a tool feels reversed.
    pub fn force(&self, place: usize) -> Vec3<f64> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.numbers[3 * place + axis]);
        Vec3::new(x, y, z)
    }

    /// The number of the handle of the imposed node at this place.
    pub(crate) fn handle(&self, place: usize) -> usize {
        self.handles[place]
    }
}

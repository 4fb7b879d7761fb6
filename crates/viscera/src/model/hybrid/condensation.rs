use super::part;
use crate::executor::{Divide, Executor};
use crate::material::Tissue;
use crate::math::{Mat3, Scalar, Vec3};
use crate::mesh::{Region, VolumeMesh};
use crate::model::precomputed::{ResponsesError, Supports};
use crate::model::{ModelError, ModelRecipe, Scratch, TotalLagrangian};
use crate::solver::{BlockMatrix, Filter, LinearSolver, SolverError, System};

/// The pre-computed part of a hybrid body, condensed onto its boundary.
///
/// 72 bytes for each two nodes of the boundary, and for each of these and each follower.
#[derive(Clone, Debug, PartialEq)]
pub struct Condensation {
    /// The cells that move, and the others; ascending.
    dynamic: Vec<u32>,
    precomputed: Vec<u32>,
    /// Nodes that the pre-computed part shares or by which it is held, and its others; ascending.
    boundary: Vec<u32>,
    followers: Vec<u32>,
    /// S [N/m], row after row.
    stiffness: Vec<Mat3<f64>>,
    /// T, the column of a boundary node after that of the one before.
    shares: Vec<Mat3<f64>>,
}

impl Condensation {
    /// Condenses all cells without a corner in `dynamic`; none where there is no such region.
    ///
    /// # Errors
    /// [`ModelError::Region`] for a region that selects nothing; [`ModelError::Responses`] where a piece of the pre-computed part is
    /// held by nothing.
    pub fn compute(
        tissue: &Tissue,
        supports: &Supports<'_>,
        dynamic: Option<&Region>,
        solver: &mut dyn LinearSolver,
        executor: &Executor,
    ) -> Result<Self, ModelError> {
        let mut parts = Self::divide(supports, dynamic)?;
        if parts.precomputed.is_empty() {
            return Ok(parts);
        }
        let system = part_stiffness(tissue, supports.mesh, &parts)?;
        solver.analyse(&system);
        solver.factor(&system).map_err(|error| match error {
            SolverError::NotPositiveDefinite => ResponsesError::NothingHolds,
            other => ResponsesError::Solver(other),
        })?;
        let (count, followers) = (parts.boundary.len(), parts.followers.len());
        let mut columns = vec![Mat3::ZERO; count * (count + followers)];
        let (solver, boundary, inside) = (&*solver, &parts.boundary, &parts.followers);
        let work = |part: usize, Column { blocks, .. }: Column<'_>| {
            for (axis, unit) in Mat3::IDENTITY.columns.into_iter().enumerate() {
                let (u, forces) = answer(&system, solver, boundary[part] as usize, unit)?;
                let values = boundary.iter().map(|&node| forces[node as usize]);
                let values = values.chain(inside.iter().map(|&node| u[node as usize]));
                blocks.iter_mut().zip(values).for_each(|(block, value)| block.columns[axis] = value);
            }
            Ok(())
        };
        let data = Column { blocks: &mut columns, length: count + followers };
        let outcome = executor.fold(count, data, &work, &|a: Result<(), SolverError>, b| a.and(b));
        outcome.unwrap_or(Ok(())).map_err(ResponsesError::Solver)?;
        let column = |of: usize| &columns[of * (count + followers)..][..count + followers];
        // Symmetric but for rounding: the mean of both halves is so to the last bit.
        let pairs = (0..count * count).map(|place| (place / count, place % count));
        let mean = |(row, other): (usize, usize)| (column(other)[row] + column(row)[other].transpose()) * 0.5;
        parts.stiffness = pairs.map(mean).collect();
        parts.shares = (0..count).flat_map(|of| column(of)[count..].iter().copied()).collect();
        Ok(parts)
    }

    /// Which cells and nodes belong to which part.
    fn divide(supports: &Supports<'_>, dynamic: Option<&Region>) -> Result<Self, ModelError> {
        let Supports { mesh, filters } = *supports;
        let mut moves = vec![dynamic.is_none(); mesh.nodes().len()];
        if let Some(region) = dynamic {
            let nodes = region.nodes(mesh).map_err(|error| ModelError::Region(Box::new(error)))?;
            nodes.into_iter().for_each(|node| moves[node as usize] = true);
        }
        let is_dynamic = |cell: &u32| mesh.cell(*cell as usize).iter().any(|&node| moves[node as usize]);
        let (dynamic, precomputed): (Vec<u32>, Vec<u32>) = (0..mesh.cell_count() as u32).partition(is_dynamic);
        let nodes_of = |cells: &[u32]| {
            let mut has = vec![false; mesh.nodes().len()];
            let corners = cells.iter().flat_map(|&cell| mesh.cell(cell as usize));
            corners.for_each(|&node| has[node as usize] = true);
            has
        };
        let (shared, own) = (nodes_of(&dynamic), nodes_of(&precomputed));
        let all = (0..mesh.nodes().len() as u32).filter(|&node| own[node as usize]);
        let is_boundary = |node: &u32| shared[*node as usize] || filters[*node as usize] != Filter::Free;
        let (boundary, followers) = all.partition(is_boundary);
        Ok(Self { dynamic, precomputed, boundary, followers, stiffness: Vec::new(), shares: Vec::new() })
    }

    /// The cells that move and can be cut, ascending.
    pub fn dynamic_cells(&self) -> &[u32] {
        &self.dynamic
    }

    /// The nodes by which the pre-computed part hangs on the rest, or is held; ascending.
    pub fn boundary(&self) -> &[u32] {
        &self.boundary
    }

    /// The nodes that follow the boundary, ascending.
    pub fn followers(&self) -> &[u32] {
        &self.followers
    }

    /// S at two places of the boundary [N/m].
    pub fn stiffness(&self, row: usize, column: usize) -> Mat3<f64> {
        self.stiffness[row * self.boundary.len() + column]
    }

    /// Cells of the pre-computed part without a corner on the boundary.
    pub(super) fn inner_cells(&self, mesh: &VolumeMesh) -> Vec<u32> {
        let touches =
            |cell: &u32| mesh.cell(*cell as usize).iter().any(|node| self.boundary.binary_search(node).is_ok());
        self.precomputed.iter().copied().filter(|cell| !touches(cell)).collect()
    }

    /// Adds T u_B to the displacements of the followers [m]; `of_boundary` gives those of the boundary, place by place.
    pub(crate) fn follow(&self, of_boundary: impl Fn(usize) -> Vec3<f64>, followers: &mut [Vec3<f64>]) {
        let count = self.followers.len();
        for place in 0..self.boundary.len() {
            let (u, column) = (of_boundary(place), &self.shares[place * count..][..count]);
            followers.iter_mut().zip(column).for_each(|(sum, &share)| *sum += share * u);
        }
    }

    /// Tᵀ f_I: what forces [N] on all nodes mean to the boundary where they act on followers, place by place.
    pub(crate) fn condense(&self, forces: &[Vec3<f64>]) -> Vec<Vec3<f64>> {
        let count = self.followers.len();
        let at_place = |place: usize| {
            let column = self.shares[place * count..][..count].iter();
            column
                .zip(&self.followers)
                .fold(Vec3::ZERO, |sum, (share, &node)| sum + share.transpose_mul(forces[node as usize]))
        };
        (0..self.boundary.len()).map(at_place).collect()
    }

    /// |S (u − v)| over |S u|, the change of the reaction of the pre-computed part on its boundary; 0 where there is none.
    pub(crate) fn change_of_reaction(
        &self,
        now: impl Fn(usize) -> Vec3<f64>,
        before: impl Fn(usize) -> Vec3<f64>,
    ) -> f64 {
        let (mut change, mut size) = (0.0, 0.0);
        for row in self.stiffness.chunks_exact(self.boundary.len().max(1)) {
            let (mut reaction, mut earlier) = (Vec3::ZERO, Vec3::ZERO);
            for (place, &block) in row.iter().enumerate() {
                reaction += block * now(place);
                earlier += block * before(place);
            }
            change += (reaction - earlier).squared_norm();
            size += reaction.squared_norm();
        }
        if size > 0.0 { (change / size).sqrt() } else { 0.0 }
    }

    /// S in the precision of a model.
    pub(super) fn stiffness_as<T: Scalar>(&self) -> Vec<Mat3<T>> {
        self.stiffness.iter().map(|block| block.cast()).collect()
    }
}

/// K of the pre-computed part at rest; all but the followers are held.
pub(crate) fn part_stiffness(tissue: &Tissue, mesh: &VolumeMesh, parts: &Condensation) -> Result<System, ModelError> {
    let cells = part(mesh, &parts.precomputed);
    // Straight from the law, whichever that is: at rest its tangent is the linear one.
    let models = [TotalLagrangian::new(tissue.of_cells(&parts.precomputed)).build_double(&cells)?];
    let mut scratch = Scratch::for_models(mesh.nodes().len(), &models);
    let mut matrix = BlockMatrix::new(&cells, models[0].rings());
    models[0].linearize(mesh.nodes(), &mut scratch);
    models[0].add_blocks(mesh.nodes(), &mut scratch, &mut matrix);
    let mut filters = vec![Filter::Held; mesh.nodes().len()];
    parts.followers.iter().for_each(|&node| filters[node as usize] = Filter::Free);
    Ok(System { matrix, filters })
}

/// A vector for each node.
type Nodal = Vec<Vec3<f64>>;

/// Displacements and forces of all nodes where one is displaced by `way` and no other of the boundary.
fn answer(
    system: &System,
    solver: &dyn LinearSolver,
    node: usize,
    way: Vec3<f64>,
) -> Result<(Nodal, Nodal), SolverError> {
    let (mut u, mut forces) = (vec![Vec3::ZERO; system.nodes()], vec![Vec3::ZERO; system.nodes()]);
    u[node] = way;
    system.matrix.times(&u, &mut forces);
    let mut follow = forces.clone();
    system.filter(&mut follow);
    solver.solve(system, &mut follow)?;
    u.iter_mut().zip(&follow).for_each(|(u, &follow)| *u -= follow);
    system.matrix.times(&u, &mut forces);
    Ok((u, forces))
}

/// Columns of blocks; a part is the one of a boundary node.
struct Column<'a> {
    blocks: &'a mut [Mat3<f64>],
    length: usize,
}

impl Divide for Column<'_> {
    fn divide(self, parts: usize) -> (Self, Self) {
        let Self { blocks, length } = self;
        let (left, right) = blocks.split_at_mut(parts * length);
        (Self { blocks: left, length }, Self { blocks: right, length })
    }
}

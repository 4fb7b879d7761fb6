//! The points at rest, and what cuts have left of the cells around them.

use crate::material::Tissue;
use crate::math::Vec3;
use crate::mesh::{TetMesh, cells_of_nodes};
use crate::model::ModelError;
use crate::model::tet_loop::RestTet;

/// What no cut changes. A point is a node and one of the tissues around it.
#[derive(Debug)]
pub(super) struct Rest {
    pub(super) mesh: TetMesh,
    cells_at_nodes: (Vec<u32>, Vec<u32>),
    /// Where the corners of those cells stand among the nodes around the node's point of that tissue: a cut would look for them.
    places: Vec<[u32; 4]>,
    /// Which tissue a cell is of.
    tissues: Vec<u32>,
    /// A cell of each tissue.
    examples: Vec<usize>,
    /// s μ of each tissue [Pa].
    shares: Vec<f64>,
    /// Node and tissue of each point.
    points: Vec<Point>,
    /// The points of node n are `points_at_nodes.1[starts[n]..starts[n + 1]]`.
    points_at_nodes: (Vec<u32>, Vec<u32>),
}

/// A node and one of the tissues around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) node: u32,
    tissue: u32,
}

/// A point with the nodes around it, its own first.
pub(super) struct Neighbourhood {
    pub(super) point: Point,
    pub(super) nodes: Vec<u32>,
}

impl Rest {
    /// The points of `mesh`, where `share` is s μ of a cell [Pa], and their neighbourhoods, in the order of the nodes.
    pub(super) fn new(
        mesh: &TetMesh,
        tissue: &Tissue,
        share: impl Fn(usize) -> f64,
    ) -> Result<(Self, Vec<Neighbourhood>), ModelError> {
        mesh.check_indices()?;
        let cells = mesh.cells.len();
        (0..cells).try_for_each(|cell| RestTet::new(mesh, cell).map(|_| ()))?;
        let (tissues, examples) = kinds_of_tissue(cells, tissue);
        let mut rest = Self {
            mesh: TetMesh::new(mesh.nodes.clone(), mesh.cells.clone()),
            cells_at_nodes: cells_of_nodes(mesh),
            places: Vec::new(),
            shares: examples.iter().map(|&cell| share(cell)).collect(),
            tissues,
            examples,
            points: Vec::new(),
            points_at_nodes: (Vec::new(), Vec::new()),
        };
        let mut neighbourhoods = Vec::new();
        for node in 0..mesh.nodes.len() as u32 {
            let mut around: Vec<u32> = rest.cells_at(node).map(|(_, cell)| rest.tissues[cell]).collect();
            around.sort_unstable();
            around.dedup();
            neighbourhoods.extend(around.into_iter().map(|tissue| rest.neighbourhood(Point { node, tissue })));
        }
        rest.places = vec![[0; 4]; rest.cells_at_nodes.1.len()];
        for Neighbourhood { point, nodes } in &neighbourhoods {
            let place = |corner| nodes.iter().position(|&node| node == corner).unwrap_or_default() as u32;
            let found: Vec<_> =
                rest.cells_around(*point).map(|(at, cell)| (at, rest.mesh.cells[cell].map(place))).collect();
            found.into_iter().for_each(|(at, places)| rest.places[at] = places);
        }
        Ok((rest, neighbourhoods))
    }

    /// Numbers the points as they stand in `neighbourhoods`.
    pub(super) fn number_points(&mut self, neighbourhoods: &[Neighbourhood]) {
        self.points = neighbourhoods.iter().map(|around| around.point).collect();
        let mut by_node: Vec<u32> = (0..self.points.len() as u32).collect();
        by_node.sort_by_key(|&point| self.points[point as usize].node);
        let mut starts = vec![0; self.mesh.nodes.len() + 1];
        self.points.iter().for_each(|point| starts[point.node as usize + 1] += 1);
        (1..starts.len()).for_each(|node| starts[node] += starts[node - 1]);
        self.points_at_nodes = (starts, by_node);
    }

    fn neighbourhood(&self, point: Point) -> Neighbourhood {
        let corners = self.cells_around(point).flat_map(|(_, cell)| self.mesh.cells[cell]);
        let mut nodes: Vec<u32> = corners.filter(|&other| other != point.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.insert(0, point.node);
        Neighbourhood { point, nodes }
    }

    /// The cells at a node, each with where it stands among those of all nodes.
    fn cells_at(&self, node: u32) -> impl Iterator<Item = (usize, usize)> + '_ {
        let (starts, cells) = &self.cells_at_nodes;
        (starts[node as usize] as usize..starts[node as usize + 1] as usize).map(|at| (at, cells[at] as usize))
    }

    /// The same for those of a point's tissue.
    fn cells_around(&self, point: Point) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.cells_at(point.node).filter(move |&(_, cell)| self.tissues[cell] == point.tissue)
    }

    /// The points of a cell's corners.
    pub(super) fn points_of(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        let (starts, points) = &self.points_at_nodes;
        self.mesh.cells[cell].into_iter().filter_map(move |node| {
            let span = starts[node as usize] as usize..starts[node as usize + 1] as usize;
            let mut own = points[span].iter().map(|&point| point as usize);
            own.find(|&point| self.points[point].tissue == self.tissues[cell])
        })
    }

    /// A cell of the point's tissue.
    pub(super) fn example(&self, point: usize) -> usize {
        self.examples[self.points[point].tissue as usize]
    }

    /// s μ of the point's tissue [Pa].
    pub(super) fn share(&self, point: usize) -> f64 {
        self.shares[self.points[point].tissue as usize]
    }

    /// V_a of a point without the cells that are `removed`; sums up what they make of the points `around` it.
    pub(super) fn weigh(&self, point: usize, removed: &[bool], around: &mut [Neighbour]) -> f64 {
        let mut volume = 0.0;
        for (at, cell) in self.cells_around(self.points[point]).filter(|&(_, cell)| !removed[cell]) {
            let rest = RestTet::measure(&self.mesh, cell);
            let share = rest.volume / 4.0;
            volume += share;
            let (places, gradients) = (self.places[at], rest.gradients());
            // The point's own node stands first.
            let own = places.iter().zip(gradients).find(|(place, _)| **place == 0).map_or(Vec3::ZERO, |(_, own)| own);
            for (place, gradient) in places.into_iter().zip(gradients) {
                let neighbour = &mut around[place as usize];
                neighbour.gradient += gradient * share;
                neighbour.spring -= gradient.dot(own) * rest.volume;
            }
        }
        volume
    }
}

/// What the cells of a point make of a node around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    /// V_a g_ab.
    pub(super) gradient: Vec3<f64>,
    /// −Σ_e V_e ∇N_a·∇N_b.
    pub(super) spring: f64,
}

impl Neighbour {
    /// One that no cell has counted yet.
    pub(super) const UNCOUNTED: Self = Self { gradient: Vec3::ZERO, spring: 0.0 };
}

/// Cells of the same parameters, to the last bit, are of one tissue: its number for each cell, and a cell of each tissue.
fn kinds_of_tissue(cells: usize, tissue: &Tissue) -> (Vec<u32>, Vec<usize>) {
    let mut numbers = vec![0; cells];
    if tissue.is_uniform() {
        return (numbers, vec![0]);
    }
    let bits = |cell: usize| tissue.values(cell).iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let mut examples: Vec<usize> = Vec::new();
    let mut known = std::collections::BTreeMap::new();
    for (cell, number) in numbers.iter_mut().enumerate() {
        *number = *known.entry(bits(cell)).or_insert_with(|| {
            examples.push(cell);
            examples.len() as u32 - 1
        });
    }
    (numbers, examples)
}

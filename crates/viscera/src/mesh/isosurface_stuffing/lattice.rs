use super::super::{GenerateError, Point};

/// A body-centred cubic lattice over a box: corners and centres of cubes.
///
/// Coordinates are counted in half cube edges: corners have even coordinates, centres odd ones. A corner has 6 long edges
/// (one cube edge) to corners and 8 short ones (√3/2 of it) to centres, and a centre likewise. Twelve tetrahedra belong to
/// a cube; each has one long edge between corners, one between centres, and four short ones.
pub(super) struct Lattice {
    /// Cubes along each axis.
    cubes: [usize; 3],
    /// The corner with the smallest coordinates [m].
    origin: Point,
    /// Edge of a cube [m].
    pub(super) edge: f64,
    /// How many of the nodes are corners; they come first.
    corners: usize,
}

/// A tetrahedron of the lattice: corners `a`, `b`, then centres `c`, `d`, so that `ab` and `cd` are its long edges.
pub(super) type LatticeCell = [u32; 4];

impl Lattice {
    /// More nodes than this are refused: 2²⁵ nodes hold 2·10⁸ tetrahedra.
    const MOST_NODES: f64 = (1 << 25) as f64;

    /// Covers a box with a margin of more than one cube on every side, the same on opposite sides.
    pub(super) fn around((low, high): (Point, Point), edge: f64) -> Result<Self, GenerateError> {
        GenerateError::check_length("edge", edge)?;
        let extent = high - low;
        for axis in 0..3 {
            GenerateError::check_length("extent", extent[axis])?;
        }
        let along = extent.to_array().map(|length| (length / edge).ceil() + 3.0);
        let nodes = 2.0 * along[0] * along[1] * along[2];
        if nodes > Self::MOST_NODES {
            let smallest_edge = edge * (nodes / Self::MOST_NODES).cbrt() * 1.01;
            return Err(GenerateError::TooFine { edge, cells: 6.0 * nodes, smallest_edge });
        }
        let cubes = along.map(|cubes| cubes as usize);
        let size = Point::from(along) * edge;
        let corners = cubes.iter().map(|cubes| cubes + 1).product();
        Ok(Self { cubes, origin: (low + high - size) * 0.5, edge, corners })
    }

    /// How many nodes there are.
    pub(super) fn node_count(&self) -> usize {
        self.corners + self.cubes.iter().product::<usize>()
    }

    /// Coordinates of a node in half cube edges: all even for a corner, all odd for a centre.
    pub(super) fn half_steps(&self, node: u32) -> [usize; 3] {
        let corner = (node as usize) < self.corners;
        let (index, across, up) = if corner {
            (node as usize, self.cubes[0] + 1, self.cubes[1] + 1)
        } else {
            (node as usize - self.corners, self.cubes[0], self.cubes[1])
        };
        let steps = [index % across, index / across % up, index / across / up];
        steps.map(|step| 2 * step + usize::from(!corner))
    }

    /// Where a node lies [m].
    pub(super) fn position(&self, node: u32) -> Point {
        let [x, y, z] = self.half_steps(node).map(|half_steps| half_steps as f64 * 0.5 * self.edge);
        self.origin + Point::new(x, y, z)
    }

    /// Whether the edge between two neighbours is a long one: between two corners or two centres.
    pub(super) fn is_long(&self, a: u32, b: u32) -> bool {
        ((a as usize) < self.corners) == ((b as usize) < self.corners)
    }

    /// Whether a node is odd in the checkerboard of its own kind: the two ends of a long edge always differ.
    pub(super) fn is_odd(&self, node: u32) -> bool {
        self.half_steps(node).iter().map(|half_steps| half_steps / 2).sum::<usize>() % 2 == 1
    }

    /// All tetrahedra inside the box, every one with positive volume, cube by cube, x fastest.
    pub(super) fn cells(&self) -> impl Iterator<Item = LatticeCell> + '_ {
        let [across, up, along] = self.cubes;
        let corner_stride = [1, across + 1, (across + 1) * (up + 1)];
        let centre_stride = [1, across, across * up];
        (0..across * up * along).flat_map(move |cube| {
            let here = [cube % across, cube / across % up, cube / across / up];
            let corner: usize = (0..3).map(|axis| here[axis] * corner_stride[axis]).sum();
            let from = self.corners + cube;
            (0..3).filter(move |&axis| here[axis] + 1 < self.cubes[axis]).flat_map(move |axis| {
                // The square between this cube and the next one, counter-clockwise seen from the next.
                let (second, third) = (corner_stride[(axis + 1) % 3], corner_stride[(axis + 2) % 3]);
                let near = corner + corner_stride[axis];
                let square = [near, near + second, near + second + third, near + third];
                let to = from + centre_stride[axis];
                (0..4).map(move |side| [square[side], square[(side + 1) % 4], from, to].map(|node| node as u32))
            })
        })
    }

    /// The edges of the lattice, each once, as [from, to].
    pub(super) fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        const LONG: [[isize; 3]; 3] = [[2, 0, 0], [0, 2, 0], [0, 0, 2]];
        const SHORT: [[isize; 3]; 4] = [[1, 1, 1], [-1, 1, 1], [1, -1, 1], [-1, -1, 1]];
        (0..self.node_count() as u32).flat_map(move |node| {
            let here = self.half_steps(node);
            LONG.iter().chain(&SHORT).filter_map(move |step| {
                let there: [isize; 3] = std::array::from_fn(|axis| here[axis] as isize + step[axis]);
                self.node_at(there).map(|to| [node, to])
            })
        })
    }

    /// The node at coordinates in half cube edges, if the lattice has it.
    fn node_at(&self, half_steps: [isize; 3]) -> Option<u32> {
        let odd = half_steps[0].rem_euclid(2) as usize;
        let counts = self.cubes.map(|cubes| cubes + 1 - odd);
        let inside = |axis: usize| half_steps[axis] >= 0 && (half_steps[axis] as usize / 2) < counts[axis];
        if !(0..3).all(inside) {
            return None;
        }
        let [x, y, z] = half_steps.map(|half_steps| half_steps as usize / 2);
        Some((odd * self.corners + x + counts[0] * (y + counts[1] * z)) as u32)
    }
}

use super::super::{HexMesh, Point, TetMesh};

/// How a cube of a grid is cut into tetrahedra.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CubeCut {
    /// Five: a regular one in the middle and four at corners. Neighbouring cubes take mirrored cuts so that their
    /// faces match. Fewest cells, no preferred direction over two cubes.
    Five,
    /// Six around one long diagonal (Kuhn's cut), the same in every cube. Stiffer along one diagonal than along the others.
    #[default]
    Six,
    /// Ten: both cuts into five, superposed, so that a cube has no preferred direction (Nesme et al. 2005, appendix B).
    /// Every place lies in two cells: **halve Young's modulus and the density**, and know that [`TetMesh::volume`] is
    /// twice that of the box and that boundary triangles cover each side twice.
    Ten,
}

// Corners of a cube are numbered x + 2y + 4z.
const FIVE_EVEN: [[usize; 4]; 5] = [[1, 4, 5, 7], [0, 1, 2, 4], [1, 3, 2, 7], [2, 4, 7, 6], [1, 2, 4, 7]];
const FIVE_ODD: [[usize; 4]; 5] = [[5, 0, 3, 1], [4, 5, 0, 6], [5, 7, 3, 6], [6, 0, 2, 3], [5, 6, 3, 0]];
const SIX: [[usize; 4]; 6] = [[0, 1, 3, 7], [0, 1, 7, 5], [0, 2, 7, 3], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 7, 6]];
/// The corners of a cube in the order in which a hexahedron lists them.
const HEXAHEDRON: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Nodes of a grid over the box from the origin to `size`, x fastest, then y, then z.
struct Grid {
    cells: [usize; 3],
}

impl Grid {
    fn nodes(&self, size: [f64; 3]) -> Vec<Point> {
        let at = |axis: usize, step: usize| size[axis] * step as f64 / self.cells[axis] as f64;
        let [across, up, along] = self.cells;
        let mut nodes = Vec::with_capacity((across + 1) * (up + 1) * (along + 1));
        for z in 0..=along {
            for y in 0..=up {
                nodes.extend((0..=across).map(|x| Point::new(at(0, x), at(1, y), at(2, z))));
            }
        }
        nodes
    }

    /// The eight corners of every cube, with the cube's parity: whether x + y + z is odd.
    fn cubes(&self) -> impl Iterator<Item = ([u32; 8], bool)> {
        let [across, up, along] = self.cells;
        let node = move |x: usize, y: usize, z: usize| (x + (across + 1) * (y + (up + 1) * z)) as u32;
        (0..along).flat_map(move |z| {
            (0..up).flat_map(move |y| {
                (0..across).map(move |x| {
                    let corners = std::array::from_fn(|c| node(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)));
                    (corners, (x + y + z) % 2 == 1)
                })
            })
        })
    }

    /// How many steps a node lies from the low side along an axis.
    fn step(&self, node: u32, axis: usize) -> usize {
        let stride: usize = self.cells[..axis].iter().map(|cells| cells + 1).product();
        node as usize / stride % (self.cells[axis] + 1)
    }
}

/// Hands the six sides of a grid to `name`, as names and tests of a node.
fn with_sides(grid: &Grid, name: impl FnOnce(&[(&str, &dyn Fn(u32) -> bool)])) {
    let low = |axis| move |node| grid.step(node, axis) == 0;
    let high = |axis: usize| move |node| grid.step(node, axis) == grid.cells[axis];
    name(&[
        ("x-min", &low(0)),
        ("x-max", &high(0)),
        ("y-min", &low(1)),
        ("y-max", &high(1)),
        ("z-min", &low(2)),
        ("z-max", &high(2)),
    ]);
}

impl TetMesh {
    /// A box from the origin to `size` [m], cut into `cells` cubes per axis and each cube into six tetrahedra.
    ///
    /// Nodes run x fastest, then y, then z. Its sides are the regions "x-min", "x-max", "y-min", … "z-max".
    /// No cells along an axis make an empty mesh, a size of zero cells without volume.
    pub fn box_grid(cells: [usize; 3], size: [f64; 3]) -> Self {
        Self::box_grid_cut(cells, size, CubeCut::Six)
    }

    /// As [`box_grid`](Self::box_grid), with a choice of how each cube is cut.
    pub fn box_grid_cut(cells: [usize; 3], size: [f64; 3], cut: CubeCut) -> Self {
        let grid = Grid { cells };
        if cells.contains(&0) {
            return Self::default();
        }
        let mut tetrahedra = Vec::new();
        for (corners, odd) in grid.cubes() {
            let mut add = |cut: &[[usize; 4]]| tetrahedra.extend(cut.iter().map(|tet| tet.map(|c| corners[c])));
            match cut {
                CubeCut::Five => add(if odd { &FIVE_ODD } else { &FIVE_EVEN }),
                CubeCut::Six => add(&SIX),
                CubeCut::Ten => {
                    add(&FIVE_EVEN);
                    add(&FIVE_ODD);
                }
            }
        }
        let mut mesh = Self::new(grid.nodes(size), tetrahedra);
        with_sides(&grid, |sides| mesh.name_sides(sides));
        mesh
    }
}

impl HexMesh {
    /// A box from the origin to `size` [m], cut into `cells` hexahedra per axis.
    ///
    /// Nodes and cells run x fastest, then y, then z. Its sides are the regions "x-min", "x-max", "y-min", … "z-max".
    /// No cells along an axis make an empty mesh, a size of zero cells without volume.
    pub fn box_grid(cells: [usize; 3], size: [f64; 3]) -> Self {
        let grid = Grid { cells };
        if cells.contains(&0) {
            return Self::default();
        }
        let hexahedra = grid.cubes().map(|(corners, _)| HEXAHEDRON.map(|c| corners[c])).collect();
        let mut mesh = Self::new(grid.nodes(size), hexahedra);
        with_sides(&grid, |sides| mesh.name_sides(sides));
        mesh
    }
}

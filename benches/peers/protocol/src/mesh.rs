use std::fmt::Write;
use std::path::Path;

use crate::{Case, Failure};

/// Tetrahedra, as a text of numbers: how many nodes and cells, the nodes' places [m], the cells' corners.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Places of the nodes [m].
    pub nodes: Vec<[f64; 3]>,
    /// Corners of the cells, of positive volume.
    pub cells: Vec<[u32; 4]>,
}

impl Mesh {
    /// Reads it.
    ///
    /// # Errors
    /// Where there is no such file, or it ends too early.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut words = text.split_whitespace();
        let mut number = || words.next().and_then(|word| word.parse::<f64>().ok()).ok_or("the mesh ends too early");
        let (nodes, cells) = (number()? as usize, number()? as usize);
        let mut mesh = Self::default();
        for _ in 0..nodes {
            mesh.nodes.push([number()?, number()?, number()?]);
        }
        for _ in 0..cells {
            mesh.cells.push([number()? as u32, number()? as u32, number()? as u32, number()? as u32]);
        }
        Ok(mesh)
    }

    /// The text.
    pub fn text(&self) -> String {
        let mut text = format!("{} {}\n", self.nodes.len(), self.cells.len());
        for [x, y, z] in &self.nodes {
            let _ = writeln!(text, "{x} {y} {z}");
        }
        for [a, b, c, d] in &self.cells {
            let _ = writeln!(text, "{a} {b} {c} {d}");
        }
        text
    }

    /// Whether a node is held: it lies at z = 0.
    pub fn is_held(&self, node: usize) -> bool {
        self.nodes[node][2] == 0.0
    }

    /// The node in the middle of the free end.
    pub fn tip(&self, case: &Case) -> usize {
        let [width, height, length] = case.beam.size;
        let middle = [0.5 * width, 0.5 * height, length];
        let away = |node: usize| (0..3).map(|axis| (self.nodes[node][axis] - middle[axis]).powi(2)).sum::<f64>();
        (0..self.nodes.len()).min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(0)
    }

    /// Lumped masses [kg]: a quarter of each cell at each of its corners.
    pub fn masses(&self, density: f64) -> Vec<f64> {
        let mut masses = vec![0.0; self.nodes.len()];
        for cell in &self.cells {
            let [a, b, c, d] = cell.map(|node| self.nodes[node as usize]);
            let edge = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|axis| to[axis] - a[axis]) };
            let (u, v, w) = (edge(b), edge(c), edge(d));
            let cross = [v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]];
            let volume = (u[0] * cross[0] + u[1] * cross[1] + u[2] * cross[2]) / 6.0;
            for &node in cell {
                masses[node as usize] += 0.25 * density * volume;
            }
        }
        masses
    }
}

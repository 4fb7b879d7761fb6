//! The assembled tangent is the tangent.

use viscera::math::Mat3;
use viscera::mesh::VolumeMesh;
use viscera::model::{BlockSink, Scratch};

use super::support::{Evaluate, Matrix, Random, Vector, deformed, hex_mesh, models_and_penalty, tet_mesh};

/// A dense matrix of blocks.
struct Dense {
    nodes: usize,
    blocks: Vec<Matrix>,
}

impl BlockSink<f64> for Dense {
    fn add(&mut self, row: u32, column: u32, block: Mat3<f64>) {
        self.blocks[row as usize * self.nodes + column as usize] += block;
    }
}

/// The sum of the blocks times a direction equals the product along it, to the rounding of the largest product; whether
/// cells were removed or not.
#[test]
fn blocks_times_a_direction_equal_the_product() {
    for mesh in [VolumeMesh::from(tet_mesh([3, 2, 2])), VolumeMesh::from(hex_mesh([3, 2, 2]))] {
        let mut random = Random::new(23);
        let f = random.deformation(0.2);
        let x = deformed(&mesh, f, Vector::ZERO, 1e-3, &mut random);
        let dx = random.vectors(x.len(), 1.0);
        for mut named in models_and_penalty::<f64>(&mesh) {
            for removed in [&[][..], &[1, 4]] {
                named.model.remove(removed);
                let mut scratch = Scratch::new(x.len());
                let mut dense = Dense { nodes: x.len(), blocks: vec![Matrix::ZERO; x.len() * x.len()] };
                named.model.linearize(&x, &mut scratch);
                named.model.add_blocks(&x, &mut scratch, &mut dense);
                let product = named.model.product(&x, &dx);
                let scale = product.iter().map(|v| v.norm()).fold(0.0, f64::max);
                for (row, expected) in dense.blocks.chunks(x.len()).zip(product) {
                    let sum = row.iter().zip(&dx).fold(Vector::ZERO, |sum, (&block, &dx)| sum + block * dx);
                    assert!((sum - expected).norm() <= 1e-12 * scale, "{}: {sum:?}, not {expected:?}", named.name);
                }
            }
        }
    }
}

//! The assembled tangent is the tangent.

use viscera::material::{LawKind, Tissue};
use viscera::math::Mat3;
use viscera::mesh::VolumeMesh;
use viscera::model::corotational::{IntegrationVolume, Rotation, StrainDisplacement, Tangent};
use viscera::model::{BlockSink, Corotational, ForceModel, Precision, Scratch};

use super::support::{
    Evaluate, Matrix, Random, Vector, assert_near, deformed, examples, hex_mesh, models_and_penalty, tet_mesh,
};

/// A dense matrix of blocks, or its diagonal.
struct Dense {
    nodes: usize,
    blocks: Vec<Matrix>,
    diagonal_only: bool,
}

impl Dense {
    fn of(model: &dyn ForceModel<f64>, x: &[Vector], scratch: &mut Scratch<f64>, diagonal_only: bool) -> Self {
        let nodes = x.len();
        let mut dense = Self { nodes, blocks: vec![Matrix::ZERO; nodes * nodes], diagonal_only };
        model.add_blocks(x, scratch, &mut dense);
        dense
    }

    fn times(&self, dx: &[Vector]) -> Vec<Vector> {
        let row = |row: &[Matrix]| row.iter().zip(dx).fold(Vector::ZERO, |sum, (&block, &dx)| sum + block * dx);
        self.blocks.chunks(self.nodes).map(row).collect()
    }

    fn diagonal(&self) -> impl Iterator<Item = &Matrix> {
        self.blocks.iter().step_by(self.nodes + 1)
    }
}

impl BlockSink<f64> for Dense {
    fn add(&mut self, row: u32, column: u32, block: Mat3<f64>) {
        self.blocks[row as usize * self.nodes + column as usize] += block;
    }

    fn keeps_diagonal_only(&self) -> bool {
        self.diagonal_only
    }
}

/// The sum of the blocks times a direction equals the product along it, to the rounding of the largest product; a sink that
/// keeps the diagonal gets the same one; whether cells were removed or not, and whether the model was prepared or not.
fn check(name: &str, model: &mut dyn ForceModel<f64>, x: &[Vector], dx: &[Vector]) {
    for removed in [&[][..], &[1, 4]] {
        model.remove(removed);
        let mut scratch = Scratch::new(x.len());
        for prepared in [false, true] {
            if prepared {
                model.linearize(x, &mut scratch);
            }
            let dense = Dense::of(model, x, &mut scratch, false);
            assert_near(&dense.times(dx), &model.product(x, dx), 1e-12, name);
            let diagonal = Dense::of(model, x, &mut scratch, true);
            assert!(dense.diagonal().eq(diagonal.diagonal()), "{name}: another diagonal");
            let columns = |blocks: &[Matrix]| blocks.iter().flat_map(|block| block.columns).collect::<Vec<_>>();
            let mut at_once = vec![Matrix::ZERO; x.len()];
            model.add_diagonal(x, &mut scratch, &mut at_once);
            let expected: Vec<_> = dense.diagonal().copied().collect();
            assert_near(&columns(&at_once), &columns(&expected), 1e-12, name);
        }
    }
}

#[test]
fn blocks_times_a_direction_equal_the_product() {
    for mesh in [VolumeMesh::from(tet_mesh([3, 2, 2])), VolumeMesh::from(hex_mesh([3, 2, 2]))] {
        let mut random = Random::new(23);
        let f = random.deformation(0.2);
        let x = deformed(&mesh, f, Vector::ZERO, 1e-3, &mut random);
        let dx = random.vectors(x.len(), 1.0);
        for mut named in models_and_penalty::<f64>(&mesh) {
            check(&named.name, named.model.as_mut(), &x, &dx);
        }
        for (tissue, _) in examples().into_iter().filter(|(tissue, _)| is_linear(tissue)) {
            for (name, recipe) in corotational_variants(&tissue) {
                check(&name, f64::build_model(&recipe, &mesh).unwrap().as_mut(), &x, &dx);
            }
        }
    }
}

fn is_linear(tissue: &Tissue) -> bool {
    matches!(tissue.kind(), LawKind::LinearElastic | LawKind::TransverseLinear)
}

fn corotational_variants(tissue: &Tissue) -> Vec<(String, Corotational)> {
    let mut variants = Vec::new();
    for rotation in [Rotation::Polar, Rotation::Qr, Rotation::Svd] {
        for strain in [StrainDisplacement::AtRest, StrainDisplacement::Updated] {
            for volume in [IntegrationVolume::Initial, IntegrationVolume::Current] {
                for tangent in [Tangent::Frozen, Tangent::Exact] {
                    let recipe = Corotational::new(tissue.clone());
                    let recipe = recipe.rotation(rotation).strain_displacement(strain).volume(volume).tangent(tangent);
                    variants.push((format!("corotational {rotation:?} {strain:?} {volume:?} {tangent:?}"), recipe));
                }
            }
        }
    }
    variants
}

//! Linear tissue under a load: it moves in proportion, and its volume is a cubic of the load.

use viscera::body::Body;
use viscera::dynamics::quasi_static::QuasiStatic;
use viscera::mesh::TetMesh;
use viscera_validation::setting::Settled;

use crate::ReproduceError;
use crate::deformed::{Deformed, Vector};

/// The largest force that is tried [N].
const MOST: f64 = 1e6;

/// How linear tissue answers a force of one newton.
pub(crate) struct LinearResponse {
    mesh: TetMesh,
    /// Displacements of the nodes [m/N].
    per_newton: Vec<Vector>,
}

impl LinearResponse {
    /// Solves once for `body` of linear tissue on `mesh` under its load of 1 N.
    pub(crate) fn new(mesh: &TetMesh, body: Body) -> Result<Self, ReproduceError> {
        let once = QuasiStatic { small_strain: true, ..QuasiStatic::default() };
        let per_newton = Settled::new(body, [0.0; 3], &once)?.displacements();
        Ok(Self { mesh: mesh.clone(), per_newton })
    }

    /// The shape under `newtons` [N].
    pub(crate) fn under(&self, newtons: f64) -> Deformed {
        let moved: Vec<Vector> = self.per_newton.iter().map(|&u| u * newtons).collect();
        Deformed::new(&self.mesh, &moved)
    }

    /// The force [N] under which the volume grows by `share`: papers that do not state their loads state this.
    pub(crate) fn force_that_grows(&self, share: f64) -> Result<f64, ReproduceError> {
        let grown = |newtons: f64| self.under(newtons).volume_variation() >= share;
        let mut high = 1e-6;
        while !grown(high) {
            high *= 2.0;
            if high > MOST {
                return Err(ReproduceError::Unreachable { percent: 100.0 * share, most: MOST });
            }
        }
        let mut low = 0.0;
        for _ in 0..60 {
            let half = 0.5 * (low + high);
            *if grown(half) { &mut high } else { &mut low } = half;
        }
        Ok(high)
    }
}

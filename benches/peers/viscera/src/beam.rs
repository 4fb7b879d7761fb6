use std::cell::Cell;

use serde_json::{Value, json};
use viscera::body::Body;
use viscera::mesh::Region;
use viscera::world::{BodyId, World, WorldConfig};
use viscera_peers_protocol::{Case, Failure, Mesh, Peer, Setup, Simulation};

use crate::{Variant, tetrahedra};

/// Viscera as one of those compared: single precision, one thread.
pub struct Viscera;

impl Peer for Viscera {
    fn about(&self) -> Value {
        json!({
            "name": "viscera",
            "version": env!("CARGO_PKG_VERSION"),
            "variants": Variant::ALL.map(Variant::about),
        })
    }

    fn build(&self, case: &Case, mesh: &Mesh, setup: &Setup) -> Result<Box<dyn Simulation>, Failure> {
        let variant = Variant::ALL.into_iter().find(|variant| variant.name() == setup.variant);
        let variant = variant.ok_or_else(|| format!("no such variant: {}", setup.variant))?;
        let config = WorldConfig { gravity: setup.gravity, step: setup.step, integrator: variant.integrator() };
        let mut world = World::<f32>::new(config)?;
        let body = Body::new(tetrahedra(mesh), case.tissue.density)
            .boxed_model(variant.recipe(case)?)
            .damping(setup.damping)
            .fix(Region::plane([0.0; 3], [0.0, 0.0, 1.0], 0.0));
        let body = world.add(body)?;
        Ok(Box::new(Beam { world, body }))
    }
}

struct Beam {
    world: World<f32>,
    body: BodyId,
}

impl Simulation for Beam {
    fn advance(&mut self, steps: u64) -> Result<u64, Failure> {
        let mut made = 0;
        for _ in 0..steps {
            made += u64::from(self.world.step()?.substeps);
        }
        Ok(made)
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        self.world.body(self.body).positions().iter().map(|x| x.cast::<f64>().to_array()).collect()
    }

    fn place(&mut self, positions: &[[f64; 3]]) {
        let node = Cell::new(0);
        let body = self.world.body_mut(self.body);
        // Nodes are asked for in their order.
        body.set_positions(|_| positions[node.replace(node.get() + 1)].into());
        body.set_velocities(|_| [0.0; 3].into());
    }
}

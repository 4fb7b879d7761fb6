//! The beam in rapier3d, by its finite elements (feature `fem`).
//!
//! Lengths are in decimetres: rapier leaves a cell of less than 1.2e-7 (`f32::EPSILON`) in volume without stiffness, whatever
//! the unit, and a cell of the finest mesh has 4e-8 m³ but 4e-5 dm³. In consistent units the motion is the same.

use std::path::Path;

use rapier3d::prelude::*;
use serde_json::{Value, json};
use viscera_peers_protocol::{Case, Failure, Mesh, Peer, Setup, Simulation, serve};

/// Lengths in one metre.
const UNITS: f64 = 10.0;
/// Iterations of the conjugate gradient in a step.
const ITERATIONS: usize = 25;

struct Rapier;

impl Peer for Rapier {
    fn about(&self) -> Value {
        let variant = |name: &str, law: &str, reference: &str| {
            json!({
                "name": name,
                "law": law,
                "scheme": format!("implicit, {ITERATIONS} iterations of CG"),
                "precision": "f32",
                "reference": reference,
                "note": "in decimetres: cells below 1.2e-7 in volume lose their stiffness",
            })
        };
        json!({
            "name": "rapier3d",
            "version": "0.36.1",
            "variants": [
                variant("fem corotational", "corotational", "corotational"),
                variant("fem neo-Hookean", "stable neo-Hookean", "stable-neo-hookean"),
            ],
        })
    }

    fn build(&self, case: &Case, mesh: &Mesh, setup: &Setup) -> Result<Box<dyn Simulation>, Failure> {
        let mut world = PhysicsWorld::new();
        world.gravity = vector(setup.gravity);
        let parameters = &mut world.integration_parameters;
        parameters.dt = setup.step as Real;
        // One solve a step, of a fixed number of iterations.
        parameters.num_solver_iterations = 1;
        parameters.soft_bodies.max_extra_substeps = 0;
        parameters.soft_bodies.fem.linear_tolerance = 0.0;
        parameters.soft_bodies.fem.max_linear_iterations = ITERATIONS;
        let model = match setup.variant.as_str() {
            "fem corotational" => SoftBodyCellModel::Corotational,
            "fem neo-Hookean" => SoftBodyCellModel::NeoHookean,
            other => return Err(format!("no such variant: {other}").into()),
        };
        let material = SoftBodyMaterial {
            young_modulus: (case.tissue.young / UNITS) as Real,
            poisson_ratio: case.tissue.poisson as Real,
            elastic_damping_ratio: 0.0,
            ..Default::default()
        };
        let held = (0..mesh.nodes.len()).filter(|&node| mesh.is_held(node)).map(|node| node as u32);
        let body = SoftBodyBuilder::new(mesh.nodes.iter().map(|&node| vector(node)).collect())
            .cells(mesh.cells.clone())
            .cell_model(model)
            .material(material)
            .solver(SoftBodySolver::Fem)
            .masses(mesh.masses(case.tissue.density).into_iter().map(|mass| mass as Real).collect())
            .pinned_particles(held)
            .linear_damping(setup.damping as Real)
            .no_surface_collider()
            .can_sleep(false);
        let body = world.insert_soft_body(body);
        Ok(Box::new(Beam { world, body }))
    }
}

fn vector(metres: [f64; 3]) -> Vector {
    let [x, y, z] = metres.map(|metres| (metres * UNITS) as Real);
    Vector::new(x, y, z)
}

struct Beam {
    world: PhysicsWorld,
    body: SoftBodyHandle,
}

impl Simulation for Beam {
    fn advance(&mut self, steps: u64) -> Result<u64, Failure> {
        for _ in 0..steps {
            self.world.step();
        }
        let body = &self.world.soft_bodies[self.body];
        if body.is_enabled() { Ok(steps) } else { Err("rapier took the body out: it is not finite".into()) }
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        let metres = |x: Vector| [x.x, x.y, x.z].map(|x| f64::from(x) / UNITS);
        self.world.soft_bodies[self.body].particle_positions().map(metres).collect()
    }

    fn place(&mut self, positions: &[[f64; 3]]) {
        let body = &mut self.world.soft_bodies[self.body];
        for (node, &position) in positions.iter().enumerate() {
            body.set_particle_position(node, vector(position));
            body.set_particle_velocity(node, Vector::ZERO);
        }
    }
}

fn main() -> Result<(), Failure> {
    let case = std::env::args().nth(1).ok_or("name the case: case.toml")?;
    serve(&Rapier, &Case::read(Path::new(&case))?)
}

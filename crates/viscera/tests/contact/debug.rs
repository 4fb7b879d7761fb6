use super::support::*;
use viscera::world::Integrator;

#[test]
fn debug() {
    for (integrator, friction) in [(EXPLICIT, 0.3), (EXPLICIT, 0.0), (implicit(), 0.0), (implicit(), 0.3)] {
        let mut world = world::<f64>(GRAVITY, 8e-3, integrator);
        let id =
            world.add(block([6, 2, 4], [0.06, 0.02, 0.04], Vector::new(0.0, 0.003, 0.0), 20e3).damping(30.0)).unwrap();
        let along = Vector::new(0.0, 0.0, 1.0);
        let rods = [0.013, 0.047]
            .map(|x| world.add_instrument(rod(Vector::new(x, 0.0, 0.02), along, 3e-3, friction)).unwrap());
        println!("== {} {friction}", matches!(integrator, Integrator::Explicit(_)));
        for step in 0..250 {
            let report = match world.step() {
                Ok(r) => r,
                Err(e) => {
                    println!("{e}");
                    break;
                }
            };
            if step < 12 || step > 240 {
                let f = rods.map(|r| *world.tool(r));
                let o = world.observe(id);
                println!(
                    "{step} {:?} {:.5?} {:.5?} n {} {} ke {:.2e} el {:.2e} {:?}",
                    report.substeps,
                    f[0].contact_force.to_array(),
                    f[1].contact_force.to_array(),
                    f[0].contacts,
                    f[1].contacts,
                    o.kinetic_energy,
                    o.elastic_energy,
                    report.implicit.map(|i| (
                        i.newton_iterations,
                        i.linear_iterations,
                        i.residual,
                        i.converged,
                        i.negative_curvature
                    ))
                );
            }
        }
    }
}

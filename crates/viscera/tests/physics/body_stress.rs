//! Stress as it is shown: that of the law, of the model, and of no turn.

use approx::assert_relative_eq;

use viscera::body::Body;
use viscera::material::{LinearElastic, StVenantKirchhoff, Tissue};
use viscera::math::{Mat3, Vec3};
use viscera::mesh::TetMesh;
use viscera::model::{Corotational, ModelRecipe, TotalLagrangian};
use viscera::world::{World, WorldConfig};

/// The stress of the first cell of a box that is stretched 1.2 times along x and turned by a right angle about z.
fn stress_of_a_turned_stretch(recipe: impl ModelRecipe + 'static) -> Mat3<f64> {
    let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
    let mesh = TetMesh::box_grid([1, 1, 1], [0.1, 0.2, 0.3]);
    let id = world.add(Body::new(mesh, 1000.0).model(recipe)).unwrap();
    world.body_mut(id).set_positions(|x| Vec3::new(-x.y, 1.2 * x.x, x.z));
    world.body(id).first_piola_stress(0)
}

/// E = diag(0.22, 0, 0), S = λ tr E + 2μE, P = F S: the first column of P is (0, 1.2 S₁₁, 0).
#[test]
fn stress_is_that_of_the_law_at_the_gradient() {
    let law = StVenantKirchhoff::from_young_poisson(10e3, 0.4).unwrap();
    let stress = stress_of_a_turned_stretch(TotalLagrangian::new(Tissue::uniform(law)));
    assert_relative_eq!(stress.columns[0].y, 1.2 * 0.22 * (law.lambda + 2.0 * law.mu), max_relative = 1e-10);
    assert_relative_eq!(stress.columns[1].x, -0.22 * law.lambda, max_relative = 1e-10);
}

/// The small strain of the stretch alone is diag(0.2, 0, 0), and the stress turns with the cell.
#[test]
fn stress_of_a_corotational_cell_knows_no_turn() {
    let law = LinearElastic::from_young_poisson(10e3, 0.4).unwrap();
    let stress = stress_of_a_turned_stretch(Corotational::new(Tissue::uniform(law)));
    assert_relative_eq!(stress.columns[0].y, 0.2 * (law.lambda + 2.0 * law.mu), max_relative = 1e-10);
    assert_relative_eq!(stress.columns[1].x, -0.2 * law.lambda, max_relative = 1e-10);
}

const YOUNG: f64 = 10e3; // Pa
const POISSON: f64 = 0.4;

/// Von Mises stress of a small cube whose points go to x' = R (x + u(x)) with R a turn of `angle` about z.
fn stress(recipe: impl ModelRecipe + 'static, u: fn(Vec3<f64>) -> Vec3<f64>, angle: f64) -> f64 {
    let mut world = World::<f64>::new(WorldConfig::default()).unwrap();
    let id = world.add(Body::new(TetMesh::box_grid([1, 1, 1], [0.1; 3]), 1000.0).model(recipe)).unwrap();
    let (sin, cos) = angle.sin_cos();
    world.body_mut(id).set_positions(|x| {
        let y = x + u(x);
        Vec3::new(cos * y.x - sin * y.y, sin * y.x + cos * y.y, y.z)
    });
    world.body(id).von_mises_stress(3)
}

fn tension(x: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(x.x, -POISSON * x.y, -POISSON * x.z) * 1e-6
}

fn shear(x: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(1e-6 * x.y, 0.0, 0.0)
}

/// Small strains: σ = E ε in tension, √3 μ γ in shear (Timoshenko, Goodier, section 84), and no turn changes it.
#[test]
fn tension_and_shear_show_their_stress_however_they_are_turned() {
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let svk = || TotalLagrangian::new(Tissue::uniform(StVenantKirchhoff::from_young_poisson(YOUNG, POISSON).unwrap()));
    let turned = || Corotational::new(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON).unwrap()));
    for angle in [0.0, 1.0] {
        // Strains of 1e-6 leave 1e-5 to the geometry, and to rounding.
        assert_relative_eq!(stress(svk(), tension, angle), YOUNG * 1e-6, max_relative = 1e-5);
        assert_relative_eq!(stress(turned(), tension, angle), YOUNG * 1e-6, max_relative = 1e-5);
        assert_relative_eq!(stress(svk(), shear, angle), 3_f64.sqrt() * mu * 1e-6, max_relative = 1e-5);
        assert_relative_eq!(stress(turned(), shear, angle), 3_f64.sqrt() * mu * 1e-6, max_relative = 1e-5);
    }
}

/// The linear law takes a turn for strain: what it computes with is what is shown.
#[test]
fn the_linear_law_alone_shows_stress_in_a_mere_turn() {
    let linear = TotalLagrangian::new(Tissue::uniform(LinearElastic::from_young_poisson(YOUNG, POISSON).unwrap()));
    // F = turn of 1 rad: ε = diag(cos 1 − 1, cos 1 − 1, 0), and σ_vm = 2 μ |cos 1 − 1|.
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let expected = 2.0 * mu * (1.0 - 1_f64.cos());
    assert_relative_eq!(stress(linear, |_| Vec3::ZERO, 1.0), expected, max_relative = 1e-10);
}

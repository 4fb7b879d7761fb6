//! Forces are the gradient of the energy, products the derivative of forces: by finite differences.

use viscera::mesh::VolumeMesh;

use crate::support::{
    Evaluate, Random, Vector, assert_near, deformed, hex_mesh, largest, models_and_penalty, tet_mesh,
};

fn meshes() -> [VolumeMesh; 2] {
    [tet_mesh([2, 2, 2]).into(), hex_mesh([2, 2, 2]).into()]
}

/// Nodes at the places `x + s dx`.
fn moved(x: &[Vector], dx: &[Vector], s: f64) -> Vec<Vector> {
    x.iter().zip(dx).map(|(&x, &dx)| x + dx * s).collect()
}

/// What five points leave: roundings; of J^(−2/3), the length of a spring and the rotation of neighbours also h⁴/30 of the fifth
/// derivative, 2e-8.
fn polynomial_or_not(name: &str) -> f64 {
    let is_none = ["of neo-hookean", "mass-spring", "shape-memory"].iter().any(|other| name.contains(other));
    if is_none { 1e-7 } else { 1e-9 }
}

#[test]
fn rest_holds_itself() {
    for mesh in meshes() {
        let x = mesh.nodes();
        for named in models_and_penalty::<f64>(&mesh) {
            // what a displacement of one metre would cost, times the roundings of a position
            let stiffness = largest(&named.model.product(x, &Random::new(41).vectors(x.len(), 1.0)));
            let modulus = 1e4 * mesh.size();
            let bound = 64.0 * f64::EPSILON * mesh.size() * stiffness.max(modulus);
            assert!(largest(&named.model.forces(x)) <= bound, "{}: {:e}", named.name, largest(&named.model.forces(x)));
            assert!(named.model.energy(x).abs() <= bound * mesh.size(), "{}: {}", named.name, named.model.energy(x));
        }
    }
}

/// What steps expect of a model's energy is what it claims. That of shape memory jumps where neighbours are turned inside out.
#[test]
fn models_with_a_potential_are_those_that_claim_one() {
    for mesh in meshes() {
        for named in models_and_penalty::<f64>(&mesh) {
            let expected = named.claims.conservative && !named.name.contains("shape-memory");
            assert_eq!(named.model.has_potential(), expected, "{}", named.name);
        }
    }
}

/// Every component at every node. Five points are exact for polynomials of degree four, which all energies but that of
/// the volume penalty are; rounding leaves 1e-16 W/h, 1e-9 of the largest force.
#[test]
fn forces_are_the_gradient_of_the_energy() {
    for mesh in meshes() {
        let mut random = Random::new(42);
        let x = deformed(&mesh, random.deformation(0.3), random.vector() * 0.1, 0.004, &mut random);
        let h = 1e-3 * mesh.size();
        for named in models_and_penalty::<f64>(&mesh) {
            if !named.claims.conservative {
                continue;
            }
            let mut slopes = vec![Vector::ZERO; x.len()];
            let mut place = x.clone();
            for node in 0..x.len() {
                for axis in 0..3 {
                    let mut energy = |steps: f64| {
                        place[node][axis] = x[node][axis] + steps * h;
                        named.model.energy(&place)
                    };
                    let near = energy(1.0) - energy(-1.0);
                    let far = energy(2.0) - energy(-2.0);
                    place[node][axis] = x[node][axis];
                    slopes[node][axis] = (8.0 * near - far) / (12.0 * h);
                }
            }
            // |δ|³ has a kink in its third derivative, where five points keep h² of their error
            let tolerance = if named.name == "volume penalty" { 1e-4 } else { polynomial_or_not(&named.name) };
            assert_near(&named.model.forces(&x), &slopes, tolerance, &named.name);
        }
    }
}

#[test]
fn products_are_the_derivative_of_forces() {
    for mesh in meshes() {
        let mut random = Random::new(43);
        let x = deformed(&mesh, random.deformation(0.3), random.vector() * 0.1, 0.004, &mut random);
        let dx = random.vectors(x.len(), 1.0);
        let h = 1e-3 * mesh.size();
        for named in models_and_penalty::<f64>(&mesh) {
            if !named.claims.exact_products {
                continue;
            }
            // δ|δ| is no polynomial where δ changes its sign: a step so small that hardly any cell does
            let (h, tolerance) =
                if named.name == "volume penalty" { (1e-4 * h, 1e-6) } else { (h, polynomial_or_not(&named.name)) };
            let forces = |s: f64| named.model.forces(&moved(&x, &dx, s * h));
            let (back2, back, ahead, ahead2) = (forces(-2.0), forces(-1.0), forces(1.0), forces(2.0));
            let slopes: Vec<_> =
                (0..x.len()).map(|i| ((ahead[i] - back[i]) * 8.0 - (ahead2[i] - back2[i])) / (12.0 * h)).collect();
            assert_near(&named.model.product(&x, &dx), &slopes, tolerance, &named.name);
        }
    }
}

/// a·K b = b·K a, also far from rest and of models whose products are not the derivative of their forces.
#[test]
fn products_are_symmetric() {
    let dot = |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(&a, &b)| a.dot(b)).sum::<f64>();
    for mesh in meshes() {
        let mut random = Random::new(44);
        let x = deformed(&mesh, random.deformation(0.5), Vector::ZERO, 0.008, &mut random);
        let (a, b) = (random.vectors(x.len(), 1.0), random.vectors(x.len(), 1.0));
        for named in models_and_penalty::<f64>(&mesh) {
            let (ka, kb) = (named.model.product(&x, &a), named.model.product(&x, &b));
            let scale = (dot(&ka, &ka) * dot(&b, &b)).sqrt();
            let difference = dot(&b, &ka) - dot(&a, &kb);
            assert!(difference.abs() <= 1e-13 * scale, "{}: {difference:e} of {scale:e}", named.name);
        }
    }
}

/// What is added is added: outputs keep what they held.
#[test]
fn forces_and_products_are_added_to_what_is_there() {
    use viscera::model::Scratch;
    for mesh in meshes() {
        let mut random = Random::new(45);
        let x = deformed(&mesh, random.deformation(0.3), Vector::ZERO, 0.004, &mut random);
        let (dx, before) = (random.vectors(x.len(), 1.0), random.vectors(x.len(), 10.0));
        for named in models_and_penalty::<f64>(&mesh) {
            let mut scratch = Scratch::new(x.len());
            let mut out = before.clone();
            named.model.add_forces(&x, &mut scratch, &mut out);
            named.model.add_product(&x, &dx, &mut scratch, &mut out);
            let (forces, product) = (named.model.forces(&x), named.model.product(&x, &dx));
            let expected: Vec<_> = (0..x.len()).map(|i| before[i] + forces[i] + product[i]).collect();
            assert_near(&out, &expected, 1e-13, &named.name);
        }
    }
}

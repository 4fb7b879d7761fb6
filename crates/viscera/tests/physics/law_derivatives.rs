//! Stress is the derivative of energy, tangent that of stress: by dual numbers, exact, and by finite differences.

use viscera::material::{Law, LawFamily, LawKind, LawVisitor};
use viscera::math::{Dual, Mat3, Vec3};

use crate::support::{Matrix, Random, assert_close, assert_near};

/// Deformations up to large and inverted ones: F = I + G with entries of G up to 0.9.
fn deformations() -> impl Iterator<Item = (Matrix, Matrix)> {
    let mut random = Random::new(1);
    [1e-3, 0.1, 0.3, 0.9].into_iter().flat_map(|size| [size; 8]).map(move |size| {
        let f = random.deformation(size);
        (f, random.matrix())
    })
}

fn along(f: &Matrix, df: &Matrix) -> Mat3<Dual<f64>> {
    let column = |i: usize| {
        let (v, d) = (f.columns[i], df.columns[i]);
        Vec3::new(Dual::new(v.x, d.x), Dual::new(v.y, d.y), Dual::new(v.z, d.z))
    };
    Mat3::from_columns(column(0), column(1), column(2))
}

fn dual_law<L: LawFamily>() -> L::At<Dual<f64>> {
    let values: Vec<_> = L::example().values().into_iter().map(Dual::constant).collect();
    L::at(&values)
}

fn derivative(p: Mat3<Dual<f64>>) -> Matrix {
    let [a, b, c] = p.columns.map(|column| Vec3::from(column.to_array().map(|entry| entry.derivative)));
    Mat3::from_columns(a, b, c)
}

/// Runs a check for every law of the registry.
fn every_law(check: impl LawVisitor + Copy) {
    LawKind::ALL.iter().for_each(|kind| {
        kind.visit(check);
    });
}

#[test]
fn stress_is_the_derivative_of_energy() {
    #[derive(Clone, Copy)]
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let law = L::example();
            for (f, df) in deformations() {
                let work = law.stress(&f).contract(df);
                let scale = law.stress(&f).squared_norm().sqrt() * df.squared_norm().sqrt();
                let exact = dual_law::<L>().energy(&along(&f, &df)).derivative;
                assert!((work - exact).abs() <= 1e-13 * scale, "{}: {work} is not {exact} at {f:?}", L::NAME);

                // five points: the error is h⁴ times the fifth derivative, rounding 1e-16 ψ/h
                let h: f64 = 1e-3;
                let energy = |s: f64| law.energy(&(f + df * (s * h)));
                let slope = (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * h);
                // near rest, where the stress is small, of J^(−2/3) a fifth derivative of some ten moduli is left
                let stiffness = law.tangent(&f, &df).squared_norm().sqrt() * df.squared_norm().sqrt();
                let bound = 1e-9 * scale + 10.0 * h.powi(4) * stiffness;
                assert!((work - slope).abs() <= bound, "{}: {work} is not {slope} at {f:?}", L::NAME);
            }
        }
    }
    every_law(Check);
}

#[test]
fn tangent_is_the_derivative_of_stress() {
    #[derive(Clone, Copy)]
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let law = L::example();
            for (f, df) in deformations() {
                let tangent = law.tangent(&f, &df);
                let exact = derivative(dual_law::<L>().stress(&along(&f, &df)));
                assert_near(&tangent.columns, &exact.columns, 1e-13, L::NAME);

                let h = 1e-3;
                let stress = |s: f64| law.stress(&(f + df * (s * h)));
                let slope = ((stress(1.0) - stress(-1.0)) * 8.0 - (stress(2.0) - stress(-2.0))) * (1.0 / (12.0 * h));
                assert_near(&tangent.columns, &slope.columns, 1e-9, L::NAME);
            }
        }
    }
    every_law(Check);
}

/// dF1:dP[dF2] = dF2:dP[dF1], because both are the same second derivative of ψ.
#[test]
fn tangent_is_symmetric() {
    #[derive(Clone, Copy)]
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(2));
            for (f, first) in deformations() {
                let second = random.matrix();
                let (p1, p2) = (law.tangent(&f, &first), law.tangent(&f, &second));
                let scale = (p1.squared_norm() * second.squared_norm()).sqrt();
                let difference = second.contract(p1) - first.contract(p2);
                assert!(difference.abs() <= 1e-13 * scale, "{}: {difference} of {scale}", L::NAME);
            }
        }
    }
    every_law(Check);
}

/// The tangent is linear in its direction.
#[test]
fn tangent_is_linear_in_its_direction() {
    #[derive(Clone, Copy)]
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(3));
            for (f, first) in deformations() {
                let second = random.matrix();
                let sum = law.tangent(&f, &(first * 2.0 - second));
                let parts = law.tangent(&f, &first) * 2.0 - law.tangent(&f, &second);
                assert_near(&sum.columns, &parts.columns, 1e-13, L::NAME);
            }
        }
    }
    every_law(Check);
}

/// Values go out and come back unchanged, one for each parameter that the law declares.
#[test]
fn parameters_come_back_as_they_were_given() {
    #[derive(Clone, Copy)]
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let law = L::example();
            assert_eq!(law.values().len(), L::PARAMETERS.len(), "{}", L::NAME);
            assert_eq!(L::from_values(&law.values()), law);
            let f = Random::new(4).deformation(0.2);
            assert_close(L::at::<f64>(&law.values()).energy(&f), law.energy(&f), 0.0, L::NAME);
            // each of them is felt, or it would go untested everywhere
            for (index, parameter) in L::PARAMETERS.iter().enumerate() {
                let mut values = law.values();
                values[index] *= 1.5;
                let changed = L::from_values(&values).energy(&f);
                assert!(changed != law.energy(&f), "{}: {} changes nothing", L::NAME, parameter.name);
            }
        }
    }
    every_law(Check);
}

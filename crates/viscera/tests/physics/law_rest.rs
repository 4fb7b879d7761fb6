//! What a law is at rest, near it, and where it has no business: singular and inverted F.

use viscera::material::{Law, LawFamily, LawKind, LawVisitor, QuadraticLaw, StrainMeasure, green_strain, small_strain};
use viscera::math::{Mat3, Sym3, Vec3};

use crate::support::{Matrix, Random, Vector, assert_close, assert_near};

#[test]
fn rest_has_neither_energy_nor_stress() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let law = L::example();
            // exactly: F = I has no rounding
            assert_eq!(law.energy(&Matrix::IDENTITY), 0.0, "{}", L::NAME);
            assert_eq!(law.stress(&Matrix::IDENTITY), Matrix::ZERO, "{}", L::NAME);
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

/// At rest dP = λ tr(ε) I + 2μ ε + 2κ_a (a0·ε a0) a0 a0ᵀ for dF = ε + ω: a turn ω stresses nothing.
#[test]
fn small_strains_meet_the_stiffness_that_the_law_declares() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(11));
            let rest = law.at_rest();
            assert_close(rest.direction.norm(), 1.0, 1e-15, L::NAME);
            for _ in 0..10 {
                let df = random.matrix();
                let strain = df.symmetric_part();
                let along = strain.quadratic(rest.direction);
                let hooke: Matrix = (Sym3::diagonal(rest.lame.lambda * strain.trace())
                    + strain * (2.0 * rest.lame.mu)
                    + Sym3::square(rest.direction) * (2.0 * rest.fibre_stiffness * along))
                    .into();
                assert_near(&law.tangent(&Matrix::IDENTITY, &df).columns, &hooke.columns, 1e-13, L::NAME);
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

/// No plane wave at rest is stiffer than the modulus from which the stable step is computed, and some come close.
#[test]
fn the_wave_modulus_bounds_the_acoustic_tensor() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(12));
            let bound = law.at_rest().wave_modulus();
            let stiffness = |normal: Vector, motion: Vector| {
                motion.dot(law.tangent(&Matrix::IDENTITY, &motion.outer(normal)) * normal)
            };
            for _ in 0..200 {
                let (normal, motion) = (random.vector().normalized().unwrap(), random.vector().normalized().unwrap());
                let modulus = stiffness(normal, motion);
                assert!(modulus > 0.0 && modulus <= bound * (1.0 + 1e-14), "{}: {modulus} above {bound}", L::NAME);
            }
            let along = law.at_rest().direction;
            assert_close(stiffness(along, along), bound, 1e-14, L::NAME);
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

/// A law that calls itself quadratic is, in the strain that it names: what tensor-mass relies on.
#[test]
fn quadratic_laws_are_quadratic_in_the_strain_they_name() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(13));
            let Some(QuadraticLaw { strain, stiffness }) = law.quadratic() else { return };
            for _ in 0..10 {
                let f = random.deformation(0.5);
                let e = match strain {
                    StrainMeasure::Small => small_strain(&f),
                    StrainMeasure::Green => green_strain(&f),
                };
                let energy = 0.5 * stiffness.lame.lambda * e.trace().powi(2)
                    + stiffness.lame.mu * e.squared_norm()
                    + stiffness.fibre_stiffness * e.quadratic(stiffness.direction).powi(2);
                assert_close(law.energy(&f), energy, 1e-13, L::NAME);
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

/// Flat, collapsed, mirrored and hugely stretched: forces must stay numbers, in single precision too.
#[test]
fn every_finite_deformation_has_a_finite_answer() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let values: Vec<f32> = L::example().values().into_iter().map(|value| value as f32).collect();
            let (law, single) = (L::example(), L::at::<f32>(&values));
            let diagonal = |x: f64, y: f64, z: f64| {
                Mat3::from_columns(Vec3::new(x, 0.0, 0.0), Vec3::new(0.0, y, 0.0), Vec3::new(0.0, 0.0, z))
            };
            let mut shapes = vec![
                Matrix::ZERO,
                diagonal(1.0, 1.0, 0.0),
                diagonal(1.0, 0.0, 0.0),
                diagonal(1.0, 1.0, -1.0),
                diagonal(-1.0, -1.0, -1.0),
                diagonal(-1e3, 1e-3, 1.0),
                diagonal(1e3, 1e3, 1e3),
                diagonal(1e-20, 1e-20, 1e-20),
            ];
            let mut random = Random::new(14);
            shapes.extend((0..20).map(|_| random.matrix() * 3.0));
            for f in shapes {
                let df = random.matrix();
                let numbers = [law.energy(&f), law.stress(&f).squared_norm(), law.tangent(&f, &df).squared_norm()];
                assert!(numbers.iter().all(|number| number.is_finite()), "{}: {numbers:?} at {f:?}", L::NAME);
                let (f, df) = (f.cast::<f32>(), df.cast::<f32>());
                assert!(single.energy(&f).is_finite(), "{} in single precision at {f:?}", L::NAME);
                assert!(single.stress(&f).is_finite() && single.tangent(&f, &df).is_finite(), "{} at {f:?}", L::NAME);
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

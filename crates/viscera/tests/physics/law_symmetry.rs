//! Turning the tissue in space, and turning its material: what a law must not and what it must notice.

use viscera::material::{LawFamily, LawKind, LawVisitor};
use viscera::math::Vec3;

use crate::support::{Matrix, Random, Vector, assert_close, assert_near};

/// ψ(QF) = ψ(F), P(QF) = Q P(F) and dP(QF)[Q dF] = Q dP(F)[dF] for laws that say so, and false for those that do not.
#[test]
fn objective_laws_and_only_they_ignore_rotations_in_space() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(21));
            for _ in 0..20 {
                let (f, df, q) = (random.deformation(0.4), random.matrix(), random.rotation());
                let turned = q * f;
                if L::OBJECTIVE {
                    assert_close(law.energy(&turned), law.energy(&f), 1e-13, L::NAME);
                    assert_near(&law.stress(&turned).columns, &(q * law.stress(&f)).columns, 1e-13, L::NAME);
                    let (tangent, expected) = (law.tangent(&turned, &(q * df)), q * law.tangent(&f, &df));
                    assert_near(&tangent.columns, &expected.columns, 1e-13, L::NAME);
                }
            }
            // A quarter turn of tissue at rest: strains of −1 for a law that takes it for a deformation.
            let quarter =
                Matrix::from_columns(Vec3::new(0.0, 1.0, 0.0), Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
            let mu = law.at_rest().lame.mu;
            assert_eq!(L::OBJECTIVE, law.energy(&quarter) <= 1e-13 * mu, "{}: objective or not?", L::NAME);
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

/// Laws that say that they are blind to reflections store the same energy in a cell and in its mirror image, whatever the
/// deformation; the others store energy in the mirror image of the shape at rest, which drives it back.
#[test]
fn only_laws_that_say_so_are_blind_to_reflections() {
    struct Check(bool);
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(23));
            let mu = law.at_rest().lame.mu;
            for _ in 0..20 {
                let (f, q) = (random.deformation(0.4), random.rotation());
                let mirror = q * Matrix::diagonal(-1.0);
                if self.0 {
                    assert_close(law.energy(&(mirror * f)), law.energy(&f), 1e-13, L::NAME);
                } else {
                    let energy = law.energy(&mirror);
                    assert!(energy > mu, "{}: {energy} J/m³ in a mirror", L::NAME);
                }
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check(kind.is_blind_to_reflections())));
    let blind: Vec<_> = LawKind::ALL.iter().filter(|kind| kind.is_blind_to_reflections()).collect();
    assert_eq!(blind, [&LawKind::StVenantKirchhoff, &LawKind::TransverseStVenantKirchhoff]);
    assert!(!LawKind::TURNS_BACK.is_blind_to_reflections());
}

/// The torque per volume P Fᵀ − F Pᵀ of an objective law vanishes: Cauchy's stress is symmetric.
#[test]
fn cauchy_stress_of_objective_laws_is_symmetric() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(22));
            for _ in 0..20 {
                let f = random.deformation(0.8);
                let kirchhoff = law.stress(&f) * f.transpose();
                if L::OBJECTIVE {
                    assert_near(&kirchhoff.columns, &kirchhoff.transpose().columns, 1e-13, L::NAME);
                }
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

fn turn_about(axis: Vector, angle: f64) -> Matrix {
    let cross = Matrix::from_columns(
        axis.cross(Vector::new(1.0, 0.0, 0.0)),
        axis.cross(Vector::new(0.0, 1.0, 0.0)),
        axis.cross(Vector::new(0.0, 0.0, 1.0)),
    );
    Matrix::IDENTITY * angle.cos() + cross * angle.sin() + axis.outer(axis) * (1.0 - angle.cos())
}

/// The same strain applied to tissue whose material was turned by Q before: Qᵀ F Q for a law that is not objective, which
/// amounts to F Q for one that is.
#[test]
fn isotropic_laws_have_no_direction_and_fibred_ones_have_one() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(23));
            let rest = law.at_rest();
            for _ in 0..20 {
                let (f, q) = (random.deformation(0.4), random.rotation());
                let turned = |q: Matrix| law.energy(&if L::OBJECTIVE { f * q } else { q.transpose() * f * q });
                let energy = law.energy(&f);
                if rest.fibre_stiffness == 0.0 {
                    assert_close(turned(q), energy, 1e-13, L::NAME);
                } else {
                    assert_close(turned(turn_about(rest.direction, random.signed() * 3.0)), energy, 1e-12, L::NAME);
                    let half_turn =
                        turn_about(rest.direction.cross(random.vector()).normalized().unwrap(), std::f64::consts::PI);
                    assert_close(turned(half_turn), energy, 1e-12, L::NAME);
                    assert!((turned(q) - energy).abs() > 1e-6 * energy, "{}: fibres are not felt", L::NAME);
                }
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

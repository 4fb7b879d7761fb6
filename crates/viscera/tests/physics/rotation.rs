//! Rotations in deformation gradients: flat, inverted, null and enormous ones included.

use viscera::math::rotation::{polar, polar_along, qr, svd};
use viscera::math::{Lanes, MAX_LANES, Mat3, Part, Scalar, Simd, Vec3, dispatch, dispatch_level};

use crate::support::{Matrix, Random, Vector, assert_near};

/// Q diag(stretches) Qᵀ for a random rotation Q: a symmetric stretch.
fn stretch(stretches: [f64; 3], random: &mut Random) -> Matrix {
    let axes = random.rotation();
    let [a, b, c] = axes.columns;
    Mat3::from_columns(a * stretches[0], b * stretches[1], c * stretches[2]) * axes.transpose()
}

/// Deformation gradients of every kind, from harmless to hopeless.
fn gradients() -> Vec<Matrix> {
    let mut random = Random::new(201);
    let mut all = vec![Mat3::ZERO, Mat3::IDENTITY, -Mat3::IDENTITY, Mat3::diagonal(1e-40), Mat3::diagonal(-3.0)];
    for stretches in [
        [1.0, 1.0, 1e-9],
        [1.0, 1.0, 0.0],
        [1.0, 1.0, -1.0],
        [2.0, 0.5, -0.5],
        [1.0, 1e-3, -1e-3],
        [1.0, 1e-12, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, -1.0, -1.0],
        [1e3, 1.0, 1e-3],
        [1.0, 0.6, -0.2],
    ] {
        for size in [1.0, 1e-7, 1e15, 1e-18] {
            let turn = random.rotation();
            all.push(turn * stretch(stretches, &mut random) * size);
        }
    }
    for axis in 0..3 {
        let mut unit = Vector::ZERO;
        unit[axis] = 1.0;
        all.extend([0, 1, 2].map(|column| {
            let mut single = Mat3::ZERO;
            single.columns[column] = unit;
            single
        }));
    }
    for _ in 0..200 {
        all.push(random.matrix());
        all.push(random.deformation(0.4));
    }
    all
}

fn rotations<T: Scalar>(f: &Mat3<T>) -> [(&'static str, Mat3<T>); 3] {
    [("polar", polar(f)), ("svd", svd(f).rotation()), ("qr", qr(f))]
}

/// RᵀR = I and det R = +1 to rounding, in both precisions, up to the largest numbers there are.
fn every_extraction_gives_a_rotation<T: Scalar>(huge: f64) {
    let mut all = gradients();
    all.extend([Mat3::diagonal(huge), Random::new(202).matrix() * huge, Mat3::diagonal(1.0 / huge)]);
    for f in all {
        let f: Mat3<T> = f.cast();
        for (name, r) in rotations(&f) {
            let r: Matrix = r.cast();
            let off = (r.transpose() * r - Mat3::IDENTITY).squared_norm().sqrt();
            let bound = 16.0 * T::EPSILON.to_f64();
            assert!(off <= bound, "{name}: off by {off:e} for {f:?}");
            assert!((r.determinant() - 1.0).abs() <= bound, "{name}: mirrors {f:?}");
        }
    }
}

#[test]
fn every_extraction_gives_a_rotation_in_double_precision() {
    every_extraction_gives_a_rotation::<f64>(1e300);
}

#[test]
fn every_extraction_gives_a_rotation_in_single_precision() {
    every_extraction_gives_a_rotation::<f32>(1e38);
}

/// σ2 + σ3 with the sign of det F, over σ1: how well the rotation is defined.
fn gap(f: &Matrix) -> f64 {
    let values = svd(f).values;
    (values.y + values.z) / values.x
}

/// F = R S gives R back; where S inverts, along its smallest stretch.
#[test]
fn polar_finds_the_rotation_that_was_put_in() {
    let mut random = Random::new(203);
    for stretches in [[1.0, 1.0, 1.0], [1.4, 1.0, 0.7], [1.2, 0.9, 1e-6], [1.3, 1.0, -0.4], [1.0, 1.0, -0.95]] {
        for _ in 0..20 {
            let r = random.rotation();
            let f = r * stretch(stretches, &mut random);
            let tolerance = 4e-15 / gap(&f);
            assert_near(&polar(&f).columns, &r.columns, tolerance, format!("polar of {stretches:?}"));
            assert_near(&svd(&f).rotation().columns, &r.columns, tolerance, format!("svd of {stretches:?}"));
        }
    }
}

/// The closed form and Jacobi's sweeps share no line. What a rounding of F may turn is ε over the gap.
#[test]
fn the_fast_rotation_equals_the_reference() {
    for f in gradients() {
        let gap = gap(&f);
        if gap > 1e-10 {
            assert_near(&polar(&f).columns, &svd(&f).rotation().columns, 1e-14 / gap, format!("{f:?}, gap {gap:e}"));
        }
        let single: Mat3<f32> = f.cast();
        let gap = crate::rotation::gap(&single.cast());
        if gap > 1e-3 {
            let reference = svd(&single.cast::<f64>()).rotation();
            assert_near(&polar(&single).columns, &reference.columns, 3e-6 / gap, format!("{single:?}, gap {gap:e}"));
        }
    }
}

/// F = U Σ Vᵀ with falling sizes, and the sign of det F on the smallest.
#[test]
fn singular_values_rebuild_the_matrix_and_carry_its_sign() {
    for f in gradients() {
        let svd = svd(&f);
        let [a, b, c] = svd.left.columns;
        let values = svd.values;
        let again = Mat3::from_columns(a * values.x, b * values.y, c * values.z) * svd.right.transpose();
        let error = (again - f).squared_norm().sqrt();
        assert!(error <= 1e-14 * values.x.max(1e-30), "{f:?}: off by {error:e}");
        let slack = 1e-14 * values.x;
        assert!(values.x >= values.y - slack && values.y >= values.z.abs() - slack && values.y >= 0.0, "{values:?}");
        let volume = f.determinant();
        if volume.abs() > 1e-12 * values.x.powi(3) {
            assert_eq!(values.z > 0.0, volume > 0.0, "{f:?}");
        }
        assert!((svd.right.determinant() - 1.0).abs() <= 1e-14);
    }
}

/// RᵀF is upper triangular with a positive diagonal but for its last entry, which carries the sign of det F.
#[test]
fn qr_leaves_an_upper_triangle() {
    let mut random = Random::new(204);
    for _ in 0..100 {
        let f = random.matrix();
        let triangle = qr(&f).transpose() * f;
        let [a, b, c] = triangle.columns;
        assert!(a.y.abs().max(a.z.abs()).max(b.z.abs()) <= 1e-15, "{triangle:?}");
        assert!(a.x > 0.0 && b.y > 0.0 && (c.z > 0.0) == (f.determinant() > 0.0));
    }
}

/// Five points: the error is h⁴ over the fifth power of the gap.
#[test]
fn the_derivative_of_polar_is_that_of_finite_differences() {
    let mut random = Random::new(205);
    for _ in 0..50 {
        let turn = random.rotation();
        for stretches in [[1.0, 1.0, 1.0], [1.5, 1.0, 0.6], [1.2, 1.0, -0.3]] {
            let f = turn * stretch(stretches, &mut random);
            let df = random.matrix();
            let h = 1e-3;
            let at = |s: f64| polar(&(f + df * (s * h)));
            let slope = ((at(1.0) - at(-1.0)) * 8.0 - (at(2.0) - at(-2.0))) * (1.0 / (12.0 * h));
            assert_near(&polar_along(&f, &polar(&f), &df).columns, &slope.columns, 1e-7, format!("{stretches:?}"));
        }
    }
    let nowhere = polar_along(&Mat3::ZERO, &Mat3::IDENTITY, &random.matrix());
    assert_eq!(nowhere, Mat3::ZERO, "a null F has no rotation to change");
}

/// It does not feel the size of F, down to where F counts as nothing; below, at 1e-107, third powers of F vanish, and with them what told
/// the one from the other.
#[test]
fn the_derivative_of_polar_is_a_number_for_every_size() {
    let mut random = Random::new(206);
    let (f, df) = (random.matrix(), random.matrix());
    let wanted = polar_along(&f, &polar(&f), &df);
    for power in -320..=100 {
        let size = 10f64.powi(power);
        let (f, df) = (f * size, df * size);
        let found = polar_along(&f, &polar(&f), &df);
        let expected = if power < -31 { Mat3::ZERO } else { wanted };
        assert!(
            power == -31 || (found - expected).squared_norm() <= 1e-24 * wanted.squared_norm(),
            "1e{power}: {found:?}"
        );
    }
}

/// One lane does not feel its neighbours, the hopeless among them.
fn lanes_agree_with_scalars<T: Scalar>() {
    let all: Vec<Mat3<T>> = gradients().iter().map(|f| f.cast()).collect();
    for batch in all.chunks_exact(T::LANES) {
        let columns = |i: usize| batch.iter().map(|f| f.columns[i / 3][i % 3]).collect::<Vec<_>>();
        let numbers: [Vec<T>; 9] = std::array::from_fn(columns);
        let mut out = [[T::ZERO; MAX_LANES]; 27];
        dispatch!(dispatch_level(), simd => {
            for part in Part::all::<T>(simd) {
                rotate_batch(part, &numbers, &mut out);
            }
        });
        for (lane, f) in batch.iter().enumerate() {
            for (method, (name, expected)) in rotations(f).into_iter().enumerate() {
                let number = |i: usize| out[9 * method + i][lane];
                let column = |i: usize| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
                let actual = [column(0), column(1), column(2)];
                let [a, b, _] = f.cast::<f64>().columns;
                let angle = a.cross(b).norm() / (a.norm() * b.norm()).max(1e-300);
                let gap = if name == "qr" { angle } else { gap(&f.cast()) };
                if gap > 1e3 * T::EPSILON.to_f64() {
                    assert_near(
                        &actual,
                        &expected.columns,
                        64.0 * T::EPSILON.to_f64() / gap,
                        format!("{name} of {f:?}"),
                    );
                }
            }
        }
    }
}

#[inline(always)]
fn rotate_batch<T: Scalar, S: Simd>(part: Part<S>, numbers: &[Vec<T>; 9], out: &mut [[T; MAX_LANES]; 27]) {
    let column = |i: usize| {
        Vec3::new(
            T::Lanes::<S>::load(part, &numbers[3 * i]),
            T::Lanes::<S>::load(part, &numbers[3 * i + 1]),
            T::Lanes::<S>::load(part, &numbers[3 * i + 2]),
        )
    };
    let f = Mat3::from_columns(column(0), column(1), column(2));
    for (method, r) in [polar(&f), svd(&f).rotation(), qr(&f)].into_iter().enumerate() {
        for i in 0..9 {
            r.columns[i / 3][i % 3].store(part, &mut out[9 * method + i]);
        }
    }
}

#[test]
fn lanes_of_doubles_agree_with_doubles() {
    lanes_agree_with_scalars::<f64>();
}

#[test]
fn lanes_of_singles_agree_with_singles() {
    lanes_agree_with_scalars::<f32>();
}

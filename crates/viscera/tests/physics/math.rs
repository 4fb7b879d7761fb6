//! Small matrices, lanes and dual numbers: identities that hold for any numbers.

use viscera::math::{Dual, Lanes, Part, Real, Scalar, Simd, Sym3, dispatch, dispatch_level};

use crate::support::{Matrix, Random, Vector, assert_near};

#[test]
fn cross_product_is_normal_to_both_and_as_long_as_the_area() {
    let mut random = Random::new(111);
    assert_eq!(Vector::new(1.0, 0.0, 0.0).cross(Vector::new(0.0, 1.0, 0.0)), Vector::new(0.0, 0.0, 1.0));
    for _ in 0..20 {
        let (a, b) = (random.vector(), random.vector());
        let c = a.cross(b);
        assert!(c.dot(a).abs() <= 1e-15 && c.dot(b).abs() <= 1e-15);
        let area = a.squared_norm() * b.squared_norm() - a.dot(b).powi(2);
        assert!((c.squared_norm() - area).abs() <= 1e-14);
    }
}

/// A A⁻¹ = I, cof A = det A · A⁻ᵀ, and rank one leaves cof A = 0.
#[test]
fn inverse_and_cofactor_fit_the_determinant() {
    let mut random = Random::new(112);
    for _ in 0..20 {
        let a = random.deformation(0.5);
        assert_near(&(a * a.inverse()).columns, &Matrix::IDENTITY.columns, 1e-13, "inverse");
        let cofactor = a.inverse().transpose() * a.determinant();
        assert_near(&a.cofactor().columns, &cofactor.columns, 1e-13, "cofactor");
        let (u, v) = (random.vector(), random.vector());
        assert!(u.outer(v).cofactor().squared_norm() <= 1e-30);
        assert_near(&[u.outer(v) * a.columns[0]], &[u * v.dot(a.columns[0])], 1e-14, "outer product");
    }
}

#[test]
fn symmetric_products_equal_those_of_full_matrices() {
    let mut random = Random::new(113);
    for _ in 0..20 {
        let (a, b) = (random.matrix(), random.matrix());
        let (s, t) = (a.symmetric_part(), b.symmetric_part());
        let (full_s, full_t) = (Matrix::from(s), Matrix::from(t));
        assert_near(&Matrix::from(s.sandwich(t)).columns, &(full_s * full_t * full_s).columns, 1e-14, "sandwich");
        assert_near(&(a * t).columns, &(a * full_t).columns, 1e-14, "matrix times symmetric");
        assert_near(&Matrix::from(a.gram()).columns, &(a.transpose() * a).columns, 1e-14, "gram");
        assert!((s.contract(t) - full_s.contract(full_t)).abs() <= 1e-14);
        let v = random.vector();
        assert_near(&Matrix::from(Sym3::square(v)).columns, &v.outer(v).columns, 1e-14, "square");
        assert!((s.quadratic(v) - v.dot(full_s * v)).abs() <= 1e-14);
    }
}

/// Each operation of a dual number against five points of the plain one.
#[test]
fn dual_numbers_differentiate_every_operation() {
    let check = |name: &str, dual: Dual<f64>, plain: &dyn Fn(f64) -> f64, at: f64| {
        let h = 1e-3;
        let slope = (8.0 * (plain(at + h) - plain(at - h)) - (plain(at + 2.0 * h) - plain(at - 2.0 * h))) / (12.0 * h);
        assert!((dual.value - plain(at)).abs() <= 1e-15 * plain(at).abs().max(1.0), "{name}");
        assert!(
            (dual.derivative - slope).abs() <= 1e-9 * slope.abs().max(1.0),
            "{name}: {} not {slope}",
            dual.derivative
        );
    };
    for at in [0.3, 0.9, 1.7] {
        let x = Dual::new(at, 1.0);
        let three = x.like(3.0);
        check("add", x + three, &|x| x + 3.0, at);
        check("subtract", three - x * x, &|x| 3.0 - x * x, at);
        check("divide", three / x, &|x| 3.0 / x, at);
        check("quotient", x / (x + three), &|x| x / (x + 3.0), at);
        check("negate", -x, &|x| -x, at);
        check("square root", (x * x + three).sqrt(), &|x| (x * x + 3.0).sqrt(), at);
        check("logarithm", (x * x).ln(), &|x| (x * x).ln(), at);
        check("multiply and add", x.mul_add(x, three * x), &|x| x * x + 3.0 * x, at);
        check("absolute value", (x - three).abs(), &|x| (x - 3.0).abs(), at);
        check("smaller", (x * x).min(three), &|x| (x * x).min(3.0), at);
        check("larger", (x * x).max(x.half()), &|x| (x * x).max(0.5 * x), at);
        let mut sum = three;
        sum += x.squared();
        sum -= x.double();
        check("assign", sum, &|x| 3.0 + x * x - 2.0 * x, at);
    }
}

#[inline(always)]
fn round_trip<S: Simd, T: Scalar>(simd: S, rows: &[[T; 4]], nodes: &[u32], [at_once, by_halves]: [&mut [[T; 4]]; 2]) {
    for part in Part::all::<T>(simd) {
        let [x, y, z, _] = T::Lanes::<S>::gather(simd, rows, part.of::<T, T::Lanes<S>, _>(nodes));
        let mut columns = [vec![T::ZERO; T::LANES], vec![T::ZERO; T::LANES], vec![T::ZERO; T::LANES]];
        [x, y, z].into_iter().zip(&mut columns).for_each(|(lanes, column)| lanes.store(part, column));
        T::Lanes::<S>::scatter_add([x, y, z], part.of::<T, T::Lanes<S>, _>(nodes), at_once);
        for half in part.halves::<T>() {
            let columns = columns.each_ref().map(|column| T::Half::<S>::load(half, column));
            T::Half::<S>::scatter_add(columns, half.of::<T, T::Half<S>, _>(nodes), by_halves);
        }
    }
}

/// Lanes that name the same node all arrive: a batch may hold neighbours. The fourth number is nobody's to touch.
fn duplicates_add_up<T: Scalar>() {
    let number = |i: usize| T::from_f64((i as f64).sin());
    let rows: Vec<[T; 4]> = (0..6).map(|row| std::array::from_fn(|column| number(4 * row + column))).collect();
    let nodes = [5, 2, 2, 0, 2, 5, 3, 3, 1, 1, 4, 5, 5, 0, 2, 4];
    for level in crate::law_lanes::levels() {
        let (mut at_once, mut by_halves) = (vec![[T::ZERO; 4]; 6], vec![[T::ZERO; 4]; 6]);
        dispatch!(level, simd => round_trip(simd, &rows, &nodes, [&mut at_once, &mut by_halves]));
        let mut expected = vec![[T::ZERO; 4]; 6];
        for &node in &nodes[..T::LANES] {
            (0..3).for_each(|column| expected[node as usize][column] += rows[node as usize][column]);
        }
        assert_eq!(at_once, expected, "{} at {level:?}", T::NAME);
        assert_eq!(by_halves, expected, "{} by halves at {level:?}", T::NAME);
    }
}

#[test]
fn gather_and_scatter_add_lanes_that_share_a_node() {
    duplicates_add_up::<f32>();
    duplicates_add_up::<f64>();
}

#[inline(always)]
fn lane_operations<S: Simd>(part: Part<S>, a: &[f64], b: &[f64], out: &mut [[f64; 8]; 6]) {
    type Lane<S> = <f64 as Scalar>::Lanes<S>;
    let (a, b) = (Lane::<S>::load(part, a), Lane::<S>::load(part, b));
    let smaller = Lane::<S>::select(a.less_than(b), a, b);
    let results = [a.abs().sqrt(), a.min(b), a.max(b), a.abs().ln(), smaller, a.like(7.0)];
    results.into_iter().zip(out).for_each(|(lanes, out)| lanes.store(part, out));
}

#[test]
fn lanes_do_what_scalars_do() {
    let (a, b) = ([1.5, -2.0, 0.25, 8.0, 3.0, -0.5, 6.0, -7.0], [2.0, -3.0, 0.5, -8.0, 1.0, 1.0, -1.0, 4.0]);
    let mut out = [[0.0; 8]; 6];
    dispatch!(dispatch_level(), simd => {
        for part in Part::all::<f64>(simd) {
            lane_operations(part, &a, &b, &mut out);
        }
    });
    let [root, smaller, larger, logarithm, selected, seven] = out;
    for lane in 0..8 {
        assert_eq!(root[lane], a[lane].abs().sqrt());
        assert_eq!(smaller[lane], f64::min(a[lane], b[lane]));
        assert_eq!(larger[lane], f64::max(a[lane], b[lane]));
        assert_eq!(logarithm[lane], a[lane].abs().ln());
        assert_eq!(selected[lane], smaller[lane]);
        assert_eq!(seven[lane], 7.0);
    }
}

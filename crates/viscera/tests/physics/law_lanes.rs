//! One text, many numbers: a law gives the same in scalars, in lanes of every instruction set here, and in single precision.

use viscera::material::{Law, LawFamily, LawKind, LawVisitor};
use viscera::math::{Lanes, Level, Mat3, Part, Scalar, Simd, Vec3, dispatch, dispatch_level};

use crate::support::{Random, assert_near};

/// Every instruction set of this processor, the poorest first.
pub(crate) fn levels() -> Vec<Level> {
    let best = dispatch_level();
    let mut levels = vec![Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(Level::Sse2));
        levels.extend(best.as_sse4_2().map(Level::Sse4_2));
        levels.extend(best.as_avx2().map(Level::Avx2));
        levels.extend(best.as_avx512().map(Level::Avx512));
    }
    levels.push(best);
    levels
}

type Stresses<T> = (Vec<T>, Vec<Mat3<T>>, Vec<Mat3<T>>);

/// Energy, stress and tangent of a block, lane by lane.
#[inline(always)]
fn in_lanes<S: Simd, T: Scalar, L: LawFamily>(simd: S, values: &[T], f: &[Mat3<T>], df: &[Mat3<T>]) -> Stresses<T> {
    let values: Vec<T::Lanes<S>> = values.iter().map(|&value| T::Lanes::<S>::splat(simd, value)).collect();
    let law = L::at(&values);
    let mut energy = vec![T::ZERO; T::LANES];
    let (mut stress, mut tangent) = (vec![Mat3::ZERO; T::LANES], vec![Mat3::ZERO; T::LANES]);
    for part in Part::all::<T>(simd) {
        let (f, df) = (pack::<S, T>(part, f), pack::<S, T>(part, df));
        law.energy(&f).store(part, &mut energy);
        unpack::<S, T>(part, law.stress(&f), &mut stress);
        unpack::<S, T>(part, law.tangent(&f, &df), &mut tangent);
    }
    (energy, stress, tangent)
}

fn pack<S: Simd, T: Scalar>(part: Part<S>, matrices: &[Mat3<T>]) -> Mat3<T::Lanes<S>> {
    let entry = |column: usize, row: usize| {
        let lanes: Vec<T> = matrices.iter().map(|matrix| matrix.columns[column][row]).collect();
        T::Lanes::<S>::load(part, &lanes)
    };
    let column = |i: usize| Vec3::new(entry(i, 0), entry(i, 1), entry(i, 2));
    Mat3::from_columns(column(0), column(1), column(2))
}

fn unpack<S: Simd, T: Scalar>(part: Part<S>, matrix: Mat3<T::Lanes<S>>, matrices: &mut [Mat3<T>]) {
    for column in 0..3 {
        for row in 0..3 {
            let mut lanes: Vec<T> = matrices.iter().map(|matrix| matrix.columns[column][row]).collect();
            matrix.columns[column][row].store(part, &mut lanes);
            matrices.iter_mut().zip(lanes).for_each(|(matrix, value)| matrix.columns[column][row] = value);
        }
    }
}

/// Lanes may fuse multiplications and additions, so they equal scalars to a few roundings only.
fn lanes_equal_scalars<T: Scalar>() {
    struct Check<T>(std::marker::PhantomData<T>);
    impl<T: Scalar> LawVisitor for Check<T> {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let mut random = Random::new(31);
            let values: Vec<T> = L::example().values().into_iter().map(T::from_f64).collect();
            let f: Vec<Mat3<T>> = (0..T::LANES).map(|_| random.deformation(0.5).cast()).collect();
            let df: Vec<Mat3<T>> = (0..T::LANES).map(|_| random.matrix().cast()).collect();
            let scalar = L::at::<T>(&values);
            let tolerance = 64.0 * T::EPSILON.to_f64();
            for level in levels() {
                let (energy, stress, tangent) = dispatch!(level, simd => in_lanes::<_, T, L>(simd, &values, &f, &df));
                for lane in 0..T::LANES {
                    let what = format!("{} over {} at {level:?}, lane {lane}", L::NAME, T::NAME);
                    let expected = scalar.energy(&f[lane]).to_f64();
                    assert!((energy[lane].to_f64() - expected).abs() <= tolerance * expected, "{what}");
                    assert_near(&stress[lane].columns, &scalar.stress(&f[lane]).columns, tolerance, &what);
                    assert_near(&tangent[lane].columns, &scalar.tangent(&f[lane], &df[lane]).columns, tolerance, &what);
                }
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check::<T>(std::marker::PhantomData)));
}

#[test]
fn lanes_of_every_instruction_set_equal_scalars_in_double_precision() {
    lanes_equal_scalars::<f64>();
}

#[test]
fn lanes_of_every_instruction_set_equal_scalars_in_single_precision() {
    lanes_equal_scalars::<f32>();
}

/// At strains near one half a law loses a few of the 24 bits and no more.
#[test]
fn single_precision_agrees_with_double() {
    struct Check;
    impl LawVisitor for Check {
        type Output = ();
        fn visit<L: LawFamily>(self) {
            let (law, mut random) = (L::example(), Random::new(32));
            let values: Vec<f32> = law.values().into_iter().map(|value| value as f32).collect();
            let single = L::at::<f32>(&values);
            for _ in 0..20 {
                // the same F in both: its own rounding is not the law's
                let (f, df) = (random.deformation(0.5).cast::<f32>(), random.matrix().cast::<f32>());
                let (exact_f, exact_df) = (f.cast::<f64>(), df.cast::<f64>());
                let tolerance = 32.0 * f64::from(f32::EPSILON);
                assert_near(&single.stress(&f).columns, &law.stress(&exact_f).columns, tolerance, L::NAME);
                let tangent = law.tangent(&exact_f, &exact_df);
                assert_near(&single.tangent(&f, &df).columns, &tangent.columns, tolerance, L::NAME);
                let energy = law.energy(&exact_f);
                assert!((f64::from(single.energy(&f)) - energy).abs() <= tolerance * energy, "{}", L::NAME);
            }
        }
    }
    LawKind::ALL.iter().for_each(|kind| kind.visit(Check));
}

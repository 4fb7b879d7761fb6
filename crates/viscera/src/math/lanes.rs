use std::cell::Cell;
use std::cmp::PartialOrd;
use std::fmt::{Display, LowerExp};
use std::sync::OnceLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x8, f64x4};

use super::Real;
use super::rows::{add_doubles, add_singles, gather_doubles, gather_singles};

/// A floating-point number that a world can be simulated in: `f32` for play, `f64` for statics and validation.
pub trait Scalar: Real<Mask = bool> + PartialOrd + Default + Display + LowerExp + 'static {
    /// A batch of [`Scalar::LANES`] values in one or more SIMD registers.
    type Lanes<S: Simd>: Lanes<Self, S>;

    /// How many values a batch holds; the layout of element tables depends on it.
    const LANES: usize;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// `"f32"` or `"f64"`.
    const NAME: &'static str;

    /// The nearest number.
    fn from_f64(value: f64) -> Self;
    /// The same number in double precision.
    fn to_f64(self) -> f64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

/// SIMD lanes of the scalar `T`, for the instruction set that the token `S` stands for.
pub trait Lanes<T: Scalar, S: Simd>: Real {
    /// Reads the first [`Scalar::LANES`] values.
    fn load(simd: S, values: &[T]) -> Self;
    /// Writes the first [`Scalar::LANES`] values.
    fn store(self, values: &mut [T]);
    /// The same value in every lane.
    fn splat(simd: S, value: T) -> Self;
    /// Reads four numbers per lane, lane `i` from `rows[nodes[i]]`, and gives them column by column.
    ///
    /// Rows are loaded whole and transposed in registers: eight single loads into an array, read back as one vector,
    /// stall on store forwarding (three times slower, measured).
    fn gather(simd: S, rows: &[[T; 4]], nodes: &[u32]) -> [Self; 4];
    /// Adds three numbers per lane, lane `i` to the first three of `rows[nodes[i]]`, lane after lane: lanes may name the
    /// same row.
    fn scatter_add(columns: [Self; 3], nodes: &[u32], rows: &mut [[T; 4]]);
}

macro_rules! impl_lanes {
    ($scalar:ty, $lanes:ident, $count:expr, $name:expr, $gather:path, $scatter_add:path) => {
        impl Scalar for $scalar {
            type Lanes<S: Simd> = $lanes<S>;

            const LANES: usize = $count;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPSILON: Self = <$scalar>::EPSILON;
            const NAME: &'static str = $name;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $scalar
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$scalar>::is_finite(self)
            }
        }

        impl<S: Simd> Lanes<$scalar, S> for $lanes<S> {
            #[inline(always)]
            fn load(simd: S, values: &[$scalar]) -> Self {
                Self::from_slice(simd, &values[..$count])
            }
            #[inline(always)]
            fn store(self, values: &mut [$scalar]) {
                self.store_slice(&mut values[..$count]);
            }
            #[inline(always)]
            fn splat(simd: S, value: $scalar) -> Self {
                SimdBase::splat(simd, value)
            }
            #[inline(always)]
            fn gather(simd: S, rows: &[[$scalar; 4]], nodes: &[u32]) -> [Self; 4] {
                $gather(simd, rows, nodes)
            }
            #[inline(always)]
            fn scatter_add(columns: [Self; 3], nodes: &[u32], rows: &mut [[$scalar; 4]]) {
                $scatter_add(columns, nodes, rows);
            }
        }

        impl<S: Simd> Real for $lanes<S> {
            type Mask = <$lanes<S> as SimdBase<S>>::Mask;

            const ROUNDING: f64 = <$scalar>::EPSILON as f64;

            #[inline(always)]
            fn like(self, value: f64) -> Self {
                SimdBase::splat(self.token(), value as $scalar)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                SimdFloat::mul_add(self, factor, addend)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                SimdBase::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                SimdBase::max(self, other)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                let mut values = [0.0; $count];
                self.store_slice(&mut values);
                Self::from_slice(self.token(), &values.map(<$scalar>::ln))
            }
            #[inline(always)]
            fn cbrt(self) -> Self {
                let mut values = [0.0; $count];
                self.store_slice(&mut values);
                Self::from_slice(self.token(), &values.map(<$scalar>::cbrt))
            }
            #[inline(always)]
            fn less_than(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                mask.select(if_true, if_false)
            }
            #[inline(always)]
            fn any(mask: Self::Mask) -> bool {
                mask.any_true()
            }
            #[inline(always)]
            fn all(mask: Self::Mask) -> bool {
                mask.all_true()
            }
        }
    };
}

impl_lanes!(f32, f32x8, 8, "f32", gather_singles, add_singles);
impl_lanes!(f64, f64x4, 4, "f64", gather_doubles, add_doubles);

thread_local! {
    static ASKED: Cell<Option<Level>> = const { Cell::new(None) };
}

/// The instruction set of the kernels: the best that the processor has on which the program runs, found once.
pub fn dispatch_level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    ASKED.get().unwrap_or_else(|| *LEVEL.get_or_init(Level::new))
}

/// Does `work` with the kernels of another instruction set, on this thread alone, to hold them against each other.
pub fn with_level<R>(level: Level, work: impl FnOnce() -> R) -> R {
    struct PutBack(Option<Level>);
    impl Drop for PutBack {
        fn drop(&mut self) {
            ASKED.set(self.0);
        }
    }
    let _put_back = PutBack(ASKED.replace(Some(level)));
    work()
}

/// The instruction set that every processor of the target has, for kernels that are not worth compiling for each set there is:
/// tangents that are assembled, once for many products.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) fn baseline() -> impl Simd {
    Level::baseline().as_sse2().expect("SSE2 is part of the target")
}

/// The same for ARM.
#[cfg(target_arch = "aarch64")]
pub(crate) fn baseline() -> impl Simd {
    Level::baseline().as_neon().expect("NEON is part of the target")
}

/// The same for WebAssembly.
#[cfg(target_arch = "wasm32")]
pub(crate) fn baseline() -> impl Simd {
    Level::baseline().as_wasm_simd128().expect("simd128 is part of the target")
}

/// The widest batch of any scalar.
pub const MAX_LANES: usize = 8;

use std::cell::Cell;
use std::cmp::PartialOrd;
use std::fmt::{Display, LowerExp};
use std::sync::OnceLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f32x4, f32x8, f64x4};

use super::Real;

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

/// Transposes a 4×4 block that lies in four vectors of four lanes.
#[inline(always)]
fn transpose<S: Simd, V: SimdBase<S>>([a, b, c, d]: [V; 4]) -> [V; 4] {
    let (ac_low, bd_low) = (a.zip_low(c), b.zip_low(d));
    let (ac_high, bd_high) = (a.zip_high(c), b.zip_high(d));
    [ac_low.zip_low(bd_low), ac_low.zip_high(bd_low), ac_high.zip_low(bd_high), ac_high.zip_high(bd_high)]
}

/// Loads four rows and gives their columns.
#[inline(always)]
fn gather_four<T: Copy, S: Simd, V: SimdBase<S, Element = T>>(simd: S, rows: &[[T; 4]], nodes: &[u32]) -> [V; 4] {
    let row = |lane: usize| V::from_slice(simd, &rows[nodes[lane] as usize]);
    transpose([row(0), row(1), row(2), row(3)])
}

/// Adds the transpose of four columns to four rows, row after row.
#[inline(always)]
fn scatter_add_four<T: Copy, S: Simd, V>(columns: [V; 4], nodes: &[u32], simd: S, rows: &mut [[T; 4]])
where
    V: SimdBase<S, Element = T> + std::ops::Add<Output = V>,
{
    let added = transpose(columns);
    for lane in 0..4 {
        let row = &mut rows[nodes[lane] as usize];
        (V::from_slice(simd, row) + added[lane]).store_slice(row);
    }
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
        }
    };
}

impl_lanes!(f32, f32x8, 8, "f32", gather_eight_singles, scatter_add_eight_singles);
impl_lanes!(f64, f64x4, 4, "f64", gather_four, scatter_add_four_doubles);

#[inline(always)]
fn gather_eight_singles<S: Simd>(simd: S, rows: &[[f32; 4]], nodes: &[u32]) -> [f32x8<S>; 4] {
    let (a, b) = (two_rows(simd, rows, &nodes[..2]), two_rows(simd, rows, &nodes[2..4]));
    let (c, d) = (two_rows(simd, rows, &nodes[4..6]), two_rows(simd, rows, &nodes[6..8]));
    let (xz_low, yw_low) = (a.unzip_low(b), a.unzip_high(b));
    let (xz_high, yw_high) = (c.unzip_low(d), c.unzip_high(d));
    [xz_low.unzip_low(xz_high), yw_low.unzip_low(yw_high), xz_low.unzip_high(xz_high), yw_low.unzip_high(yw_high)]
}

/// Two rows, one after the other.
#[inline(always)]
fn two_rows<S: Simd>(simd: S, rows: &[[f32; 4]], nodes: &[u32]) -> f32x8<S> {
    let first = f32x4::from_slice(simd, &rows[nodes[0] as usize]);
    first.combine(f32x4::from_slice(simd, &rows[nodes[1] as usize]))
}

#[inline(always)]
fn scatter_add_eight_singles<S: Simd>([x, y, z]: [f32x8<S>; 3], nodes: &[u32], rows: &mut [[f32; 4]]) {
    let zero: f32x8<S> = SimdBase::splat(x.token(), 0.0);
    let (xz_low, xz_high) = (x.zip_low(z), x.zip_high(z));
    let (y_low, y_high) = (y.zip_low(zero), y.zip_high(zero));
    add_two_rows(xz_low.zip_low(y_low), &nodes[..2], rows);
    add_two_rows(xz_low.zip_high(y_low), &nodes[2..4], rows);
    add_two_rows(xz_high.zip_low(y_high), &nodes[4..6], rows);
    add_two_rows(xz_high.zip_high(y_high), &nodes[6..8], rows);
}

/// Adds to two rows, one after the other: they may be the same.
#[inline(always)]
fn add_two_rows<S: Simd>(added: f32x8<S>, nodes: &[u32], rows: &mut [[f32; 4]]) {
    let (first, second) = added.split();
    let row = &mut rows[nodes[0] as usize];
    (f32x4::from_slice(first.token(), row) + first).store_slice(row);
    let row = &mut rows[nodes[1] as usize];
    (f32x4::from_slice(second.token(), row) + second).store_slice(row);
}

#[inline(always)]
fn scatter_add_four_doubles<S: Simd>([x, y, z]: [f64x4<S>; 3], nodes: &[u32], rows: &mut [[f64; 4]]) {
    let simd = x.token();
    scatter_add_four([x, y, z, SimdBase::splat(simd, 0.0)], &nodes[..4], simd, rows);
}

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

//! Which instruction set kernels run with, and how they are compiled for each.

use std::cell::Cell;
use std::sync::OnceLock;

pub use fearless_simd::Level;

pub use super::super::dispatch;
use super::Simd;

/// Does `$op` with kernels of the instruction set of `$level`, compiled once for each of those named here.
///
/// That of the crate hides which one it is, and with it how wide a batch is; and it compiles SSE4.2 as well, which nothing gains from.
#[macro_export]
#[doc(hidden)]
macro_rules! dispatch {
    ($level:expr, $simd:pat => $op:expr) => {{
        use $crate::math::Level;
        match $level {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(token) => $crate::math::dispatch!(@with token, $simd => $op),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(token) => $crate::math::dispatch!(@with token, $simd => $op),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            level => {
                let token = level.as_sse2().expect("SSE2 is part of the target");
                $crate::math::dispatch!(@with token, $simd => $op)
            }
            #[cfg(target_arch = "aarch64")]
            level => {
                let token = level.as_neon().expect("NEON is part of the target");
                $crate::math::dispatch!(@with token, $simd => $op)
            }
            #[cfg(target_arch = "wasm32")]
            level => {
                let token = level.as_wasm_simd128().expect("simd128 is part of the target");
                $crate::math::dispatch!(@with token, $simd => $op)
            }
        }
    }};
    (@with $token:ident, $simd:pat => $op:expr) => {{
        let $simd = $token;
        $crate::math::vectorize($token, #[inline(always)] || $op)
    }};
}

/// Does `work` with the instructions of `simd`.
#[inline(always)]
pub fn vectorize<S: Simd, R>(simd: S, work: impl FnOnce() -> R) -> R {
    fearless_simd::Simd::vectorize(simd, work)
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

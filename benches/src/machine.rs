use std::hint::black_box;
use std::time::Instant;

use viscera::math::{Lanes, MAX_LANES, Part, Real, Scalar, Simd, dispatch, dispatch_level};

/// What one thread of this machine can do at best.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    /// Fused multiply-adds in single precision [FLOP/s], two operations each.
    pub flops_f32: f64,
    /// The same in double precision.
    pub flops_f64: f64,
    /// Bytes read in order from an array far larger than the caches [B/s].
    pub bandwidth: f64,
}

/// The instruction set that kernels are run with, in lower case.
pub fn instruction_set() -> String {
    format!("{:?}", dispatch_level()).split(['(', ' ', '{']).next().unwrap_or_default().to_lowercase()
}

impl Machine {
    /// Measures it: about two seconds, as shared machines are slow for tenths of one, and a peak that is too low makes shares too high.
    pub fn measure() -> Self {
        Self { flops_f32: peak::<f32>(), flops_f64: peak::<f64>(), bandwidth: bandwidth() }
    }

    /// The peak in the precision of `T` [FLOP/s].
    pub fn flops<T: Scalar>(&self) -> f64 {
        if T::NAME == f32::NAME { self.flops_f32 } else { self.flops_f64 }
    }
}

/// The best of several runs: whatever else the machine does makes a run only longer.
fn best_of(runs: usize, mut seconds: impl FnMut() -> f64) -> f64 {
    (0..runs).map(|_| seconds()).fold(f64::INFINITY, f64::min)
}

fn seconds_of(work: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    work();
    begin.elapsed().as_secs_f64()
}

/// Chains of multiply-adds that do not wait for one another: latency 4 on 2 ports needs eight, and ten leave room.
const CHAINS: usize = 10;
const ROUNDS: usize = 2_000_000;

fn peak<T: Scalar>() -> f64 {
    let seconds = best_of(100, || seconds_of(|| multiply_and_add::<T>()));
    (2 * CHAINS * ROUNDS * dispatch!(dispatch_level(), simd => lanes_of::<T, _>(simd))) as f64 / seconds
}

/// How many numbers a register holds, or two of them where they are narrow.
fn lanes_of<T: Scalar, S: Simd>(_simd: S) -> usize {
    T::Lanes::<S>::COUNT
}

fn multiply_and_add<T: Scalar>() {
    dispatch!(dispatch_level(), simd => multiply_and_add_with::<T, _>(simd));
}

#[inline(always)]
fn multiply_and_add_with<T: Scalar, S: Simd>(simd: S) {
    let factor = T::Lanes::<S>::splat(simd, T::from_f64(black_box(0.999)));
    let addend = T::Lanes::<S>::splat(simd, T::from_f64(black_box(0.001)));
    let mut chains = [T::Lanes::<S>::splat(simd, T::from_f64(black_box(0.5))); CHAINS];
    for _ in 0..ROUNDS {
        for chain in &mut chains {
            *chain = chain.mul_add(factor, addend);
        }
    }
    let sum = chains.into_iter().reduce(|a, b| a + b).unwrap_or(factor);
    let mut values = [T::ZERO; MAX_LANES];
    sum.store(Part::first(simd), &mut values);
    black_box(values);
}

/// 256 MB: no cache holds them.
const NUMBERS: usize = 32 << 20;

fn bandwidth() -> f64 {
    let numbers = vec![1.0_f64; NUMBERS];
    let seconds = best_of(20, || {
        seconds_of(|| {
            // Eight sums, or the additions would wait for one another.
            let mut sums = [0.0; 8];
            for eight in black_box(&numbers).chunks_exact(8) {
                for (sum, number) in sums.iter_mut().zip(eight) {
                    *sum += number;
                }
            }
            black_box(sums);
        })
    });
    (NUMBERS * size_of::<f64>()) as f64 / seconds
}

#![allow(unsafe_code)]

/// Bytes that a processor fetches at once.
const LINE: usize = 64;

/// Asks for `values` to be fetched from memory: a loop that streams through tables and computes in between waits for each of them otherwise.
/// Nothing where the processor cannot be asked.
#[inline(always)]
pub(crate) fn prefetch<V>(values: &[V]) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let start = values.as_ptr().cast::<i8>();
        for offset in (0..size_of_val(values)).step_by(LINE) {
            // SAFETY: the place lies within `values`, and fetching changes nothing that a program sees.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(offset)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (values, LINE);
}

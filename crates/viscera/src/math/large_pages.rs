#![allow(unsafe_code)]

/// What one of the large pages holds [bytes].
const LARGE: usize = 2 << 20;

/// A vector of `len` times `fill`, on large pages of memory where it is large and the system has them.
///
/// A processor looks up where each page of memory is and remembers some thousand of them; the tables of a million cells have ten times as
/// many of the usual 4 KiB.
pub(crate) fn filled<V: Clone>(len: usize, fill: V) -> Vec<V> {
    let mut values = room_for(len);
    values.resize(len, fill);
    values
}

/// The same for `values` that are there.
pub(crate) fn moved<V>(values: Vec<V>) -> Vec<V> {
    let mut moved = room_for(values.len());
    moved.extend(values);
    moved
}

/// The same, to be filled.
pub(crate) fn room_for<V>(len: usize) -> Vec<V> {
    let size = len * size_of::<V>();
    if size < LARGE / 2 {
        return Vec::with_capacity(len);
    }
    // To the end of the last of them, less what allocators put before a vector.
    let whole = size.next_multiple_of(LARGE) - SMALL;
    let values = Vec::with_capacity(len.max(whole / size_of::<V>()));
    ask_for_large_pages(&values);
    values
}

/// What a page holds of those that memory is usually given in [bytes].
const SMALL: usize = 4 << 10;

/// Has to come before anything is written there: a page that is in use stays what it is.
#[cfg(target_os = "linux")]
fn ask_for_large_pages<V>(values: &Vec<V>) {
    let start = values.as_ptr() as usize / SMALL * SMALL;
    let end = values.as_ptr() as usize + values.capacity() * size_of::<V>();
    // SAFETY: this asks for larger pages and no more, so what lies there keeps its place and its value, the vector's neighbours on its
    // first and last page as well. Where the system does not have them it refuses, and all is as before.
    unsafe { libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn ask_for_large_pages<V>(_: &Vec<V>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_hold_what_they_were_filled_with() {
        for len in [0, 1, 1000, LARGE / 4 - 1, LARGE / 4, LARGE, 3 * LARGE + 17] {
            let values = filled(len, 7_u32);
            assert!(values.len() == len && values.iter().all(|&value| value == 7), "{len}");
        }
        assert_eq!(filled(3 * LARGE, ()).len(), 3 * LARGE);
    }

    /// Where Linux has them at all, it marks memory for which they were asked for with `hg`.
    #[test]
    #[cfg(target_os = "linux")]
    fn large_vectors_lie_where_large_pages_were_asked_for() {
        if !std::path::Path::new("/sys/kernel/mm/transparent_hugepage").exists() {
            return;
        }
        let (large, small) = (filled(8 * LARGE, 1_u8), filled(100, 1_u8));
        assert!(flags_at(large.as_ptr() as usize + 4 * LARGE).contains(" hg"));
        assert!(!flags_at(small.as_ptr() as usize).contains(" hg"));
    }

    /// What the system says of the memory around an address.
    #[cfg(target_os = "linux")]
    fn flags_at(address: usize) -> String {
        let mut is_around = false;
        for line in std::fs::read_to_string("/proc/self/smaps").unwrap().lines() {
            let bounds = line.split_once(' ').and_then(|(range, _)| range.split_once('-'));
            let parsed = bounds.and_then(|(start, end)| {
                Some((usize::from_str_radix(start, 16).ok()?, usize::from_str_radix(end, 16).ok()?))
            });
            if let Some((start, end)) = parsed {
                is_around = (start..end).contains(&address);
            }
            if is_around && let Some(flags) = line.strip_prefix("VmFlags:") {
                return flags.into();
            }
        }
        String::new()
    }
}

//! How much is in a message or a file, found before any of it is kept: a value of one byte takes forty in memory, and one that
//! promises four billion others takes room for some of them.

/// Whether MessagePack has, or says that it has, more than `most` values; lists, maps, keys and what is in them all count. Takes no
/// memory, whatever the bytes say. Those that break off are counted as far as they go.
pub(super) fn has_more_values_than(most: u64, bytes: &[u8]) -> bool {
    let (mut rest, mut seen, mut to_come) = (bytes, 0, 1);
    while to_come > 0 {
        let Some((&marker, after)) = rest.split_first() else { return false };
        let (head, content) = content(marker, after);
        (seen, to_come) = (seen + 1, to_come - 1);
        let skipped = match content {
            Content::Bytes(length) => head + length,
            Content::Values(count) => {
                to_come += count;
                head
            }
        };
        if seen + to_come > most {
            return true;
        }
        rest = usize::try_from(skipped).ok().and_then(|skipped| after.get(skipped..)).unwrap_or_default();
    }
    false
}

/// Whether MessagePack is whole, and lists and maps in it (of which keys and values count) have at most as many values as `widest` says:
/// the outermost the first of them, what is in it the next, and so on; none lies deeper. Takes no memory.
pub(crate) fn fits<const DEEPEST: usize>(widest: &[u64; DEEPEST], bytes: &[u8]) -> bool {
    // Of each list that is being read, how many values are still to come; in all of them together.
    let (mut rest, mut open, mut depth, mut to_come) = (bytes, [0; DEEPEST], 0, 1_u64);
    while to_come > 0 {
        while depth > 0 && open[depth - 1] == 0 {
            depth -= 1;
        }
        if depth > 0 {
            open[depth - 1] -= 1;
        }
        to_come -= 1;
        let Some((&marker, after)) = rest.split_first() else { return false };
        let (head, content) = content(marker, after);
        let skipped = match content {
            Content::Bytes(length) => head + length,
            Content::Values(0) => head,
            Content::Values(count) => {
                if depth == DEEPEST || count > widest[depth] {
                    return false;
                }
                open[depth] = count;
                depth += 1;
                to_come += count;
                head
            }
        };
        match usize::try_from(skipped).ok().and_then(|skipped| after.get(skipped..)) {
            // A value has a byte at least.
            Some(left) if to_come <= left.len() as u64 => rest = left,
            _ => return false,
        }
    }
    rest.is_empty()
}

/// What comes behind a marker and its length.
enum Content {
    Bytes(u64),
    Values(u64),
}

/// How many bytes of length a marker has behind it, and what comes after those.
fn content(marker: u8, after: &[u8]) -> (u64, Content) {
    use Content::{Bytes, Values};
    // Big-endian; zero where the bytes break off, which whoever reads them will find.
    let length = |size: usize| {
        let bytes = after.get(..size).unwrap_or_default();
        bytes.iter().fold(0, |length, &byte| length << 8 | u64::from(byte))
    };
    let low = |bits: u8| u64::from(marker & bits);
    match marker {
        0x80..=0x8f => (0, Values(2 * low(0x0f))),
        0x90..=0x9f => (0, Values(low(0x0f))),
        0xa0..=0xbf => (0, Bytes(low(0x1f))),
        // Bytes and texts.
        0xc4 | 0xd9 => (1, Bytes(length(1))),
        0xc5 | 0xda => (2, Bytes(length(2))),
        0xc6 | 0xdb => (4, Bytes(length(4))),
        // Extensions, with a byte for their type.
        0xc7 => (1, Bytes(1 + length(1))),
        0xc8 => (2, Bytes(1 + length(2))),
        0xc9 => (4, Bytes(1 + length(4))),
        0xd4..=0xd8 => (0, Bytes(1 + (1 << (marker - 0xd4)))),
        // Numbers.
        0xcc | 0xd0 => (0, Bytes(1)),
        0xcd | 0xd1 => (0, Bytes(2)),
        0xca | 0xce | 0xd2 => (0, Bytes(4)),
        0xcb | 0xcf | 0xd3 => (0, Bytes(8)),
        // Lists and maps.
        0xdc => (2, Values(length(2))),
        0xdd => (4, Values(length(4))),
        0xde => (2, Values(2 * length(2))),
        0xdf => (4, Values(2 * length(4))),
        // Small numbers, nil, yes and no are in their marker.
        0x00..=0x7f | 0xc0..=0xc3 | 0xe0..=0xff => (0, Bytes(0)),
    }
}

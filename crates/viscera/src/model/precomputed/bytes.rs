//! Responses as bytes, all little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 10 | `responses\0` |
//! | 2 | format |
//! | 3 × 4 | checksums of mesh, tissue and held nodes |
//! | 2 × 8 | nodes, handles |
//! | 4 each | the handles |
//! | 72 each | C, handle after handle, node after node, column after column |
//! | 4 | CRC-32 of all before |

use super::responses::Checksums;
use super::{Responses, ResponsesError};
use crate::math::{Mat3, Vec3};

const MARK: &[u8; 10] = b"responses\0";
/// Grows with every change of what is written.
const FORMAT: u16 = 1;
const HEAD: usize = MARK.len() + 2 + 12 + 16;
const CHECKSUM: usize = 4;

impl Responses {
    /// The responses as bytes, to be kept; equal ones give equal bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEAD + self.bytes() + CHECKSUM);
        bytes.extend_from_slice(MARK);
        bytes.extend(FORMAT.to_le_bytes());
        let Checksums { mesh, tissue, held } = self.checksums;
        [mesh, tissue, held].into_iter().for_each(|checksum| bytes.extend(checksum.to_le_bytes()));
        [self.nodes, self.handles.len()].into_iter().for_each(|count| bytes.extend((count as u64).to_le_bytes()));
        self.handles.iter().for_each(|handle| bytes.extend(handle.to_le_bytes()));
        let numbers = self.columns.iter().flat_map(|block| block.columns).flat_map(Vec3::to_array);
        numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// Reads responses; whose they are, [`Responses::check`] tells.
    ///
    /// # Errors
    /// [`ResponsesError::NotResponses`], [`ResponsesError::Damaged`], [`ResponsesError::OtherVersion`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ResponsesError> {
        let damaged = ResponsesError::Damaged { length: bytes.len() };
        let Some(after_mark) = bytes.strip_prefix(MARK) else { return Err(ResponsesError::NotResponses) };
        let (content, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or(damaged)?;
        if content.len() < HEAD || crc32fast::hash(content) != u32::from_le_bytes(*checksum) {
            return Err(damaged);
        }
        let found = u16::from_le_bytes([after_mark[0], after_mark[1]]);
        if found != FORMAT {
            return Err(ResponsesError::OtherVersion { found, known: FORMAT });
        }
        let mut numbers = Numbers(&after_mark[2..after_mark.len() - CHECKSUM]);
        let responses = numbers.responses().ok_or(damaged)?;
        if numbers.0.is_empty() { Ok(responses) } else { Err(damaged) }
    }
}

/// What is left to be read.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn take<const BYTES: usize>(&mut self) -> Option<[u8; BYTES]> {
        let (first, rest) = self.0.split_first_chunk::<BYTES>()?;
        self.0 = rest;
        Some(*first)
    }

    fn short(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn count(&mut self) -> Option<usize> {
        self.take().map(u64::from_le_bytes).and_then(|count| usize::try_from(count).ok())
    }

    fn vector(&mut self) -> Option<Vec3<f64>> {
        let mut number = || self.take().map(f64::from_le_bytes).filter(|number| number.is_finite());
        Some(Vec3::new(number()?, number()?, number()?))
    }

    /// None where they are too few, too many, or mean nothing: a checksum says who wrote them, not that they are right.
    fn responses(&mut self) -> Option<Responses> {
        let checksums = Checksums { mesh: self.short()?, tissue: self.short()?, held: self.short()? };
        let (nodes, count) = (self.count()?, self.count()?);
        let blocks = nodes.checked_mul(count)?;
        let bytes = blocks.checked_mul(size_of::<Mat3<f64>>())?.checked_add(count.checked_mul(size_of::<u32>())?)?;
        if bytes != self.0.len() {
            return None;
        }
        let handles: Vec<u32> = (0..count).map(|_| self.short()).collect::<Option<_>>()?;
        let in_order = handles.is_sorted_by(|a, b| a < b) && handles.last().is_none_or(|&last| (last as usize) < nodes);
        let mut block = |_| Some(Mat3 { columns: [self.vector()?, self.vector()?, self.vector()?] });
        let columns = (0..blocks).map(&mut block).collect::<Option<_>>()?;
        in_order.then_some(Responses { checksums, nodes, handles, columns })
    }
}

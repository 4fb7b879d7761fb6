//! A checkpoint as a file.
//!
//! | bytes | what |
//! |---|---|
//! | 19 | `viscera checkpoint\n` |
//! | 2 | format, little-endian |
//! | … | program, run, interval, records: as postcard encodes them |
//! | … | the world's snapshot |
//! | 4 | CRC-32 of all before, little-endian |

use std::fs;
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use viscera_io::write::{WriteError, write_atomically};

use super::error::CheckpointError;
use super::mark::RunMark;
use crate::instruction_set::instruction_set;
use crate::run::recording::Kept;

const MARK: &[u8] = b"viscera checkpoint\n";
/// Grows with every change of what is written.
const FORMAT: u16 = 3;
const CHECKSUM: usize = 4;

/// The program that writes and reads: another one may compute other bits.
const PROGRAM: &str = concat!("viscera ", env!("CARGO_PKG_VERSION"));

/// All that a run needs to go on.
#[derive(Debug)]
pub(super) struct Content {
    pub(super) head: Head,
    /// The world, as its snapshot writes itself.
    pub(super) world: Vec<u8>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Head {
    program: String,
    pub(super) run: RunMark,
    /// Simulated time between checkpoints [s].
    pub(super) interval: f64,
    /// The instruction set that kernels ran with.
    pub(super) instructions: String,
    pub(super) kept: Kept,
}

impl Head {
    pub(super) fn new(run: RunMark, interval: f64, kept: Kept) -> Self {
        Self { program: PROGRAM.to_owned(), run, interval, instructions: instruction_set(), kept }
    }
}

impl Content {
    /// Writes it aside, and renames it when all of it is on the disk.
    pub(super) fn write(&self, path: &Path) -> Result<(), WriteError> {
        let mut bytes = [MARK, &FORMAT.to_le_bytes()].concat();
        bytes =
            postcard::to_extend(&self.head, bytes).expect("numbers, texts and lists of known length have an encoding");
        bytes.extend_from_slice(&self.world);
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        write_atomically(path, |out| out.write_all(&bytes))
    }

    pub(super) fn read(path: &Path) -> Result<Self, CheckpointError> {
        let path = || path.to_owned();
        let damaged = |why: &str| CheckpointError::Damaged { path: path(), why: why.to_owned() };
        let bytes = fs::read(path()).map_err(|source| CheckpointError::Unreadable { path: path(), source })?;
        let rest = bytes.strip_prefix(MARK).ok_or_else(|| damaged("it does not begin as one does"))?;
        let whole = bytes.split_last_chunk::<CHECKSUM>();
        let checksum = whole.filter(|(content, checksum)| crc32fast::hash(content) == u32::from_le_bytes(**checksum));
        if checksum.is_none() || rest.len() < 2 + CHECKSUM {
            return Err(damaged(&format!("its checksum does not fit its {} bytes", bytes.len())));
        }
        let other =
            |found: String, known: &str| CheckpointError::OtherVersion { path: path(), found, known: known.to_owned() };
        let format = u16::from_le_bytes([rest[0], rest[1]]);
        if format != FORMAT {
            return Err(other(format!("a program of format {format}"), &format!("one of format {FORMAT}")));
        }
        let (head, world) = postcard::take_from_bytes::<Head>(&rest[2..rest.len() - CHECKSUM])
            .map_err(|_| damaged("its checksum fits, and its content makes no sense"))?;
        if head.program != PROGRAM {
            return Err(other(head.program, PROGRAM));
        }
        Ok(Self { head, world: world.to_vec() })
    }
}

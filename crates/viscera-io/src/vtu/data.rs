use std::borrow::Cow;
use std::io::Read;
use std::str::FromStr;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use roxmltree::Node;

use crate::cursor::excerpt;
use crate::{ParseError, Place, Problem};

/// Deflate cannot shrink data further than this (zlib technical notes, "maximum compression factor").
const LARGEST_INFLATION: usize = 1032;

/// The data behind the `_` of `<AppendedData>`.
pub(super) struct Appended<'a> {
    bytes: &'a [u8],
    base64: bool,
}

/// Cuts the appended data off, because raw bytes are no XML; what is left is closed again.
pub(super) fn split_appended(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<Appended<'_>>), ParseError> {
    let tag = bytes.windows(13).position(|window| window == b"<AppendedData");
    let as_text = |bytes| {
        std::str::from_utf8(bytes)
            .map_err(|error| Problem::Xml { detail: "it is not UTF-8".to_owned() }.at(Place::Byte(error.valid_up_to())))
    };
    let Some(tag) = tag else { return Ok((Cow::Borrowed(as_text(bytes)?), None)) };
    let opened = bytes[tag..].iter().position(|&byte| byte == b'>').map(|length| tag + length + 1);
    let start = opened.and_then(|open| bytes[open..].iter().position(|&byte| byte == b'_').map(|skip| open + skip + 1));
    let (Some(opened), Some(start)) = (opened, start) else {
        return Err(Problem::Truncated { expected: "the `_` that starts the appended data" }.at(Place::Byte(tag)));
    };
    let base64 = bytes[tag..opened].windows(8).any(|window| window == b"\"base64\"");
    let text = format!("{}</VTKFile>", as_text(&bytes[..tag])?);
    Ok((Cow::Owned(text), Some(Appended { bytes: &bytes[start..], base64 })))
}

/// How the arrays of a file are stored.
pub(super) struct Storage<'a> {
    appended: Option<Appended<'a>>,
    big_endian: bool,
    /// Sizes before the data have 64 bits, not 32.
    wide_header: bool,
    compressed: bool,
    /// Bytes that the rest of the file can still unpack to; arrays that share data would exceed it.
    budget: usize,
}

impl<'a> Storage<'a> {
    pub(super) fn new(root: Node, appended: Option<Appended<'a>>, file_size: usize) -> Result<Self, Problem> {
        let compressed = match root.attribute("compressor") {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(Problem::Unsupported {
                    what: format!("data compressed by `{}`", excerpt(other.as_bytes())),
                    mend: "write the file with ZLib or without compression",
                });
            }
        };
        Ok(Self {
            appended,
            big_endian: root.attribute("byte_order") == Some("BigEndian"),
            wide_header: root.attribute("header_type") == Some("UInt64"),
            compressed,
            budget: file_size.saturating_mul(if compressed { LARGEST_INFLATION } else { 1 }),
        })
    }

    /// A data array as real numbers.
    pub(super) fn reals(&mut self, array: Node) -> Result<Vec<f64>, Problem> {
        if is_text(array) {
            return words(array, "a coordinate");
        }
        let bytes = self.unpack(array)?;
        match array.attribute("type") {
            Some("Float32") => self.numbers(&bytes, |bytes| f32::from_le_bytes(bytes).into()),
            Some("Float64") => self.numbers(&bytes, f64::from_le_bytes),
            other => Err(unknown_type(other)),
        }
    }

    /// A data array as integers.
    pub(super) fn integers(&mut self, array: Node) -> Result<Vec<i64>, Problem> {
        if is_text(array) {
            return words(array, "a node, offset or type of a cell");
        }
        let bytes = self.unpack(array)?;
        match array.attribute("type") {
            Some("Int8") => self.numbers(&bytes, |bytes| i8::from_le_bytes(bytes).into()),
            Some("UInt8") => self.numbers(&bytes, |bytes| u8::from_le_bytes(bytes).into()),
            Some("Int16") => self.numbers(&bytes, |bytes| i16::from_le_bytes(bytes).into()),
            Some("UInt16") => self.numbers(&bytes, |bytes| u16::from_le_bytes(bytes).into()),
            Some("Int32") => self.numbers(&bytes, |bytes| i32::from_le_bytes(bytes).into()),
            Some("UInt32") => self.numbers(&bytes, |bytes| u32::from_le_bytes(bytes).into()),
            Some("Int64" | "UInt64") => self.numbers(&bytes, i64::from_le_bytes),
            other => Err(unknown_type(other)),
        }
    }

    fn numbers<T, const SIZE: usize>(&self, bytes: &[u8], number: impl Fn([u8; SIZE]) -> T) -> Result<Vec<T>, Problem> {
        if !bytes.len().is_multiple_of(SIZE) {
            let (expected, found) = (bytes.len().next_multiple_of(SIZE) as u64, bytes.len() as u64);
            return Err(Problem::Length { what: "bytes of an array", expected, found });
        }
        let each = bytes.chunks_exact(SIZE).map(|chunk| {
            let mut bytes = [0; SIZE];
            bytes.copy_from_slice(chunk);
            if self.big_endian {
                bytes.reverse();
            }
            number(bytes)
        });
        Ok(each.collect())
    }

    /// The bytes of an array, decoded and inflated.
    fn unpack(&mut self, array: Node) -> Result<Vec<u8>, Problem> {
        let mut source = self.source(array)?;
        let sizes = |source: &mut Source, count: usize| -> Result<Vec<u64>, Problem> {
            let bytes = source.take(count.saturating_mul(if self.wide_header { 8 } else { 4 }))?;
            match self.wide_header {
                true => self.numbers(&bytes, u64::from_le_bytes),
                false => self.numbers(&bytes, |bytes| u32::from_le_bytes(bytes).into()),
            }
        };
        let mut unpacked = Vec::new();
        if !self.compressed {
            let size = sizes(&mut source, 1)?[0];
            unpacked = source.take(usize::try_from(size).unwrap_or(usize::MAX))?;
        } else {
            let head = sizes(&mut source, 3)?;
            let (blocks, block_size) = (usize::try_from(head[0]).unwrap_or(usize::MAX), head[1].max(head[2]));
            for size in sizes(&mut source, blocks)? {
                let packed = source.take(usize::try_from(size).unwrap_or(usize::MAX))?;
                let left = block_size.min(self.budget.saturating_sub(unpacked.len()) as u64);
                ZlibDecoder::new(&packed[..])
                    .take(left)
                    .read_to_end(&mut unpacked)
                    .map_err(|error| Problem::Damaged { encoding: "zlib", detail: error.to_string() })?;
            }
        }
        match self.budget.checked_sub(unpacked.len()) {
            Some(left) => self.budget = left,
            None => {
                let (expected, found) = (self.budget as u64, unpacked.len() as u64);
                return Err(Problem::Length { what: "bytes of all arrays", expected, found });
            }
        }
        Ok(unpacked)
    }

    /// Where the bytes of an array start.
    fn source<'b>(&'b self, array: Node<'b, 'b>) -> Result<Source<'b>, Problem> {
        let format = array.attribute("format").unwrap_or("ascii");
        match (format, &self.appended) {
            ("binary", _) => Ok(Source::new(array.text().unwrap_or("").as_bytes(), true)),
            ("appended", Some(appended)) => {
                let offset = array.attribute("offset").and_then(|offset| offset.parse().ok()).unwrap_or(usize::MAX);
                match appended.bytes.get(offset..) {
                    Some(bytes) => Ok(Source::new(bytes, appended.base64)),
                    None => Err(Problem::Truncated { expected: "the appended data of an array (at its offset)" }),
                }
            }
            ("appended", None) => Err(Problem::Truncated { expected: "<AppendedData>, which this array refers to" }),
            (other, _) => Err(Problem::Unexpected {
                expected: "the format ascii, binary or appended",
                found: excerpt(other.as_bytes()),
            }),
        }
    }
}

/// Bytes that are read from the front, in base64 or raw.
struct Source<'a> {
    bytes: &'a [u8],
    base64: bool,
    /// Decoded, but not asked for yet.
    waiting: Vec<u8>,
}

impl<'a> Source<'a> {
    fn new(bytes: &'a [u8], base64: bool) -> Self {
        Self { bytes, base64, waiting: Vec::new() }
    }

    fn take(&mut self, count: usize) -> Result<Vec<u8>, Problem> {
        let cut = Problem::Truncated { expected: "the data of an array" };
        if !self.base64 {
            let (taken, rest) = self.bytes.split_at_checked(count).ok_or(cut)?;
            self.bytes = rest;
            return Ok(taken.to_vec());
        }
        self.take_base64(count, cut)
    }

    /// Sizes and data may be encoded together or apart, each with its own padding, so groups of four are decoded one by
    /// one.
    fn take_base64(&mut self, count: usize, cut: Problem) -> Result<Vec<u8>, Problem> {
        let mut taken = std::mem::take(&mut self.waiting);
        while taken.len() < count {
            let mut group = [0; 4];
            let mut filled = 0;
            let mut read = 0;
            for &byte in self.bytes {
                read += 1;
                if !byte.is_ascii_whitespace() {
                    group[filled] = byte;
                    filled += 1;
                }
                if filled == 4 {
                    break;
                }
            }
            if filled < 4 {
                return Err(cut);
            }
            let mut bytes = [0; 3];
            let decoded = STANDARD
                .decode_slice(group, &mut bytes)
                .map_err(|error| Problem::Damaged { encoding: "base64", detail: error.to_string() })?;
            self.bytes = &self.bytes[read..];
            taken.extend_from_slice(&bytes[..decoded]);
        }
        self.waiting = taken.split_off(count);
        Ok(taken)
    }
}

fn is_text(array: Node) -> bool {
    array.attribute("format").is_none_or(|format| format == "ascii")
}

fn words<T: FromStr>(array: Node, expected: &'static str) -> Result<Vec<T>, Problem> {
    let text = array.text().unwrap_or("");
    let number =
        |word: &str| word.parse().map_err(|_| Problem::Unexpected { expected, found: excerpt(word.as_bytes()) });
    text.split_ascii_whitespace().map(number).collect()
}

fn unknown_type(found: Option<&str>) -> Problem {
    let found = excerpt(found.unwrap_or("none").as_bytes());
    Problem::Unexpected { expected: "the type of an array, such as Float64 or Int32", found }
}

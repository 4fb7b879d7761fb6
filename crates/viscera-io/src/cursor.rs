use std::str::{FromStr, SplitAsciiWhitespace, from_utf8};

use crate::{ParseError, Place, Problem};

/// A reading position in a file that may change between text and binary data on the way.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Places are told as bytes, not as lines.
    pub(crate) binary: bool,
    /// Multi-byte numbers start with the highest byte.
    pub(crate) big_endian: bool,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, binary: false, big_endian: false }
    }

    /// What has not been read yet.
    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Where the cursor is. Lines are counted only when they are asked for: when something is wrong.
    pub(crate) fn here(&self) -> Place {
        self.place_of(self.at)
    }

    fn place_of(&self, at: usize) -> Place {
        if self.binary {
            return Place::Byte(at);
        }
        Place::Line(1 + self.bytes[..at.min(self.bytes.len())].iter().filter(|&&byte| byte == b'\n').count())
    }

    /// Refuses a count that the rest of the file cannot hold, before anything is made of it.
    pub(crate) fn bounded(&self, count: u64, smallest: usize, what: &'static str) -> Result<usize, ParseError> {
        let possible = self.rest().len() / smallest + 1;
        match usize::try_from(count) {
            Ok(count) if count <= possible => Ok(count),
            _ => Err(Problem::TooMany { what, count, bytes: self.rest().len() }.at(self.here())),
        }
    }

    pub(crate) fn skip_blank(&mut self) {
        self.at += self.rest().iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    }

    /// Goes behind the next `needle`; false, and no step, where there is none.
    pub(crate) fn skip_past(&mut self, needle: &[u8]) -> bool {
        let found = self.rest().windows(needle.len()).position(|window| window == needle);
        self.at += found.map_or(0, |offset| offset + needle.len());
        found.is_some()
    }

    /// The next line that is not blank, in columns.
    pub(crate) fn fields(&mut self, expected: &'static str) -> Result<Fields<'a>, ParseError> {
        self.skip_blank();
        if self.rest().is_empty() {
            return Err(Problem::Truncated { expected }.at(self.here()));
        }
        let start = self.at;
        let text = self.line();
        match from_utf8(text) {
            Ok(text) => Ok(Fields {
                cursor: Self { at: start, ..self.clone() },
                columns: text.split_ascii_whitespace(),
                expected,
                found: 0,
                cut: self.rest().is_empty() && !self.bytes.ends_with(b"\n"),
            }),
            Err(_) => Err(Problem::Unexpected { expected, found: excerpt(text) }.at(self.place_of(start))),
        }
    }

    /// The rest of this line, without its end.
    pub(crate) fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length])
    }

    /// The next word, wherever the lines end.
    pub(crate) fn word(&mut self, expected: &'static str) -> Result<&'a str, ParseError> {
        self.skip_blank();
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(Problem::Truncated { expected }.at(self.here()));
        }
        match from_utf8(&rest[..length]) {
            Ok(word) => {
                self.at += length;
                Ok(word)
            }
            Err(_) => Err(Problem::Unexpected { expected, found: excerpt(&rest[..length]) }.at(self.here())),
        }
    }

    /// The next word, if there is one, as a number.
    pub(crate) fn number<T: FromStr>(&mut self, expected: &'static str) -> Result<T, ParseError> {
        let word = self.word(expected)?;
        word.parse().map_err(|_| self.unexpected(expected, word))
    }

    /// The next word must be this one.
    pub(crate) fn keyword(&mut self, keyword: &'static str) -> Result<(), ParseError> {
        match self.word(keyword)? {
            word if word == keyword => Ok(()),
            word => Err(self.unexpected(keyword, word)),
        }
    }

    pub(crate) fn unexpected(&self, expected: &'static str, found: &str) -> ParseError {
        Problem::Unexpected { expected, found: excerpt(found.as_bytes()) }.at(self.here())
    }

    /// Raw bytes.
    pub(crate) fn take(&mut self, count: usize, expected: &'static str) -> Result<&'a [u8], ParseError> {
        let taken = self.rest().get(..count).ok_or(Problem::Truncated { expected }.at(self.here()))?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, expected: &'static str) -> Result<[u8; N], ParseError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, expected)?);
        if self.big_endian {
            array.reverse();
        }
        Ok(array)
    }

    pub(crate) fn binary_i32(&mut self, expected: &'static str) -> Result<i32, ParseError> {
        self.array(expected).map(i32::from_le_bytes)
    }

    pub(crate) fn binary_i64(&mut self, expected: &'static str) -> Result<i64, ParseError> {
        self.array(expected).map(i64::from_le_bytes)
    }

    pub(crate) fn binary_u64(&mut self, expected: &'static str) -> Result<u64, ParseError> {
        self.array(expected).map(u64::from_le_bytes)
    }

    pub(crate) fn binary_f32(&mut self, expected: &'static str) -> Result<f32, ParseError> {
        self.array(expected).map(f32::from_le_bytes)
    }

    pub(crate) fn binary_f64(&mut self, expected: &'static str) -> Result<f64, ParseError> {
        self.array(expected).map(f64::from_le_bytes)
    }
}

/// One line of a file, column by column.
pub(crate) struct Fields<'a> {
    cursor: Cursor<'a>,
    columns: SplitAsciiWhitespace<'a>,
    expected: &'static str,
    found: usize,
    /// The file ends with this line, without the end of a line.
    cut: bool,
}

impl<'a> Fields<'a> {
    pub(crate) fn place(&self) -> Place {
        self.cursor.here()
    }

    /// The next column; a line that has none is reported with the description given to [`Cursor::fields`].
    pub(crate) fn word(&mut self) -> Result<&'a str, ParseError> {
        let word = self.columns.next().ok_or_else(|| match self.cut {
            true => Problem::Truncated { expected: "the rest of this line" }.at(self.place()),
            false => self.wrong_columns(),
        })?;
        self.found += 1;
        Ok(word)
    }

    /// The next column as a number.
    pub(crate) fn number<T: FromStr>(&mut self, expected: &'static str) -> Result<T, ParseError> {
        let word = self.word()?;
        word.parse().map_err(|_| self.cursor.unexpected(expected, word))
    }

    /// The next column, if there is one.
    pub(crate) fn next_word(&mut self) -> Option<&'a str> {
        self.columns.next().inspect(|_| self.found += 1)
    }

    /// All columns that are left, as numbers.
    pub(crate) fn rest<T: FromStr>(&mut self, expected: &'static str) -> Result<Vec<T>, ParseError> {
        let mut numbers = Vec::new();
        while let Some(word) = self.next_word() {
            numbers.push(word.parse().map_err(|_| self.cursor.unexpected(expected, word))?);
        }
        Ok(numbers)
    }

    /// No column may be left.
    pub(crate) fn end(mut self) -> Result<(), ParseError> {
        match self.columns.next() {
            None => Ok(()),
            Some(_) => {
                self.found += 1 + self.columns.by_ref().count();
                Err(self.wrong_columns())
            }
        }
    }

    fn wrong_columns(&self) -> ParseError {
        Problem::Columns { expected: self.expected, found: self.found }.at(self.place())
    }
}

/// The start of a piece of a file, fit for a message.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    let mut text: String = String::from_utf8_lossy(&bytes[..bytes.len().min(32)])
        .chars()
        .take(24)
        .map(|c| if c.is_control() { '·' } else { c })
        .collect();
    if bytes.len() > 24 {
        text.push('…');
    }
    text
}

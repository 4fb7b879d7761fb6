//! Pixels, and their way into a PNG file.

use std::io::Write;
use std::path::Path;

use super::PictureError;
use crate::write::{WriteError, write_atomically};

/// A drawn picture: sRGB, 8 bits per channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green, blue per pixel, rows from the top.
    pub pixels: Vec<u8>,
}

impl Image {
    /// Red, green, blue at `column`, `row` from the upper left; `None` outside.
    pub fn pixel(&self, column: usize, row: usize) -> Option<[u8; 3]> {
        let at = (row * self.width + column) * 3;
        let inside = column < self.width && row < self.height;
        inside.then(|| [self.pixels[at], self.pixels[at + 1], self.pixels[at + 2]])
    }

    /// Encodes it as PNG.
    ///
    /// # Errors
    /// What `sink` reports.
    pub fn write_png(&self, sink: &mut impl Write) -> Result<(), PictureError> {
        let mut encoder = ::png::Encoder::new(sink, self.width as u32, self.height as u32);
        encoder.set_color(::png::ColorType::Rgb);
        encoder.set_depth(::png::BitDepth::Eight);
        encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels)?;
        Ok(writer.finish()?)
    }

    /// Writes a PNG file: aside first, then renamed, so that no reader meets half a picture.
    ///
    /// # Errors
    /// The folder cannot be written, or the disk is full. The file aside is removed.
    pub fn save_png(&self, path: impl AsRef<Path>) -> Result<(), PictureError> {
        let path = path.as_ref();
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        write_atomically(path, |out| out.write_all(&bytes)).map_err(|error| match error {
            WriteError::Unwritable { path, source } => PictureError::Write { path: path.display().to_string(), source },
            other => PictureError::Write { path: path.display().to_string(), source: std::io::Error::other(other) },
        })
    }
}

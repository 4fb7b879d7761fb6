//! Words and measures over the picture: title, footer, scale bar, legend.

use std::convert::Infallible;

use embedded_graphics::mono_font::{MonoFont, MonoTextStyle, iso_8859_1};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{DrawTarget, Drawable, OriginDimensions, Pixel, Point, Size};
use embedded_graphics::text::{Baseline, Text};

use super::body::Field;
use super::camera::View;
use super::ground::nice_length;
use super::scene::Picture;
use super::{Image, viridis};

const INK: [u8; 3] = [52, 56, 62];
const TICKS: usize = 5;

/// Draws all of them.
pub(super) fn annotate(image: &mut Image, picture: &Picture, view: &View) {
    let scale = (image.height / 720).max(1);
    let (large, small) = (&iso_8859_1::FONT_10X20, &iso_8859_1::FONT_8X13);
    let margin = 22 * scale;
    let bottom = image.height.saturating_sub(margin + 13 * scale);
    write(image, &picture.title, [margin, 18 * scale], large, scale);
    write(image, &picture.footer, [margin, bottom], small, scale);
    if !picture.annotated {
        return;
    }
    scale_bar(image, view, bottom, margin, scale);
    if let Some(field) = picture.bodies.iter().find_map(|body| body.field.as_ref()) {
        legend(image, field, margin, scale);
    }
}

/// A bar of one grid square at the depth of the framed box's centre, lower right.
fn scale_bar(image: &mut Image, view: &View, bottom: usize, margin: usize, scale: usize) {
    let length = nice_length(view.size / 5.0);
    let pixels = (view.scale_at((view.minimum + view.maximum) * 0.5) * length).round() as usize;
    let label = length_label(length);
    let end = image.width.saturating_sub(margin);
    let start = end.saturating_sub(pixels);
    let row = bottom + 9 * scale;
    fill(image, [start, row], [end, row + 2 * scale], INK);
    for column in [start, end.saturating_sub(2 * scale)] {
        fill(image, [column, row.saturating_sub(4 * scale)], [column + 2 * scale, row + 2 * scale], INK);
    }
    let text = (start + end).saturating_sub(label.chars().count() * 8 * scale) / 2;
    write(image, &label, [text, row.saturating_sub(18 * scale)], &iso_8859_1::FONT_8X13, scale);
}

/// The colour map as an upright bar at the right, with numbers and unit.
fn legend(image: &mut Image, field: &Field, margin: usize, scale: usize) {
    let height = image.height * 2 / 5;
    let (top, bar) = (image.height / 5, 16 * scale);
    let labels = legend_labels(field.range[0], field.range[1]);
    let widest = labels.iter().map(String::len).max().unwrap_or(0) * 8 * scale;
    let left = image.width.saturating_sub(margin + widest + bar + 8 * scale);
    fill(
        image,
        [left.saturating_sub(scale), top.saturating_sub(scale)],
        [left + bar + scale, top + height + scale],
        INK,
    );
    for row in 0..height {
        let colour = viridis(1.0 - (row as f64 + 0.5) / height as f64);
        fill(image, [left, top + row], [left + bar, top + row + 1], [colour.red, colour.green, colour.blue]);
    }
    for (index, label) in labels.iter().enumerate() {
        let row = top + height - height * index / (TICKS - 1);
        fill(image, [left + bar, row], [left + bar + 4 * scale, row + scale], INK);
        write(image, label, [left + bar + 8 * scale, row.saturating_sub(6 * scale)], &iso_8859_1::FONT_8X13, scale);
    }
    let heading = if field.unit.is_empty() { field.name.clone() } else { format!("{} [{}]", field.name, field.unit) };
    let start = (image.width.saturating_sub(margin)).saturating_sub(heading.chars().count() * 8 * scale);
    write(image, &heading, [start.min(left), top.saturating_sub(26 * scale)], &iso_8859_1::FONT_8X13, scale);
}

/// The legend's five numbers from `low` to `high`: three figures of the larger end, powers of ten where they are short.
pub fn legend_labels(low: f64, high: f64) -> Vec<String> {
    let largest = low.abs().max(high.abs());
    let decade = if largest > 0.0 && largest.is_finite() { largest.log10().floor() as i32 } else { 0 };
    let values = (0..TICKS).map(|i| low + (high - low) * (i as f64 / (TICKS - 1) as f64));
    if !(-3..=5).contains(&decade) {
        return values.map(|value| format!("{value:.2e}")).collect();
    }
    let decimals = (2 - decade).max(0) as usize;
    values.map(|value| format!("{value:.decimals$}")).collect()
}

/// A length in the unit that needs no decimals.
fn length_label(length: f64) -> String {
    let units = [(1e3, "km"), (1.0, "m"), (1e-2, "cm"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")];
    let fits = units.into_iter().find(|(unit, _)| length >= unit * 0.999).filter(|_| length < 1e6);
    fits.map_or_else(|| format!("{length:.0e} m"), |(unit, name)| format!("{:.0} {name}", length / unit))
}

/// Fills columns and rows from `start` to before `end`, as far as they lie on the image.
fn fill(image: &mut Image, start: [usize; 2], end: [usize; 2], colour: [u8; 3]) {
    for row in start[1]..end[1].min(image.height) {
        for column in start[0]..end[0].min(image.width) {
            let at = (row * image.width + column) * 3;
            image.pixels[at..at + 3].copy_from_slice(&colour);
        }
    }
}

/// Writes a line with its upper left corner at `place`.
fn write(image: &mut Image, text: &str, place: [usize; 2], font: &MonoFont<'_>, scale: usize) {
    let mut ink = Ink { image, place, scale };
    let style = MonoTextStyle::new(font, BinaryColor::On);
    let Ok(_) = Text::with_baseline(text, Point::zero(), style, Baseline::Top).draw(&mut ink);
}

/// Ink on the image, in pixels `scale` wide, from `place` on.
struct Ink<'a> {
    image: &'a mut Image,
    place: [usize; 2],
    scale: usize,
}

impl OriginDimensions for Ink<'_> {
    fn size(&self) -> Size {
        Size::new(self.image.width as u32, self.image.height as u32)
    }
}

impl DrawTarget for Ink<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(point, colour) in pixels {
            if let (Ok(x), Ok(y), BinaryColor::On) = (usize::try_from(point.x), usize::try_from(point.y), colour) {
                let start = [self.place[0] + x * self.scale, self.place[1] + y * self.scale];
                fill(self.image, start, [start[0] + self.scale, start[1] + self.scale], INK);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers at the ends are the field's own, between them even steps, in three figures of the larger end.
    #[test]
    fn legend_numbers_span_the_range() {
        assert_eq!(legend_labels(0.0, 12.5), ["0.0", "3.1", "6.2", "9.4", "12.5"]);
        assert_eq!(legend_labels(-0.004, 0.004), ["-0.00400", "-0.00200", "0.00000", "0.00200", "0.00400"]);
        assert_eq!(legend_labels(0.0, 4e6), ["0.00e0", "1.00e6", "2.00e6", "3.00e6", "4.00e6"]);
    }

    /// Lengths are read in the unit in which they are whole.
    #[test]
    fn scale_bar_names_whole_lengths() {
        let found = [0.05, 0.2, 2.0, 0.005, 5e-5].map(length_label);
        assert_eq!(found, ["5 cm", "20 cm", "2 m", "5 mm", "50 µm"]);
    }
}

//! Line plots as SVG, linear or logarithmic in both directions.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use crate::ValidationError;

/// Width of a drawing, and of the keys to the right of its plot.
const WIDTH: u32 = 960;
const KEYS: u32 = 300;

/// Colours that most people tell apart (Okabe, Ito 2008), then darker ones.
const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(120, 60, 20),
    RGBColor(90, 90, 90),
    RGBColor(70, 0, 120),
    RGBColor(0, 90, 40),
];

/// Curves over two axes.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Name of the file, without the ending.
    pub name: &'static str,
    /// The line above it.
    pub title: String,
    /// What lies along x, with its unit.
    pub x: &'static str,
    /// What lies along y, with its unit.
    pub y: &'static str,
    /// How numbers become places.
    pub scale: Scale,
    /// The curves, in the order of their keys.
    pub curves: Vec<Curve>,
}

/// How numbers become places, on both axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    Linear,
    /// By their logarithms; numbers that are not positive are left out.
    Logarithmic,
}

impl Scale {
    /// Round numbers within a span of places.
    fn ticks(self, span: &Range<f64>) -> Vec<f64> {
        match self {
            Self::Linear => {
                let rough = (span.end - span.start) / 7.0;
                let power = 10_f64.powf(rough.log10().floor());
                let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
                let step = step.unwrap_or(rough);
                let (first, last) = ((span.start / step).ceil() as i64, (span.end / step).floor() as i64);
                (first..=last).map(|number| number as f64 * step).collect()
            }
            Self::Logarithmic => {
                let decades = span.start.floor() as i32..=span.end.ceil() as i32;
                let of_each: &[f64] = match span.end - span.start {
                    wide if wide > 4.0 => &[1.0],
                    middle if middle > 1.0 => &[1.0, 2.0, 5.0],
                    _ => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
                };
                let ticks = decades.flat_map(|decade| of_each.iter().map(move |m| f64::from(decade) + m.log10()));
                ticks.filter(|tick| span.contains(tick)).collect()
            }
        }
    }
}

/// A span of places with round numbers.
struct Axis {
    span: Range<f64>,
    ticks: Vec<f64>,
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.span.start) / (self.span.end - self.span.start);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.span.clone()
    }
}

/// A number as short as its size allows.
fn short(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) => {
            let text = format!("{value:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{value:.0e}"),
    }
}

/// A named line through points; one that others are compared with is dashed.
#[derive(Clone, Debug)]
pub struct Curve {
    /// What it is called beside the plot.
    pub name: String,
    /// The points that it joins.
    pub points: Vec<(f64, f64)>,
    /// Whether others are compared with it.
    pub dashed: bool,
}

impl Plot {
    /// A plot without curves.
    pub fn new(name: &'static str, title: impl Into<String>, [x, y]: [&'static str; 2], scale: Scale) -> Self {
        Self { name, title: title.into(), x, y, scale, curves: Vec::new() }
    }

    /// Adds a curve.
    pub fn curve(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { name: name.into(), points, dashed: false });
    }

    /// Adds a curve that others are compared with.
    pub fn reference(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { name: name.into(), points, dashed: true });
    }

    /// The drawing.
    ///
    /// # Errors
    /// [`ValidationError::Plot`].
    pub fn svg(&self) -> Result<String, ValidationError> {
        let mut text = String::new();
        self.draw(&mut text)
            .map_err(|error| ValidationError::Plot { file: format!("{}.svg", self.name), why: error.to_string() })?;
        Ok(text)
    }

    fn draw(&self, text: &mut String) -> Result<(), Box<dyn std::error::Error + '_>> {
        let place = |value: f64| if self.scale == Scale::Logarithmic { value.log10() } else { value };
        let curves: Vec<Vec<(f64, f64)>> = self
            .curves
            .iter()
            .map(|curve| curve.points.iter().map(|&(x, y)| (place(x), place(y))).collect::<Vec<_>>())
            .map(|points| points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).collect())
            .collect();
        let span = |of: fn(&(f64, f64)) -> f64| {
            let values = curves.iter().flatten().map(of);
            let (least, most) = values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            let margin = 0.05 * (most - least).max(1e-9);
            least - margin..most + margin
        };
        let label = |value: &f64| match self.scale {
            Scale::Linear => short(*value),
            Scale::Logarithmic => short(10_f64.powf(*value)),
        };
        let root = SVGBackend::with_string(text, (WIDTH, 480)).into_drawing_area();
        root.fill(&WHITE)?;
        let (drawing, keys) = root.split_horizontally(WIDTH - KEYS);
        let (x, y) = (span(|point| point.0), span(|point| point.1));
        let axis = |span: Range<f64>| Axis { ticks: self.scale.ticks(&span), span };
        let mut chart = ChartBuilder::on(&drawing)
            .caption(&self.title, ("sans-serif", 16))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(70)
            .build_cartesian_2d(axis(x), axis(y))?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .light_line_style(WHITE)
            .draw()?;
        for (number, (curve, points)) in self.curves.iter().zip(curves).enumerate() {
            let colour = if curve.dashed { BLACK } else { COLOURS[number % COLOURS.len()] };
            let style = ShapeStyle { color: colour.to_rgba(), filled: true, stroke_width: 2 };
            let height = 60 + 24 * number as i32;
            let key = [(8, height), (34, height)];
            if curve.dashed {
                chart.draw_series(DashedLineSeries::new(points, 6, 4, style))?;
                keys.draw(&DashedPathElement::new(key, 6, 4, style))?;
            } else {
                chart.draw_series(LineSeries::new(points.clone(), style))?;
                chart.draw_series(points.into_iter().map(|point| Circle::new(point, 3, style)))?;
                keys.draw(&PathElement::new(key, style))?;
            }
            keys.draw(&Text::new(curve.name.clone(), (42, height - 6), ("sans-serif", 12)))?;
        }
        root.present()?;
        drop(chart);
        drop((drawing, keys));
        drop(root);
        Ok(())
    }
}

//! Line plots as SVG, linear or logarithmic in both directions.

use plotters::prelude::*;

use crate::ValidationError;

/// Curves over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    /// Name of the file.
    pub(crate) name: &'static str,
    pub(crate) title: String,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
    pub(crate) scale: Scale,
    pub(crate) curves: Vec<Curve>,
}

/// How numbers become places, on both axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    Logarithmic,
}

/// A named line through points; one that others are compared with is dashed.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) dashed: bool,
}

impl Plot {
    pub(crate) fn curve(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { name: name.into(), points, dashed: false });
    }

    pub(crate) fn reference(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>) {
        self.curves.push(Curve { name: name.into(), points, dashed: true });
    }

    /// The drawing.
    pub(crate) fn svg(&self) -> Result<String, ValidationError> {
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
            Scale::Linear => format!("{}", (value * 1e6).round() / 1e6),
            Scale::Logarithmic => format!("{:.2e}", 10_f64.powf(*value)),
        };
        let root = SVGBackend::with_string(text, (820, 520)).into_drawing_area();
        root.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(&self.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(76)
            .build_cartesian_2d(span(|point| point.0), span(|point| point.1))?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .x_labels(8)
            .y_labels(8)
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .light_line_style(WHITE)
            .draw()?;
        for (number, (curve, points)) in self.curves.iter().zip(curves).enumerate() {
            let colour = if curve.dashed { BLACK.to_rgba() } else { Palette99::pick(number).to_rgba() };
            let style = ShapeStyle { color: colour, filled: true, stroke_width: 2 };
            let key = move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style);
            if curve.dashed {
                chart.draw_series(DashedLineSeries::new(points, 6, 4, style))?.label(&curve.name).legend(key);
            } else {
                chart.draw_series(LineSeries::new(points.clone(), style))?.label(&curve.name).legend(key);
                chart.draw_series(points.into_iter().map(|point| Circle::new(point, 3, style)))?;
            }
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        root.present()?;
        drop(chart);
        drop(root);
        Ok(())
    }
}

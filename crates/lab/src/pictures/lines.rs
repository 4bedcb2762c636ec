//! Lines: one quantity against another.

use std::path::Path;

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::{COLORS, FONT, PictureError, error, with_font};

/// One line of a chart.
#[derive(Debug, Clone)]
pub struct Line {
    /// What it is called.
    pub label: String,
    /// Points from left to right; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Drawn as separate points without a line: what others measured, for instance.
    pub dots: bool,
}

impl Line {
    /// A line through points.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points, dots: false }
    }

    /// Points alone.
    pub fn dots(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), points, dots: true }
    }
}

/// What an axis shows.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// Whether equal ways mean equal ratios; only what is greater than 0 is drawn then.
    pub log: bool,
    /// Values that the axis holds in any case.
    pub holds: Vec<f64>,
}

impl Axis {
    /// An even axis from 0.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), log: false, holds: vec![0.0] }
    }

    /// A logarithmic axis.
    pub fn log(label: &str) -> Self {
        Self { label: label.to_owned(), log: true, holds: Vec::new() }
    }

    fn range(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
        for v in values.chain(self.holds.iter().copied()).filter(|v| self.takes(*v)) {
            (lo, hi) = (lo.min(v), hi.max(v));
        }
        match (self.log, lo < hi) {
            (true, true) => (lo / 1.2, hi * 1.25),
            (false, true) => (lo, hi + (hi - lo) * 0.06),
            (true, false) if lo.is_finite() => (lo / 2.0, lo * 2.0),
            (false, false) if lo.is_finite() => (lo.min(0.0), lo.max(0.0) + 1.0),
            _ => (1.0, 10.0),
        }
    }

    fn takes(&self, v: f64) -> bool {
        v.is_finite() && (!self.log || v > 0.0)
    }
}

/// Width of the drawing without the legend, and height, in pixels.
pub(super) const SIZE: (u32, u32) = (1000, 620);

/// Room for a legend with these labels beside a drawing, in pixels.
pub(super) fn legend_width<'a>(labels: impl Iterator<Item = &'a str>) -> u32 {
    64 + labels.map(|l| l.chars().count()).max().unwrap_or(0) as u32 * 9
}

/// Draws lines as a PNG, with the legend beside them.
///
/// # Errors
/// If the file cannot be written.
pub fn lines(path: &Path, title: &str, x: &Axis, y: &Axis, lines: &[Line]) -> Result<(), PictureError> {
    with_font();
    let room = legend_width(lines.iter().map(|l| l.label.as_str()));
    let root = BitMapBackend::new(path, (SIZE.0 + room, SIZE.1)).into_drawing_area();
    let points = || lines.iter().flat_map(|l| &l.points).filter(|p| x.takes(p.0) && y.takes(p.1));
    let (xs, ys) = (x.range(points().map(|p| p.0)), y.range(points().map(|p| p.1)));
    let drawn = match (x.log, y.log) {
        (false, false) => draw(&root, title, (x, xs.0..xs.1), (y, ys.0..ys.1), lines),
        (true, false) => draw(&root, title, (x, (xs.0..xs.1).log_scale()), (y, ys.0..ys.1), lines),
        (false, true) => draw(&root, title, (x, xs.0..xs.1), (y, (ys.0..ys.1).log_scale()), lines),
        (true, true) => {
            draw(&root, title, (x, (xs.0..xs.1).log_scale()), (y, (ys.0..ys.1).log_scale()), lines)
        }
    };
    drawn.map_err(|e| error(path)(e.to_string()))
}

/// A number in as few digits as tell it.
fn short(v: f64) -> String {
    match v.abs() {
        a if a >= 1e6 || a > 0.0 && a < 1e-3 => format!("{v:.0e}"),
        a if a >= 100.0 || a == a.round() => format!("{v:.0}"),
        a if a >= 1.0 => format!("{v:.1}"),
        _ => format!("{v:.3}").trim_end_matches('0').to_owned(),
    }
}

fn draw<X, Y>(
    root: &DrawingArea<BitMapBackend, plotters::coord::Shift>,
    title: &str,
    (x, across): (&Axis, X),
    (y, up): (&Axis, Y),
    lines: &[Line],
) -> Result<(), Box<dyn std::error::Error>>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    root.fill(&WHITE)?;
    let (plot, legend) = root.split_horizontally(SIZE.0);
    let mut chart = ChartBuilder::on(&plot)
        .caption(title, (FONT, 26))
        .margin(16)
        .x_label_area_size(50)
        .y_label_area_size(84)
        .build_cartesian_2d(across, up)?;
    chart
        .configure_mesh()
        .x_desc(&x.label)
        .y_desc(&y.label)
        .label_style((FONT, 17))
        .axis_desc_style((FONT, 19))
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .light_line_style(WHITE)
        .draw()?;
    for (i, line) in lines.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let at: Vec<(f64, f64)> =
            line.points.iter().copied().filter(|p| x.takes(p.0) && y.takes(p.1)).collect();
        let y = 72 + 26 * i as i32;
        legend.draw(&Text::new(line.label.as_str(), (40, y - 8), (FONT, 17)))?;
        if line.dots {
            chart.draw_series(at.iter().map(|&p| TriangleMarker::new(p, 8, color.filled())))?;
            legend.draw(&TriangleMarker::new((18, y), 8, color.filled()))?;
            continue;
        }
        chart.draw_series(LineSeries::new(at.iter().copied(), color.stroke_width(3)))?;
        legend.draw(&PathElement::new([(4, y), (32, y)], color.stroke_width(3)))?;
        if at.len() <= 40 {
            chart.draw_series(at.iter().map(|&p| Circle::new(p, 4, color.filled())))?;
        }
    }
    root.present()?;
    Ok(())
}

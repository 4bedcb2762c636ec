//! Lines: one quantity against another.

use std::path::Path;

use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::PictureError;
use super::palette::{QUIET, Style, TEXT};
use super::svg::{Area, Drawn, Head, Sample, font, log_ticks, mark, path as draw_path, save, short};

/// One line of a chart.
#[derive(Debug, Clone)]
pub struct Line {
    /// What it is called.
    pub label: String,
    /// How it looks.
    pub style: Style,
    /// Points from left to right; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Drawn as separate marks without a line: numbers from elsewhere, for instance.
    pub dots: bool,
}

impl Line {
    /// A line through points.
    pub fn new(label: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style, points, dots: false }
    }

    /// Points alone.
    pub fn dots(label: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), style, points, dots: true }
    }
}

/// What an axis shows.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// The quantity and its unit.
    pub label: String,
    /// Whether equal ways mean equal ratios; only values greater than 0 are drawn then.
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
            (true, true) => {
                let margin = (hi / lo).powf(0.05);
                (lo / margin, hi * margin)
            }
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

/// Width of charts, and height without the head, in pixels.
pub const SIZE: (u32, u32) = (1000, 480);

/// Marks on a line; longer ones have a mark at some points only.
const MARKS: usize = 18;

/// Draws lines as an SVG. The title states the finding, the subtitle names the quantities.
///
/// # Errors
/// If the file cannot be written.
pub fn lines(
    path: &Path,
    title: &str,
    subtitle: &str,
    (x, y): (&Axis, &Axis),
    lines: &[Line],
) -> Result<(), PictureError> {
    let key =
        |l: &Line| (if l.dots { Sample::Mark(l.style) } else { Sample::Line(l.style) }, l.label.clone());
    let head = Head::new(SIZE.0, title, subtitle, lines.iter().map(key).collect());
    let points = || lines.iter().flat_map(|l| &l.points).filter(|p| x.takes(p.0) && y.takes(p.1));
    let (xs, ys) = (x.range(points().map(|p| p.0)), y.range(points().map(|p| p.1)));
    let even = |(a, b): (f64, f64)| a..b;
    let log = |(a, b): (f64, f64)| (a..b).log_scale().with_key_points(log_ticks(a, b));
    save(path, (SIZE.0, SIZE.1 + head.height as u32), |root| {
        head.draw(root)?;
        match (x.log, y.log) {
            (false, false) => draw(root, &head, (x, even(xs)), (y, even(ys)), lines),
            (true, false) => draw(root, &head, (x, log(xs)), (y, even(ys)), lines),
            (false, true) => draw(root, &head, (x, even(xs)), (y, log(ys)), lines),
            (true, true) => draw(root, &head, (x, log(xs)), (y, log(ys)), lines),
        }
    })
}

fn draw<X, Y>(
    root: &Area<'_>,
    head: &Head,
    (x, across): (&Axis, X),
    (y, up): (&Axis, Y),
    lines: &[Line],
) -> Drawn
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let (_, plot) = root.split_vertically(head.height);
    let mut chart = ChartBuilder::on(&plot)
        .margin(16)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(across, up)?;
    chart
        .configure_mesh()
        .x_desc(&x.label)
        .y_desc(&y.label)
        .label_style(font(14.0).color(&TEXT))
        .axis_desc_style(font(15.0).color(&TEXT))
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .axis_style(QUIET)
        .bold_line_style(BLACK.mix(0.13))
        .light_line_style(TRANSPARENT)
        .draw()?;
    let place = |p: &(f64, f64)| chart.backend_coord(p);
    let inside = |p: &&(f64, f64)| x.takes(p.0) && y.takes(p.1);
    let places: Vec<Vec<(i32, i32)>> =
        lines.iter().map(|l| l.points.iter().filter(inside).map(place).collect()).collect();
    for (line, at) in lines.iter().zip(&places).filter(|(l, _)| !l.dots) {
        draw_path(root, at, &line.style)?;
    }
    for (i, (line, at)) in lines.iter().zip(&places).enumerate() {
        // Each line starts to be marked at another point, so that marks do not cover each other.
        let step = at.len().div_ceil(MARKS).max(1);
        for &p in at.iter().skip(if step > 1 { i % step } else { 0 }).step_by(step) {
            mark(root, p, if line.dots { 7 } else { 5 }, &line.style, true)?;
        }
    }
    Ok(())
}

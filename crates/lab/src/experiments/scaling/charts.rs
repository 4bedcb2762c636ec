//! The charts and tables of this section.

use super::super::{Lab, LabError, Section, Table};
use super::measure::Row;
use crate::pictures::palette::{HZB, POINT, other};
use crate::pictures::{Axis, Line, lines};

/// A chart of times.
pub(super) struct Chart<'a> {
    pub(super) file: &'a str,
    pub(super) title: String,
    /// The quantity that grows.
    pub(super) of: &'a str,
}

/// The value of the last row over that of the first; 0 without rows.
pub(super) fn growth(rows: &[Row], value: impl Fn(&Row) -> f64) -> f64 {
    match (rows.first(), rows.last()) {
        (Some(first), Some(last)) => value(last) / value(first).max(f64::MIN_POSITIVE),
        _ => 0.0,
    }
}

/// The points of a line.
pub(super) fn points(rows: &[Row], value: impl Fn(&Row) -> f64) -> Vec<(f64, f64)> {
    rows.iter().map(|r| (r.size, value(r))).collect()
}

/// Draws the medians and tails of both methods.
pub(super) fn queries(lab: &Lab, section: &mut Section, chart: &Chart, rows: &[Row]) -> Result<(), LabError> {
    let all = [
        Line::new("point, median", POINT, points(rows, |r| r.point.median)),
        Line::new("point, p99", POINT.dashed(), points(rows, |r| r.point.p99)),
        Line::new("hzb, median", HZB, points(rows, |r| r.hzb.median)),
        Line::new("hzb, p99", HZB.dashed(), points(rows, |r| r.hzb.p99)),
    ];
    let axes = (&Axis::log(chart.of), &Axis::log("time of a query, ms"));
    let subtitle = "Median and 99th percentile over the views, on logarithmic axes.";
    lines(&lab.folder.join(chart.file), &chart.title, subtitle, axes, &all)?;
    section.picture(chart.file, &chart.title);
    Ok(())
}

/// Draws the time of setup and the memory of all series, by the number of objects.
pub(super) fn setups(lab: &Lab, section: &mut Section, series: &[(&str, &Vec<Row>)]) -> Result<(), LabError> {
    let draw = |file: &str, title: &str, label: &str, value: fn(&Row) -> f64| {
        let line = |(i, (name, rows)): (usize, &(&str, &Vec<Row>))| {
            Line::new(*name, other(i), rows.iter().map(|r| (r.objects as f64, value(r))).collect())
        };
        let all: Vec<Line> = series.iter().enumerate().map(line).collect();
        let axes = (&Axis::log("objects"), &Axis::log(label));
        lines(&lab.folder.join(file), title, "All objects of a scene, on logarithmic axes.", axes, &all)
    };
    let rows = || series.iter().flat_map(|(_, rows)| rows.iter()).filter(|r| r.objects >= 1000);
    let most = |value: fn(&Row) -> f64| rows().map(|r| value(r) / r.objects as f64).fold(0.0, f64::max);
    let least =
        |value: fn(&Row) -> f64| rows().map(|r| value(r) / r.objects as f64).fold(f64::INFINITY, f64::min);
    let range =
        |value: fn(&Row) -> f64, unit: f64| (least(value).min(most(value)) * unit, most(value) * unit);
    section.text("### Setup and memory\n\nThe same scenes, by the number of all objects in them.");
    let (a, b) = range(|r| r.setup, 1e6);
    let title = format!("With 1,000 objects and more, setup takes {a:.1} to {b:.1} microseconds an object");
    draw("scaling-setup.svg", &title, "setup, s", |r| r.setup)?;
    section.picture("scaling-setup.svg", &title);
    let (a, b) = range(|r| r.memory, 1.0);
    let title = format!("With 1,000 objects and more, a scene takes {a:.0} to {b:.0} bytes an object");
    draw("scaling-memory.svg", &title, "memory of the scene, MB", |r| r.memory / 1e6)?;
    section.picture("scaling-memory.svg", &title);
    Ok(())
}

/// All rows of several series.
pub(super) fn table(series: &[(&str, &Vec<Row>)]) -> Table {
    let columns = [
        "series",
        "size",
        "objects",
        "in the frustum",
        "PVS of point",
        "point, ms",
        "point p99, ms",
        "hzb, ms",
        "hzb p99, ms",
        "setup, s",
        "memory, MB",
        "of the grid",
        "of objects",
        "of shapes",
    ];
    let mut table = Table::new("scaling", &columns);
    for (name, rows) in series {
        for r in rows.iter() {
            let times = [r.point.median, r.point.p99, r.hzb.median, r.hzb.p99].map(|ms| format!("{ms:.4}"));
            let counts = [format!("{:.1}", r.in_frustum), format!("{:.1}", r.found)];
            table.row(
                [(*name).to_owned(), format!("{}", r.size), r.objects.to_string()]
                    .into_iter()
                    .chain(counts)
                    .chain(times)
                    .chain([format!("{:.4}", r.setup), format!("{:.3}", r.memory / 1e6)])
                    .chain(r.parts.map(|bytes| format!("{:.3}", bytes as f64 / 1e6))),
            );
        }
    }
    table
}

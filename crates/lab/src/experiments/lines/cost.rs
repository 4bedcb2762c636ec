//! Times of the stages by vertices and by pixels.

use casca_lines::buffers::LineBuffer;
use casca_lines::occlusion::{AoOptions, Occlusion};
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::View;

use super::agreement::FEW_ROWS;
use super::case::{Case, RADIUS, Sampling, seen_from};
use super::clock::timed;
use super::score::straight_line;
use crate::experiments::{Lab, LabError, Section, Table, grouped};
use crate::pictures::{Axis, Line, lines as line_chart, palette};

/// Samples of a pixel: fewer than elsewhere, so that whole pictures take seconds.
const SAMPLES: u32 = 32;

/// One frame of a set.
struct Frame {
    vertices: usize,
    covered: usize,
    grid: f64,
    few: f64,
    buffer: f64,
    occlusion: f64,
}

/// The milliseconds of a stage.
type Stage = fn(&Frame) -> f64;

/// The times of a frame in milliseconds, on one thread.
fn frame(lines: u32, canvas: u32, sampling: &Sampling) -> Result<Frame, LabError> {
    let lines = Recipe { lines, ..Recipe::new(Family::Reservoir, sampling.seed) }.make()?;
    let bounds = lines.bounds();
    let view = View::around(bounds, seen_from(Family::Reservoir), None, [canvas; 2])?;
    let small = view.with_height(FEW_ROWS.min(canvas))?;
    let of = |view: &View| SlabGrid::of_lines(&lines, view, Slices::S128, SpanRule::Span);
    let radius = RADIUS * f64::from((bounds[1] - bounds[0]).max_element());
    let samples = Case::samples(SAMPLES, sampling.seed)?;
    let options = AoOptions::new(radius as f32, view.pixel_size(1.0) as f32 / 2.0);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one.install(|| {
        let (grid, _) = timed(sampling.seconds, || of(&view));
        let (few, columns) = timed(sampling.seconds, || of(&small));
        let (buffer, shown) = timed(sampling.seconds, || LineBuffer::new(&lines, &view));
        let estimate = Occlusion::new(&columns, &samples, options)?;
        let (occlusion, _) = timed(sampling.seconds, || estimate.of(&shown));
        let [grid, few, buffer, occlusion] = [grid, few, buffer, occlusion].map(|t| t * 1e3);
        Ok(Frame { vertices: lines.points().len(), covered: shown.covered(), grid, few, buffer, occlusion })
    })
}

/// The heads of the table.
const COLUMNS: [&str; 8] = [
    "lines",
    "vertices",
    "picture",
    "pixels with lines",
    "grid, ms",
    "grid of few rows, ms",
    "buffer, ms",
    "occlusion, ms",
];

/// Measures frames of so many lines in pictures of so many rows.
fn measure(
    lab: &Lab,
    sampling: &Sampling,
    runs: &[(u32, u32)],
    table: &mut Table,
) -> Result<Vec<(u32, u32, Frame)>, LabError> {
    let mut frames = Vec::new();
    for &(lines, canvas) in runs {
        (lab.progress)(&format!("{lines} lines in {canvas} x {canvas} pixels"));
        let f = frame(lines, canvas, sampling)?;
        let times = [f.grid, f.few, f.buffer, f.occlusion].map(|t| format!("{t:.1}"));
        let sizes = [grouped(f.vertices), format!("{canvas} x {canvas}"), grouped(f.covered)];
        table.row(std::iter::once(lines.to_string()).chain(sizes).chain(times));
        frames.push((lines, canvas, f));
    }
    Ok(frames)
}

/// Adds a table of times by vertices and by pixels, and charts.
///
/// # Errors
/// If the library refuses a value, or a chart cannot be written.
pub fn costs(lab: &Lab, sampling: &Sampling, section: &mut Section) -> Result<(), LabError> {
    let mut table = Table::new("lines_cost", &COLUMNS);
    let sizes = lab.pick(vec![2000, 5000, 10_000, 15_000, 20_000], vec![200, 400]);
    let canvases = lab.pick(vec![256, 384, 512, 768, 1024], vec![64, 96]);
    let (usual, usual_lines) = (sampling.canvas, lab.pick(5000, 400));
    let mut runs: Vec<(u32, u32)> = sizes.into_iter().map(|n| (n, usual)).collect();
    runs.extend(canvases.into_iter().map(|c| (usual_lines, c)).filter(|r| r.1 != usual));
    let frames = measure(lab, sampling, &runs, &mut table)?;
    let of_sizes = || frames.iter().filter(|(_, c, _)| *c == usual).map(|(.., f)| f);
    let mut of_canvases: Vec<_> = frames.iter().filter(|(n, ..)| *n == usual_lines).collect();
    of_canvases.sort_by_key(|(_, canvas, _)| *canvas);
    let series =
        |y: Stage| -> Vec<(f64, f64)> { of_sizes().map(|f| (f.vertices as f64 / 1e6, y(f))).collect() };
    let pixel = |f: &Frame| (f.covered as f64 / 1e3, f.occlusion);
    let by_pixels: Vec<(f64, f64)> = of_canvases.iter().map(|(.., f)| pixel(f)).collect();
    let by_size: Vec<(f64, f64)> = of_sizes().map(pixel).collect();
    let (a, b) = (straight_line(&series(|f| f.grid + f.buffer)), straight_line(&by_pixels));
    section.text(format!(
        "Times of a frame of the reservoir, one thread, {SAMPLES} samples; the occlusion reads the grid of {FEW_ROWS} rows. **Grid and buffer take {:.1} ms and {:.1} ms a million vertices (r² {:.4}); the occlusion takes {:.1} ms and \
         {:.2} ms a thousand pixels with lines (r² {:.4}; {usual_lines} lines).**",
        a.0, a.1, a.2, b.0, b.1, b.2
    ));
    section.table(table);
    let stages: [(&str, Stage); 4] = [
        ("grid", |f| f.grid),
        ("grid of few rows", |f| f.few),
        ("buffer", |f| f.buffer),
        ("occlusion", |f| f.occlusion),
    ];
    let styled = |i: usize, points: Vec<(f64, f64)>| Line::new(stages[i].0, palette::other(i), points);
    let vertices: Vec<Line> = (0..3).map(|i| styled(i, series(stages[i].1))).collect();
    let rows = |y: Stage| of_canvases.iter().map(|(_, c, f)| (f64::from(*c), y(f))).collect();
    let resolution: Vec<Line> = (0..4).map(|i| styled(i, rows(stages[i].1))).collect();
    let pixels = [
        Line::new(format!("{usual_lines} lines, pictures of several sizes"), palette::other(3), by_pixels),
        Line::dots(format!("sets of several sizes, {usual} rows"), palette::other(4), by_size),
    ];
    let several = format!("Reservoir of several sizes. One thread, {SAMPLES} samples.");
    let about = format!("Reservoir of {usual_lines} lines. One thread, {SAMPLES} samples.");
    let title = format!("Grid and buffer: {:.1} ms and {:.1} ms a million vertices, r² {:.4}", a.0, a.1, a.2);
    draw(
        lab,
        section,
        "lines_time_by_vertices.svg",
        &Words { title: &title, subtitle: &several, across: "million vertices" },
        &vertices,
    )?;
    let title =
        format!("Occlusion: {:.1} ms and {:.2} ms a thousand pixels with lines, r² {:.4}", b.0, b.1, b.2);
    draw(
        lab,
        section,
        "lines_time_by_pixels.svg",
        &Words { title: &title, subtitle: &several, across: "thousand pixels with lines" },
        &pixels,
    )?;
    let title = "The occlusion grows with the pixels that lines cover, the other stages less";
    draw(
        lab,
        section,
        "lines_time_by_resolution.svg",
        &Words { title, subtitle: &about, across: "rows of the picture" },
        &resolution,
    )
}

/// What a chart of times says.
struct Words<'a> {
    title: &'a str,
    subtitle: &'a str,
    across: &'a str,
}

/// Draws times and puts the chart into the section.
fn draw(lab: &Lab, section: &mut Section, file: &str, words: &Words, drawn: &[Line]) -> Result<(), LabError> {
    let axes = (&Axis::linear(words.across), &Axis::linear("ms"));
    line_chart(&lab.folder.join(file), words.title, words.subtitle, axes, drawn)?;
    section.picture(file, &format!("Times against {}.", words.across));
    Ok(())
}

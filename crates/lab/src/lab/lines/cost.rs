//! Times of the stages by vertices and by pixels.

use std::time::Instant;

use casca_lines::buffers::LineBuffer;
use casca_lines::occlusion::{AoOptions, Occlusion};
use casca_lines::sets::generate::{Family, Recipe};
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::View;

use super::agreement::FEW_ROWS;
use super::case::{Case, Effort, RADIUS, SAMPLES, seen_from};
use super::score::straight_line;
use crate::lab::{Lab, LabError, Section, Table, grouped, median};

/// The median of the milliseconds of some runs, and the last result.
fn timed<T>(repeats: usize, work: impl Fn() -> T) -> (f64, T) {
    let mut times = Vec::new();
    loop {
        let start = Instant::now();
        let result = work();
        times.push(start.elapsed().as_secs_f64() * 1e3);
        if times.len() >= repeats {
            return (median(&mut times), result);
        }
    }
}

/// One frame of a set.
struct Frame {
    vertices: usize,
    covered: usize,
    grid: f64,
    few: f64,
    buffer: f64,
    occlusion: f64,
}

fn frame(lines: u32, canvas: u32, effort: &Effort) -> Result<Frame, LabError> {
    let lines = Recipe { lines, ..Recipe::new(Family::Reservoir, effort.seed) }.make()?;
    let bounds = lines.bounds();
    let view = View::around(bounds, seen_from(Family::Reservoir), None, [canvas; 2])?;
    let small = view.with_height(FEW_ROWS.min(canvas))?;
    let of = |view: &View| SlabGrid::of_lines(&lines, view, Slices::S128, SpanRule::Span);
    let (grid, _) = timed(effort.repeats, || of(&view));
    let (few, columns) = timed(effort.repeats, || of(&small));
    let (buffer, shown) = timed(effort.repeats, || LineBuffer::new(&lines, &view));
    let radius = RADIUS * f64::from((bounds[1] - bounds[0]).max_element());
    let samples = Case::samples(SAMPLES, effort.seed)?;
    let options = AoOptions::new(radius as f32, view.pixel_size(1.0) as f32 / 2.0);
    let occlusion = Occlusion::new(&columns, &samples, options)?;
    let (occlusion, _) = timed(effort.repeats, || occlusion.of(&shown));
    Ok(Frame { vertices: lines.points().len(), covered: shown.covered(), grid, few, buffer, occlusion })
}

/// Adds a table of times by vertices and by pixels.
///
/// # Errors
/// If the library refuses a value.
pub fn costs(lab: &Lab, effort: &Effort, section: &mut Section) -> Result<(), LabError> {
    let columns = [
        "lines",
        "vertices",
        "picture",
        "pixels with lines",
        "grid, ms",
        "grid of few rows, ms",
        "buffer, ms",
        "occlusion, ms",
    ];
    let mut table = Table::new("lines_cost", &columns);
    let (mut by_vertices, mut by_pixels) = (Vec::new(), Vec::new());
    let sizes = lab.pick(vec![2000, 5000, 10_000, 20_000], vec![200, 400]);
    let canvases = lab.pick(vec![256, 768, 1024], vec![128]);
    let usual = effort.canvas;
    let runs =
        sizes.into_iter().map(|n| (n, usual)).chain(canvases.into_iter().map(|c| (lab.pick(5000, 400), c)));
    for (lines, canvas) in runs {
        (lab.progress)(&format!("{lines} lines in {canvas} pixels"));
        let f = frame(lines, canvas, effort)?;
        if canvas == usual {
            by_vertices.push((f.vertices as f64 / 1e6, f.grid + f.buffer));
        }
        by_pixels.push((f.covered as f64 / 1e3, f.occlusion));
        table.row([
            lines.to_string(),
            grouped(f.vertices),
            format!("{canvas} x {canvas}"),
            grouped(f.covered),
            format!("{:.1}", f.grid),
            format!("{:.1}", f.few),
            format!("{:.1}", f.buffer),
            format!("{:.1}", f.occlusion),
        ]);
    }
    let (a, b) = (straight_line(&by_vertices), straight_line(&by_pixels));
    section.text(format!(
        "Times of a frame of the reservoir, all threads, {SAMPLES} samples, medians of {} runs; the occlusion reads the grid of \
         {FEW_ROWS} rows. **Grid and buffer take {:.1} ms and {:.1} ms a million vertices (r² {:.3}); the occlusion takes {:.1} ms and \
         {:.2} ms a thousand pixels with lines (r² {:.3}).**",
        effort.repeats, a.0, a.1, a.2, b.0, b.1, b.2
    ));
    section.table(table);
    Ok(())
}

//! Simplified lines against rays at the lines that they were made of.

use std::time::Instant;

use casca_lines::buffers::{Fragment, LineBuffer};
use casca_lines::cells::Cells;
use casca_lines::occlusion::AoOptions;
use casca_lines::sets::LineSet;
use casca_lines::sets::simplify::Tolerance;

use crate::methods::{METHODS, Method, Setting};
use crate::{Case, Kind, RAYS, pearson, rmse};

/// Tolerances in pixels at the middle of the depths, twice a tube's radius each; none at first.
const PIXELS: [f32; 6] = [0.0, 0.125, 0.25, 0.5, 1.0, 2.0];
/// The methods that are shown.
const SHOWN: [&str; 2] = ["24 rays (default)", "places"];

/// Prints a row for each kind and tolerance.
pub fn print(cases: &[(&Kind, Case)]) {
    println!(
        "| kind | pixels | vertices | MiB | another line, none | truth of the lines left | 24 rays; places | µs a pixel |"
    );
    println!("|---|{}", "---:|".repeat(7));
    for (kind, case) in cases {
        let truth = case.truth(&case.view, &case.receivers, RAYS);
        PIXELS.iter().for_each(|pixels| row(kind, (case, &truth), *pixels));
    }
}

fn row(kind: &Kind, (case, truth): (&Case, &[f64]), pixels: f32) {
    let start = Instant::now();
    let lines = match pixels {
        0.0 => case.lines.clone(),
        _ => case.lines.simplified(&Tolerance::within(2.0 * case.setting.tube * pixels)),
    };
    let took = start.elapsed().as_secs_f64() * 1e3;
    let buffer = LineBuffer::new(&lines, &case.view);
    let at = |[x, y]: [u32; 2]| buffer.fragments()[(y * case.view.size()[0] + x) as usize];
    // Pixels that show the same line, with the truth there.
    let shown =
        || case.receivers.iter().zip(truth).map(|((pixel, old), truth)| (*pixel, old, at(*pixel), *truth));
    let none = shown().filter(|s| s.2.is_none()).count();
    let (receivers, wanted): (Vec<([u32; 2], Fragment)>, Vec<f64>) = shown()
        .filter_map(|(pixel, old, new, truth)| Some(((pixel, new.filter(|n| n.line == old.line)?), truth)))
        .unzip();
    let block: Vec<([u32; 2], Fragment)> = case.block.iter().filter_map(|b| Some((b.0, at(b.0)?))).collect();
    let share = |count: usize| 100.0 * count as f64 / case.receivers.len().max(1) as f64;
    let (count, mib) = (lines.points().len(), on_device(&lines, case.setting));
    let others = case.receivers.len() - receivers.len() - none;
    let simple = Case { lines, view: case.view, buffer, receivers, block, setting: case.setting };
    let methods: Vec<_> = SHOWN.iter().filter_map(|name| METHODS.iter().find(|m| m.name == *name)).collect();
    let near = |m: &&Method| {
        let found = m.prepared(&simple, &simple.view).values(&simple.receivers);
        format!("{:.4}, {:.4}", pearson(&found, &wanted), rmse(&found, &wanted))
    };
    let own = simple.truth(&simple.view, &simple.receivers, RAYS);
    println!(
        "| {} | {pixels} | {count} ({:.1}%), {took:.0} ms | {mib:.1} | {:.1}%, {:.1}% | {:.4}, {:.4} | {} | {} |",
        kind.name,
        100.0 * count as f64 / case.lines.points().len() as f64,
        share(others),
        share(none),
        pearson(&own, &wanted),
        rmse(&own, &wanted),
        methods.iter().map(near).collect::<Vec<_>>().join("; "),
        methods.iter().map(|m| format!("{:.1}", m.times(&simple).1)).collect::<Vec<_>>().join("; "),
    );
}

/// MiB of the set on a device, as `GpuLines` copies it.
fn on_device(lines: &LineSet, setting: Setting) -> f64 {
    let cells = Cells::new(lines, AoOptions::rays(setting.radius, setting.tube).margin());
    let words = cells.lists().len() + cells.starts().len() + 8 * cells.ends().len();
    let segments = lines.segments().count();
    (4.0 * words as f64 + 32.0 * lines.points().len() as f64 + 12.5 * segments as f64) / f64::from(1 << 20)
}

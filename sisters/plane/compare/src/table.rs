//! The results, as a table and as CSV.

use std::collections::BTreeSet;
use std::fmt::Write;

use casca_plane::OpaqueTiles;
use casca_plane::maps::MapKind;

use crate::methods::Method;

/// A method on a map.
pub struct Line {
    kind: MapKind,
    size: u32,
    range: u32,
    method: Method,
    /// Whether the method can do it at all.
    ran: bool,
    /// Microseconds of a view.
    median: f64,
    mean: f64,
    /// Tiles of a view: those that can be seen, those of them that are not shown, by kind, and
    /// those that are shown but cannot be seen.
    seen: f64,
    missed_free: f64,
    missed_opaque: f64,
    wrong: f64,
}

impl Line {
    pub fn new(kind: MapKind, size: u32, range: u32, method: Method, mut times: Vec<f64>, ran: bool) -> Self {
        times.sort_by(f64::total_cmp);
        let median = times.get(times.len() / 2).copied().unwrap_or(0.0);
        let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
        let [seen, missed_free, missed_opaque, wrong] = [0.0; 4];
        Self { kind, size, range, method, ran, median, mean, seen, missed_free, missed_opaque, wrong }
    }

    /// Adds one of `views`.
    pub fn compare(
        &mut self,
        opaque: &OpaqueTiles,
        truth: &BTreeSet<(u32, u32)>,
        shown: &BTreeSet<(u32, u32)>,
        views: usize,
    ) {
        let share = |count: usize| count as f64 / views as f64;
        let missed = truth.difference(shown).count();
        let missed_opaque = truth.difference(shown).filter(|&&(x, y)| opaque.get(x, y)).count();
        self.seen += share(truth.len());
        self.missed_free += share(missed - missed_opaque);
        self.missed_opaque += share(missed_opaque);
        self.wrong += share(shown.difference(truth).count());
    }
}

/// Prints lines of a table, with its head if `first`.
pub fn print(lines: &[Line], first: bool) {
    if first {
        println!(
            "| map | size | range | method | median | mean | seen | missed, free | missed, opaque | shown wrongly |"
        );
        println!("|---|---|---|---|---|---|---|---|---|---|");
    }
    for line in lines {
        let range = if line.range == 0 { "none".to_string() } else { line.range.to_string() };
        print!("| {} | {} | {range} | {} ", line.kind.name(), line.size, line.method.name());
        if line.ran {
            println!(
                "| {:.1} us | {:.1} us | {:.1} | {:.1} | {:.1} | {:.1} |",
                line.median, line.mean, line.seen, line.missed_free, line.missed_opaque, line.wrong
            );
        } else {
            println!("| - | - | - | - | - | - |");
        }
    }
}

/// All lines, as text to be stored.
pub fn csv(lines: &[Line]) -> String {
    let mut text =
        "map,size,range,method,median_us,mean_us,seen,missed_free,missed_opaque,shown_wrongly\n".to_string();
    for line in lines.iter().filter(|line| line.ran) {
        let (kind, method) = (line.kind.name(), line.method.name());
        let _ = writeln!(
            text,
            "{kind},{},{},{method},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2}",
            line.size,
            line.range,
            line.median,
            line.mean,
            line.seen,
            line.missed_free,
            line.missed_opaque,
            line.wrong
        );
    }
    text
}

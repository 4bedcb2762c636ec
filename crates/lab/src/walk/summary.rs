//! The results of a walk as a table.

use std::path::PathBuf;
use std::time::Duration;

use casca_tools::command_line::{Outcome, say};

use super::options::Options;
use super::session::{Frame, Session};
use crate::pictures::FrameCounts;

/// The results of a walk.
pub struct Summary {
    scene: String,
    method: &'static str,
    cell: f64,
    /// Objects that are tested.
    objects: usize,
    setup: Duration,
    grid_bytes: usize,
    out: PathBuf,
    frames: Vec<Frame>,
    mean_frustum: f64,
    mean_pvs: f64,
    /// Unknown without an item buffer: rays look only at objects that the PVS leaves out.
    mean_exact: Option<f64>,
}

fn mean(values: impl ExactSizeIterator<Item = usize>) -> f64 {
    let n = values.len().max(1) as f64;
    values.map(|value| value as f64).sum::<f64>() / n
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The value below which a share of all values is; 0 of none.
fn percentile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n => values[((n - 1) as f64 * share).round() as usize],
    }
}

impl Summary {
    pub fn new(options: &Options, session: &Session<'_>, frames: Vec<Frame>) -> Self {
        let mean_of = |count: fn(&FrameCounts) -> usize| mean(frames.iter().map(|f| count(&f.counts)));
        let (scene, world) = (&session.driver.scene, &session.world);
        Self {
            scene: world.name.clone(),
            method: options.query_method().name(),
            cell: scene.grid().cell_size(),
            objects: world.objects.iter().filter(|o| o.tested).count(),
            setup: session.setup,
            grid_bytes: scene.memory().grid(),
            out: options.out.clone(),
            mean_frustum: mean_of(|c| c.frustum),
            mean_pvs: mean_of(|c| c.pvs),
            mean_exact: (options.width > 0).then(|| mean_of(|c| c.exact)),
            frames,
        }
    }

    /// Rays and pixels that were looked at.
    fn proofs(&self) -> u64 {
        self.frames.iter().map(|f| f.verdict.rays + f.verdict.item_rays).sum()
    }

    fn losses(&self) -> usize {
        self.frames.iter().map(|f| f.verdict.false_negatives.len()).sum()
    }

    /// A percentile of the times of queries, in microseconds.
    fn query(&self, share: f64) -> f64 {
        percentile(self.frames.iter().map(|f| micros(f.query)), share)
    }

    /// Whether the walk lost something, or could not have noticed.
    pub fn outcome(&self) -> Outcome {
        if self.losses() > 0 {
            return Outcome::Lost;
        }
        if self.objects == 0 || self.proofs() == 0 {
            eprintln!("nothing was checked: no ray was shot at anything that could be lost");
            return Outcome::NothingChecked;
        }
        Outcome::Well
    }

    /// Prints the table.
    pub fn print(&self) {
        let row = |name: &str, value: String| say(format_args!("{name:<34}{value:>16}"));
        let known = |value: Option<String>| value.unwrap_or_else(|| "unknown".to_owned());
        say("");
        row("scene", self.scene.clone());
        row("method", self.method.to_owned());
        row("edge of a cell", format!("{} m", self.cell));
        row("frames", self.frames.len().to_string());
        row("objects", self.objects.to_string());
        row("in the frustum (mean)", format!("{:.1}", self.mean_frustum));
        row("PVS (mean)", format!("{:.1}", self.mean_pvs));
        row("exactly visible (mean)", known(self.mean_exact.map(|n| format!("{n:.1}"))));
        let ratio = self.mean_exact.filter(|exact| *exact > 0.0).map(|exact| self.mean_pvs / exact);
        row("PVS / exactly visible", known(ratio.map(|n| format!("{n:.3}"))));
        row("false negatives", self.losses().to_string());
        row("rays of proof", format!("{:.1} M", self.proofs() as f64 / 1e6));
        row("query time, median", format!("{:.0} us", self.query(0.5)));
        row("query time, 99th percentile", format!("{:.0} us", self.query(0.99)));
        let cells: u64 = self.frames.iter().map(|f| f.cells).sum();
        if cells > 0 {
            let nanoseconds: f64 = self.frames.iter().map(|f| micros(f.query) * 1e3).sum();
            row("query time per visited cell", format!("{:.2} ns", nanoseconds / cells as f64));
        }
        let update = percentile(self.frames.iter().map(|f| micros(f.update)), 0.5);
        row("scene update, median", format!("{update:.0} us"));
        row("preparation and setup", format!("{:.0} ms", self.setup.as_secs_f64() * 1e3));
        row("grid memory", format!("{:.2} MiB", self.grid_bytes as f64 / (1 << 20) as f64));
        say(format_args!("\npictures: walk.svg and frame.png in {}", self.out.display()));
    }
}

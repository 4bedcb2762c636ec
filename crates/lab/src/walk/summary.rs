//! The results of a walk as a table.

use std::time::Duration;

use casca_tools::command_line::{Outcome, say};

use super::options::Options;
use super::session::{Frame, Session};
use crate::pictures::FrameCounts;

/// The results of a walk.
pub struct Summary<'a> {
    pub options: &'a Options,
    pub session: &'a Session<'a>,
    pub frames: &'a [Frame],
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

impl Summary<'_> {
    /// The mean of a count over the frames.
    fn mean(&self, count: fn(&FrameCounts) -> usize) -> f64 {
        let sum: usize = self.frames.iter().map(|f| count(&f.counts)).sum();
        sum as f64 / self.frames.len().max(1) as f64
    }

    /// Objects that are tested.
    fn objects(&self) -> usize {
        self.session.world.objects.iter().filter(|o| o.tested).count()
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
        if self.objects() == 0 || self.proofs() == 0 {
            eprintln!("nothing was checked: no ray was shot at anything that could be lost");
            return Outcome::NothingChecked;
        }
        Outcome::Well
    }

    /// Prints the table.
    pub fn print(&self) {
        let row = |name: &str, value: String| say(format_args!("{name:<34}{value:>16}"));
        let known = |value: Option<String>| value.unwrap_or_else(|| "unknown".to_owned());
        // Unknown without an item buffer: rays look only at objects that the PVS leaves out.
        let (pvs, exact) = (self.mean(|c| c.pvs), self.mean(|c| c.exact));
        let exact = (self.options.width > 0).then_some(exact);
        let scene = &self.session.driver.scene;
        say("");
        row("scene", self.session.world.name.clone());
        row("method", self.options.query_method().name().to_owned());
        row("edge of a cell", format!("{} m", scene.grid().cell_size()));
        row("frames", self.frames.len().to_string());
        row("objects", self.objects().to_string());
        row("in the frustum (mean)", format!("{:.1}", self.mean(|c| c.frustum)));
        row("PVS (mean)", format!("{pvs:.1}"));
        row("exactly visible (mean)", known(exact.map(|n| format!("{n:.1}"))));
        let ratio = exact.filter(|exact| *exact > 0.0).map(|exact| pvs / exact);
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
        row("preparation and setup", format!("{:.0} ms", self.session.setup.as_secs_f64() * 1e3));
        row("grid memory", format!("{:.2} MiB", scene.memory().grid() as f64 / (1 << 20) as f64));
        say(format_args!("\npictures: walk.svg and frame.png in {}", self.options.out.display()));
    }
}

//! Arguments and progress bars that commands share.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use casca_cache::MeshCache;
use casca_tools::command_line::PathError;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

/// Why a command failed.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Frames that can be walked: as many as a file may give.
pub const FRAMES: RangeInclusive<i64> = 1..=100_000;
/// Widths of item buffers in pixels. The largest takes 2 GB.
pub const WIDTHS: RangeInclusive<i64> = 16..=16_384;
/// Rays to one object, at most.
pub const MOST_SAMPLES: i64 = 10_000;

/// Arguments of all commands with something random and a progress bar.
#[derive(Debug, Clone, Args)]
pub struct Common {
    /// Seed of all that is random
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// No progress bar
    #[arg(long)]
    pub quiet: bool,
}

/// Where prepared meshes are kept.
#[derive(Debug, Clone, Args)]
pub struct Cached {
    /// A folder of prepared meshes: those in it are read, others are prepared and put there
    /// [default: all are prepared]
    #[arg(long)]
    pub cache: Option<PathBuf>,
}

impl Cached {
    /// The cache, if one is asked for.
    pub fn open(&self) -> Result<Option<MeshCache>, PathError> {
        let Some(folder) = &self.cache else { return Ok(None) };
        Ok(Some(MeshCache::new(folder).map_err(PathError::write(folder))?))
    }
}

/// A bar with a label that counts up to `total` of what `unit` names.
pub fn bar(quiet: bool, total: usize, label: &str, unit: &str) -> ProgressBar {
    let template = format!("{{msg}} {{bar:40}} {unit} {{pos}} of {{len}}, {{eta}} left");
    start(quiet, ProgressBar::new(total as u64), &template).with_message(label.to_owned())
}

/// The time that has passed and a message, with a sign that work goes on.
#[cfg(feature = "experiments")]
pub fn spinner(quiet: bool) -> ProgressBar {
    let spinner = start(quiet, ProgressBar::new_spinner(), "{spinner} {elapsed} {prefix}: {wide_msg}");
    spinner.enable_steady_tick(std::time::Duration::from_millis(200));
    spinner
}

/// A bar in a style, if it is to be seen.
fn start(quiet: bool, bar: ProgressBar, template: &str) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

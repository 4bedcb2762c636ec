//! Commands for clouds larger than memory: `generate`, `bricks`, `walk`.

mod bricks;
mod generate;
mod town;
mod walk;

pub use bricks::Cut;
pub use generate::Generate;
use indicatif::{ProgressBar, ProgressStyle};
pub use walk::Walk;

type Done = Result<(), Box<dyn std::error::Error>>;

/// A bar that counts points; without a total, how many and how fast.
fn progress(total: Option<u64>, label: &'static str) -> ProgressBar {
    let (bar, template) = match total {
        Some(total) => (ProgressBar::new(total), "{msg} {bar:40} {percent} %, {eta} left"),
        None => (ProgressBar::new_spinner(), "{spinner} {msg} {human_pos} points, {per_sec}"),
    };
    let style = ProgressStyle::with_template(template);
    style.map_or(bar.clone(), |style| bar.with_style(style)).with_message(label)
}

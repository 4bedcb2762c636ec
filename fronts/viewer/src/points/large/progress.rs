//! A bar for work that takes long.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar that counts points; without a total, how many and how fast.
pub fn progress(total: Option<u64>, label: &'static str) -> ProgressBar {
    let (bar, template) = match total {
        Some(total) => (ProgressBar::new(total), "{msg} {bar:40} {percent} %, {eta} left"),
        None => (ProgressBar::new_spinner(), "{spinner} {msg} {human_pos} points, {per_sec}"),
    };
    let style = ProgressStyle::with_template(template);
    style.map_or(bar.clone(), |style| bar.with_style(style)).with_message(label)
}

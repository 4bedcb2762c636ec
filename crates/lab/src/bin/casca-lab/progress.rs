//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar with a label that counts up to `total` of what `unit` names.
pub fn bar(quiet: bool, total: usize, label: &str, unit: &str) -> ProgressBar {
    let template = format!("{{msg}} {{bar:40}} {unit} {{pos}} of {{len}}, {{eta}} left");
    start(quiet, ProgressBar::new(total as u64), &template).with_message(label.to_owned())
}

/// A sign that work goes on, after the time that has passed.
pub fn spinner(quiet: bool) -> ProgressBar {
    let spinner = start(quiet, ProgressBar::new_spinner(), "{spinner} {elapsed} {prefix}: {wide_msg}");
    spinner.enable_steady_tick(Duration::from_millis(200));
    spinner
}

fn start(quiet: bool, bar: ProgressBar, template: &str) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_sound() {
        for template in
            ["{msg} {bar:40} frame {pos} of {len}, {eta} left", "{spinner} {elapsed} {prefix}: {wide_msg}"]
        {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
        let bar = bar(true, 10, "city", "frame");
        bar.inc(3);
        assert!(bar.is_hidden());
    }
}

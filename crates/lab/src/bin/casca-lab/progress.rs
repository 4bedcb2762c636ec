//! Progress on the terminal.

use indicatif::{ProgressBar, ProgressStyle};

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

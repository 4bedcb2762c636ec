//! The times of the stages of frames, as a table.

use std::time::Duration;

use casca_tools::command_line::say;

/// Stages of a frame with their times, in the order in which they ran; one may run several times.
pub type Stages = Vec<(&'static str, Duration)>;

/// Prints a row for each stage and one for whole frames, in milliseconds, and a column for each way
/// of making frames: medians over its frames.
pub fn table(ways: &[(&str, Vec<Stages>)]) {
    let mut names: Vec<&'static str> = Vec::new();
    for (name, _) in ways.iter().flat_map(|(_, frames)| frames.iter().flatten()) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let row = |name: &str, of: &dyn Fn(&[Stages]) -> f64| {
        let times: String = ways.iter().map(|(_, frames)| format!("{:>16.2}", of(frames))).collect();
        say(format_args!("{name:<18}{times}"));
    };
    let heads: String = ways.iter().map(|(way, _)| format!("{way:>16}")).collect();
    say(format_args!("{:<18}{heads}", "ms"));
    for name in names {
        row(name, &|frames| median(frames, &|stage| stage == name));
    }
    row("frame", &|frames| median(frames, &|_| true));
}

/// The median over frames of the time that the chosen stages take in a frame, in milliseconds.
fn median(frames: &[Stages], is_chosen: &dyn Fn(&str) -> bool) -> f64 {
    let of = |frame: &Stages| frame.iter().filter(|s| is_chosen(s.0)).map(|s| s.1).sum::<Duration>();
    let mut times: Vec<Duration> = frames.iter().map(of).collect();
    times.sort_unstable();
    times.get(times.len() / 2).map_or(0.0, |time| time.as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_that_of_the_sums_of_each_frame() {
        let ms = Duration::from_millis;
        let frames: Vec<Stages> =
            [3, 90, 4, 5, 1].map(|t| vec![("rays", ms(t)), ("show", ms(7)), ("rays", ms(1))]).into();
        assert_eq!(median(&frames, &|name| name == "rays"), 5.0);
        assert_eq!((median(&frames, &|_| true), median(&[], &|_| true)), (12.0, 0.0));
    }
}

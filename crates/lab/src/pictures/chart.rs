//! The chart of a walk.

use std::path::Path;

use super::PictureError;
use super::palette::{EXACT, FRUSTUM, POINT};
use super::{Axis, Line, lines};

/// One frame of a walk, for the chart.
#[derive(Debug, Clone, Copy)]
pub struct FrameCounts {
    /// Objects in the frustum.
    pub frustum: usize,
    /// Objects in the PVS.
    pub pvs: usize,
    /// Objects that can be seen.
    pub exact: usize,
}

/// Draws objects in the frustum, in the PVS and visible, frame by frame, as an SVG. The finding is
/// its title, and `title` stands below.
///
/// # Errors
/// If the file cannot be written.
pub fn chart(path: &Path, title: &str, frames: &[FrameCounts]) -> Result<(), PictureError> {
    if frames.is_empty() {
        return Err(PictureError::at(path)("there are no frames".to_owned()));
    }
    let of = |label: &str, style, value: fn(&FrameCounts) -> usize| {
        let points = frames.iter().enumerate().map(|(i, f)| (i as f64, value(f) as f64));
        Line::new(format!("{label}: {:.0}", mean(frames, value)), style, points.collect())
    };
    let all = [
        of("in view", FRUSTUM, |f| f.frustum),
        of("found visible", POINT, |f| f.pvs),
        of("exactly visible", EXACT.dashed(), |f| f.exact),
    ];
    let subtitle = format!("{title}. The legend gives the means over the walk.");
    let axes = (&Axis::linear("frame of the walk"), &Axis::linear("objects"));
    lines(path, &finding(frames), &subtitle, axes, &all)
}

fn mean(frames: &[FrameCounts], value: fn(&FrameCounts) -> usize) -> f64 {
    frames.iter().map(|f| value(f) as f64).sum::<f64>() / frames.len().max(1) as f64
}

fn finding(frames: &[FrameCounts]) -> String {
    let [view, found, exact] =
        [mean(frames, |f| f.frustum), mean(frames, |f| f.pvs), mean(frames, |f| f.exact)];
    let kept = if view > 0.0 { found / view * 100.0 } else { 100.0 };
    match exact > 0.0 {
        true => format!(
            "{kept:.0}% of the objects in view are found visible: {:.2} for each that can be seen",
            found / exact
        ),
        false => format!("{kept:.0}% of the objects in view are found visible"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_title_says_the_finding() {
        let frame = |frustum, pvs, exact| FrameCounts { frustum, pvs, exact };
        let said = finding(&[frame(100, 10, 8), frame(300, 30, 24)]);
        assert_eq!(said, "10% of the objects in view are found visible: 1.25 for each that can be seen");
        assert!(!finding(&[frame(0, 0, 0)]).contains("NaN"));
    }
}

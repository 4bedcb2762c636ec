//! Bars: how a whole is shared out, side by side.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::PictureError;
use super::lines::SIZE;
use super::palette::{QUIET, TEXT, other, text_on};
use super::svg::{Area, Drawn, Head, Sample, save, text};

/// One bar.
#[derive(Debug, Clone)]
pub struct Bar {
    /// What stands before it.
    pub label: String,
    /// Percent of each part, as many as there are parts. Parts that are not greater than 0 are not
    /// drawn.
    pub shares: Vec<f64>,
}

/// Pixels of the left border, where the labels are, of one percent, and from one bar to the next.
const LEFT: i32 = 190;
const PERCENT: f64 = 7.7;
const STEP: i32 = 74;

/// Draws horizontal bars of 0 to 100 percent as an SVG, with the names of the parts above them.
///
/// # Errors
/// If the file cannot be written.
pub fn bars(
    path: &Path,
    title: &str,
    subtitle: &str,
    axis: &str,
    parts: &[&str],
    bars: &[Bar],
) -> Result<(), PictureError> {
    let key = |(i, part): (usize, &&str)| (Sample::Box(other(i).color), (*part).to_owned());
    let head = Head::new(SIZE.0, title, subtitle, parts.iter().enumerate().map(key).collect());
    let bottom = head.height + STEP * bars.len() as i32 + 6;
    save(path, (SIZE.0, bottom as u32 + 64), |root| {
        head.draw(root)?;
        for tick in (0..=100).step_by(10) {
            let x = at(f64::from(tick));
            root.draw(&PathElement::new([(x, head.height), (x, bottom)], BLACK.mix(0.15)))?;
            text(root, (x, bottom + 14), 14.0, TEXT, HPos::Center, &tick.to_string())?;
        }
        text(root, (at(50.0), bottom + 42), 15.0, TEXT, HPos::Center, axis)?;
        for (i, one) in bars.iter().enumerate() {
            bar(root, head.height + 8 + STEP * i as i32, one)?;
        }
        Ok(())
    })
}

fn at(percent: f64) -> i32 {
    LEFT + (percent * PERCENT).round() as i32
}

fn bar(root: &Area<'_>, top: i32, bar: &Bar) -> Drawn {
    text(root, (LEFT - 12, top + 28), 15.0, TEXT, HPos::Right, &bar.label)?;
    let mut from = 0.0;
    for (i, &share) in bar.shares.iter().enumerate().filter(|(_, s)| s.is_finite() && **s > 0.0) {
        let color = other(i).color;
        let corners = [(at(from), top), (at(from + share), top + 56)];
        root.draw(&Rectangle::new(corners, color.filled()))?;
        // A border tells neighbours apart in grey, too.
        root.draw(&Rectangle::new(corners, WHITE.stroke_width(1)))?;
        if share >= 4.0 {
            let middle = (at(from + share / 2.0), top + 28);
            text(root, middle, 14.0, text_on(color), HPos::Center, &format!("{share:.0}"))?;
        }
        from += share;
    }
    root.draw(&PathElement::new([(at(0.0), top), (at(0.0), top + 56)], QUIET))?;
    Ok(())
}

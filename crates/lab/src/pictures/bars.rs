//! Bars: how a whole is shared out, side by side.

use std::path::Path;

use plotters::prelude::*;

use super::COLORS;
use super::lines::{SIZE, legend_width};
use super::{FONT, PictureError, error, with_font};

/// One bar.
#[derive(Debug, Clone)]
pub struct Bar {
    /// What stands before it.
    pub label: String,
    /// Percent of each part, as many as there are parts. Nothing is drawn for what is not greater than 0.
    pub shares: Vec<f64>,
}

/// Pixels of the left border, where the labels are, and of one percent.
const LEFT: i32 = 230;
const PERCENT: f64 = 7.4;

/// Draws horizontal bars of 0 to 100 percent as a PNG, with the names of the parts beside them.
///
/// # Errors
/// If the file cannot be written.
pub fn bars(path: &Path, title: &str, axis: &str, parts: &[&str], bars: &[Bar]) -> Result<(), PictureError> {
    with_font();
    let room = legend_width(parts.iter().copied());
    let root = BitMapBackend::new(path, (SIZE.0 + room, 150 + 90 * bars.len() as u32)).into_drawing_area();
    let draw = || -> Result<(), Box<dyn std::error::Error>> {
        root.fill(&WHITE)?;
        root.draw(&Text::new(title, (LEFT - 100, 18), (FONT, 26)))?;
        let bottom = 70 + 90 * bars.len() as i32;
        let at = |percent: f64| LEFT + (percent * PERCENT).round() as i32;
        for tick in (0..=100).step_by(10) {
            let x = at(f64::from(tick));
            root.draw(&PathElement::new([(x, 62), (x, bottom)], BLACK.mix(0.15)))?;
            root.draw(&Text::new(format!("{tick}"), (x - 8, bottom + 6), (FONT, 17)))?;
        }
        root.draw(&Text::new(axis, (LEFT + 200, bottom + 36), (FONT, 19)))?;
        for (i, bar) in bars.iter().enumerate() {
            let top = 76 + 90 * i as i32;
            root.draw(&Text::new(bar.label.as_str(), (16, top + 20), (FONT, 19)))?;
            let mut from = 0.0;
            for (share, color) in bar.shares.iter().zip(COLORS.iter().cycle()) {
                if !(share.is_finite() && *share > 0.0) {
                    continue;
                }
                let corners = [(at(from), top), (at(from + share), top + 60)];
                root.draw(&Rectangle::new(corners, color.filled()))?;
                if *share >= 4.0 {
                    let style = (FONT, 17).into_font().color(&WHITE);
                    root.draw(&Text::new(
                        format!("{share:.0}"),
                        (at(from + share / 2.0) - 8, top + 21),
                        style,
                    ))?;
                }
                from += share;
            }
        }
        for (i, (part, color)) in parts.iter().zip(COLORS.iter().cycle()).enumerate() {
            let y = 76 + 26 * i as i32;
            let x = SIZE.0 as i32;
            root.draw(&Rectangle::new([(x, y), (x + 26, y + 16)], color.filled()))?;
            root.draw(&Text::new(*part, (x + 36, y), (FONT, 17)))?;
        }
        root.present()?;
        Ok(())
    };
    draw().map_err(|e| error(path)(e.to_string()))
}

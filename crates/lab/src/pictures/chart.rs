//! The chart of a walk.

use std::path::Path;

use plotters::prelude::*;

use super::{FONT, PictureError, error, with_font};

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

const FRUSTUM_COLOR: RGBColor = RGBColor(150, 150, 150);
const PVS_COLOR: RGBColor = RGBColor(31, 90, 180);
const EXACT_COLOR: RGBColor = RGBColor(20, 140, 60);

/// Draws objects in the frustum, in the PVS and visible, frame by frame, as a PNG.
///
/// # Errors
/// If the file cannot be written.
pub fn chart(path: &Path, title: &str, frames: &[FrameCounts]) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let root = BitMapBackend::new(path, (1200, 640)).into_drawing_area();
    let draw = || -> Result<(), Box<dyn std::error::Error>> {
        root.fill(&WHITE)?;
        let top = frames.iter().map(|f| f.frustum.max(f.pvs)).max().unwrap_or(1).max(1) as f64 * 1.12;
        let last = frames.len().saturating_sub(1).max(1);
        let mut chart = ChartBuilder::on(&root)
            .caption(title, (FONT, 26))
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(70)
            .build_cartesian_2d(0..last, 0.0..top)?;
        chart
            .configure_mesh()
            .x_desc("frame of the walk")
            .y_desc("objects")
            .label_style((FONT, 17))
            .axis_desc_style((FONT, 19))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .light_line_style(WHITE)
            .draw()?;
        let mut line = |label: &str,
                        color: RGBColor,
                        of: fn(&FrameCounts) -> usize|
         -> Result<(), Box<dyn std::error::Error>> {
            let mean = frames.iter().map(|f| of(f) as f64).sum::<f64>() / frames.len().max(1) as f64;
            chart
                .draw_series(LineSeries::new(
                    frames.iter().enumerate().map(|(i, f)| (i, of(f) as f64)),
                    color.stroke_width(3),
                ))?
                .label(format!("{label} (mean {mean:.0})"))
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(3)));
            Ok(())
        };
        line("in the frustum", FRUSTUM_COLOR, |f| f.frustum)?;
        line("found visible by casca (PVS)", PVS_COLOR, |f| f.pvs)?;
        line("truly visible (exact)", EXACT_COLOR, |f| f.exact)?;
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .label_font((FONT, 18))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .legend_area_size(32)
            .draw()?;
        root.present()?;
        Ok(())
    };
    draw().map_err(|e| fail(e.to_string()))
}

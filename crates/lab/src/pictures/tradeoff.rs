//! Speed against accuracy.

use std::path::Path;

use plotters::prelude::*;

use super::{COLORS, FONT, PictureError, error, with_font};

/// One method at one setting on one scene.
#[derive(Debug, Clone)]
pub struct TradeoffPoint {
    /// The scene.
    pub scene: String,
    /// The method.
    pub method: String,
    /// The setting that varies, in a word.
    pub setting: String,
    /// Median time of a frame in milliseconds.
    pub ms: f64,
    /// Objects found visible over objects that are.
    pub ratio: f64,
    /// Visible objects lost in a frame, on average.
    pub lost: f64,
    /// Whether it is on the Pareto front of those that lose nothing.
    pub front: bool,
}

/// Draws speed against accuracy: a panel for each scene, a line for each method, a disc for each setting
/// that lost nothing, with a ring on the Pareto front, and a cross for each that did. PNG, or SVG by the file's ending.
///
/// # Errors
/// If the file cannot be written.
pub fn tradeoff(path: &Path, title: &str, points: &[TradeoffPoint]) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let rows = (distinct(points, |p| &p.scene).len() + 1).div_ceil(3).max(1);
    let size = (1500, 60 + 470 * rows as u32);
    let drawn = if path.extension().is_some_and(|e| e == "svg") {
        draw_tradeoff(&SVGBackend::new(path, size).into_drawing_area(), title, points)
    } else {
        draw_tradeoff(&BitMapBackend::new(path, size).into_drawing_area(), title, points)
    };
    drawn.map_err(|e| fail(e.to_string()))
}

/// The values of a field in the order in which they first come.
fn distinct(points: &[TradeoffPoint], of: fn(&TradeoffPoint) -> &String) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for p in points {
        if !found.contains(of(p)) {
            found.push(of(p).clone());
        }
    }
    found
}

fn draw_tradeoff<B>(
    root: &DrawingArea<B, plotters::coord::Shift>,
    title: &str,
    points: &[TradeoffPoint],
) -> Result<(), Box<dyn std::error::Error>>
where
    B: DrawingBackend,
    B::ErrorType: 'static,
{
    root.fill(&WHITE)?;
    let root = root.titled(title, (FONT, 28))?;
    let scenes = distinct(points, |p| &p.scene);
    let methods = distinct(points, |p| &p.method);
    let panels = root.split_evenly(((scenes.len() + 1).div_ceil(3).max(1), 3));
    for (scene, panel) in scenes.iter().zip(&panels) {
        let own: Vec<&TradeoffPoint> = points.iter().filter(|p| p.scene == *scene).collect();
        let (mut left, mut right, mut top) = (f64::INFINITY, 0f64, 1.2f64);
        for p in &own {
            (left, right) = (left.min(p.ms), right.max(p.ms));
            top = top.max(p.ratio.min(3.0));
        }
        let (left, right) = (left.max(1e-4) * 0.7, right.max(1e-3) * 1.5);
        let bottom = own.iter().map(|p| p.ratio).fold(1.0, f64::min) - 0.05;
        let mut chart = ChartBuilder::on(panel)
            .caption(scene, (FONT, 22))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(56)
            .build_cartesian_2d((left..right).log_scale(), bottom..top + 0.1)?;
        chart
            .configure_mesh()
            .x_desc("ms a frame")
            .y_desc("found visible / visible")
            .label_style((FONT, 15))
            .axis_desc_style((FONT, 16))
            .x_labels(6)
            .y_label_formatter(&|v| format!("{v:.2}"))
            .light_line_style(WHITE)
            .draw()?;
        chart.draw_series(LineSeries::new([(left, 1.0), (right, 1.0)], BLACK.mix(0.5)))?;
        for (i, method) in methods.iter().enumerate() {
            let color = COLORS[i % COLORS.len()];
            let at: Vec<(f64, f64, f64, bool)> = own
                .iter()
                .filter(|p| p.method == *method)
                .map(|p| (p.ms, p.ratio.min(top), p.lost, p.front))
                .collect();
            chart.draw_series(LineSeries::new(at.iter().map(|p| (p.0, p.1)), color.stroke_width(2)))?;
            for &(x, y, lost, front) in &at {
                if front {
                    chart.draw_series([Circle::new((x, y), 9, BLACK.stroke_width(2))])?;
                }
                if lost > 0.0 {
                    chart.draw_series([Cross::new((x, y), 6, color.stroke_width(2))])?;
                    let label = format!("{lost:.2}");
                    chart.draw_series([Text::new(
                        label,
                        (x, y + (top - bottom) * 0.03),
                        (FONT, 13).into_font().color(&color),
                    )])?;
                } else {
                    chart.draw_series([Circle::new((x, y), 5, color.filled())])?;
                }
            }
        }
    }
    let Some(legend) = panels.get(scenes.len()) else { return Ok(root.present()?) };
    let text = |at: (i32, i32), text: &str, color: RGBColor| {
        legend.draw(&Text::new(text.to_owned(), at, (FONT, 20).into_font().color(&color)))
    };
    for (i, method) in methods.iter().enumerate() {
        let (color, y) = (COLORS[i % COLORS.len()], 60 + 32 * i as i32);
        legend.draw(&PathElement::new([(40, y), (80, y)], color.stroke_width(3)))?;
        text((92, y - 10), method, color)?;
    }
    let y = 80 + 32 * methods.len() as i32;
    legend.draw(&Circle::new((60, y), 5, BLACK.filled()))?;
    text((92, y - 10), "nothing visible was lost", BLACK)?;
    legend.draw(&Cross::new((60, y + 32), 6, BLACK.stroke_width(2)))?;
    text((92, y + 22), "visible objects lost in each frame (the number)", BLACK)?;
    legend.draw(&Circle::new((60, y + 64), 9, BLACK.stroke_width(2)))?;
    text((92, y + 54), "on the Pareto front of what lost nothing", BLACK)?;
    text((40, y + 92), "Down and to the left is better; 1 is exact.", BLACK)?;
    root.present()?;
    Ok(())
}

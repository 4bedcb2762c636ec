//! What frames cost against what an object is worth.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::PictureError;
use super::palette::{CELL, FRUSTUM, HIDDEN, HZB, POINT, QUIET, RAYS, Style, TEXT};
use super::svg::{Area, Drawn, font, log_ticks, path as draw_path, save, short, text};

/// One method on one scene.
#[derive(Debug, Clone)]
pub struct WorthLine {
    /// The scene.
    pub scene: String,
    /// The method.
    pub method: String,
    /// Mean time of a frame's query in milliseconds.
    pub ms: f64,
    /// Objects found, of a frame.
    pub set: f64,
    /// Objects that are visible.
    pub visible: f64,
    /// Visible objects lost in a frame.
    pub lost: f64,
}

impl WorthLine {
    /// A method on a scene, of which nothing is known yet.
    pub fn new(scene: &str, method: &str) -> Self {
        let (scene, method) = (scene.to_owned(), method.to_owned());
        Self { scene, method, ms: 0.0, set: 0.0, visible: 0.0, lost: 0.0 }
    }

    /// Milliseconds of a frame whose objects cost this many microseconds each.
    fn cost(&self, worth: f64) -> f64 {
        self.ms + self.set * worth / MICROSECONDS
    }
}

const WIDTH: u32 = 1000;
const PANEL: u32 = 300;
const COLUMNS: usize = 2;
/// Worths of an object in microseconds.
const WORTHS: (f64, f64) = (1.0, 100.0);
/// Of a millisecond.
const MICROSECONDS: f64 = 1e3;
/// Pixels between labels.
const APART: i32 = 15;

/// Draws query time plus worth times set against the worth: a panel for each scene, a line for each
/// method, dashed where it loses visible objects, with its name at its end. SVG.
///
/// # Errors
/// If the file cannot be written.
pub fn worth(path: &Path, lines: &[WorthLine]) -> Result<(), PictureError> {
    let mut scenes: Vec<&str> = lines.iter().map(|line| line.scene.as_str()).collect();
    scenes.dedup();
    scenes.sort_unstable();
    scenes.dedup();
    let rows = scenes.len().div_ceil(COLUMNS).max(1);
    save(path, (WIDTH, PANEL * rows as u32), |root| {
        for (scene, area) in scenes.iter().zip(root.split_evenly((rows, COLUMNS))) {
            let own: Vec<&WorthLine> = lines.iter().filter(|line| line.scene == *scene).collect();
            panel(root, &area, scene, &own)?;
        }
        Ok(())
    })
}

/// Colours that all readers can tell apart, and dashes for what loses visible objects.
fn look(line: &WorthLine) -> Style {
    let color = match line.method.as_str() {
        "frustum only" => FRUSTUM.color,
        "hzb" => HZB.color,
        "MOC" => RAYS.color,
        "rasterizer" => CELL.color,
        "casca fast" => RGBColor(86, 180, 233),
        "casca kept" => HIDDEN,
        _ => POINT.color,
    };
    Style { color, dashed: line.lost > 0.0, ..POINT }
}

/// Heights of labels near those of the ends of their lines, but apart from each other.
fn apart(ends: &[i32]) -> Vec<i32> {
    let mut order: Vec<usize> = (0..ends.len()).collect();
    order.sort_by_key(|&i| ends[i]);
    let mut heights = ends.to_vec();
    // Twice: labels that were pushed down meet others, which are pushed up by half of it.
    for pair in order.windows(2) {
        heights[pair[1]] = heights[pair[1]].max(heights[pair[0]] + APART);
    }
    let pushed = |heights: &[i32]| order.iter().map(|&i| heights[i] - ends[i]).max().unwrap_or(0);
    let up = pushed(&heights) / 2;
    heights.iter().map(|h| h - up).collect()
}

fn panel(root: &Area<'_>, area: &Area<'_>, scene: &str, lines: &[&WorthLine]) -> Drawn {
    let costs = || lines.iter().flat_map(|line| [line.cost(WORTHS.0), line.cost(WORTHS.1)]);
    let (least, most) = costs().fold((f64::INFINITY, 0f64), |(lo, hi), c| (lo.min(c), hi.max(c)));
    let (bottom, top) = (least / 1.15, most * 1.15);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_top(30)
        .margin_right(124)
        .x_label_area_size(42)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (WORTHS.0..WORTHS.1).log_scale().with_key_points(vec![1.0, 3.0, 10.0, 30.0, 100.0]),
            (bottom..top).log_scale().with_key_points(log_ticks(bottom, top)),
        )?;
    chart
        .configure_mesh()
        .x_desc("worth of an object, µs")
        .y_desc("query + worth × set, ms")
        .label_style(font(14.0).color(&TEXT))
        .axis_desc_style(font(14.0).color(&QUIET))
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .axis_style(QUIET)
        .bold_line_style(BLACK.mix(0.1))
        .light_line_style(TRANSPARENT)
        .draw()?;
    let place = |line: &WorthLine, worth: f64| chart.backend_coord(&(worth, line.cost(worth)));
    let corner = area.get_base_pixel();
    text(root, (corner.0 + 64, corner.1 + 16), 17.0, TEXT, HPos::Left, scene)?;
    for line in lines {
        let steps = (0..=40).map(|i| WORTHS.0 * (WORTHS.1 / WORTHS.0).powf(f64::from(i) / 40.0));
        draw_path(root, &steps.map(|worth| place(line, worth)).collect::<Vec<_>>(), &look(line))?;
    }
    let ends: Vec<i32> = lines.iter().map(|line| place(line, WORTHS.1).1).collect();
    for ((line, end), height) in lines.iter().zip(&ends).zip(apart(&ends)) {
        let (x, style) = (place(line, WORTHS.1).0, look(line));
        root.draw(&PathElement::new([(x + 1, *end), (x + 10, height)], style.color.stroke_width(1)))?;
        text(root, (x + 13, height), 14.0, style.color, HPos::Left, &line.method)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_lines_rise_with_the_worth() {
        let mut heights = apart(&[100, 102, 200, 101]);
        heights.sort_unstable();
        assert!(heights.windows(2).all(|w| w[1] - w[0] >= APART), "{heights:?}");
        assert!((80..=100).contains(&heights[0]) && heights[3] <= 200);
        let line = WorthLine { ms: 2.0, set: 50.0, ..WorthLine::new("city", "hzb") };
        assert_eq!((line.cost(0.0), line.cost(10.0)), (2.0, 2.5));
        assert!(!look(&line).dashed && look(&WorthLine { lost: 0.1, ..line }).dashed);
    }
}

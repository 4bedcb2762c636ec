//! Pictures: the chart of a walk, the grid from above, and speed against accuracy.

use std::path::Path;

use casca::Scene;
use casca::matrix::BitMatrix;
use glam::{DVec3, IVec3, Vec3};
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use crate::world::Camera;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
#[error("cannot draw {path}: {why}")]
pub struct PictureError {
    path: String,
    why: String,
}

fn error(path: &Path) -> impl Fn(String) -> PictureError + '_ {
    move |why| PictureError { path: path.display().to_string(), why }
}

const FONT: &str = "sans-serif";

/// Makes the text of pictures work without fonts on the machine.
fn with_font() {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        // Fails only for broken font data.
        let _ = register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT);
    }
}

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
}

const METHOD_COLORS: [RGBColor; 6] = [
    RGBColor(31, 90, 180),
    RGBColor(20, 140, 60),
    RGBColor(200, 90, 20),
    RGBColor(150, 40, 150),
    RGBColor(120, 120, 120),
    RGBColor(0, 0, 0),
];

/// Draws speed against accuracy: a panel for each scene, a line for each method, a disc for each setting
/// that lost nothing and a cross for each that did. PNG, or SVG by the file's ending.
///
/// # Errors
/// If the file cannot be written.
pub fn tradeoff(path: &Path, title: &str, points: &[TradeoffPoint]) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let size = (1500, 1000);
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
            let color = METHOD_COLORS[i % METHOD_COLORS.len()];
            let at: Vec<(f64, f64, f64)> = own
                .iter()
                .filter(|p| p.method == *method)
                .map(|p| (p.ms, p.ratio.min(top), p.lost))
                .collect();
            chart.draw_series(LineSeries::new(at.iter().map(|p| (p.0, p.1)), color.stroke_width(2)))?;
            for &(x, y, lost) in &at {
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
        let (color, y) = (METHOD_COLORS[i % METHOD_COLORS.len()], 60 + 32 * i as i32);
        legend.draw(&PathElement::new([(40, y), (80, y)], color.stroke_width(3)))?;
        text((92, y - 10), method, color)?;
    }
    let y = 80 + 32 * methods.len() as i32;
    legend.draw(&Circle::new((60, y), 5, BLACK.filled()))?;
    text((92, y - 10), "nothing visible was lost", BLACK)?;
    legend.draw(&Cross::new((60, y + 32), 6, BLACK.stroke_width(2)))?;
    text((92, y + 22), "visible objects lost in each frame (the number)", BLACK)?;
    text((40, y + 64), "Down and to the left is better; 1 is exact.", BLACK)?;
    root.present()?;
    Ok(())
}

/// What the picture from above shows of one frame.
pub struct TopView<'a> {
    /// The scene at that frame.
    pub scene: &'a Scene,
    /// Cells that the walk visited.
    pub visited: &'a BitMatrix,
    /// Cells that it found hidden.
    pub hidden: &'a BitMatrix,
    /// Temporal bounding volumes at the eye's height: their corners.
    pub volumes: &'a [(DVec3, DVec3)],
    /// The camera.
    pub camera: Camera,
    /// Where the camera goes.
    pub path: &'a [Vec3],
}

const OPAQUE_CELL: RGBColor = RGBColor(60, 60, 66);
const HIDDEN_CELL: RGBColor = RGBColor(176, 196, 226);
const VISIBLE_CELL: RGBColor = RGBColor(255, 226, 140);
const PARTLY_CELL: RGBColor = RGBColor(205, 205, 205);
const VOLUME: RGBColor = RGBColor(190, 40, 150);
const VIEW: RGBColor = RGBColor(200, 30, 30);
const WALK: RGBColor = RGBColor(20, 120, 60);

/// Draws the slice of the grid at the eye's height from above, as a PNG: opaque,
/// hidden and visible cells, temporal bounding volumes, frustum and path.
///
/// # Errors
/// If the file cannot be written.
pub fn top_view(path: &Path, title: &str, view: &TopView) -> Result<(), PictureError> {
    let fail = error(path);
    with_font();
    let grid = view.scene.grid();
    let (min, max) = (grid.min(), grid.max());
    let (width, depth) = (max.x - min.x, max.z - min.z);
    let long = width.max(depth);
    let (w, h) = ((880.0 * width / long) as u32 + 360, (880.0 * depth / long).max(420.0) as u32 + 120);
    let root = BitMapBackend::new(path, (w, h)).into_drawing_area();
    let draw = || -> Result<(), Box<dyn std::error::Error>> {
        root.fill(&WHITE)?;
        let (left, right) = root.split_horizontally(w - 290);
        let mut chart = ChartBuilder::on(&left)
            .caption(title, (FONT, 22))
            .margin(10)
            .x_label_area_size(44)
            .y_label_area_size(60)
            .build_cartesian_2d(min.x..max.x, max.z..min.z)?;
        let eye = view.camera.eye.as_dvec3();
        let dims = grid.dims();
        let y = grid.cell_of(eye).y.clamp(0, dims.y - 1);
        let mut cells = Vec::new();
        for z in 0..dims.z {
            for x in 0..dims.x {
                let c = IVec3::new(x, y, z);
                let color = if view.scene.is_opaque(c) {
                    OPAQUE_CELL
                } else if view.hidden.get(c) {
                    HIDDEN_CELL
                } else if view.visited.get(c) {
                    VISIBLE_CELL
                } else if view.scene.is_occupied(c) {
                    PARTLY_CELL
                } else {
                    continue;
                };
                let (lo, hi) = grid.cell_bounds(c);
                cells.push(Rectangle::new([(lo.x, lo.z), (hi.x, hi.z)], color.filled()));
            }
        }
        chart.draw_series(cells)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc("x (m)")
            .y_desc("z (m)")
            .label_style((FONT, 15))
            .axis_desc_style((FONT, 17))
            .x_label_formatter(&|v| format!("{v:.0}"))
            .y_label_formatter(&|v| format!("{v:.0}"))
            .draw()?;
        chart.draw_series(
            view.volumes
                .iter()
                .map(|(lo, hi)| Rectangle::new([(lo.x, lo.z), (hi.x, hi.z)], VOLUME.stroke_width(1))),
        )?;
        chart.draw_series(LineSeries::new(
            view.path.iter().map(|p| (f64::from(p.x), f64::from(p.z))),
            WALK.stroke_width(2),
        ))?;
        let inverse = view.camera.view_projection().as_dmat4().inverse();
        for x in [-1.0, 1.0] {
            // The lateral border of the frustum at the eye's height, as far as the picture goes.
            let towards = inverse.project_point3(DVec3::new(x, 0.0, 0.5)) - eye;
            let flat = DVec3::new(towards.x, 0.0, towards.z).normalize_or_zero();
            let mut reach = 2.0 * long;
            for (o, d, lo, hi) in [(eye.x, flat.x, min.x, max.x), (eye.z, flat.z, min.z, max.z)] {
                if d.abs() > 1e-9 {
                    let border = if d > 0.0 { hi } else { lo };
                    reach = reach.min(((border - o) / d).max(0.0));
                }
            }
            let end = eye + flat * reach;
            chart.draw_series(LineSeries::new([(eye.x, eye.z), (end.x, end.z)], VIEW.stroke_width(2)))?;
        }
        chart.draw_series([Circle::new((eye.x, eye.z), 5, VIEW.filled())])?;

        let text = |label: &str, y: i32| Text::new(label.to_owned(), (46, y), (FONT, 17).into_font());
        let height = y_label(grid.min().y + (f64::from(y) + 0.5) * grid.cell_size());
        right.draw(&Text::new(
            format!("Slice at eye height ({height} m)"),
            (10, 50),
            (FONT, 17).into_font(),
        ))?;
        let boxes = [
            (VISIBLE_CELL, "visible cell"),
            (HIDDEN_CELL, "hidden cell"),
            (OPAQUE_CELL, "opaque cell (occludes)"),
            (PARTLY_CELL, "occupied, not visited"),
        ];
        let mut at = 84;
        for (color, label) in boxes {
            right.draw(&Rectangle::new([(10, at), (36, at + 18)], color.filled()))?;
            right.draw(&text(label, at + 1))?;
            at += 30;
        }
        right.draw(&Rectangle::new([(10, at), (36, at + 18)], WHITE.filled()))?;
        right.draw(&Rectangle::new([(10, at), (36, at + 18)], BLACK.mix(0.2).stroke_width(1)))?;
        right.draw(&text("empty, not visited", at + 1))?;
        at += 30;
        right.draw(&Rectangle::new([(10, at), (36, at + 18)], VOLUME.stroke_width(1)))?;
        right.draw(&text("hidden moving object's", at - 6))?;
        right.draw(&text("bounding volume (TBV)", at + 11))?;
        at += 38;
        for (color, label) in [(VIEW, "eye and frustum"), (WALK, "path of the walk")] {
            right.draw(&PathElement::new([(10, at + 9), (36, at + 9)], color.stroke_width(3)))?;
            right.draw(&text(label, at + 1))?;
            at += 30;
        }
        root.present()?;
        Ok(())
    };
    draw().map_err(|e| fail(e.to_string()))
}

fn y_label(y: f64) -> String {
    format!("y = {y:.1}")
}

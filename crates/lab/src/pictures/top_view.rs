//! The grid from above.

use std::path::Path;

use casca::Scene;
use casca::matrix::BitMatrix;
use glam::{DVec3, IVec3, Vec3};
use plotters::prelude::*;

use super::{FONT, PictureError, error, with_font};
use crate::world::Camera;

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

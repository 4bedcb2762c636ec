//! The grid from above.

use std::path::Path;

use casca::Scene;
use casca::internals::{BitMatrix, SceneInternals};
use glam::{DVec3, IVec3, Vec3};
use plotters::prelude::*;

use super::PictureError;
use super::palette::{
    CAMERA, HIDDEN_CELL, Marker, OPAQUE_CELL, QUIET, Style, TEXT, UNVISITED_CELL, VISIBLE_CELL, VOLUME, WALK,
};
use super::svg::{Area, Drawn, Head, Sample, font, mark, path as draw_path, save};
use casca_scenes::world::Camera;

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

const WALKED: Style = Style { color: WALK, marker: Marker::Star, dashed: true };
const SEEN: Style = Style { color: CAMERA, marker: Marker::Disc, dashed: false };

/// Cells `x0..x1` of the rows `z0..z1`, all of one kind.
struct Block {
    x: std::ops::Range<i32>,
    z: std::ops::Range<i32>,
    kind: usize,
}

/// The kinds of cells: colours and names.
const KINDS: [(RGBColor, &str); 4] = [
    (VISIBLE_CELL, "cell that may be seen"),
    (HIDDEN_CELL, "hidden cell"),
    (OPAQUE_CELL, "opaque cell, which hides"),
    (UNVISITED_CELL, "occupied cell, not visited"),
];

impl TopView<'_> {
    /// The layer of cells at the height of the eye.
    fn layer(&self) -> i32 {
        let grid = self.scene.grid();
        grid.cell_of(self.camera.eye.as_dvec3()).y.clamp(0, grid.dims().y - 1)
    }

    fn kind(&self, occupied: &BitMatrix, cell: IVec3) -> Option<usize> {
        if self.scene.is_opaque(cell) {
            Some(2)
        } else if self.hidden.get(cell) {
            Some(1)
        } else if self.visited.get(cell) {
            Some(0)
        } else {
            occupied.get(cell).then_some(3)
        }
    }

    /// The layer's cells in as few rectangles as row by row gives.
    fn blocks(&self) -> Vec<Block> {
        let (dims, y) = (self.scene.grid().dims(), self.layer());
        let occupied = self.scene.occupied();
        let (mut done, mut open): (Vec<Block>, Vec<Block>) = (Vec::new(), Vec::new());
        for z in 0..dims.z {
            let mut row: Vec<Block> = Vec::new();
            for x in 0..dims.x {
                let Some(kind) = self.kind(&occupied, IVec3::new(x, y, z)) else { continue };
                match row.last_mut() {
                    Some(last) if last.x.end == x && last.kind == kind => last.x.end = x + 1,
                    _ => row.push(Block { x: x..x + 1, z: z..z + 1, kind }),
                }
            }
            for block in &mut row {
                if let Some(above) = open.iter().position(|o| o.x == block.x && o.kind == block.kind) {
                    block.z.start = open.swap_remove(above).z.start;
                }
            }
            done.append(&mut open);
            open = row;
        }
        done.append(&mut open);
        done
    }

    /// Shares of the visited cells of the layer that are hidden.
    fn finding(&self) -> String {
        let count = |kind| -> i32 {
            let of_kind = self.blocks().into_iter().filter(|b| b.kind == kind);
            of_kind.map(|b| (b.x.len() * b.z.len()) as i32).sum()
        };
        let (seen, hidden) = (count(0), count(1));
        let share = f64::from(hidden) / f64::from((seen + hidden).max(1)) * 100.0;
        format!("Opaque cells hide {share:.0}% of the cells in view at the height of the eye")
    }

    /// The ends of the left and right border of the view at the height of the eye.
    fn borders(&self) -> [DVec3; 2] {
        let grid = self.scene.grid();
        let (min, max, eye) = (grid.min(), grid.max(), self.camera.eye.as_dvec3());
        let inverse = self.camera.view_projection().as_dmat4().inverse();
        [-1.0, 1.0].map(|x| {
            let towards = inverse.project_point3(DVec3::new(x, 0.0, 0.5)) - eye;
            let flat = DVec3::new(towards.x, 0.0, towards.z).normalize_or_zero();
            let mut reach = 2.0 * (max - min).max_element();
            for (o, d, lo, hi) in [(eye.x, flat.x, min.x, max.x), (eye.z, flat.z, min.z, max.z)] {
                if d.abs() > 1e-9 {
                    let border = if d > 0.0 { hi } else { lo };
                    reach = reach.min(((border - o) / d).max(0.0));
                }
            }
            eye + flat * reach
        })
    }
}

/// Draws the slice of the grid at the eye's height from above, as an SVG: opaque, hidden and
/// visible cells, temporal bounding volumes, frustum and path. The finding is its title, and
/// `title` stands below.
///
/// # Errors
/// If the file cannot be written.
pub fn top_view(path: &Path, title: &str, view: &TopView) -> Result<(), PictureError> {
    let grid = view.scene.grid();
    let size = grid.max() - grid.min();
    let long = size.x.max(size.z);
    let wide = ((880.0 * size.x / long) as u32 + 120).max(760);
    let mut keys: Vec<(Sample, String)> =
        KINDS.iter().map(|&(color, name)| (Sample::Box(color), name.to_owned())).collect();
    keys.push((Sample::Frame(QUIET), "empty cell, not visited".to_owned()));
    keys.push((Sample::Frame(VOLUME), "bounding volume of a hidden moving object".to_owned()));
    keys.push((Sample::Line(SEEN), "eye and borders of the view".to_owned()));
    keys.push((Sample::Line(WALKED), "path of the walk, from the star".to_owned()));
    let middle = grid.min().y + (f64::from(view.layer()) + 0.5) * grid.cell_size();
    let subtitle = format!("{title}; the slice at the height of the eye, y = {middle:.1} m");
    let head = Head::new(wide, &view.finding(), &subtitle, keys);
    let high = (880.0 * size.z / long).max(300.0) as u32 + 90 + head.height as u32;
    save(path, (wide, high), |root| {
        head.draw(root)?;
        draw(root, &head, view)
    })
}

fn draw(root: &Area<'_>, head: &Head, view: &TopView) -> Drawn {
    let grid = view.scene.grid();
    let (min, max) = (grid.min(), grid.max());
    let (_, plot) = root.split_vertically(head.height);
    let mut chart = ChartBuilder::on(&plot)
        .margin(14)
        .x_label_area_size(50)
        .y_label_area_size(64)
        .build_cartesian_2d(min.x..max.x, max.z..min.z)?;
    for block in view.blocks() {
        let cell = |x, z| grid.cell_bounds(IVec3::new(x, 0, z));
        let (lo, hi) = (cell(block.x.start, block.z.start).0, cell(block.x.end - 1, block.z.end - 1).1);
        let corners = [(lo.x, lo.z), (hi.x, hi.z)].map(|p| chart.backend_coord(&p));
        root.draw(&Rectangle::new(corners, KINDS[block.kind].0.filled()))?;
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("x, m")
        .y_desc("z, m")
        .label_style(font(14.0).color(&TEXT))
        .axis_desc_style(font(15.0).color(&TEXT))
        .x_label_formatter(&|v| format!("{v:.0}"))
        .y_label_formatter(&|v| format!("{v:.0}"))
        .axis_style(QUIET)
        .draw()?;
    let at = |x: f64, z: f64| chart.backend_coord(&(x, z));
    for (lo, hi) in view.volumes {
        let inside = |p: DVec3| p.clamp(min, max);
        let (lo, hi) = (inside(*lo), inside(*hi));
        root.draw(&Rectangle::new([at(lo.x, lo.z), at(hi.x, hi.z)], VOLUME.stroke_width(1)))?;
    }
    let walk: Vec<(i32, i32)> = view.path.iter().map(|p| at(f64::from(p.x), f64::from(p.z))).collect();
    draw_path(root, &walk, &WALKED)?;
    if let Some(&start) = walk.first() {
        mark(root, start, 7, &WALKED, true)?;
    }
    let eye = view.camera.eye.as_dvec3();
    for end in view.borders() {
        draw_path(root, &[at(eye.x, eye.z), at(end.x, end.z)], &SEEN)?;
    }
    mark(root, at(eye.x, eye.z), 6, &SEEN, true)
}

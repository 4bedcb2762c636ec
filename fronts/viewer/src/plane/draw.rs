//! The map as the eye sees it.

use casca_stage::canvas::Target;
use casca_stage::egui::{Color32, Context, LayerId, Mesh, Painter, Pos2, Rect, Shape};
use casca_stage::gpu::Gpu;
use casca_stage::panel::Panel;
use casca_stage::report::{Entry, Sample};
use glam::Vec2;

use crate::plane::level::{Level, RADIUS};

const HIDDEN: Color32 = Color32::from_rgb(32, 36, 46);
const SEEN: Color32 = Color32::from_rgb(61, 70, 88);
const REGION: Color32 = Color32::from_rgb(255, 233, 168);
const HIDDEN_WALL: Color32 = Color32::from_rgb(89, 80, 63);
const SEEN_WALL: Color32 = Color32::from_rgb(226, 200, 150);
const DOOR: Color32 = Color32::from_rgb(186, 112, 50);
const VISIBLE: Color32 = Color32::from_rgb(235, 110, 10);
const CULLED: Color32 = Color32::from_rgb(90, 162, 255);
const EYE: Color32 = Color32::from_rgb(208, 32, 96);
/// The radius of the eye, in tiles.
const EYE_RADIUS: f32 = 0.42;
/// The least side of a tile in points: a window may be empty, and places are divided by it.
const LEAST_SIDE: f32 = 1e-3;

/// The colours and their meanings.
pub fn legend() -> Vec<Entry> {
    let entries = [
        (EYE, "the eye"),
        (REGION, "what it sees"),
        (SEEN_WALL, "walls that it sees"),
        (DOOR, "closed doors"),
        (VISIBLE, "visible guards"),
        (CULLED, "hidden guards: culled"),
    ];
    entries
        .map(|(colour, text)| Entry {
            colour: colour.to_array(),
            sample: Sample::Area,
            text: text.to_owned(),
        })
        .into()
}

/// Where tiles are in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    corner: Vec2,
    /// The side of a tile.
    side: f32,
}

impl Places {
    /// As large as fits into a picture.
    pub fn new(level: &Level, size: Vec2) -> Self {
        let (width, height) = level.size();
        let tiles = Vec2::new(width as f32, height as f32);
        let side = (size / tiles).min_element().max(LEAST_SIDE);
        Self { corner: 0.5 * (size - tiles * side), side }
    }

    /// The place in the map that a point of the picture shows.
    pub fn tile(&self, at: Vec2) -> Vec2 {
        (at - self.corner) / self.side
    }

    fn point(&self, tile: Vec2) -> Pos2 {
        let at = self.corner + tile * self.side;
        Pos2::new(at.x, at.y)
    }

    fn square(&self, (x, y): (u32, u32)) -> Rect {
        let at = Vec2::new(x as f32, y as f32);
        Rect::from_min_max(self.point(at), self.point(at + 1.0))
    }
}

/// Draws the map over a target, where a point is `scale` pixels wide.
pub fn picture(panel: &mut Panel, (gpu, target, scale): (&Gpu, &Target, f32), level: &Level) {
    panel.clear(gpu, target);
    panel.draw(gpu, target, scale, &|context| show(context, level));
}

fn show(context: &Context, level: &Level) {
    let painter = context.layer_painter(LayerId::background());
    let size = context.content_rect().size();
    let places = Places::new(level, Vec2::new(size.x, size.y));
    let (width, height) = level.size();
    let all = Vec2::new(width as f32, height as f32);
    painter.rect_filled(Rect::from_min_max(places.point(Vec2::ZERO), places.point(all)), 0.0, HIDDEN);
    let opaque = level.layer.opaque();
    for at in level.seen.cells().filter(|&(x, y)| !opaque.get(x, y)) {
        painter.rect_filled(places.square(at), 0.0, SEEN);
    }
    region(&painter, &places, level);
    for (x, y) in opaque.bits().cells() {
        let colour = match (level.seen.get(x, y), level.doors.contains(&(x, y))) {
            (true, true) => DOOR,
            (true, false) => SEEN_WALL,
            (false, _) => HIDDEN_WALL,
        };
        painter.rect_filled(places.square((x, y)).shrink(0.03 * places.side), 0.0, colour);
    }
    for (at, visible) in level.guards() {
        let colour = if visible { VISIBLE } else { CULLED };
        painter.circle_filled(places.point(at), RADIUS * places.side, colour);
    }
    painter.circle_filled(places.point(level.eye), EYE_RADIUS * places.side, EYE);
}

/// The visible region, as a fan of triangles around the eye, which sees all of its border.
fn region(painter: &Painter, places: &Places, level: &Level) {
    let border = level.region();
    let mut mesh = Mesh::default();
    mesh.colored_vertex(places.point(level.eye), REGION);
    border.iter().for_each(|&at| mesh.colored_vertex(places.point(at), REGION));
    let count = border.len() as u32;
    (0..count).for_each(|i| mesh.add_triangle(0, 1 + i, 1 + (i + 1) % count));
    painter.add(Shape::mesh(mesh));
}

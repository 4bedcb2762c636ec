//! Pictures of one cloud side by side: its points, those that each operator finds visible, and its
//! surface.

use std::error::Error;

use casca_points::Camera;
use casca_points::gpu::{Pane, Style, Surfel, SurfelRenderer, Surfels};
use casca_stage::canvas::Target;
use casca_stage::egui::{self, Color32, FontId, Pos2, Rect};
use casca_stage::gpu::Gpu;
use casca_stage::panel::Panel;
use casca_stage::wgpu::{Color, TextureFormat};
use glam::Vec3;

use crate::points::operators::{Looked, Operator};

/// The colour of points without one.
const GREY: [u8; 3] = [150, 160, 170];
/// The radius of a dot in pixels.
const DOT: f32 = 0.8;
/// The radius of a disc of the surface, as a multiple of that of a square: discs are drawn with
/// little weight at their rims.
const DISC: f32 = 2.2;
/// The text of a pane that is left over.
const EXPLANATION: &str = "Points hide nothing: far ones show through the gaps between near ones. The operators estimate which points \
                           the eye can see; surface splatting fills the gaps.";
/// The height of a caption's letters, as a share of the height of a pane.
const LETTERS: f32 = 0.05;

/// What a pane shows: all points, those that an operator leaves, or the surface by surface splatting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// All points.
    Points,
    /// Those that an operator leaves.
    By(Operator),
    /// The surface, by surface splatting.
    Surface,
}

/// The contents of panes by their names.
pub const CONTENTS: [(&str, Content); 5] = [
    ("points", Content::Points),
    ("discs", Content::By(Operator::Discs)),
    ("hpr", Content::By(Operator::Hpr)),
    ("splat", Content::By(Operator::Splat)),
    ("surface", Content::Surface),
];

/// Discs and a caption.
struct Shown {
    surfels: Surfels,
    style: Style,
    title: String,
}

/// All panes.
pub struct Panes {
    renderer: SurfelRenderer,
    panel: Panel,
    contents: Vec<Content>,
    shown: Vec<Shown>,
}

impl Panes {
    /// Panes with nothing in them yet, for pictures of a format.
    pub fn new(gpu: &Gpu, format: TextureFormat, contents: &[Content]) -> Self {
        let (renderer, panel) = (SurfelRenderer::new(gpu, format), Panel::new(gpu, format));
        Self { renderer, panel, contents: contents.to_vec(), shown: Vec::new() }
    }

    /// Columns and rows.
    fn grid(&self) -> (u32, u32) {
        let count = self.contents.len() as u32;
        let columns = if count < 4 { count } else { count.div_ceil(2) };
        (columns.max(1), count.div_ceil(columns.max(1)).max(1))
    }

    /// The size of a pane in a picture of this size.
    pub fn size(&self, (width, height): (u32, u32)) -> (u32, u32) {
        let (columns, rows) = self.grid();
        ((width / columns).max(1), (height / rows).max(1))
    }

    /// Finds the points that a camera sees, for all panes. Returns the captions, with times.
    pub fn find(
        &mut self,
        gpu: &Gpu,
        looked: &Looked,
        camera: &Camera,
    ) -> Result<Vec<String>, Box<dyn Error>> {
        self.shown.clear();
        let mut lines = Vec::new();
        for &content in &self.contents {
            let found = match content {
                Content::By(operator) => Some(looked.visible(operator, camera)?),
                Content::Points | Content::Surface => None,
            };
            let (visible, time) = found.unzip();
            let is_surface = content == Content::Surface;
            let surfel = |i| surfel(looked, i, is_surface);
            let surfels: Vec<Surfel> = match &visible {
                Some(visible) => visible.iter_ones().map(surfel).collect(),
                None => (0..looked.cloud.len()).map(surfel).collect(),
            };
            let count = surfels.len();
            let title = match content {
                Content::Points => format!("all {count} points"),
                Content::By(Operator::Discs) => format!("rays between discs: {count} points"),
                Content::By(Operator::Hpr) => format!("hidden point removal: {count} points"),
                Content::By(Operator::Splat) => format!("splat operator: {count} points"),
                Content::Surface => "all points, drawn as a surface".to_owned(),
            };
            let took =
                time.map_or(String::new(), |time| format!(", found in {:.0} ms", time.as_secs_f64() * 1e3));
            lines.push(format!("{title}{took}"));
            let (scale, least_pixels) = if is_surface { (1.0, 0.7) } else { (0.0, DOT) };
            let style = Style { scale, least_pixels, offset: DISC * looked.auto.radius, lit: is_surface };
            self.shown.push(Shown { surfels: Surfels::new(gpu, &surfels)?, style, title });
        }
        Ok(lines)
    }

    /// Draws all panes as `camera` sees them, whose picture has the size of one.
    pub fn draw(&mut self, gpu: &Gpu, target: &Target, camera: &Camera, scale: f32) {
        let (columns, (width, height)) = (self.grid().0, camera.size());
        let corner = |i: usize| (i as u32 % columns * width, i as u32 / columns * height);
        let panes: Vec<_> = self.shown.iter().enumerate().map(|(i, shown)| (corner(i), shown)).collect();
        let drawn: Vec<Pane> = panes
            .iter()
            .map(|&(corner, Shown { surfels, style, .. })| Pane { surfels, style: *style, corner })
            .collect();
        self.renderer.draw(gpu, target, camera, Color::WHITE, &drawn);
        self.panel.draw(gpu, target, scale, &|context| {
            let titles = panes.iter().map(|(at, shown)| (*at, &*shown.title));
            let left_over = (panes.len() > 1).then(|| (corner(panes.len()), EXPLANATION));
            titles.chain(left_over).for_each(|(at, text)| caption(context, at, (width, height), scale, text));
        });
    }
}

/// Writes a text into the left upper corner of a pane, whose place and size are in pixels.
fn caption(context: &egui::Context, (x, y): (u32, u32), (width, height): (u32, u32), scale: f32, text: &str) {
    let painter = context.layer_painter(egui::LayerId::background());
    let font = FontId::proportional((LETTERS * height as f32 / scale).max(8.0));
    let at = Pos2::new(x as f32, y as f32) / scale + egui::Vec2::splat(0.6 * font.size);
    let wide = width as f32 / scale - 1.2 * font.size;
    let text = painter.layout(text.to_owned(), font.clone(), Color32::BLACK, wide);
    let behind = Rect::from_min_size(at, text.size()).expand(0.25 * font.size);
    painter.rect_filled(behind, 0.0, Color32::from_white_alpha(215));
    painter.galley(at, text, Color32::BLACK);
}

/// The disc of a point. Only surfaces need the normal: dots of all sides are drawn.
fn surfel(looked: &Looked, i: usize, is_surface: bool) -> Surfel {
    let [r, g, b] = looked.cloud.colours.get(i).copied().unwrap_or(GREY);
    let normal = looked.normals.get(i).filter(|_| is_surface).copied().unwrap_or(Vec3::ZERO);
    let radius = looked.cloud.radii.get(i).copied().unwrap_or(DISC * looked.auto.radius);
    Surfel {
        position: looked.positions[i].to_array(),
        radius,
        normal: normal.to_array(),
        colour: [r, g, b, 255],
    }
}

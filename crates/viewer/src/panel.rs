//! Numbers, the occlusion buffers and help, over the picture.

use std::time::Duration;

use casca::internals::OcclusionImage;
use casca_stage::canvas::Target;
use casca_stage::egui::{self, Align2, Color32, ColorImage, RichText, TextureHandle};
use casca_stage::gpu::Gpu;
use casca_stage::panel::{Panel, boxed};

use crate::overlays::{Layer, Overlays};
use crate::playback::Method;

/// What the panel says.
pub struct Numbers {
    /// Name of the scene.
    pub scene: String,
    /// What draws.
    pub device: String,
    /// How it was culled.
    pub method: Method,
    /// Whether the culling camera stands still.
    pub frozen: bool,
    /// Objects drawn, and all.
    pub visible: (usize, usize),
    /// Time of the query, and of drawing.
    pub times: (Duration, Duration),
    /// From an item buffer: objects that pixels show, and how many of them were not drawn.
    pub check: Option<(usize, usize)>,
    /// Whether help is shown.
    pub help: bool,
}

/// Draws the panel over a target, where a point is `scale` pixels wide, with the occlusion buffers given.
pub fn draw(
    panel: &mut Panel,
    (gpu, target, scale): (&Gpu, &Target, f32),
    numbers: &Numbers,
    overlays: &Overlays,
    images: &[OcclusionImage],
) {
    let insets: Vec<TextureHandle> =
        images.iter().map(|image| panel.image("occlusion buffer", inset(image))).collect();
    panel.draw(gpu, target, scale, &|context| show(context, numbers, overlays, &insets));
}

fn show(context: &egui::Context, numbers: &Numbers, overlays: &Overlays, insets: &[TextureHandle]) {
    boxed(context, "numbers", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| {
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        let (shown, all) = numbers.visible;
        let percent = 100.0 * shown as f64 / all.max(1) as f64;
        ui.label(RichText::new(format!("{} - {}", numbers.scene, numbers.method)).strong().size(17.0));
        ui.label(RichText::new(format!("drawn  {shown} of {all} objects ({percent:.1} %)")).size(15.0));
        let [query, draw] = [numbers.times.0, numbers.times.1].map(|t| t.as_secs_f64() * 1e3);
        if numbers.method != Method::All {
            ui.label(format!("query  {query:.2} ms"));
        }
        ui.label(format!("draw   {draw:.2} ms on {}", numbers.device));
        match numbers.check {
            Some((exact, lost)) => {
                let ratio = shown as f64 / exact.max(1) as f64;
                ui.label(format!("visible in pixels  {exact};  drawn / visible  {ratio:.2}"));
                let text = RichText::new(format!("visible objects lost  {lost}")).strong();
                let bad = if lost > 0 { Color32::from_rgb(255, 90, 90) } else { Color32::LIGHT_GREEN };
                ui.label(text.color(bad));
            }
            None => {
                ui.label("C compares every frame with an item buffer");
            }
        }
        if numbers.frozen {
            ui.label(RichText::new("the culling camera stands still").color(Color32::YELLOW));
        }
        for layer in Layer::EVERY.into_iter().filter(|&layer| overlays.is_on(layer)) {
            let text = match layer {
                Layer::Hidden => "orange wireframe: hidden objects, not drawn",
                Layer::Volumes => "violet boxes: volumes that hidden moving objects stay in",
                Layer::Cells => "cells at eye height: grey opaque, orange hidden, green seen",
                Layer::Caps if !overlays.are_caps_ready() => "cap polygons are being traced",
                Layer::Caps => {
                    "blue outlines: what blocks the view from the eye's cell, on some shells of cells"
                }
                Layer::Buffers => "insets: occlusion buffers, dark is covered nearby, white is open",
                Layer::Frustum => "black lines: the culling camera's frustum, cut short",
            };
            ui.label(text);
        }
    });
    if !insets.is_empty() {
        boxed(context, "insets", Align2::RIGHT_TOP, [-10.0, 10.0], &mut |ui| {
            for texture in insets {
                let size = texture.size_vec2();
                ui.image((texture.id(), size * (220.0 / size.max_elem())));
            }
        });
    }
    if numbers.help {
        boxed(context, "help", Align2::CENTER_BOTTOM, [0.0, -10.0], &mut |ui| {
            ui.set_max_width(context.content_rect().width() - 40.0);
            let layers: Vec<String> =
                Layer::EVERY.iter().zip(1..).map(|(layer, key)| format!("{key} {}", layer.name())).collect();
            ui.label("W A S D Q E fly (Shift: faster)   right mouse button: look   P back to the path   Space: pause   F freeze the culling camera");
            ui.label(format!(
                "M method   C check   N next scene   {}   H help   Esc quit",
                layers.join("   ")
            ));
        });
    }
}

/// An occlusion buffer, upright: open pixels white, others the darker the nearer they are covered.
fn inset(image: &OcclusionImage) -> ColorImage {
    let (w, h) = (image.width.max(1), image.height.max(1));
    // Columns run along y on the sides of x: those are turned.
    let (d, turned) = (image.direction, image.direction.x.abs() > 0.5);
    let size = if turned { [h, w] } else { [w, h] };
    let mirrored = d.x < -0.5 || d.z > 0.5;
    let mut pixels = Vec::with_capacity(w * h);
    for y in 0..size[1] {
        for x in 0..size[0] {
            let across = if mirrored { size[0] - 1 - x } else { x };
            let up = size[1] - 1 - y;
            let (column, row) = if turned { (up, across) } else { (across, up) };
            let depth = image.depth.get(row * w + column).copied().unwrap_or(f32::INFINITY);
            pixels.push(match depth {
                0.0 => Color32::from_rgb(60, 75, 100),
                d if d.is_infinite() => Color32::WHITE,
                d => Color32::from_gray((30.0 + 190.0 * (1.0 - (-d / 40.0).exp())) as u8),
            });
        }
    }
    ColorImage::new(size, pixels)
}

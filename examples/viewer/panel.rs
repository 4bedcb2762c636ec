//! Numbers, the occlusion buffers and help, over the picture.

use std::time::Duration;

use casca::OcclusionImage;
use egui::{Align2, Color32, ColorImage, RichText, TextureHandle};

use super::gpu::Gpu;
use super::overlays::{Layer, Overlays};
use super::stage::Method;

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

/// Draws the panel.
pub struct Panel {
    context: egui::Context,
    renderer: egui_wgpu::Renderer,
    insets: Vec<TextureHandle>,
}

impl Panel {
    /// A panel over pictures of this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let context = egui::Context::default();
        context.set_theme(egui::Theme::Dark);
        let renderer = egui_wgpu::Renderer::new(&gpu.device, format, egui_wgpu::RendererOptions::PREDICTABLE);
        Self { context, renderer, insets: Vec::new() }
    }

    /// Draws it over `target`, where a point is `scale` pixels wide.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::TextureView,
        scale: f32,
        numbers: &Numbers,
        overlays: &Overlays,
        images: &[OcclusionImage],
    ) {
        let (context, insets) = (self.context.clone(), &mut self.insets);
        *insets = images.iter().map(|image| inset(&context, image)).collect();
        let size = target.texture();
        let points = egui::vec2(size.width() as f32, size.height() as f32) / scale;
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, points)),
            ..Default::default()
        };
        input.viewports.entry(input.viewport_id).or_default().native_pixels_per_point = Some(scale);
        let run = || context.run_ui(input.clone(), |ui| show(ui.ctx(), numbers, overlays, insets));
        let mut output = run();
        // Boxes are placed by the size that they had before.
        output.append(run());
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [size.width(), size.height()],
            pixels_per_point: output.pixels_per_point,
        };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let jobs = context.tessellate(output.shapes, output.pixels_per_point);
        for (id, deltas) in &output.textures_delta.set {
            deltas.iter().for_each(|delta| self.renderer.update_texture(device, queue, *id, delta));
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut commands = self.renderer.update_buffers(device, queue, &mut encoder, &jobs, &screen);
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        self.renderer.render(&mut pass, &jobs, &screen);
        drop(pass);
        commands.push(encoder.finish());
        queue.submit(commands);
        for id in &output.textures_delta.free {
            self.renderer.free_texture(id);
        }
    }
}

fn show(context: &egui::Context, numbers: &Numbers, overlays: &Overlays, insets: &[TextureHandle]) {
    let boxed = |name: &str, corner: Align2, offset: [f32; 2], add: &mut dyn FnMut(&mut egui::Ui)| {
        let area = egui::Area::new(egui::Id::unique(name)).anchor(corner, offset);
        area.interactable(false).fade_in(false).show(context, |ui| {
            let frame =
                egui::Frame::new().fill(Color32::from_black_alpha(215)).inner_margin(8).corner_radius(6);
            ui.visuals_mut().override_text_color = Some(Color32::from_gray(225));
            frame.show(ui, |ui| add(ui));
        });
    };
    boxed("numbers", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| {
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
        boxed("insets", Align2::RIGHT_TOP, [-10.0, 10.0], &mut |ui| {
            for texture in insets {
                let size = texture.size_vec2();
                ui.image((texture.id(), size * (220.0 / size.max_elem())));
            }
        });
    }
    if numbers.help {
        boxed("help", Align2::CENTER_BOTTOM, [0.0, -10.0], &mut |ui| {
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
fn inset(context: &egui::Context, image: &OcclusionImage) -> TextureHandle {
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
    context.load_texture("occlusion buffer", ColorImage::new(size, pixels), egui::TextureOptions::NEAREST)
}

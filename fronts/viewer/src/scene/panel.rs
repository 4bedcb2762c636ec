//! Numbers, the occlusion buffers and help, over the picture.

use std::time::Duration;

use casca::internals::OcclusionImage;
use casca_stage::canvas::Target;
use casca_stage::egui::{self, Align2, Color32, ColorImage, RichText, TextureHandle};
use casca_stage::gpu::{Gpu, IS_PAGE};
use casca_stage::panel::{Entry, Panel, boxed};

use crate::scene::overlays::{Layer, Overlays};
use crate::scene::playback::Method;

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
    /// The meanings of the colours.
    pub legend: Vec<Entry>,
    /// Whether help is shown.
    pub help: bool,
    /// From above: where the eye of the camera that is culled for is, in shares of the picture from
    /// its left upper corner.
    pub eye: Option<[f32; 2]>,
}

/// How much a line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// It names all others.
    Title,
    /// It is read first.
    First,
    /// It is one of many.
    Plain,
    /// All is well.
    Good,
    /// Something is wrong.
    Bad,
    /// The picture is not as one expects.
    Notice,
}

impl Numbers {
    /// What there is to say, line by line.
    pub fn lines(&self) -> Vec<(String, Weight)> {
        let (shown, all) = self.visible;
        let percent = 100.0 * shown as f64 / all.max(1) as f64;
        let [query, draw] = [self.times.0, self.times.1].map(|t| t.as_secs_f64() * 1e3);
        let mut lines = vec![
            (format!("{} - {}", self.scene, self.method), Weight::Title),
            (format!("drawn  {shown} of {all} objects ({percent:.1} %)"), Weight::First),
        ];
        if self.method != Method::All {
            lines.push((format!("query  {query:.2} ms"), Weight::Plain));
        }
        // In a page nothing tells when a drawing ends: it is the time from frame to frame.
        let drawing = if IS_PAGE { "frame" } else { "draw " };
        lines.push((format!("{drawing}  {draw:.2} ms on {}", self.device), Weight::Plain));
        match self.check {
            Some((exact, lost)) => {
                let ratio = shown as f64 / exact.max(1) as f64;
                let text = format!("visible in pixels  {exact};  drawn / visible  {ratio:.2}");
                lines.push((text, Weight::Plain));
                let weight = if lost > 0 { Weight::Bad } else { Weight::Good };
                lines.push((format!("visible objects lost  {lost}"), weight));
            }
            None => lines.push(("C compares every frame with an item buffer".to_owned(), Weight::Plain)),
        }
        if self.frozen {
            lines.push(("the culling camera stands still".to_owned(), Weight::Notice));
        }
        lines
    }
}

/// Draws the panel over a target, where a point is `scale` pixels wide, with the occlusion buffers
/// given.
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

/// Draws a title and a legend over a target, where a point is `scale` pixels wide, and a mark at a
/// camera's eye, whose place is in shares of the picture from its left upper corner.
pub fn caption(
    panel: &mut Panel,
    (gpu, target, scale): (&Gpu, &Target, f32),
    title: &str,
    legend: &[Entry],
    [x, y]: [f32; 2],
) {
    panel.draw(gpu, target, scale, &|context| {
        let across = context.content_rect().width();
        mark_eye(context, context.content_rect().size() * egui::vec2(x, y));
        strip(context, "title", Align2::CENTER_TOP, &mut |ui| {
            ui.label(RichText::new(title).size(23.0));
        });
        strip(context, "legend", Align2::CENTER_BOTTOM, &mut |ui| {
            legend.chunks(4).for_each(|row| legend_row(ui, across - 16.0, row));
        });
    });
}

/// Entries side by side. Their widths do not depend on numbers: when those change, nothing moves.
fn legend_row(ui: &mut egui::Ui, across: f32, row: &[Entry]) {
    let share = |entry: &Entry| entry.text.trim_end_matches(|c: char| c.is_ascii_digit()).len() + 9;
    let unit = across / row.iter().map(share).sum::<usize>().max(66) as f32;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for entry in row {
            let wide = unit * share(entry) as f32;
            ui.allocate_ui(egui::vec2(wide, 22.0), |ui| {
                ui.set_min_width(wide);
                ui.spacing_mut().item_spacing.x = 8.0;
                entry.add(ui);
            });
        }
    });
}

/// A dot with the word "camera".
fn mark_eye(context: &egui::Context, at: egui::Vec2) {
    let painter = context.layer_painter(egui::LayerId::background());
    let at = at.to_pos2();
    let text = painter.layout_no_wrap("camera".to_owned(), egui::FontId::proportional(15.0), Color32::BLACK);
    let middle = at - egui::vec2(0.0, 20.0);
    let word = egui::Rect::from_center_size(middle, text.size());
    painter.rect_filled(word.expand2(egui::vec2(4.0, 0.0)), 3.0, Color32::from_white_alpha(225));
    painter.galley(word.min, text, Color32::BLACK);
    painter.circle_filled(at, 6.5, Color32::WHITE);
    painter.circle_filled(at, 4.5, Color32::BLACK);
}

/// A white strip across the picture.
fn strip(context: &egui::Context, name: &str, side: Align2, add: &mut dyn FnMut(&mut egui::Ui)) {
    let area = egui::Area::new(egui::Id::unique(name)).anchor(side, [0.0, 0.0]);
    area.interactable(false).fade_in(false).show(context, |ui| {
        egui::Frame::new().fill(Color32::WHITE).inner_margin(8).show(ui, |ui| {
            ui.visuals_mut().override_text_color = Some(Color32::from_gray(30));
            ui.style_mut().text_styles.insert(egui::TextStyle::Body, egui::FontId::proportional(15.0));
            ui.set_width(context.content_rect().width() - 16.0);
            add(ui);
        });
    });
}

fn show(context: &egui::Context, numbers: &Numbers, overlays: &Overlays, insets: &[TextureHandle]) {
    if let Some([x, y]) = numbers.eye {
        mark_eye(context, context.content_rect().size() * egui::vec2(x, y));
    }
    insets_of(context, insets);
    // A page says it in its own words.
    if IS_PAGE {
        return;
    }
    boxed(context, "numbers", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| {
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        for (line, weight) in numbers.lines() {
            let text = RichText::new(line);
            ui.label(match weight {
                Weight::Title => text.strong().size(17.0),
                Weight::First => text.size(15.0),
                Weight::Plain => text,
                Weight::Good => text.strong().color(Color32::LIGHT_GREEN),
                Weight::Bad => text.strong().color(Color32::from_rgb(255, 90, 90)),
                Weight::Notice => text.color(Color32::YELLOW),
            });
        }
        numbers.legend.iter().for_each(|entry| entry.add(ui));
        if overlays.is_on(Layer::Caps) && !overlays.are_caps_ready() {
            ui.label("cap polygons are being traced");
        }
        if !insets.is_empty() {
            ui.label("insets: occlusion buffers, dark is covered nearby, white is open");
        }
    });
    if numbers.help {
        boxed(context, "help", Align2::CENTER_BOTTOM, [0.0, -10.0], &mut |ui| {
            ui.set_max_width(context.content_rect().width() - 40.0);
            let layers: Vec<String> =
                Layer::EVERY.iter().zip(1..).map(|(layer, key)| format!("{key} {}", layer.name())).collect();
            if numbers.eye.is_some() {
                let text = "From above: casca culls for the camera in the bright wedge. Hold W to fly down, B looks through the camera, and back.";
                ui.label(RichText::new(text).size(15.0).strong());
            }
            ui.label("W A S D Q E fly (Shift: faster)   right mouse button: look   P back to the path   Space: pause   F freeze the culling camera   B look at it from above, and back");
            ui.label(format!(
                "M method   C check   N next scene   {}   H help   Esc quit",
                layers.join("   ")
            ));
        });
    }
}

/// The occlusion buffers.
fn insets_of(context: &egui::Context, insets: &[TextureHandle]) {
    if !insets.is_empty() {
        boxed(context, "insets", Align2::RIGHT_TOP, [-10.0, 10.0], &mut |ui| {
            for texture in insets {
                let size = texture.size_vec2();
                ui.image((texture.id(), size * (220.0 / size.max_elem())));
            }
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

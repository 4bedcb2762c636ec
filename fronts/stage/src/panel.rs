//! Text, images, sliders and buttons over a picture.

use egui::{Align2, Color32, ComboBox, RichText, ScrollArea, Slider, SliderClamping};

use crate::canvas::Target;
use crate::dial::{Dial, Setting, Turned};
use crate::gpu::Gpu;
use crate::pass::over;
use crate::report::{Entry, Report, Sample};
use crate::screen::Screen;

/// The colour behind panels that stand alone.
const GROUND: wgpu::Color = wgpu::Color { r: 0.09, g: 0.10, b: 0.13, a: 1.0 };

/// Draws boxes of text and images, and in windows boxes of sliders and buttons.
pub struct Panel {
    context: egui::Context,
    renderer: egui_wgpu::Renderer,
}

impl Panel {
    /// A panel over pictures of this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self::with(egui::Context::default(), gpu, format)
    }

    /// A panel in a window, for [`Panel::report`].
    pub(crate) fn on(screen: &Screen) -> Self {
        Self::with(screen.panels.clone(), &screen.gpu, screen.format())
    }

    fn with(context: egui::Context, gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        context.set_theme(egui::Theme::Dark);
        let renderer = egui_wgpu::Renderer::new(&gpu.device, format, egui_wgpu::RendererOptions::PREDICTABLE);
        Self { context, renderer }
    }

    /// Draws what `show` shows over `target`, where a point is `scale` pixels wide.
    pub fn draw(&mut self, gpu: &Gpu, target: &Target, scale: f32, show: &dyn Fn(&egui::Context)) {
        let (width, height) = target.size();
        let points = egui::vec2(width as f32, height as f32) / scale;
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, points)),
            ..Default::default()
        };
        input.viewports.entry(input.viewport_id).or_default().native_pixels_per_point = Some(scale);
        let context = self.context.clone();
        let run = || context.run_ui(input.clone(), |ui| show(ui.ctx()));
        let mut output = run();
        // Boxes are placed by the size that they had before.
        output.append(run());
        self.paint(gpu, target, output);
    }

    /// Draws a report over `target` and gives its sliders and buttons the window's mouse and keys;
    /// returns the dial that was turned. The panel must come from [`Panel::on`]. Call it once a
    /// frame.
    pub(crate) fn report(&mut self, screen: &Screen, target: &Target, report: &Report) -> Turned {
        let (input, mut found) = (screen.input(), Turned::Nothing);
        let mut output = self.context.clone().run_ui(input, |ui| {
            boxed(ui.ctx(), "report", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| found = told(ui, report));
        });
        // The cursor that panels ask for, and their text for the clipboard.
        let wishes = std::mem::take(&mut output.platform_output);
        screen.events.borrow_mut().handle_platform_output(&screen.window, wishes);
        self.paint(&screen.gpu, target, output);
        found
    }

    /// Fills the picture with one dark colour, for panels that stand alone.
    pub fn clear(&self, gpu: &Gpu, target: &Target) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[over(&target.colour, Some(GROUND))],
            ..Default::default()
        });
        gpu.queue.submit([encoder.finish()]);
    }

    /// Shows words in the middle of a picture, and nothing else.
    pub fn say(&mut self, gpu: &Gpu, target: &Target, scale: f32, words: &str) {
        self.clear(gpu, target);
        self.draw(gpu, target, scale, &|context| {
            boxed(context, "words", Align2::CENTER_CENTER, [0.0, 0.0], &mut |ui| {
                ui.label(RichText::new(words).size(22.0));
            });
        });
    }

    fn paint(&mut self, gpu: &Gpu, target: &Target, mut output: egui::FullOutput) {
        let (width, height) = target.size();
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [width, height],
            pixels_per_point: output.pixels_per_point,
        };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let jobs = self.context.tessellate(output.shapes, output.pixels_per_point);
        for (id, deltas) in &output.textures_delta.set {
            deltas.iter().for_each(|delta| self.renderer.update_texture(device, queue, *id, delta));
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut commands = self.renderer.update_buffers(device, queue, &mut encoder, &jobs, &screen);
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[over(&target.colour, None)],
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
        output.textures_delta.clear();
    }
}

impl Entry {
    /// Adds a sample of the colour and its meaning, side by side.
    pub fn add(&self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            let high = ui.text_style_height(&egui::TextStyle::Body);
            let (place, _) = ui.allocate_exact_size(egui::vec2(1.6 * high, high), egui::Sense::hover());
            let [r, g, b, _] = self.colour;
            let colour = Color32::from_rgb(r, g, b);
            let thick = if self.sample == Sample::Line { 0.2 * high } else { 0.75 * high };
            let sample = egui::Rect::from_center_size(place.center(), egui::vec2(place.width(), thick));
            ui.painter().rect_filled(sample, 0.0, colour);
            if let Sample::Framed([r, g, b]) = self.sample {
                ui.painter().rect_filled(sample.shrink(0.14 * high), 0.0, Color32::from_rgb(r, g, b));
            }
            ui.label(&self.text);
        });
    }
}

/// The greatest over the least number of a slider from which on it is logarithmic.
const LOGARITHMIC: f64 = 64.0;
/// Choices among more than this are a list to open.
const SIDE_BY_SIDE: usize = 5;

/// Adds a report: its lines, colours, dials and keys. Returns the dial that was turned.
pub fn told(ui: &mut egui::Ui, report: &Report) -> Turned {
    for (number, line) in report.lines.iter().enumerate() {
        let text = RichText::new(line);
        ui.label(if number == 0 { text.strong() } else { text });
    }
    report.legend.iter().for_each(|entry| entry.add(ui));
    // What is above and below stays in the window.
    let high = 0.7 * ui.ctx().content_rect().height();
    let found = ScrollArea::vertical().max_height(high).show(ui, |ui| turned(ui, &report.dials)).inner;
    if !report.keys.is_empty() {
        ui.label(report.keys);
    }
    found
}

/// Shows dials, and returns the one that was turned.
fn turned(ui: &mut egui::Ui, dials: &[Dial]) -> Turned {
    let mut found = Turned::Nothing;
    for Dial { name, setting } in dials {
        let mut turn = |value: f64, is_held| found = Turned::Dial(name.clone(), value, is_held);
        match setting {
            Setting::Number { value, range, step } => {
                let mut value = *value;
                let far = *range.start() > 0.0 && range.end() / range.start() >= LOGARITHMIC;
                // A number of the command line beyond the range stays until the slider is dragged.
                let slider = Slider::new(&mut value, range.clone()).clamping(SliderClamping::Edits);
                let slider = if *step > 0.0 { slider.step_by(*step) } else { slider };
                let answer = ui.add(slider.logarithmic(far).text(name));
                if answer.changed() || answer.drag_stopped() {
                    turn(value, answer.dragged());
                }
            }
            Setting::Switch(on) => {
                let mut on = *on;
                if ui.checkbox(&mut on, name).changed() {
                    turn(f64::from(u8::from(on)), false);
                }
            }
            Setting::Choice { names, chosen } => {
                let mut now = *chosen;
                let mut row = |ui: &mut egui::Ui| {
                    for (place, text) in names.iter().enumerate() {
                        ui.selectable_value(&mut now, place, text);
                    }
                };
                if names.len() > SIDE_BY_SIDE {
                    let text = names.get(*chosen).map_or("", |name| name);
                    ComboBox::from_label(name).selected_text(text).show_ui(ui, row);
                } else {
                    ui.horizontal(|ui| row(ui));
                }
                if now != *chosen {
                    turn(now as f64, false);
                }
            }
            Setting::Button => {
                if ui.button(name).clicked() {
                    turn(1.0, false);
                }
            }
        }
    }
    found
}

/// A dark box at a corner or side of the picture, `offset` points away from it.
pub fn boxed(
    context: &egui::Context,
    name: &str,
    corner: Align2,
    offset: [f32; 2],
    add: &mut dyn FnMut(&mut egui::Ui),
) {
    let area = egui::Area::new(egui::Id::unique(name)).anchor(corner, offset);
    area.fade_in(false).show(context, |ui| {
        let frame = egui::Frame::new().fill(Color32::from_black_alpha(215)).inner_margin(8).corner_radius(6);
        ui.visuals_mut().override_text_color = Some(Color32::from_gray(225));
        frame.show(ui, |ui| add(ui));
    });
}

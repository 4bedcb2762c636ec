//! Numbers, titles and legends over the picture.

use std::time::Duration;

use casca_stage::canvas::Target;
use casca_stage::egui::{self, Align2, Color32, RichText};
use casca_stage::gpu::{Gpu, IS_PAGE};
use casca_stage::panel::{Panel, boxed, told};
use casca_stage::report::{Entry, Report};

use crate::scene::draw::Check;
use crate::scene::playback::{Frame, Method};

/// The numbers of a frame of the scene called so, line by line: how it was culled, how many of how
/// many objects are drawn, the time of drawing, and from an item buffer how many objects pixels show
/// and how many of them were not drawn.
pub fn numbers(
    (scene, method): (&str, Method),
    frame: &Frame<'_>,
    (device, drawing): (&str, Duration),
    check: Option<&Check>,
) -> Vec<String> {
    let (shown, all) = (frame.visible.len(), frame.objects.len());
    let percent = 100.0 * shown as f64 / all.max(1) as f64;
    let [query, draw] = [frame.time, drawing].map(|t| t.as_secs_f64() * 1e3);
    let mut lines =
        vec![format!("{scene} - {method}"), format!("drawn  {shown} of {all} objects ({percent:.1} %)")];
    if method != Method::All {
        lines.push(format!("query  {query:.2} ms"));
    }
    // In a page nothing tells when a drawing ends: it is the time from frame to frame.
    lines.push(format!("{}  {draw:.2} ms on {device}", if IS_PAGE { "frame" } else { "draw " }));
    if let Some(Check { shown: exact, lost }) = check {
        let ratio = shown as f64 / exact.len().max(1) as f64;
        lines.push(format!("visible in pixels  {};  drawn / visible  {ratio:.2}", exact.len()));
        lines.push(format!("visible objects lost  {}", lost.len()));
    }
    lines
}

/// Draws over a target, where a point is `scale` pixels wide: a mark at an eye, whose place is in
/// shares of the picture from its left upper corner, and a report.
pub fn draw(
    panel: &mut Panel,
    (gpu, target, scale): (&Gpu, &Target, f32),
    eye: Option<[f32; 2]>,
    report: Option<&Report>,
) {
    panel.draw(gpu, target, scale, &|context| {
        if let Some([x, y]) = eye {
            mark_eye(context, context.content_rect().size() * egui::vec2(x, y));
        }
        if let Some(report) = report {
            boxed(context, "numbers", Align2::LEFT_TOP, [10.0, 10.0], &mut |ui| drop(told(ui, report)));
        }
    });
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

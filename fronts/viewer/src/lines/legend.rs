//! The legend of the colours of lines: a bar with numbers, or names.

use casca_lines::sets::colour::{Legend, viridis};
use casca_stage::canvas::Target;
use casca_stage::egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Ui, vec2};
use casca_stage::gpu::Gpu;
use casca_stage::panel::{Panel, boxed};
use casca_stage::report::{Entry, Sample};

/// Points of the bar of numbers.
const BAR: [f32; 2] = [180.0, 12.0];
/// Numbers beside the bar.
const TICKS: u8 = 4;
/// The most groups that are named.
const MOST_GROUPS: usize = 12;

/// Draws the legend into the upper left corner of a picture; nothing if colours mean nothing.
pub fn draw(panel: &mut Panel, gpu: &Gpu, target: &Target, legend: &Legend) {
    if *legend != Legend::Own {
        panel.draw(gpu, target, 1.0, &|context| {
            boxed(context, "colours", Align2::LEFT_TOP, [8.0, 8.0], &mut |ui| show(ui, legend));
        });
    }
}

/// Adds the legend.
fn show(ui: &mut Ui, legend: &Legend) {
    let Legend::Scalar { name, range } = legend else {
        return entries(legend).iter().for_each(|entry| entry.add(ui));
    };
    ui.label(name);
    let (place, _) = ui.allocate_exact_size(vec2(BAR[0] + 24.0, BAR[1] + 18.0), Sense::hover());
    let bar = Rect::from_min_size(place.min + vec2(12.0, 0.0), vec2(BAR[0], BAR[1]));
    for x in 0..BAR[0] as u32 {
        let [r, g, b] = viridis((x as f32 + 0.5) / BAR[0]);
        let column = Rect::from_min_size(bar.min + vec2(x as f32, 0.0), vec2(1.0, BAR[1]));
        ui.painter().rect_filled(column, 0.0, Color32::from_rgb(r, g, b));
    }
    let grey = Color32::from_gray(225);
    for tick in 0..=TICKS {
        let share = f32::from(tick) / f32::from(TICKS);
        let x = bar.min.x + share * BAR[0];
        let mark = Rect::from_min_max(Pos2::new(x - 0.5, bar.max.y), Pos2::new(x + 0.5, bar.max.y + 4.0));
        ui.painter().rect_filled(mark, 0.0, grey);
        if tick % 2 == 0 {
            let at = Pos2::new(x, bar.max.y + 4.0);
            let text = number(value(*range, share));
            ui.painter().text(at, Align2::CENTER_TOP, text, FontId::proportional(11.0), grey);
        }
    }
}

/// The colours and their meanings, one by one.
pub fn entries(legend: &Legend) -> Vec<Entry> {
    let entry =
        |[r, g, b]: [u8; 3], text: String| Entry { colour: [r, g, b, 255], sample: Sample::Area, text };
    match legend {
        Legend::Own => Vec::new(),
        Legend::Direction => [([255, 0, 0], "along x"), ([0, 255, 0], "along y"), ([0, 0, 255], "along z")]
            .map(|(colour, text)| entry(colour, text.to_owned()))
            .to_vec(),
        Legend::Scalar { name, range } => (0..=TICKS)
            .map(|tick| f32::from(tick) / f32::from(TICKS))
            .map(|t| entry(viridis(t), format!("{name} {}", number(value(*range, t)))))
            .collect(),
        Legend::Groups(groups) => {
            let named = groups.iter().take(MOST_GROUPS).map(|(name, colour)| entry(*colour, name.clone()));
            let left = groups.len().saturating_sub(MOST_GROUPS);
            let more = (left > 0).then(|| entry([0; 3], format!("and {left} more groups")));
            named.chain(more).collect()
        }
    }
}

/// The value at a share of a range; halves do not overflow.
fn value([low, high]: [f32; 2], share: f32) -> f64 {
    f64::from(low) + (f64::from(high) - f64::from(low)) * f64::from(share)
}

/// A number in at most four digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e5 => {
            let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
            let text = format!("{value:.digits$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_legends_name_their_colours() {
        let said = [0.0, 0.25, -1234.56, 99999.0, 1e-9, f64::from(f32::MAX)].map(number);
        assert_eq!(said, ["0", "0.25", "-1235", "99999", "1.00e-9", "3.40e38"]);
        let scalar = Legend::Scalar { name: "fa".to_owned(), range: [-f32::MAX, f32::MAX] };
        let texts: Vec<String> = entries(&scalar).into_iter().map(|e| e.text).collect();
        assert_eq!((&*texts[0], &*texts[2], texts.len()), ("fa -3.40e38", "fa 0", 5));
        let many = Legend::Groups((0..14).map(|i| (i.to_string(), [i; 3])).collect());
        let last = entries(&many).pop().map(|e| e.text);
        assert_eq!((entries(&many).len(), last.as_deref()), (13, Some("and 2 more groups")));
        assert_eq!(entries(&Legend::Direction)[1].colour, [0, 255, 0, 255]);
    }
}

//! Speed against accuracy.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::PictureError;
use super::palette::{AUTOMATIC, QUIET, Style, TEXT, method as style_of, other};
use super::svg::{Area, Drawn, Head, Sample, font, log_ticks, mark, path as draw_path, save, short, text};

/// One method at one setting on one scene.
#[derive(Debug, Clone)]
pub struct TradeoffPoint {
    /// The scene.
    pub scene: String,
    /// The method.
    pub method: String,
    /// The setting that varies, in a word.
    pub setting: String,
    /// Median time of a frame in milliseconds.
    pub ms: f64,
    /// Objects found visible over objects that are.
    pub ratio: f64,
    /// Visible objects lost in a frame, on average.
    pub lost: f64,
    /// Whether it is on the Pareto front of those that lose nothing.
    pub front: bool,
}

const WIDTH: u32 = 1200;
const PANEL: u32 = 350;
const COLUMNS: usize = 3;

/// Draws speed against accuracy: a panel for each scene, a line for each method, a filled mark for
/// each setting that lost nothing, with a ring on the Pareto front, and an empty one for each that
/// did. SVG. The finding is its title, and `title` stands below.
///
/// # Errors
/// If the file cannot be written.
pub fn tradeoff(path: &Path, title: &str, points: &[TradeoffPoint]) -> Result<(), PictureError> {
    let scenes = distinct(points, |p| &p.scene);
    let methods = distinct(points, |p| &p.method);
    let head = Head::new(WIDTH, &finding(points), &subtitle(title), keys(&methods));
    let columns = COLUMNS.min(scenes.len().max(1));
    let rows = scenes.len().div_ceil(columns).max(1);
    save(path, (WIDTH, head.height as u32 + PANEL * rows as u32 + 10), |root| {
        head.draw(root)?;
        let (_, below) = root.split_vertically(head.height);
        for (scene, area) in scenes.iter().zip(below.split_evenly((rows, columns))) {
            let own: Vec<&TradeoffPoint> = points.iter().filter(|p| p.scene == *scene).collect();
            panel(root, &area, scene, &methods, &own)?;
        }
        Ok(())
    })
}

fn subtitle(title: &str) -> String {
    format!(
        "{title}. Each mark is a setting: the median time of a query, and how many objects it finds for each that is \
         visible. Both axes are logarithmic; lower left is better, 1 is exact."
    )
}

fn keys(methods: &[String]) -> Vec<(Sample, String)> {
    let mut keys: Vec<(Sample, String)> =
        methods.iter().enumerate().map(|(i, m)| (Sample::Line(look(m, i)), m.clone())).collect();
    let any = other(8);
    keys.push((Sample::Mark(any), "filled: no visible object was lost".to_owned()));
    keys.push((Sample::Open(any), "empty: visible objects were lost".to_owned()));
    keys.push((Sample::Ring, "ring: no lossless setting is both faster and tighter".to_owned()));
    keys
}

/// The style of a method; the automatic settings have a mark of their own.
fn look(method: &str, number: usize) -> Style {
    match method.contains("automatic") {
        true => AUTOMATIC,
        false => style_of(method).unwrap_or_else(|| other(number)),
    }
}

fn first_word(method: &str) -> &str {
    method.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default()
}

/// How many settings of each kind of method lost something, in words.
fn finding(points: &[TradeoffPoint]) -> String {
    let sampled = |p: &&TradeoffPoint| first_word(&p.method) == "hzb";
    let (theirs, ours): (Vec<&TradeoffPoint>, Vec<&TradeoffPoint>) = points.iter().partition(sampled);
    let lossy = |of: &[&TradeoffPoint]| of.iter().filter(|p| p.lost > 0.0).count();
    let front = |of: &[&TradeoffPoint]| of.iter().filter(|p| p.front).count();
    let ours_lost = match lossy(&ours) {
        0 => "none".to_owned(),
        n => n.to_string(),
    };
    let best = match (front(&ours), front(&ours) + front(&theirs)) {
        (own, all) if own == all => format!("all {all}"),
        (own, all) => format!("{own} of the {all}"),
    };
    format!(
        "Sampled depth buffers lose visible objects at {} of {} settings, casca at {ours_lost} of {}; {best} best trade-offs \
         are casca's",
        lossy(&theirs),
        theirs.len(),
        ours.len()
    )
}

/// The values of a field in the order in which they first come.
fn distinct(points: &[TradeoffPoint], of: fn(&TradeoffPoint) -> &String) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for p in points {
        if !found.contains(of(p)) {
            found.push(of(p).clone());
        }
    }
    found
}

/// The range of an axis around all of its values, which are drawn where they are.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut lo, mut hi) = (f64::INFINITY, 0f64);
    for v in values.filter(|v| v.is_finite() && *v > 0.0) {
        (lo, hi) = (lo.min(v), hi.max(v));
    }
    let margin = (hi / lo).powf(0.07).max(1.01);
    if lo > hi { (0.5, 2.0) } else { (lo / margin, hi * margin) }
}

fn panel(
    root: &Area<'_>,
    area: &Area<'_>,
    scene: &str,
    methods: &[String],
    points: &[&TradeoffPoint],
) -> Drawn {
    let (left, right) = range(points.iter().map(|p| p.ms));
    // Shows that a panel's differences are small rather than magnifying them.
    let (bottom, top) = range(points.iter().map(|p| p.ratio).chain([1.0, 1.3]));
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_top(34)
        .x_label_area_size(44)
        .y_label_area_size(58)
        .build_cartesian_2d(
            (left..right).log_scale().with_key_points(log_ticks(left, right)),
            (bottom..top).log_scale().with_key_points(log_ticks(bottom, top)),
        )?;
    chart
        .configure_mesh()
        .x_desc("time of a query, ms")
        .y_desc("objects found / visible")
        .label_style(font(13.0).color(&TEXT))
        .axis_desc_style(font(13.0).color(&QUIET))
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .axis_style(QUIET)
        .bold_line_style(BLACK.mix(0.1))
        .light_line_style(TRANSPARENT)
        .draw()?;
    let place = |x: f64, y: f64| chart.backend_coord(&(x, y));
    root.draw(&PathElement::new([place(left, 1.0), place(right, 1.0)], TEXT))?;
    let corner = area.get_base_pixel();
    text(root, (corner.0 + 70, corner.1 + 20), 16.0, TEXT, HPos::Left, scene)?;
    let placed = |method: &String| -> Vec<((i32, i32), &TradeoffPoint)> {
        let own = points.iter().filter(|p| p.method == *method && p.ms > 0.0 && p.ratio > 0.0);
        own.map(|p| (place(p.ms, p.ratio), *p)).collect()
    };
    for (i, method) in methods.iter().enumerate() {
        let at: Vec<(i32, i32)> = placed(method).into_iter().map(|p| p.0).collect();
        draw_path(root, &at, &look(method, i))?;
    }
    // The automatic settings, the first, on top.
    for (i, method) in methods.iter().enumerate().rev() {
        for (at, p) in placed(method) {
            if p.front {
                root.draw(&Circle::new(at, 9, TEXT.stroke_width(2)))?;
            }
            mark(root, at, 5, &look(method, i), p.lost == 0.0)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(method: &str, ratio: f64, lost: f64) -> TradeoffPoint {
        let scene = "rooms".to_owned();
        TradeoffPoint {
            scene,
            method: method.to_owned(),
            setting: String::new(),
            ms: 1.0,
            ratio,
            lost,
            front: lost == 0.0,
        }
    }

    #[test]
    fn the_title_counts_losses_and_nothing_is_cut_off() {
        let points =
            [point("point, automatic", 1.1, 0.0), point("hzb (depth)", 1.0, 2.0), point("cell", 7.5, 0.0)];
        let said = finding(&points);
        assert!(said.contains("1 of 1 settings, casca at none of 2; all 2 best"), "{said}");
        let (lo, hi) = range(points.iter().map(|p| p.ratio));
        assert!(lo < 1.0 && hi > 7.5);
    }
}

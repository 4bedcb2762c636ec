//! Time and set by the resolution of the buffers.

use casca::{Method, PointOptions};

use super::super::{ASPECT, Contender, LabError, Section, Table};
use super::bench::Bench;
use super::measure::{Times, Turn, frustums, set_up, take_turns};
use crate::pictures::palette::{HZB, POINT, Style};
use crate::pictures::{Axis, Line, lines};
use casca_scenes::generated::{SceneKind, SceneOptions, build};

const SCENES: [SceneKind; 3] = [SceneKind::City, SceneKind::Spheres, SceneKind::Terrain];

/// The cost of a method at a resolution.
struct Point {
    pixels: f64,
    times: Times,
    found: f64,
}

/// Both methods on one scene.
struct Scene {
    name: &'static str,
    point: Vec<Point>,
    hzb: Vec<Point>,
}

pub(super) fn run(bench: &Bench, section: &mut Section) -> Result<(), LabError> {
    section.text(
        "### Resolution\n\nThe same views at finer and finer pixels: `pixel_degrees` of `point` from 2 degrees to a sixteenth, with all \
         other options at their defaults, and `hzb` with as many pixels across the view.",
    );
    let steps = bench.sizes([1, 4], [1, 2, 4, 8, 16], [32]);
    let walks = bench.walks();
    let mut scenes = Vec::new();
    for kind in SCENES {
        (bench.lab.progress)(&format!("resolutions of {}", kind.name()));
        let world = build(kind, &SceneOptions { seed: bench.lab.seed, ..SceneOptions::default() });
        let (driver, _) = set_up(&world)?;
        let cameras = frustums(&driver, &world, walks.views)?;
        let mut scene = Scene { name: kind.name(), point: Vec::new(), hzb: Vec::new() };
        let across = cameras
            .first()
            .map_or(90.0, |(camera, _)| 2.0 * (1.0 / camera.projection.x_axis.x).atan().to_degrees());
        for &step in &steps {
            let degrees = 2.0 / step as f32;
            let width = (across / degrees).round().max(16.0);
            let method = Method::Point(PointOptions::default().pixel_degrees(degrees).min_pixels(0));
            let size = (width as usize, (width / ASPECT).round() as usize);
            let contenders = [Contender::casca("", method)?, Contender::hzb(size.0, size.1)];
            let mut turns = contenders.map(|c| Turn::new(c, &driver));
            take_turns(&mut turns, &world, &cameras, walks.repeats)?;
            for (turn, points) in turns.into_iter().zip([&mut scene.point, &mut scene.hzb]) {
                let (times, found) = turn.results();
                points.push(Point { pixels: f64::from(width), times, found });
            }
        }
        scenes.push(scene);
    }
    draw(bench, section, &scenes, ("time", "time of a query, ms"), |p| p.times.median, time_title(&scenes))?;
    draw(bench, section, &scenes, ("set", "objects found, mean"), |p| p.found, set_title(&scenes))?;
    section.rows("All resolutions as CSV", table(&scenes));
    Ok(())
}

/// The least and the greatest growth from the coarsest to the finest pixels over the scenes.
fn growths(scenes: &[Scene], value: impl Fn(&Scene) -> f64) -> (f64, f64) {
    scenes.iter().map(value).fold((f64::INFINITY, 0.0), |(lo, hi), v| (lo.min(v), hi.max(v)))
}

/// The last value over the first.
fn growth(points: &[Point], value: impl Fn(&Point) -> f64) -> f64 {
    points.first().zip(points.last()).map_or(1.0, |(a, b)| value(b) / value(a).max(f64::MIN_POSITIVE))
}

fn time_title(scenes: &[Scene]) -> String {
    let (a, b) = growths(scenes, |s| growth(&s.point, |p| p.times.median));
    let (c, d) = growths(scenes, |s| growth(&s.hzb, |p| p.times.median));
    let pixels = scenes.first().map_or(1.0, |s| growth(&s.point, |p| p.pixels));
    format!(
        "{pixels:.0} times the pixels across: a query of point takes {a:.1} to {b:.1} times as long, one of hzb {c:.1} to {d:.1}"
    )
}

fn set_title(scenes: &[Scene]) -> String {
    let (a, b) = growths(scenes, |s| growth(&s.point, |p| p.found));
    format!(
        "From the coarsest to the finest pixels, the set of point shrinks to {a:.2} to {b:.2} of its size"
    )
}

fn draw(
    bench: &Bench,
    section: &mut Section,
    scenes: &[Scene],
    (name, label): (&str, &str),
    value: fn(&Point) -> f64,
    title: String,
) -> Result<(), LabError> {
    let mut all = Vec::new();
    for (i, scene) in scenes.iter().enumerate() {
        // Scenes differ in their marks, methods in their colours.
        let style = |style: Style| Style { marker: [POINT, HZB][i % 2].marker, dashed: i > 1, ..style };
        let points = |points: &[Point]| points.iter().map(|p| (p.pixels, value(p))).collect();
        all.push(Line::new(format!("point, {}", scene.name), style(POINT), points(&scene.point)));
        all.push(Line::new(format!("hzb, {}", scene.name), style(HZB), points(&scene.hzb)));
    }
    let file = format!("scaling-resolution-{name}.svg");
    let axes = (&Axis::log("pixels across the view"), &Axis::log(label));
    lines(
        &bench.lab.folder.join(&file),
        &title,
        "Means or medians over the views, on logarithmic axes.",
        axes,
        &all,
    )?;
    section.picture(&file, &title);
    Ok(())
}

fn table(scenes: &[Scene]) -> Table {
    let columns = ["scene", "method", "pixels across", "ms", "p99, ms", "objects found"];
    let mut table = Table::new("scaling-resolution", &columns);
    for scene in scenes {
        for (method, points) in [("point", &scene.point), ("hzb", &scene.hzb)] {
            for p in points {
                table.row([
                    scene.name.to_owned(),
                    method.to_owned(),
                    format!("{}", p.pixels),
                    format!("{:.4}", p.times.median),
                    format!("{:.4}", p.times.p99),
                    format!("{:.1}", p.found),
                ]);
            }
        }
    }
    table
}

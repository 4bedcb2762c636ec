//! Speed against accuracy: every method at several settings on every scene.

use casca::{Aabb, CellOptions, GridSpec, Method, PointOptions};

use super::front::{Cost, distance, front};
use super::walker::{Walker, item_buffer};
use super::worlds::{Place, places};
use super::{Contender, Lab, LabError, Section, Table, median};
use crate::pictures::{TradeoffPoint, tradeoff as draw};
use casca_scenes::world::World;

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Sampling {
    /// Frames of a walk, evenly spread.
    frames: usize,
    /// Times each frame is measured; the least counts.
    repeats: usize,
    /// Pixels in a row of the item buffer that says what is visible.
    width: usize,
}

/// What was measured on one scene.
#[derive(Debug, Clone)]
struct SceneTradeoff {
    /// The scene's name.
    scene: String,
    /// Mean numbers of objects in the frustum, and of visible ones.
    in_frustum: f64,
    /// Objects of which the item buffer shows a pixel.
    visible: f64,
    /// The settings measured; the first is the automatic one: all defaults, in the grid of
    /// [`GridSpec::fit`].
    points: Vec<TradeoffPoint>,
}

/// What the automatic settings are called.
const AUTOMATIC: &str = "automatic";

struct Entry {
    contender: Contender,
    /// The grid it runs in: the scene's own, or the fitted one.
    grid: usize,
    ms: Vec<f64>,
    found: usize,
    lost: usize,
}

fn entries() -> Result<Vec<Entry>, LabError> {
    let mut entries = Vec::new();
    let mut add =
        |contender, grid| entries.push(Entry { contender, grid, ms: Vec::new(), found: 0, lost: 0 });
    add(Contender::casca(AUTOMATIC, Method::default())?, 1);
    for (pixels, squares, patches) in [
        (80.0, 0, 0),
        (160.0, 0, 0),
        (160.0, 64, 0),
        (360.0, 64, 0),
        (360.0, 256, 3000),
        (640.0, 256, 6000),
        (1280.0, 4096, 16_000),
    ] {
        let options = PointOptions::default().pixel_degrees(90.0 / pixels);
        let options = options.refine_squares(squares).refine_patches(patches);
        let method = Method::Point(options.refine_budget(options.refine_budget.max(squares << 8)));
        add(Contender::casca(format!("{pixels} px a side, refined {squares}/{patches}"), method)?, 0);
    }
    for mask in [64, 256, 1024] {
        let method = Method::Cell(CellOptions::default().mask_resolution(mask));
        add(Contender::casca(format!("mask {mask}"), method)?, 0);
    }
    for (w, h) in [(320, 180), (640, 360), (1280, 720), (2560, 1440)] {
        add(Contender::hzb(w, h), 0);
    }
    Ok(entries)
}

/// Measures all methods on one world.
fn measure(world: World, sampling: &Sampling) -> Result<SceneTradeoff, LabError> {
    let mut entries = entries()?;
    let region = Aabb::new(world.grid.min, world.grid.max);
    let fitted = GridSpec::fit(region, world.objects.len())?;
    let mut walker = Walker::new(world)?;
    walker.add(&fitted)?;
    let mut exact = item_buffer(sampling.width);
    let (mut visible_sum, mut frustum_sum, mut done) = (0usize, 0usize, 0);
    let frames = walker.walk::<LabError>(sampling.frames, |walker, _, frame| {
        let visible = walker.visible(frame, &mut exact);
        // Each frame starts with another one, so that none is always the one after the item buffer.
        let count = entries.len();
        for turn in 0..count {
            let entry = &mut entries[(turn + done) % count];
            entry.ms.push(entry.contender.least(&walker.input(frame, entry.grid), sampling.repeats)?);
            entry.found += entry.contender.found().len();
            entry.lost += visible.iter().filter(|&&i| !entry.contender.sees(i)).count();
        }
        visible_sum += visible.len();
        frustum_sum += frame.in_frustum.iter().filter(|&&i| walker.world.objects[i].tested).count();
        done += 1;
        Ok(())
    })?;
    let per_frame = |n: usize| n as f64 / frames.max(1) as f64;
    let costs: Vec<Cost> = entries
        .iter_mut()
        .map(|e| Cost {
            ms: median(&mut e.ms),
            ratio: e.found as f64 / visible_sum.max(1) as f64,
            safe: e.lost == 0,
        })
        .collect();
    let on_front = front(&costs);
    let points = entries.iter().zip(&costs).zip(on_front).map(|((entry, cost), front)| TradeoffPoint {
        scene: walker.world.name.clone(),
        method: match (entry.contender.method, entry.grid) {
            ("point", 1) => "point, automatic".to_owned(),
            ("cell", _) => "cell".to_owned(),
            ("hzb", _) => "hzb".to_owned(),
            (method, _) => method.to_owned(),
        },
        setting: entry.contender.setting.clone(),
        ms: cost.ms,
        ratio: cost.ratio,
        lost: per_frame(entry.lost),
        front,
    });
    Ok(SceneTradeoff {
        scene: walker.world.name.clone(),
        in_frustum: per_frame(frustum_sum),
        visible: per_frame(visible_sum),
        points: points.collect(),
    })
}

impl SceneTradeoff {
    fn costs(&self) -> Vec<Cost> {
        let cost = |p: &TradeoffPoint| Cost { ms: p.ms, ratio: p.ratio, safe: p.lost == 0.0 };
        self.points.iter().map(cost).collect()
    }

    /// How far the automatic settings are from the Pareto front: see [`distance`].
    fn automatic_distance(&self) -> f64 {
        let costs = self.costs();
        costs.first().map_or(0.0, |own| distance(own, &costs))
    }

    /// How much slower the automatic settings are than the fastest measured without losses that are
    /// as tight, as a share.
    fn automatic_slowness(&self) -> f64 {
        let Some(own) = self.points.first() else { return 0.0 };
        let as_tight = self.points.iter().filter(|p| p.lost == 0.0 && p.ratio <= own.ratio);
        as_tight.map(|p| own.ms / p.ms - 1.0).filter(|s| s.is_finite()).fold(0.0, f64::max)
    }

    /// The settings that lost nothing and make query and drawing together the fastest, if drawing
    /// an object takes this many microseconds.
    fn best_for(&self, draw_us: f64) -> Option<&TradeoffPoint> {
        let total = |p: &TradeoffPoint| p.ms + p.ratio * self.visible * draw_us * 1e-3;
        let safe = self.points.iter().filter(|p| p.lost == 0.0);
        safe.min_by(|a, b| total(a).total_cmp(&total(b)))
    }
}

/// The table of all points measured.
fn table(scenes: &[SceneTradeoff]) -> Table {
    let mut table = Table::new(
        "tradeoff",
        &["scene", "method", "setting", "ms", "PVS", "PVS/visible", "lost in a frame", "on the front"],
    );
    for scene in scenes {
        for p in &scene.points {
            table.row([
                p.scene.clone(),
                p.method.clone(),
                p.setting.clone(),
                format!("{:.3}", p.ms),
                format!("{:.1}", p.ratio * scene.visible),
                format!("{:.3}", p.ratio),
                format!("{:.2}", p.lost),
                if p.front { "yes" } else { "" }.to_owned(),
            ]);
        }
    }
    table
}

/// Costs of drawing an object for which settings are recommended, in microseconds.
const DRAWING: [f64; 3] = [1.0, 10.0, 100.0];

/// All methods and settings on all scenes, with the Pareto front, and what settings that
/// recommends.
///
/// # Errors
/// If a scene cannot be read, or a picture not be written.
pub fn tradeoff(lab: &Lab) -> Result<Section, LabError> {
    let sampling = Sampling { frames: lab.pick(30, 2), repeats: lab.pick(3, 1), width: lab.pick(2560, 320) };
    let mut scenes = Vec::new();
    for place in lab.pick(places(lab), vec![Place::Built(casca_scenes::generated::SceneKind::Rooms)]) {
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        scenes.push(measure(world, &sampling)?);
    }
    let mut section = Section::new("Speed against accuracy");
    section.text(format!(
        "Every method at several settings: the median time of a query over {} frames of each walk (the least \
         of {} runs). An object counts as visible if one of {} rays across the picture, and as many in \
         proportion down it, hits it. `hzb` gets the objects in the frustum for nothing. `point, \
         automatic` has default settings in the grid of `GridSpec::fit`. {}",
        sampling.frames,
        sampling.repeats,
        sampling.width,
        automatic_words(&scenes)
    ));
    let file = "tradeoff.svg";
    let points: Vec<TradeoffPoint> = scenes.iter().flat_map(|s| s.points.clone()).collect();
    draw(&lab.folder.join(file), "Speed against accuracy, one thread", &points)?;
    section.picture(
        file,
        "Time of a query against the size of the PVS, for every method and setting on each scene",
    );
    section.rows("All points as CSV", table(&scenes));
    section.rows("The automatic settings as CSV", automatic_table(&scenes));
    section.text(
        "A tighter set is worth its time if drawing costs more. Recommended are, for an object that takes 1, \
         10 or 100 us to draw, the lossless settings that make query and drawing together the fastest.",
    );
    section.rows("Recommended settings as CSV", recommended_table(&scenes));
    Ok(section)
}

/// How far the automatic settings are from the best ones measured.
fn automatic_words(scenes: &[SceneTradeoff]) -> String {
    let lost = scenes.iter().filter_map(|s| s.points.first()).filter(|p| p.lost > 0.0).count();
    let worst = scenes.iter().map(SceneTradeoff::automatic_distance).fold(0.0, f64::max);
    let slowest = scenes.iter().max_by(|a, b| a.automatic_slowness().total_cmp(&b.automatic_slowness()));
    let slowest = slowest.map_or(String::new(), |s| {
        format!(
            " By time alone it is up to {:.0}% slower than the fastest lossless setting that is as tight ({}).",
            s.automatic_slowness() * 100.0,
            s.scene
        )
    });
    format!(
        "It loses visible objects on {} of {} scenes. It is at most {:.1}% behind the best lossless \
         settings: by so much it would have to become faster or tighter, for no other to be better in \
         both.{slowest}",
        if lost == 0 { "none".to_owned() } else { lost.to_string() },
        scenes.len(),
        worst * 100.0
    )
}

fn automatic_table(scenes: &[SceneTradeoff]) -> Table {
    let columns = [
        "scene",
        "in the frustum",
        "visible",
        "automatic, ms",
        "PVS/visible",
        "lost in a frame",
        "behind the best by, %",
        "slower than the fastest as tight by, %",
    ];
    let mut table = Table::new("tradeoff-automatic", &columns);
    for s in scenes {
        let Some(own) = s.points.first() else { continue };
        table.row([
            s.scene.clone(),
            format!("{:.0}", s.in_frustum),
            format!("{:.1}", s.visible),
            format!("{:.2}", own.ms),
            format!("{:.3}", own.ratio),
            format!("{:.2}", own.lost),
            format!("{:.1}", s.automatic_distance() * 100.0),
            format!("{:.0}", s.automatic_slowness() * 100.0),
        ]);
    }
    table
}

fn recommended_table(scenes: &[SceneTradeoff]) -> Table {
    let columns = ["scene", "1 us an object", "10 us an object", "100 us an object"];
    let mut table = Table::new("tradeoff-recommended", &columns);
    for s in scenes {
        let best = DRAWING.map(|us| {
            let Some(p) = s.best_for(us) else { return String::new() };
            let method = p.method.split([' ', ',']).next().unwrap_or_default();
            let setting = p.setting.replace(" a side, refined", ",");
            format!("{method}, {setting} ({:.2} ms, {:.2})", p.ms, p.ratio)
        });
        let [a, b, c] = best;
        table.row([s.scene.clone(), a, b, c]);
    }
    table
}

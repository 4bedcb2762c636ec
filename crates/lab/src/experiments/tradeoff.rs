//! Speed against accuracy: every method at several settings on every scene.

use casca::{Aabb, CellOptions, Method, PointOptions, cell_for};

use super::walker::{Walker, item_buffer};
use super::{Contender, Lab, LabError, Place, Section, Table, median, places};
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

/// What one setting costs and gives.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cost {
    /// Milliseconds of a frame.
    ms: f64,
    /// Objects found visible over objects that are.
    ratio: f64,
    /// Whether it lost nothing visible.
    safe: bool,
}

/// Which settings are on the front: they lost nothing, and no other one that lost nothing is as
/// good in one respect and better in the other.
fn front(costs: &[Cost]) -> Vec<bool> {
    let beats = |a: &Cost, b: &Cost| {
        a.safe && a.ms <= b.ms && a.ratio <= b.ratio && (a.ms < b.ms || a.ratio < b.ratio)
    };
    costs.iter().map(|c| c.safe && !costs.iter().any(|o| beats(o, c))).collect()
}

/// How far a setting is from the front: the least share by which it would have to improve in time
/// or in accuracy for no setting that lost nothing to be better in both. 0 is on the front.
fn distance(of: &Cost, costs: &[Cost]) -> f64 {
    let worse = |o: &Cost| (of.ms / o.ms).min(of.ratio / o.ratio) - 1.0;
    costs.iter().filter(|o| o.safe).map(worse).filter(|d| d.is_finite()).fold(0.0, f64::max)
}

/// What was measured on one scene.
#[derive(Debug, Clone)]
struct SceneTradeoff {
    /// The scene's name.
    scene: String,
    /// Objects of which the item buffer shows a pixel: the mean.
    visible: f64,
    /// The settings measured; the first is the automatic one: all defaults, in the grid of
    /// [`cell_for`].
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
    let fitted = cell_for(region, world.objects.len())?;
    let mut walker = Walker::new(world)?;
    walker.add(fitted)?;
    let mut exact = item_buffer(sampling.width);
    let (mut visible_sum, mut done) = (0usize, 0);
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

/// All methods and settings on all scenes, with the Pareto front.
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
         automatic` has default settings in the grid of `cell_for`. {}",
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

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(ms: f64, ratio: f64, safe: bool) -> Cost {
        Cost { ms, ratio, safe }
    }

    #[test]
    fn the_front_holds_what_nothing_safe_beats() {
        let all = [
            cost(1.0, 2.0, true),
            cost(2.0, 1.5, true),
            cost(2.0, 1.6, true),
            cost(0.5, 1.0, false),
            cost(4.0, 1.5, true),
        ];
        assert_eq!(front(&all), [true, true, false, false, false]);
        assert_eq!(distance(&all[0], &all), 0.0);
        assert!((distance(&all[2], &all) - 0.0).abs() < 1e-12, "as fast as the best");
        // Twice as slow at the same accuracy: no faster, so accuracy would have to improve from
        // 1.5.
        assert!((distance(&all[4], &all)).abs() < 1e-12);
        let worse = cost(2.2, 1.8, true);
        assert!((distance(&worse, &all) - 0.1).abs() < 1e-12);
    }
}

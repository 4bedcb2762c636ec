//! How far an eye may go before its set is too large: `View::with_reach` on every scene, beside all
//! that such eyes see.

use casca::{Method, Query, View};

use super::{ASPECT, Lab, LabError, Place, Section, Table, grouped, median};
use casca_scenes::drive::{Driver, fitted_grid, view_of};
use casca_scenes::generated::SceneKind;
use casca_scenes::measure::timed;
use casca_scenes::world::{FRAME_SECONDS, World};
use casca_truth::oracle::{BallCounts, BallOptions, BallOracle, OracleOptions, Seen};

/// How far an eye may go, in metres.
const REACHES: [f32; 9] = [0.0, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 3.0];
/// The one of them that the findings speak of: four frames of a walking camera.
const TYPICAL: usize = 4;
/// Sets that are larger than that without a reach by at most this factor pay.
const WORTH: f64 = 1.25;

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Sampling {
    /// Frames of a walk, evenly spread.
    frames: usize,
    /// Times that each query is run; the least time counts.
    repeats: usize,
    /// What finds the visible objects.
    balls: BallOptions,
}

fn sampling(quick: bool, seed: u64) -> Sampling {
    let (frames, repeats, (width, height), eyes, buffers) =
        if quick { (1, 1, (160, 90), 8, 2) } else { (5, 3, (480, 270), 64, 8) };
    let each = OracleOptions { width, height, samples_per_object: 2, max_candidates: 2000, seed };
    Sampling { frames, repeats, balls: BallOptions { each, eyes, buffers, past_rims: 256 } }
}

/// What was measured at one reach; means over the frames.
#[derive(Debug, Clone, Copy, Default)]
struct Step {
    /// Objects that may lie in the view of such an eye.
    in_frustum: f64,
    /// PVS(r): objects in the set.
    found: f64,
    /// EVS(r): objects that an eye sees, as far as sampled.
    visible: f64,
    /// The median of the times of a query, in milliseconds.
    ms: f64,
    /// Objects that an eye sees beyond doubt and the set lacks, in all frames.
    lost: usize,
}

/// What was measured on one scene.
#[derive(Debug, Clone, Default)]
struct Score {
    scene: String,
    steps: [Step; REACHES.len()],
    /// How much was looked at.
    counts: BallCounts,
}

impl Score {
    /// The greatest reach up to which sets are larger than those without by at most a quarter.
    fn pays_to(&self) -> f32 {
        let most = self.steps[0].found * WORTH;
        let paid = self.steps.iter().take_while(|s| s.found <= most).count();
        REACHES[paid.saturating_sub(1)]
    }

    /// How many times the objects of an eye that stays an eye needs that may go a typical way.
    fn growth(&self) -> f64 {
        self.steps[TYPICAL].found / self.steps[0].found.max(1.0)
    }

    fn lost(&self) -> usize {
        self.steps.iter().map(|s| s.lost).sum()
    }
}

fn measure(mut world: World, sampling: &Sampling) -> Result<Score, LabError> {
    world.set_frame(0);
    let grid = fitted_grid(&world)?;
    let mut driver = Driver::new(&world, &grid, |_| ())?;
    let (mut query, mut frustum) = (Query::new(), Query::with_method(Method::Frustum)?);
    let mut seen = Seen::of(&world);
    let mut oracle = BallOracle::new(seen.objects(&world.objects), sampling.balls);
    let frames = sampling.frames.clamp(1, world.frames.max(1));
    let mut score = Score { scene: world.name.clone(), ..Score::default() };
    let mut times: [Vec<f64>; REACHES.len()] = Default::default();
    for done in 0..frames {
        // Not the first frame: walks may begin outside of a scene.
        let number = (2 * done + 1) * world.frames / (2 * frames);
        let moved = world.set_frame(number);
        driver.scene.begin_frame(number as f64 * FRAME_SECONDS)?;
        driver.update(&world.objects, &moved)?;
        let camera = world.camera(number, ASPECT);
        let view: View = view_of(&camera)?;
        // Hidden movers go into their volumes.
        driver.scene.end_frame([query.run(&driver.scene, &view)])?;
        oracle.begin(seen.follow(&world.objects, &moved), &moved, &camera);
        for (i, reach) in REACHES.into_iter().enumerate() {
            if reach > 0.0 {
                oracle.look(seen.objects(&world.objects), reach);
            }
            let view = view.clone().with_reach(reach)?;
            let runs = (0..sampling.repeats.max(1)).map(|_| timed(|| query.run(&driver.scene, &view)).1);
            times[i].push(runs.map(|t| t.as_secs_f64() * 1e3).fold(f64::INFINITY, f64::min));
            let pvs = query.pvs();
            let step = &mut score.steps[i];
            step.lost += oracle.missing(|object| driver.sees(pvs, object)).len();
            step.found += driver.count(pvs, &world.objects) as f64 / frames as f64;
            step.visible += oracle.exact().len() as f64 / frames as f64;
            let in_frustum = frustum.run(&driver.scene, &view);
            step.in_frustum += driver.count(in_frustum, &world.objects) as f64 / frames as f64;
        }
    }
    for (step, times) in score.steps.iter_mut().zip(&mut times) {
        step.ms = median(times);
    }
    score.counts = oracle.counts();
    Ok(score)
}

/// Sets for eyes that may go ever farther, on all scenes.
///
/// # Errors
/// If a scene cannot be read or is refused.
pub fn reach(lab: &Lab) -> Result<Section, LabError> {
    let sampling = sampling(lab.quick, lab.seed);
    let kinds: &[SceneKind] =
        if lab.quick { &[SceneKind::Rooms, SceneKind::CityMeshes] } else { &SceneKind::ALL };
    let built = kinds.iter().copied().map(Place::Built);
    let mut scores = Vec::new();
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        scores.push(measure(world, &sampling)?);
    }
    let mut section = Section::new("Eyes that may go some way");
    section.text(text(&sampling, &scores));
    section.rows("All figures as CSV", table(&scores));
    Ok(section)
}

fn text(sampling: &Sampling, scores: &[Score]) -> String {
    let lost = match scores.iter().map(Score::lost).sum() {
        0 => "No set lacks a visible object".to_owned(),
        lost => format!("Sets lack {} visible objects", grouped(lost)),
    };
    let rays: u64 = scores.iter().map(|s| s.counts.rays).sum();
    let pixels: u64 = scores.iter().map(|s| s.counts.item_rays).sum();
    let by_growth = |a: &&Score, b: &&Score| a.growth().total_cmp(&b.growth());
    let ends = scores.iter().min_by(by_growth).zip(scores.iter().max_by(by_growth));
    let growth = ends.map_or(String::new(), |(least, most)| {
        format!("{:.2} ({}) to {:.2} ({})", least.growth(), least.scene, most.growth(), most.scene)
    });
    format!(
        "PVS(r) is the set of `point` for all eyes within r metres of a place (`View::with_reach`), EVS(r) \
         the set that {} such eyes see in each of {} frames of a walk: a lower bound. **{lost}, by {:.0} \
         million rays aimed and {:.0} million pixels.** An eye that may go {} m needs {growth} times the \
         objects of one that stays. A reach *pays* as long as the set is larger than that of r = 0 by at \
         most a quarter.",
        sampling.balls.eyes,
        sampling.frames,
        rays as f64 / 1e6,
        pixels as f64 / 1e6,
        REACHES[TYPICAL]
    )
}

/// A row for each scene and reach.
fn table(scores: &[Score]) -> Table {
    let columns = [
        "scene",
        "r, m",
        "in the frustum",
        "PVS(r)",
        "EVS(r)",
        "PVS(r)/EVS(r)",
        "PVS(r)/EVS(0)",
        "PVS(r)/PVS(0)",
        "ms",
        "time over that of r = 0",
        "lost",
        "pays",
    ];
    let mut table = Table::new("reach", &columns);
    for score in scores {
        let none = &score.steps[0];
        for (step, reach) in score.steps.iter().zip(REACHES) {
            let counts = [step.in_frustum, step.found, step.visible].map(|v| format!("{v:.1}"));
            let over = |a: f64, b: f64| format!("{:.3}", a / b.max(f64::MIN_POSITIVE));
            let pays = if reach <= score.pays_to() { "yes" } else { "" };
            let ratios = [
                over(step.found, step.visible),
                over(step.found, none.visible),
                over(step.found, none.found),
                format!("{:.4}", step.ms),
                over(step.ms, none.ms),
                step.lost.to_string(),
                pays.to_owned(),
            ];
            table.row([score.scene.clone(), reach.to_string()].into_iter().chain(counts).chain(ratios));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use casca_scenes::generated::{SceneOptions, build};

    #[test]
    fn a_reach_pays_while_sets_are_larger_by_at_most_a_quarter() {
        let pays = |found: [f64; REACHES.len()]| {
            let steps = found.map(|found| Step { found, visible: 9.0, ..Step::default() });
            Score { steps, ..Score::default() }.pays_to()
        };
        assert_eq!(pays([10.0, 10.0, 11.0, 12.0, 12.5, 12.6, 20.0, 20.0, 20.0]), 0.1);
        assert_eq!(pays([10.0, 13.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0]), 0.0);
        assert_eq!(pays([10.0; 9]), 3.0);
    }

    #[test]
    fn sets_grow_with_the_reach_and_lose_nothing() {
        for kind in [SceneKind::Rooms, SceneKind::CityMeshes] {
            let world = build(kind, &SceneOptions::default());
            let score = measure(world, &sampling(true, 3)).unwrap();
            assert_eq!(score.lost(), 0, "{kind:?}");
            assert!(score.counts.rays > 1000 && score.counts.eyes == 9 * 8);
            for (i, s) in score.steps.iter().enumerate() {
                assert!(s.found >= s.visible && s.in_frustum >= s.found, "{kind:?}: {s:?}");
                assert!(i == 0 || s.found >= score.steps[i - 1].found, "{kind:?}: {s:?}");
                assert!(i == 0 || s.visible >= score.steps[i - 1].visible, "{kind:?}: {s:?}");
            }
            assert!(score.steps[8].visible > score.steps[0].visible, "{kind:?}: three metres show more");
            let rows = table(&[score]).rows;
            assert!(rows.len() == 9 && rows[0][9] == "1.000" && rows[4][1] == "0.1");
        }
    }
}

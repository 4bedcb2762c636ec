//! Sets of a scene for eyes that may go ever farther, beside all that such eyes see.

use casca::{Aabb, GridSpec, Method, Query, View};

use super::super::{ASPECT, Effort, LabError, median};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::measure::timed;
use casca_scenes::world::{FRAME_SECONDS, Shape, World};
use casca_truth::oracle::{BallCounts, BallOptions, BallOracle, BallSighting, OracleOptions, Seen};

/// How far an eye may go, in metres.
pub const REACHES: [f32; 9] = [0.0, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 3.0];

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Frames of a walk, evenly spread.
    pub frames: usize,
    /// Times that each query is run; the least time counts.
    pub repeats: usize,
    /// What finds the visible objects.
    pub balls: BallOptions,
}

impl Sampling {
    /// One frame of a scene in a smoke run; a short run takes seconds for each scene, and a full
    /// one minutes: it has more frames, and an item buffer for every eye.
    pub fn new(effort: Effort, seed: u64) -> Self {
        match effort {
            Effort::Quick => Self { frames: 1, repeats: 1, balls: balls((160, 90), 8, 2, seed) },
            Effort::Short => Self { frames: 5, repeats: 3, balls: balls((480, 270), 64, 8, seed) },
            Effort::Full => Self { frames: 10, repeats: 3, balls: balls((960, 540), 64, 64, seed) },
        }
    }
}

fn balls((width, height): (usize, usize), eyes: usize, buffers: usize, seed: u64) -> BallOptions {
    let each = OracleOptions { width, height, samples_per_object: 2, max_candidates: 2000, seed };
    BallOptions { each, eyes, buffers, past_rims: 256 }
}

/// What was measured at one reach; means over the frames.
#[derive(Debug, Clone, Copy, Default)]
pub struct Step {
    /// How far the eye may go, in metres.
    pub reach: f64,
    /// Objects that may lie in the view of such an eye.
    pub in_frustum: f64,
    /// PVS(r): objects in the set.
    pub found: f64,
    /// EVS(r): objects that an eye sees, as far as sampled.
    pub visible: f64,
    /// The median of the times of a query, in milliseconds.
    pub ms: f64,
    /// Objects that an eye sees beyond doubt and the set lacks, in all frames.
    pub lost: usize,
}

/// What was measured on one scene.
#[derive(Debug, Clone, Default)]
pub struct ReachScore {
    /// The scene's name.
    pub scene: String,
    /// Whether it has meshes.
    pub meshes: bool,
    /// By the reaches of [`REACHES`].
    pub steps: [Step; REACHES.len()],
    /// How much was looked at.
    pub counts: BallCounts,
    /// Some of the objects lost.
    pub examples: Vec<(f32, BallSighting)>,
}

/// Sets that are larger than that without a reach by at most this factor pay.
const WORTH: f64 = 1.25;
/// Losses that are kept as examples.
const EXAMPLES: usize = 10;

impl ReachScore {
    /// The greatest reach up to which sets are larger than those without by at most a quarter.
    pub fn pays_to(&self) -> f64 {
        let most = self.steps[0].found * WORTH;
        self.steps.iter().take_while(|s| s.found <= most).last().map_or(0.0, |s| s.reach)
    }

    /// Objects lost at all reaches.
    pub fn lost(&self) -> usize {
        self.steps.iter().map(|s| s.lost).sum()
    }
}

/// Measures a scene. `progress` is told the frames done.
///
/// # Errors
/// If the library refuses the scene.
pub fn measure(
    mut world: World,
    sampling: &Sampling,
    mut progress: impl FnMut(usize),
) -> Result<ReachScore, LabError> {
    world.set_frame(0);
    let grid = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), world.objects.len())?;
    let mut driver = Driver::new(&world, &grid, |_| ())?;
    let (mut query, mut frustum) = (Query::new(), Query::with_method(Method::Frustum)?);
    let mut seen = Seen::of(&world);
    let mut oracle = BallOracle::new(seen.objects(&world.objects), sampling.balls);
    let frames = sampling.frames.clamp(1, world.frames.max(1));
    let mut score = ReachScore {
        scene: world.name.clone(),
        meshes: world.objects.iter().any(|o| matches!(o.shape, Shape::Mesh { .. })),
        ..ReachScore::default()
    };
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
            let lost = oracle.missing(|object| driver.sees(pvs, object));
            let step = &mut score.steps[i];
            step.reach = f64::from(reach);
            step.lost += lost.len();
            step.found += driver.count(pvs, &world.objects) as f64 / frames as f64;
            step.visible += oracle.exact().len() as f64 / frames as f64;
            let in_frustum = frustum.run(&driver.scene, &view);
            step.in_frustum += driver.count(in_frustum, &world.objects) as f64 / frames as f64;
            score.examples.extend(lost.into_iter().map(|s| (reach, s)));
            score.examples.truncate(EXAMPLES);
        }
        progress(done + 1);
    }
    for (step, times) in score.steps.iter_mut().zip(&mut times) {
        step.ms = median(times);
    }
    score.counts = oracle.counts();
    Ok(score)
}

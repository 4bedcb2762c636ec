//! A walk, with all ways side by side.

use casca::{KeptOptions, Method, PointOptions, Query, View};

use super::super::walker::item_buffer;
use super::super::{ASPECT, Contender, FrameInput, LabError, p99};
use casca_scenes::drive::{Driver, fitted_cell, view_of};
use casca_scenes::generated::{WALK_SECONDS, WalkOptions, walking};
use casca_scenes::world::{Camera, World};
use casca_truth::oracle::{Oracle, OracleOptions, Seen};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Frames of a walk, in all places together.
    pub frames: usize,
    /// Places along the path of the scene.
    pub stretches: usize,
    /// One frame in this many is compared with exact visibility.
    pub judge: usize,
    /// Pixels of a row of the item buffer.
    pub width: usize,
    /// Rays to each object that a way leaves out.
    pub rays: usize,
    /// Seed of the movers and the rays.
    pub seed: u64,
}

/// Frames after a jump to another place that are not timed: hidden movers come into their volumes
/// in them.
const SETTLE: usize = 5;

/// What a way did on a walk.
#[derive(Debug, Clone, Default)]
pub struct WayScore {
    /// Its name.
    pub name: String,
    /// Milliseconds of a frame: the mean.
    pub mean: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// Objects found and in the frustum, the mean of the frames that are judged.
    pub found: f64,
    /// Visible objects that were missing, in all frames that are judged.
    pub wrong: usize,
}

/// What was measured on one scene.
#[derive(Debug, Clone, Default)]
pub struct WalkScore {
    /// The scene's name.
    pub scene: String,
    /// Objects that move.
    pub movers: usize,
    /// Frames that are judged.
    pub judged: usize,
    /// Visible objects, the mean of the frames that are judged.
    pub visible: f64,
    /// The ways; the first is a fresh query in every frame.
    pub ways: Vec<WayScore>,
}

/// The ways that are compared; the others are measured against the first.
pub fn ways() -> Result<Vec<Contender>, LabError> {
    let options = PointOptions::default();
    let mut all = vec![
        Contender::casca("fresh", Method::Point(options))?,
        Contender::casca("coherent", Method::Point(options.coherent(true)))?,
    ];
    let (usual, small) = (KeptOptions::new(), KeptOptions::new().reach(0.06).turn(f32::to_radians(5.0)));
    for (options, aside) in [(usual, false), (small, true), (usual, true)] {
        let name = format!("kept, {} m, {:.0} degrees", options.reach, options.turn.to_degrees());
        all.push(match aside {
            true => Contender::aside(&(name + ", another thread"), options)?,
            false => Contender::kept(&name, options)?,
        });
    }
    Ok(all)
}

/// A way with its scene, which is kept up to date and gets its results back, and sums over frames.
struct Entry {
    way: Contender,
    driver: Driver,
    ms: Vec<f64>,
    found: usize,
    wrong: usize,
}

impl Entry {
    /// Runs a frame up to its answer, and returns the milliseconds that the answer took.
    fn frame(&mut self, world: &World, moved: &[usize], now: f64, camera: &Camera) -> Result<f64, LabError> {
        self.driver.scene.begin_frame(now)?;
        self.driver.update(&world.objects, moved)?;
        let input = FrameInput { driver: &self.driver, objects: &world.objects, in_frustum: &[], camera };
        Ok(self.way.run(&input)?.as_secs_f64() * 1e3)
    }

    fn score(mut self, judged: usize) -> WayScore {
        WayScore {
            name: self.way.setting,
            mean: self.ms.iter().sum::<f64>() / self.ms.len().max(1) as f64,
            p99: p99(&mut self.ms),
            found: self.found as f64 / judged.max(1) as f64,
            wrong: self.wrong,
        }
    }
}

/// Compares the sets of a frame with exact visibility.
struct Judge {
    oracle: Oracle,
    /// What the oracle is told of a file.
    seen: Seen,
    frustum: Query,
    /// Objects that moved since the frame judged before.
    moved: Vec<usize>,
    visible: usize,
    frames: usize,
}

impl Judge {
    fn new(world: &World, sampling: &Sampling) -> Result<Self, LabError> {
        let buffer = item_buffer(sampling.width);
        let options = OracleOptions {
            width: buffer.width(),
            height: buffer.height(),
            samples_per_object: sampling.rays,
            max_candidates: 20_000,
            seed: sampling.seed,
        };
        let frustum = Query::with_method(Method::Frustum)?;
        let seen = Seen::of(world);
        Ok(Self {
            oracle: Oracle::new(seen.objects(&world.objects), options),
            seen,
            frustum,
            moved: Vec::new(),
            visible: 0,
            frames: 0,
        })
    }

    /// Notes which objects moved since the frame before.
    fn note(&mut self, moved: &[usize]) {
        self.moved.extend(moved);
    }

    fn judge(&mut self, world: &World, camera: &Camera, view: &View, entries: &mut [Entry]) {
        let mut moved = std::mem::take(&mut self.moved);
        moved.sort_unstable();
        moved.dedup();
        let verdict = self.oracle.frame(self.seen.follow(&world.objects, &moved), &moved, camera, &|i| {
            entries.iter().all(|e| e.way.sees(i))
        });
        self.visible += verdict.exact.len();
        self.frames += 1;
        let Some(first) = entries.first() else { return };
        let pvs = self.frustum.run(&first.driver.scene, view);
        let tested = |i: &usize| world.objects[*i].tested && first.driver.sees(pvs, *i);
        let in_frustum: Vec<usize> = (0..world.objects.len()).filter(tested).collect();
        for entry in entries {
            entry.found += in_frustum.iter().filter(|&&i| entry.way.sees(i)).count();
            entry.wrong += verdict.false_negatives.iter().filter(|f| !entry.way.sees(f.object)).count();
        }
    }
}

/// Walks through a scene with this many movers.
///
/// # Errors
/// If the library refuses the scene, or a way fails.
pub fn measure(world: World, movers: usize, sampling: &Sampling) -> Result<WalkScore, LabError> {
    let stretches = sampling.stretches.max(1);
    let frames = sampling.frames.div_ceil(stretches).max(SETTLE + 1);
    let options = WalkOptions { movers, stretches, frames, seed: sampling.seed };
    let mut world = walking(world, ASPECT, &options);
    let cell = fitted_cell(&world)?;
    let driver = Driver::new(&world, cell, |_| ())?;
    let mut entries = Vec::new();
    for way in ways()? {
        let (driver, ms) = (driver.clone(), Vec::new());
        entries.push(Entry { way, driver, ms, found: 0, wrong: 0 });
    }
    let mut judge = Judge::new(&world, sampling)?;
    for number in 0..world.frames {
        let moved = world.set_frame(number);
        let camera = world.camera(number, ASPECT);
        let view: View = view_of(&camera)?;
        judge.note(&moved);
        let counts = number % options.frames.max(1) >= SETTLE;
        let count = entries.len();
        // Each frame starts with another way, so that none is always the one after the judgement.
        for turn in 0..count {
            let entry = &mut entries[(turn + number) % count];
            let ms = entry.frame(&world, &moved, number as f64 * WALK_SECONDS, &camera)?;
            if counts {
                entry.ms.push(ms);
            }
        }
        if number.is_multiple_of(sampling.judge.max(1)) {
            judge.judge(&world, &camera, &view, &mut entries);
        }
        for entry in &mut entries {
            entry.way.work_aside();
            entry.driver.scene.end_frame(entry.way.pvs())?;
        }
    }
    Ok(WalkScore {
        scene: world.name.clone(),
        movers,
        judged: judge.frames,
        visible: judge.visible as f64 / judge.frames.max(1) as f64,
        ways: entries.into_iter().map(|e| e.score(judge.frames)).collect(),
    })
}

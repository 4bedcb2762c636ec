//! A walk in progress: the scene, the queries and the exact visibility that they are checked
//! against.

use std::sync::Arc;
use std::time::{Duration, Instant};

use casca::{Method, Query};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::measure::{ThreadTime, timed};
use casca_scenes::world::{FRAME_SECONDS, World};
use casca_truth::oracle::{FrameVerdict, ItemBuffer, Oracle, OracleOptions, Seen};

use super::options::{ASPECT, Options};
use crate::arguments::{Failure, bar};
use crate::pictures::{FrameCounts, FramePicture, frame};

/// The height of a picture.
fn height_of(width: usize) -> usize {
    (width as f32 / ASPECT).round() as usize
}

/// The results of one frame.
pub struct Frame {
    /// Objects in the frustum, found and visible.
    pub counts: FrameCounts,
    /// Time of the query.
    pub query: Duration,
    /// Time of telling the scene what moved.
    pub update: Duration,
    /// Cells that the query visited.
    pub cells: u64,
    /// The result of the check.
    pub verdict: FrameVerdict,
}

/// A walk in progress.
pub struct Session<'a> {
    /// The scene as it is now.
    pub world: World,
    /// The library's scene.
    pub driver: Driver,
    /// Time that it took to fill the library's scene.
    pub setup: Duration,
    options: &'a Options,
    query: Query,
    frustum: Query,
    oracle: Oracle,
    /// What the oracle is told of the file.
    seen: Seen,
}

impl<'a> Session<'a> {
    /// Fills the library's scene.
    pub fn new(options: &'a Options, mut world: World) -> Result<Self, Failure> {
        world.set_frame(0);
        // By the clock on the wall: prepared meshes may be read from files.
        let start = Instant::now();
        let driver = fill(options, &world);
        let setup = start.elapsed();
        let oracle_options = OracleOptions {
            width: options.width as usize,
            height: height_of(options.width as usize),
            samples_per_object: options.samples as usize,
            max_candidates: 20_000,
            seed: options.common.seed,
        };
        let seen = Seen::of(&world);
        Ok(Self {
            driver: driver?,
            setup,
            options,
            query: Query::with_method(options.query_method())?,
            frustum: Query::with_method(Method::Frustum)?,
            oracle: Oracle::new(seen.objects(&world.objects), oracle_options),
            seen,
            world,
        })
    }

    /// Runs a frame and checks it; in the middle of the walk also draws it.
    pub fn frame(&mut self, number: usize) -> Result<Frame, Failure> {
        let moved = self.world.set_frame(number);
        let (camera, objects) = (self.world.camera(number, ASPECT), &self.world.objects);
        let view = view_of(&camera)?;

        let start = ThreadTime::now();
        self.driver.scene.begin_frame(number as f64 * FRAME_SECONDS)?;
        self.driver.update(objects, &moved)?;
        let mut update = start.elapsed();
        let ((), query) = timed(|| {
            self.query.run(&self.driver.scene, &view);
        });
        let pvs = self.query.pvs();
        let cells = pvs.stats().cells_visited;
        let in_frustum = self.driver.found(self.frustum.run(&self.driver.scene, &view));
        let sees = |object: usize| self.driver.sees(pvs, object);
        let verdict = self.oracle.frame(self.seen.follow(objects, &moved), &moved, &camera, &sees);
        let tested = |object: &usize| objects[*object].tested;
        let counts = FrameCounts {
            frustum: in_frustum.iter().copied().filter(tested).count(),
            pvs: (0..objects.len()).filter(tested).filter(|&i| sees(i)).count(),
            exact: verdict.exact.len(),
        };
        if number == self.world.frames / 2 {
            let mut exact = ItemBuffer::new(1280, height_of(1280));
            exact.render(objects, &camera);
            let picture =
                FramePicture { exact: &exact, objects, camera, in_frustum: &in_frustum, sees: &sees };
            let (name, method) = (&self.world.name, self.options.query_method().name());
            let title = format!("{name}, frame {number}: what {method} shows and hides");
            frame(&self.options.out.join("frame.png"), &title, &picture)?;
        }
        let start = ThreadTime::now();
        self.driver.scene.end_frame([self.query.pvs()])?;
        update += start.elapsed();
        Ok(Frame { counts, query, update, cells, verdict })
    }
}

/// The library's scene with all objects of the world.
fn fill(options: &Options, world: &World) -> Result<Driver, Failure> {
    let cell = world.grid.cell;
    let cache = options.cached.open()?.map(Arc::new);
    let bar = bar(options.common.quiet, world.objects.len(), "preparing", "object");
    let driver =
        Driver::with(&world.objects, cell, cache, |_, desc| desc, |done| bar.set_position(done as u64))?;
    bar.finish_and_clear();
    Ok(driver)
}

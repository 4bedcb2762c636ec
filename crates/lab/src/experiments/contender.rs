//! A method at a setting, run on frames.

use std::time::Duration;

use casca::{Error, KeptJob, KeptOptions, KeptQuery, KeptResult, Method, Pvs, Query};

use casca_scenes::drive::{Driver, view_of};
use casca_scenes::measure::ThreadTime;
use casca_scenes::world::{Camera, Object};
use casca_truth::baselines::Hzb;

/// Pixels of a depth buffer as engines use it.
pub const BUFFER: (usize, usize) = (320, 180);

/// A frame, as all methods get it.
#[derive(Clone, Copy)]
pub struct FrameInput<'a> {
    /// The scene, kept up to date.
    pub driver: &'a Driver,
    /// The objects as they are now.
    pub objects: &'a [Object],
    /// Those that may be in the frustum, ascending; only the baselines use it.
    pub in_frustum: &'a [usize],
    /// The camera.
    pub camera: &'a Camera,
}

enum Engine {
    Casca(Box<Query>),
    Kept(Box<KeptQuery>),
    /// The same, with results that another thread finds: one job after the other, each of which is
    /// done when the next frame begins.
    Aside(Box<KeptQuery>, Option<Box<KeptJob>>, Option<Box<KeptResult>>),
    Hzb(Box<Hzb>),
}

/// A method at a setting, the library's or a baseline.
pub struct Contender {
    /// The method's name.
    pub method: &'static str,
    /// The setting in a few words.
    pub setting: String,
    engine: Engine,
    found: Vec<usize>,
}

impl Contender {
    fn new(method: &'static str, setting: String, engine: Engine) -> Self {
        Self { method, setting, engine, found: Vec::new() }
    }

    /// The library by a method, whose options `setting` describes.
    ///
    /// # Errors
    /// As [`Query::with_method`].
    pub fn casca(setting: impl Into<String>, method: Method) -> Result<Self, Error> {
        Ok(Self::new(method.name(), setting.into(), Engine::Casca(Box::new(Query::with_method(method)?))))
    }

    /// The library by results that are kept for many frames.
    ///
    /// # Errors
    /// As [`KeptQuery::with_options`].
    pub fn kept(setting: &str, options: KeptOptions) -> Result<Self, Error> {
        let query = Box::new(KeptQuery::with_options(options)?);
        Ok(Self::new("kept", setting.to_owned(), Engine::Kept(query)))
    }

    /// The same, where another thread finds new results before a frame needs them.
    ///
    /// # Errors
    /// As [`KeptQuery::with_options`].
    pub fn aside(setting: &str, options: KeptOptions) -> Result<Self, Error> {
        let query = Box::new(KeptQuery::with_options(options)?);
        Ok(Self::new("kept", setting.to_owned(), Engine::Aside(query, None, None)))
    }

    /// A rasterised depth buffer of `width` by `height` pixels.
    pub fn hzb(width: usize, height: usize) -> Self {
        Self::new("hzb", format!("{width}x{height}"), Engine::Hzb(Box::new(Hzb::new(width, height))))
    }

    /// The result of the last frame, if the method is the library's.
    pub fn pvs(&self) -> Option<&Pvs> {
        match &self.engine {
            Engine::Casca(query) => Some(query.pvs()),
            Engine::Kept(query) | Engine::Aside(query, ..) => Some(query.pvs()),
            Engine::Hzb(_) => None,
        }
    }

    /// Runs a frame and returns the time that took, without that of reading the result.
    ///
    /// # Errors
    /// As [`view_of`].
    pub fn run(&mut self, frame: &FrameInput) -> Result<Duration, Error> {
        let FrameInput { driver, objects, in_frustum, camera } = *frame;
        let view = view_of(camera)?;
        let scene = &driver.scene;
        let mut visible = Vec::new();
        let start = ThreadTime::now();
        match &mut self.engine {
            Engine::Casca(query) => _ = query.run(scene, &view),
            Engine::Kept(query) => _ = query.run(scene, &view),
            Engine::Aside(query, job, found) => {
                if let Some(found) = found.take() {
                    query.install(*found, scene);
                }
                query.run(scene, &view);
                *job = Some(Box::new(query.prepare(scene, &view)));
            }
            Engine::Hzb(hzb) => visible = hzb.frame(objects, in_frustum, camera),
        }
        let time = start.elapsed();
        self.found = self.pvs().map_or(visible, |pvs| driver.found(pvs));
        self.found.retain(|&i| objects[i].tested);
        self.found.sort_unstable();
        Ok(time)
    }

    /// Does the work of the other thread until the next frame; its time is not measured.
    pub fn work_aside(&mut self) {
        if let Engine::Aside(_, job, found) = &mut self.engine {
            *found = job.take().map(|job| Box::new(job.run()));
        }
    }

    /// Runs a frame this many times, at least once, and returns the least milliseconds.
    ///
    /// # Errors
    /// As [`Contender::run`].
    pub fn least(&mut self, frame: &FrameInput, times: usize) -> Result<f64, Error> {
        let mut least = f64::INFINITY;
        for _ in 0..times.max(1) {
            least = least.min(self.run(frame)?.as_secs_f64() * 1e3);
        }
        Ok(least)
    }

    /// The tested objects that the last frame found visible, ascending.
    pub fn found(&self) -> &[usize] {
        &self.found
    }

    /// Whether the last frame found an object visible.
    pub fn sees(&self, object: usize) -> bool {
        self.found.binary_search(&object).is_ok()
    }
}

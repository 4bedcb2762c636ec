//! A method at a setting, run on frames.

use std::time::Duration;

use casca::{Error, KeptOptions, KeptQuery, Method, Query};

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

    /// A rasterised depth buffer of `width` by `height` pixels.
    pub fn hzb(width: usize, height: usize) -> Self {
        Self::new("hzb", format!("{width}x{height}"), Engine::Hzb(Box::new(Hzb::new(width, height))))
    }

    /// The query, if the method is the library's.
    pub fn query(&self) -> Option<&Query> {
        match &self.engine {
            Engine::Casca(query) => Some(query),
            _ => None,
        }
    }

    /// Runs a frame and returns the time that took, without that of reading the result.
    ///
    /// # Errors
    /// As [`view_of`].
    pub fn run(&mut self, frame: &FrameInput) -> Result<Duration, Error> {
        let FrameInput { driver, objects, in_frustum, camera } = *frame;
        let view = view_of(camera)?;
        let start = ThreadTime::now();
        let visible = match &mut self.engine {
            Engine::Casca(query) => {
                query.run(&driver.scene, &view);
                None
            }
            Engine::Kept(query) => {
                query.run(&driver.scene, &view);
                None
            }
            Engine::Hzb(hzb) => Some(hzb.frame(objects, in_frustum, camera)),
        };
        let time = start.elapsed();
        self.found = match (&self.engine, visible) {
            (Engine::Casca(query), _) => driver.found(query.pvs()),
            (Engine::Kept(query), _) => driver.found(query.pvs()),
            (_, visible) => visible.unwrap_or_default(),
        };
        self.found.retain(|&i| objects[i].tested);
        self.found.sort_unstable();
        Ok(time)
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

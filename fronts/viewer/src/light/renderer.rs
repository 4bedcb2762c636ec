//! A lit scene: its radiosity cache, which is gathered where a picture reads it, and its pictures.
//!
//! A frame has a budget. Rays of the camera ask for the states that the picture reads; these send
//! their rays and find their direct light, part by part; light is passed along; and the device gets
//! it all. With time all of it is there, and the light is that of a picture without a budget.

use std::error::Error;
use std::thread::available_parallelism;
use std::time::Duration;

use casca_radiosity::gpu::GpuCache;
use casca_radiosity::lit::LitScene;
use casca_radiosity::{Cache, Grid, Light, Scene, Statistics, Window};
use casca_scenes::world::Camera;
use casca_stage::canvas::Target;
use casca_stage::gpu::{Gpu, IS_PAGE};
use casca_stage::timing::{Clock, Instant};
use glam::{Affine3A, Vec2};

use crate::light::picture::{Layer, Picture, rays, roughness};

/// States that send their rays, or find their direct light, between two looks at the clock.
const PART: usize = 128;
/// Questions of a frame, and of each thread between two looks at the clock.
const QUESTIONS: u32 = 2048;
const QUESTION_PART: u32 = 64;
/// So many times as many if no clock is looked at, so that threads wait less for each other.
const WHOLE_PARTS: u32 = 32;
/// Cells of the window along an edge of a cell of the grid.
const FINER: u32 = 4;
/// Rays of a question on what mirrors: for one of a few pixels, and for each pixel.
const SOME_MIRRORED: u32 = 16;
const MIRRORED: u32 = 4;
/// The share of rays of states that only other states read.
const FARTHER: u32 = 4;
/// Passes of a frame: light of one bounce is there with the first.
const PASSES: u32 = 2;
/// Light is settled if a pass changes less than this share of it; it would take so many at most.
const SETTLED: f64 = 1e-4;
const MOST_PASSES: u32 = 64;
/// The plane's golden ratios, 0.7549 and 0.5698, as 32 bits behind the point: any number of first
/// points of this sequence is spread evenly (Roberts 2018).
const SPREAD: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// How light is gathered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Cells along the longest axis, 1 to 512.
    pub resolution: u32,
    /// Rays of each state that the picture reads.
    pub rays: u32,
    /// Cells are four times finer up to so many cells from the eye along each axis; 0 is nowhere.
    pub window: u32,
}

/// What a frame did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Updated {
    /// States that wait for rays.
    pub waiting: usize,
    /// States whose direct light is old.
    pub old: usize,
    /// Whether light has settled: the next frame would change nothing.
    pub settled: bool,
}

/// A lit scene and its pictures.
pub struct Renderer {
    /// How pictures are exposed: light times this is shown, and 1 is white. By their own light, if it is
    /// none.
    pub exposure: Option<f32>,
    /// How light is gathered; only read from outside.
    pub settings: Settings,
    scene: LitScene,
    cache: Cache,
    device: GpuCache,
    pub(super) picture: Picture,
    threads: u32,
    /// Questions so far: each has another place in the picture.
    asked: u32,
    updated: Updated,
}

impl Renderer {
    /// Puts the surfaces of a scene into cells. Nothing is lit before the first update.
    ///
    /// # Errors
    /// A setting out of its range, a scene that cannot be lit, and buffers that the adapter does
    /// not have.
    pub fn new(gpu: &Gpu, scene: &LitScene, settings: Settings) -> Result<Self, Box<dyn Error>> {
        let given = Scene::from(scene);
        let grid = Grid::around(&given.objects, settings.resolution);
        // A page has one thread.
        let threads = if IS_PAGE { 1 } else { available_parallelism().map_or(1, |n| n.get() as u32) };
        let half = settings.window as f32 * (grid.max - grid.min).max_element() / grid.cells as f32;
        let window = (settings.window > 0).then_some(Window { middle: grid.min, half, finer: FINER });
        let windows = [window, None];
        let how = casca_radiosity::Settings { windows, ..casca_radiosity::Settings::new(grid) };
        let cache = Cache::new(&given, how)?;
        Ok(Self {
            exposure: None,
            settings,
            device: GpuCache::new(&gpu.device, &cache)?,
            picture: Picture::new(gpu, scene)?,
            scene: scene.clone(),
            cache,
            threads,
            asked: 0,
            updated: Updated::default(),
        })
    }

    /// What the cache holds.
    pub fn statistics(&self) -> Statistics {
        self.cache.statistics()
    }

    /// Changes the lights.
    ///
    /// # Errors
    /// A light out of range. The old ones stay then.
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<(), Box<dyn Error>> {
        self.cache.set_lights(lights)?;
        self.updated.settled = false;
        Ok(())
    }

    /// Moves objects.
    ///
    /// # Errors
    /// There is no such object, or the triangles touch too many cells.
    pub fn move_objects(&mut self, gpu: &Gpu, moves: &[(usize, Affine3A)]) -> Result<(), Box<dyn Error>> {
        let mut moved = Vec::new();
        for &(number, place) in moves {
            let Some(object) = self.scene.objects.get_mut(number) else {
                return Err(format!("there is no object {number}").into());
            };
            object.transform = place;
            moved.push((number, object.lit(&self.scene.materials)));
            self.picture.move_object(gpu, number, object);
        }
        if !moved.is_empty() {
            self.cache.set_objects(moved)?;
            self.updated.settled = false;
        }
        Ok(())
    }

    /// Brings the light of a camera's picture up to date as far as the budget goes; all of it, for
    /// each pixel, without one.
    ///
    /// # Errors
    /// Too many rays, and buffers that the adapter does not have.
    pub fn update(
        &mut self,
        gpu: &Gpu,
        (camera, size): (&Camera, (u32, u32)),
        budget: Option<Duration>,
        clock: &mut Clock,
    ) -> Result<Updated, Box<dyn Error>> {
        let start = Instant::now();
        let is_late = |share: f64| budget.is_some_and(|b| start.elapsed() > b.mul_f64(share));
        let mut last = start;
        let mut stage = |clock: &mut Clock, name| {
            let now = Instant::now();
            clock.add(name, now - last);
            last = now;
        };
        let moved = self.cache.move_windows(camera.eye)?;
        self.updated.settled &= moved.kept + moved.dropped == 0;
        stage(clock, "window");
        self.ask(camera, size, budget.is_some(), &is_late)?;
        stage(clock, "questions");
        if self.updated.settled && self.cache.waiting() == 0 {
            return Ok(self.updated);
        }
        let rays = (self.settings.rays, self.settings.rays.div_ceil(FARTHER));
        // Each frame does some of all, so that a small budget ends, too.
        while self.cache.gather_part(rays, PART)? > 0 && !is_late(2.0 / 3.0) {}
        stage(clock, "rays");
        while self.cache.direct_part(PART) > 0 && !is_late(1.0) {}
        stage(clock, "direct light");
        let old = self.cache.direct_part(0);
        let passes = if budget.is_some() { PASSES } else { MOST_PASSES };
        let is_settled = self.cache.converge(SETTLED, passes) < passes;
        stage(clock, "passes and means");
        let waiting = self.cache.waiting();
        self.updated = Updated { waiting, old, settled: is_settled && waiting == 0 && old == 0 };
        self.device = GpuCache::new(&gpu.device, &self.cache)?;
        stage(clock, "upload");
        Ok(self.updated)
    }

    /// Asks for the states of each pixel, or of some more.
    fn ask(
        &mut self,
        camera: &Camera,
        (width, height): (u32, u32),
        is_some: bool,
        is_late: &impl Fn(f64) -> bool,
    ) -> Result<(), Box<dyn Error>> {
        let [corner, right, down] = rays(camera, (1, 1));
        let count = if is_some { QUESTIONS } else { width * height };
        let part = QUESTION_PART * self.threads * if is_some { 1 } else { WHOLE_PARTS };
        for first in (0..count).step_by(part as usize) {
            if first > 0 && is_late(1.0 / 3.0) {
                break;
            }
            let place = |i: u32| {
                if is_some {
                    let number = self.asked.wrapping_add(i);
                    return Vec2::from_array(
                        SPREAD.map(|s| s.wrapping_mul(number) as f32 / 2.0_f32.powi(32)),
                    );
                }
                Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5)
                    / Vec2::new(width as f32, height as f32)
            };
            let places = (first..count.min(first + part)).map(place);
            let rays: Vec<_> = places.map(|at| (camera.eye, corner + right * at.x + down * at.y)).collect();
            let seen = self.cache.request_radiances(&rays)?;
            let glossy = seen.into_iter().flatten().filter_map(|seen| {
                let material = self.scene.materials[seen.material as usize].sound();
                Some((seen.point, seen.normal, roughness(&material)?))
            });
            let rays = if is_some { SOME_MIRRORED } else { MIRRORED };
            self.cache.request_reflections(&glossy.collect::<Vec<_>>(), camera.eye, rays)?;
        }
        self.asked = self.asked.wrapping_add(count);
        Ok(())
    }

    /// Draws a layer, as large as the target.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        target: &Target,
        camera: &Camera,
        layer: Layer,
        clock: &mut Clock,
    ) -> Result<(), Box<dyn Error>> {
        self.picture.draw(gpu, (target, &self.device), camera, (layer, self.exposure), clock)
    }
}

//! The window: a camera to fly with, and keys for everything else.

use std::error::Error;
use std::time::Duration;

use casca_scenes::generated::SceneOptions;
use casca_scenes::name::SceneName;
use casca_scenes::world::{Camera, FRAME_SECONDS, Object};
use casca_stage::canvas::{Canvas, Target};
use casca_stage::dial::Dials;
use casca_stage::fly::Fly;
use casca_stage::gpu::{GpuError, IS_PAGE};
use casca_stage::panel::Panel;
use casca_stage::report::{Entry, Report};
use casca_stage::timing::Instant;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::scene::birds_eye::{FOV_Y, above_frustum, drawn, place_in};
use crate::scene::draw::{Begun, Check, Painter};
use crate::scene::geometry::Geometry;
use crate::scene::headless::haze;
use crate::scene::overlays::{LAYERS, Layer, Overlays};
use crate::scene::panel;
use crate::scene::playback::{METHODS, Method, Playback};
use crate::scene::renderer::{Output, Renderer};

/// The share of a scene's length that the camera flies in a second.
const SPEED: f32 = 0.06;
const HELP: &str = "W A S D Q E fly (Shift: faster), a mouse button: look   M: how it is culled\nN: next scene   1-3: layers   H: hides this   Esc: quit";
/// Keys of the layers.
const LAYER_KEYS: [KeyCode; 3] = [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3];

/// What a window shows first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum First {
    /// The path of the camera.
    Path,
    /// One frame of it, standing still.
    Still(usize),
    /// The scene from above, with the culling camera frozen below.
    Above,
}

/// The window of some scenes, the first one first.
pub fn start(scenes: Vec<SceneName>, options: &SceneOptions, method: Method, first: First) -> Start {
    let options = *options;
    Start::new("casca", move |screen| {
        let mut viewer = Viewer::new(screen, scenes, options, method)?;
        match first {
            First::Path => {}
            First::Still(frame) => {
                viewer.playback.ticks = frame;
                viewer.paused = true;
            }
            First::Above => viewer.look_from_above(screen.aspect()),
        }
        Ok(viewer)
    })
}

struct Viewer {
    scenes: Vec<SceneName>,
    options: SceneOptions,
    scene: usize,
    playback: Playback,
    renderer: Renderer,
    panel: Panel,
    overlays: Overlays,
    method: Method,
    fly: Option<Fly>,
    /// While it looks from above: the camera that is culled for, and what flew before.
    below: Option<(Camera, Option<Fly>)>,
    paused: bool,
    /// Where item buffers are drawn, while every frame is checked by one.
    check: Option<Canvas>,
    /// In a page: the check that is on its way, and the last one.
    checking: (Option<Begun>, Option<Check>),
    /// Time that the scene is behind.
    behind: f64,
    /// From frame to frame, in seconds, smoothed.
    between: f64,
    /// What the last frame had to say.
    said: (Vec<String>, Vec<Entry>),
}

impl Viewer {
    fn new(
        screen: &Screen,
        scenes: Vec<SceneName>,
        options: SceneOptions,
        method: Method,
    ) -> Result<Self, Box<dyn Error>> {
        let playback = Playback::new(scenes[0].open(&options)?)?;
        Ok(Self {
            renderer: Renderer::new(&screen.gpu, screen.format(), &playback.geometry),
            panel: Panel::new(&screen.gpu, screen.format()),
            scenes,
            options,
            scene: 0,
            playback,
            overlays: Overlays::default(),
            method,
            fly: None,
            below: None,
            paused: false,
            check: None,
            checking: (None, None),
            behind: 0.0,
            between: FRAME_SECONDS,
            said: (Vec::new(), Vec::new()),
        })
    }

    /// The length of the scene.
    fn reach(&self) -> f32 {
        let grid = &self.playback.world.grid;
        (grid.max - grid.min).length()
    }

    /// The camera that flies, from where the path's is if it did not yet.
    fn flying(&mut self, aspect: f32) -> &mut Fly {
        let camera = self.playback.path_camera(aspect);
        self.fly.get_or_insert_with(|| Fly::new(camera.eye, -camera.view.row(2).truncate()))
    }

    /// The camera that looks.
    fn camera(&self, aspect: f32) -> Camera {
        let reach = self.reach();
        match &self.fly {
            None => self.playback.path_camera(aspect),
            Some(fly) => {
                Camera::look_at(fly.eye, fly.eye + fly.forward(), FOV_Y, aspect, 1e-3 * reach, 4.0 * reach)
            }
        }
    }

    /// Freezes the culling camera and looks at it from above, or returns to the view before that.
    fn look_from_above(&mut self, aspect: f32) {
        if let Some((_, fly)) = self.below.take() {
            self.fly = fly;
        } else {
            let frozen = self.camera(aspect);
            let grid = &self.playback.world.grid;
            let above = above_frustum(&frozen, (grid.min.as_dvec3(), grid.max.as_dvec3()), aspect);
            self.below = Some((frozen, self.fly));
            self.fly = Some(Fly::new(above.eye, -above.view.row(2).truncate()));
        }
        // The frustum shows which camera is frozen.
        self.overlays.on[Layer::Frustum as usize] = self.below.is_some();
    }

    /// Turns to another scene.
    fn turn_to(&mut self, scene: usize, screen: &Screen) -> Done {
        self.playback = Playback::new(self.scenes[scene].open(&self.options)?)?;
        self.scene = scene;
        self.checking = (None, None);
        self.renderer = Renderer::new(&screen.gpu, screen.format(), &self.playback.geometry);
        (self.fly, self.below) = (None, None);
        self.overlays.on[Layer::Frustum as usize] = false;
        Ok(())
    }
}

impl Demo for Viewer {
    fn dials(&mut self, dials: &mut Dials, screen: &Screen) -> Done {
        let (mut scene, mut method) = (self.scene, self.method as usize);
        let names = self.scenes.iter().map(SceneName::to_string);
        if dials.choice("scene", &[KeyCode::KeyN], names, &mut scene) {
            return self.turn_to(scene, screen);
        }
        dials.choice("culled by", &[KeyCode::KeyM], METHODS.map(|(name, _)| name), &mut method);
        self.method = METHODS[method].1;
        if dials.switch("look from above (B)", Some(KeyCode::KeyB), &mut self.below.is_some()) {
            self.look_from_above(screen.aspect());
        }
        dials.switch("pause (Space)", Some(KeyCode::Space), &mut self.paused);
        let (compares, mut on) = ("compare every frame with an item buffer (C)", self.check.is_some());
        if dials.switch(compares, Some(KeyCode::KeyC), &mut on) {
            self.check = on.then(|| Canvas::new(&screen.gpu, screen.size()));
            self.checking = (None, None);
        }
        if dials.button("back to the path (P)", Some(KeyCode::KeyP)) {
            if self.below.is_some() {
                self.look_from_above(screen.aspect());
            }
            self.fly = None;
        }
        for ((name, layer), key) in LAYERS.into_iter().zip(LAYER_KEYS) {
            dials.switch(name, Some(key), &mut self.overlays.on[layer as usize]);
        }
        Ok(())
    }

    fn turn(&mut self, x: f32, y: f32, screen: &Screen) {
        self.flying(screen.aspect()).turn(x, y);
    }

    fn resize(&mut self, screen: &Screen) {
        self.check = self.check.is_some().then(|| Canvas::new(&screen.gpu, screen.size()));
    }

    fn step(&mut self, seconds: f64, screen: &Screen) {
        self.between = 0.9 * self.between + 0.1 * seconds;
        let way = screen.way(seconds) * (SPEED * self.reach());
        if way != Vec3::ZERO {
            self.flying(screen.aspect()).go(way);
        }
        self.behind = (self.behind + seconds).min(2.0 * FRAME_SECONDS);
        if self.behind >= FRAME_SECONDS {
            self.behind -= FRAME_SECONDS;
            if !self.paused {
                self.playback.ticks += 1;
            }
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let watcher = self.camera(screen.aspect());
        let culled_for = self.below.map_or(watcher, |below| below.0);
        let name = self.playback.world.name.clone();
        let (gpu, scale) = (&screen.gpu, screen.scale());
        // From above the colours have meanings: they must not fade.
        self.renderer.haze = if self.below.is_some() { 0.0 } else { haze(&self.playback) };
        let Self { renderer, panel, overlays, check, checking, method, between, said, .. } = self;
        let is_above = self.below.is_some();
        self.playback.frame(*method, &culled_for, &mut |frame| {
            let objects = (frame.geometry, frame.objects);
            let found = match check {
                Some(canvas) => {
                    let mut painter = Painter { gpu, canvas, renderer };
                    if IS_PAGE {
                        checked_later(&mut painter, &culled_for, objects, &frame.visible, checking)?
                    } else {
                        Some(painter.check(&culled_for, objects, &frame.visible)?)
                    }
                }
                None => None,
            };
            let start = Instant::now();
            let lost: &[usize] = found.as_ref().map_or(&[], |found| &found.lost);
            let (list, marks, legend) = drawn(&frame, overlays, (&watcher, is_above), lost)?;
            renderer.draw(gpu, Output::Picture, target, &watcher, &list, &marks);
            gpu.wait()?;
            let drawing = if IS_PAGE { Duration::from_secs_f64(*between) } else { start.elapsed() };
            let lines = panel::numbers((&name, *method), &frame, (&gpu.name, drawing), found.as_ref());
            *said = (lines, legend);
            let eye = is_above.then(|| place_in(&watcher, culled_for.eye));
            panel::draw(panel, (gpu, target, scale), eye, None);
            Ok(())
        })
    }

    fn report(&self, _: &Screen) -> Report {
        let (lines, legend) = self.said.clone();
        Report { lines, legend, keys: HELP, ..Report::default() }
    }
}

/// Looks at the check that is on its way, begins another where there is none, and returns the last
/// one that ended. For devices that must not be waited for.
fn checked_later(
    painter: &mut Painter<'_>,
    camera: &Camera,
    objects: (&Geometry, &[Object]),
    visible: &[usize],
    (begun, last): &mut (Option<Begun>, Option<Check>),
) -> Result<Option<Check>, GpuError> {
    match begun {
        None => *begun = Some(painter.begin_check(camera, objects, visible)?),
        Some(running) => {
            if let Some(ended) = running.end() {
                *begun = None;
                *last = Some(ended?);
            }
        }
    }
    Ok(last.clone())
}

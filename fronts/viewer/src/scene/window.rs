//! The window: a camera to fly with, and keys for everything else.

use std::error::Error;
use std::time::Duration;

use casca::internals::QueryInternals;
use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_scenes::world::{Camera, FRAME_SECONDS, Object};
use casca_stage::canvas::{Canvas, Target};
use casca_stage::dial::Dial;
use casca_stage::fly::Fly;
use casca_stage::gpu::{Gpu, GpuError, IS_PAGE};
use casca_stage::panel::Panel;
use casca_stage::report::{Entry, Report};
use casca_stage::timing::Instant;
use casca_stage::wgpu::TextureFormat;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::scene::birds_eye::{FOV_Y, above_frustum, from_above, place_in};
use crate::scene::draw::{Begun, Check, Painter, coloured};
use crate::scene::geometry::Geometry;
use crate::scene::headless::haze;
use crate::scene::legend;
use crate::scene::overlays::{Layer, Overlays};
use crate::scene::panel::{self, Numbers};
use crate::scene::playback::{Method, Playback};
use crate::scene::renderer::{Output, Renderer};

/// The share of a scene's length that the camera flies in a second.
const SPEED: f32 = 0.06;
/// Names of dials.
const SCENE: &str = "scene";
const METHOD: &str = "culled by";
const ABOVE: &str = "look from above (B)";
const FREEZE: &str = "freeze the culling camera (F)";
const PAUSE: &str = "pause (Space)";
const CHECK: &str = "compare every frame with an item buffer (C)";
const PATH: &str = "back to the path (P)";
const KEYS: &str = "W A S D Q E fly (Shift: faster), a mouse button: look   M: how it is culled\nN: next scene   1-5: layers   H: hides this   Esc: quit";
/// Keys of the layers.
const LAYER_KEYS: [KeyCode; 5] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5];

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

/// The window.
pub fn start(scenes: Vec<SceneName>, options: &SceneOptions, method: Method, first: First) -> Start {
    let options = *options;
    Start::new("casca", move |screen| {
        let mut viewer = Viewer::new(screen, scenes, options, method)?;
        match first {
            First::Path => {}
            First::Still(frame) => {
                viewer.playback.go_to(frame);
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
    frozen: Option<Camera>,
    /// While it looks from above: how it looked before.
    before: Option<Before>,
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

/// The camera that looks, and whether it is culled for.
struct Before {
    fly: Option<Fly>,
    frozen: Option<Camera>,
}

impl Viewer {
    fn new(
        screen: &Screen,
        scenes: Vec<SceneName>,
        options: SceneOptions,
        method: Method,
    ) -> Result<Self, Box<dyn Error>> {
        let playback =
            playback_of(scenes.first().unwrap_or(&SceneName::Built(SceneKind::Spheres)), &options)?;
        Ok(Self {
            renderer: renderer_of(&screen.gpu, screen.format(), &playback),
            panel: Panel::new(&screen.gpu, screen.format()),
            scenes,
            options,
            scene: 0,
            playback,
            overlays: Overlays::default(),
            method,
            fly: None,
            frozen: None,
            before: None,
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

    /// Freezes the culling camera where this one is, or frees it.
    fn freeze(&mut self, camera: Option<Camera>) {
        self.frozen = camera;
        // The frustum shows which camera is frozen.
        if self.frozen.is_some() != self.overlays.is_on(Layer::Frustum) {
            self.overlays.toggle(Layer::Frustum);
        }
    }

    /// Freezes the culling camera and looks at it from above, or returns to the view before that.
    fn look_from_above(&mut self, aspect: f32) {
        if let Some(Before { fly, frozen }) = self.before.take() {
            self.fly = fly;
            self.freeze(frozen);
            return;
        }
        let frozen = self.frozen.unwrap_or_else(|| self.camera(aspect));
        let grid = &self.playback.world.grid;
        let above = above_frustum(&frozen, (grid.min.as_dvec3(), grid.max.as_dvec3()), aspect);
        self.before = Some(Before { fly: self.fly, frozen: self.frozen });
        self.fly = Some(Fly::new(above.eye, -above.view.row(2).truncate()));
        self.freeze(Some(frozen));
    }

    /// Turns to another scene.
    fn turn_to(&mut self, scene: usize, screen: &Screen) -> Done {
        let Some(name) = self.scenes.get(scene) else { return Ok(()) };
        self.playback = playback_of(name, &self.options)?;
        self.scene = scene;
        self.checking = (None, None);
        self.renderer = renderer_of(&screen.gpu, screen.format(), &self.playback);
        (self.fly, self.before) = (None, None);
        self.freeze(None);
        Ok(())
    }
}

impl Demo for Viewer {
    fn press(&mut self, key: KeyCode, screen: &Screen) -> Done {
        match key {
            KeyCode::KeyF => {
                let free = self.frozen.is_none().then(|| self.camera(screen.aspect()));
                if let Some(Before { fly, .. }) = self.before.take() {
                    self.fly = fly;
                }
                self.freeze(free);
            }
            KeyCode::KeyB => self.look_from_above(screen.aspect()),
            KeyCode::KeyM => self.method = self.method.next(),
            KeyCode::KeyC => {
                self.check = self.check.is_none().then(|| Canvas::new(&screen.gpu, screen.size()));
                self.checking = (None, None);
            }
            KeyCode::KeyP => {
                // The camera that was frozen to be looked at from above goes on.
                if let Some(Before { frozen, .. }) = self.before.take() {
                    self.freeze(frozen);
                }
                self.fly = None;
            }
            KeyCode::Space => self.paused ^= true,
            KeyCode::KeyN => return self.turn_to((self.scene + 1) % self.scenes.len().max(1), screen),
            _ => {
                if let Some(layer) = LAYER_KEYS.iter().position(|k| *k == key) {
                    self.overlays.toggle(Layer::EVERY[layer]);
                }
            }
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
        let way = screen.way() * (SPEED * self.reach() * seconds.min(0.1) as f32);
        if way != Vec3::ZERO {
            self.flying(screen.aspect()).go(way);
        }
        self.behind = (self.behind + seconds).min(2.0 * FRAME_SECONDS);
        if self.behind >= FRAME_SECONDS {
            self.behind -= FRAME_SECONDS;
            if !self.paused {
                self.playback.advance();
            }
        }
    }

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let watcher = self.camera(screen.aspect());
        let culled_for = self.frozen.unwrap_or(watcher);
        let name = self.playback.world.name.clone();
        let (gpu, scale) = (&screen.gpu, screen.scale());
        // From above the colours have meanings: they must not fade.
        self.renderer.haze = if self.before.is_some() { 0.0 } else { haze(&self.playback) };
        let Self { renderer, panel, overlays, check, checking, method, between, said, .. } = self;
        let is_above = self.before.is_some();
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
            let marks = overlays.marks(&frame, lost)?;
            let (list, mut legend) = if is_above {
                let above = from_above(&frame, overlays, (&watcher, lost))?;
                (above.list, above.legend)
            } else {
                (coloured(frame.geometry, frame.objects, &frame.visible), Vec::new())
            };
            legend::join(&mut legend, legend::of_marks(&marks, &watcher));
            renderer.draw(gpu, Output::Picture, target, &watcher, &list, &marks);
            gpu.wait()?;
            let numbers = Numbers {
                scene: &name,
                device: &gpu.name,
                method: *method,
                visible: (frame.visible.len(), frame.objects.len()),
                times: (
                    frame.time,
                    if IS_PAGE { Duration::from_secs_f64(*between) } else { start.elapsed() },
                ),
                check: found.as_ref().map(|found| (found.shown.len(), found.lost.len())),
            };
            *said = (numbers.lines(), legend);
            let eye = is_above.then(|| place_in(&watcher, culled_for.eye));
            let images =
                if overlays.is_on(Layer::Buffers) { frame.query.occlusion_images() } else { Vec::new() };
            panel::draw(panel, (gpu, target, scale), &images, eye, None);
            Ok(())
        })
    }

    fn report(&self, _: &Screen) -> Report {
        let scenes = self.scenes.iter().map(SceneName::to_string);
        let mut dials = vec![
            Dial::choice(SCENE, scenes, self.scene),
            Dial::choice(METHOD, Method::EVERY.map(|method| method.to_string()), self.method as usize),
            Dial::switch(ABOVE, self.before.is_some()),
            Dial::switch(FREEZE, self.frozen.is_some()),
            Dial::switch(PAUSE, self.paused),
            Dial::switch(CHECK, self.check.is_some()),
            Dial::button(PATH),
        ];
        dials.extend(Layer::EVERY.map(|layer| Dial::switch(layer.name(), self.overlays.is_on(layer))));
        let (lines, legend) = self.said.clone();
        Report { lines, legend, dials, keys: KEYS }
    }

    fn set(&mut self, dial: &str, value: f64, _: bool, screen: &Screen) -> Done {
        let (on, place) = (value != 0.0, value as usize);
        match dial {
            SCENE => return self.turn_to(place, screen),
            METHOD => self.method = Method::EVERY.get(place).copied().unwrap_or(self.method),
            ABOVE if on != self.before.is_some() => return self.press(KeyCode::KeyB, screen),
            FREEZE if on != self.frozen.is_some() => return self.press(KeyCode::KeyF, screen),
            CHECK if on != self.check.is_some() => return self.press(KeyCode::KeyC, screen),
            PAUSE => self.paused = on,
            PATH => return self.press(KeyCode::KeyP, screen),
            name => {
                let layer = Layer::EVERY.into_iter().find(|layer| layer.name() == name);
                if let Some(layer) = layer.filter(|layer| on != self.overlays.is_on(*layer)) {
                    self.overlays.toggle(layer);
                }
            }
        }
        Ok(())
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

fn playback_of(scene: &SceneName, options: &SceneOptions) -> Result<Playback, Box<dyn Error>> {
    Playback::new(scene.open(options)?)
}

fn renderer_of(gpu: &Gpu, format: TextureFormat, playback: &Playback) -> Renderer {
    let mut renderer = Renderer::new(gpu, format, &playback.geometry);
    renderer.haze = haze(playback);
    renderer
}

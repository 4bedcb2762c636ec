//! The window: a camera to fly with, and keys for everything else.

use std::error::Error;
use std::time::Instant;

use casca::internals::QueryInternals;
use casca_scenes::generated::{SceneKind, SceneOptions};
use casca_scenes::name::SceneName;
use casca_scenes::world::{Camera, FRAME_SECONDS};
use casca_stage::canvas::{Canvas, Target};
use casca_stage::fly::{Fly, way};
use casca_stage::gpu::Gpu;
use casca_stage::panel::Panel;
use casca_stage::wgpu::TextureFormat;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;
use glam::Vec3;

use crate::scene::birds_eye::{FOV_Y, above_frustum, from_above, place_in};
use crate::scene::draw::{Painter, coloured};
use crate::scene::headless::haze;
use crate::scene::legend;
use crate::scene::overlays::{Layer, Overlays};
use crate::scene::panel::{self, Numbers};
use crate::scene::playback::{Method, Playback};
use crate::scene::renderer::{Output, Renderer};

/// The share of a scene's length that the camera flies in a second.
const SPEED: f32 = 0.06;
/// Keys of the layers.
const LAYER_KEYS: [KeyCode; 6] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5, KeyCode::Digit6];

/// The window. With `from_above` it starts above the first scene, with the culling camera frozen
/// below.
pub fn start(scenes: Vec<SceneName>, options: &SceneOptions, method: Method, from_above: bool) -> Start {
    let options = *options;
    Start::new("casca", move |screen| {
        let mut viewer = Viewer::new(screen, scenes, options, method)?;
        if from_above {
            viewer.look_from_above(screen.aspect());
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
    help: bool,
    /// Where item buffers are drawn, while every frame is checked by one.
    check: Option<Canvas>,
    /// Time that the scene is behind.
    behind: f64,
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
            help: true,
            check: None,
            behind: 0.0,
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

    /// Turns to the next scene.
    fn next_scene(&mut self, screen: &Screen) -> Done {
        self.scene = (self.scene + 1) % self.scenes.len().max(1);
        let Some(scene) = self.scenes.get(self.scene) else { return Ok(()) };
        self.playback = playback_of(scene, &self.options)?;
        self.renderer = renderer_of(&screen.gpu, screen.format(), &self.playback);
        (self.fly, self.before) = (None, None);
        self.freeze(None);
        self.overlays.forget_scene();
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
            }
            KeyCode::KeyH => self.help ^= true,
            KeyCode::KeyP => {
                // The camera that was frozen to be looked at from above goes on.
                if let Some(Before { frozen, .. }) = self.before.take() {
                    self.freeze(frozen);
                }
                self.fly = None;
            }
            KeyCode::Space => self.paused ^= true,
            KeyCode::KeyN => return self.next_scene(screen),
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
        let way = way(&screen.keys) * (SPEED * self.reach() * seconds.min(0.1) as f32);
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
        let Self { renderer, panel, overlays, check, method, .. } = self;
        let (frozen, help, is_above) = (self.frozen.is_some(), self.help, self.before.is_some());
        self.playback.frame(*method, &culled_for, &mut |frame| {
            let objects = (frame.geometry, frame.objects);
            let found = match check {
                Some(canvas) => {
                    Some(Painter { gpu, canvas, renderer }.check(&culled_for, objects, &frame.visible)?)
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
                scene: name.clone(),
                device: gpu.name.clone(),
                method: *method,
                frozen,
                visible: (frame.visible.len(), frame.objects.len()),
                times: (frame.time, start.elapsed()),
                check: found.as_ref().map(|found| (found.shown.len(), found.lost.len())),
                legend,
                help,
                eye: is_above.then(|| place_in(&watcher, culled_for.eye)),
            };
            let images =
                if overlays.is_on(Layer::Buffers) { frame.query.occlusion_images() } else { Vec::new() };
            panel::draw(panel, (gpu, target, scale), &numbers, overlays, &images);
            Ok(())
        })
    }
}

fn playback_of(scene: &SceneName, options: &SceneOptions) -> Result<Playback, Box<dyn Error>> {
    Playback::new(scene.open(options)?)
}

fn renderer_of(gpu: &Gpu, format: TextureFormat, playback: &Playback) -> Renderer {
    let mut renderer = Renderer::new(gpu, format, &playback.geometry);
    renderer.haze = haze(playback);
    renderer
}

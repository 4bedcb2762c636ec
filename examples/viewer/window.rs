//! The window: a camera to fly with, and keys for everything else.

use std::collections::HashSet;
use std::error::Error;
use std::sync::Arc;
use std::time::{Duration, Instant};

use casca_lab::command_line::SceneName;
use casca_lab::scenes::{SceneKind, SceneOptions};
use casca_lab::world::{Camera, FRAME_SECONDS};
use glam::Vec3;
use wgpu::CurrentSurfaceTexture;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

use super::canvas::{Canvas, coloured};
use super::gpu::{DEPTH, Gpu};
use super::headless::haze;
use super::overlays::{Layer, Overlays};
use super::panel::{Numbers, Panel};
use super::renderer::{Output, Renderer};
use super::stage::{Method, Stage};

/// Radians for each pixel that the mouse moves.
const TURN: f32 = 0.004;
/// Keys of the layers.
const LAYER_KEYS: [KeyCode; 6] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5, KeyCode::Digit6];

/// Opens the window and stays until it is closed.
///
/// # Errors
/// There is no display or no adapter, or a scene cannot be had.
pub fn open(
    scenes: Vec<SceneName>,
    options: &SceneOptions,
    method: Method,
    (size, software): ((u32, u32), bool),
) -> Result<(), Box<dyn Error>> {
    let event_loop =
        EventLoop::new().map_err(|e| format!("no window can be opened (try --headless): {e}"))?;
    let mut app = App { scenes, options: *options, method, size, software, viewer: None, failed: None };
    event_loop.run_app(&mut app)?;
    app.failed.map_or(Ok(()), Err)
}

struct App {
    scenes: Vec<SceneName>,
    options: SceneOptions,
    method: Method,
    size: (u32, u32),
    software: bool,
    viewer: Option<Viewer>,
    failed: Option<Box<dyn Error>>,
}

/// A camera that flies.
struct Fly {
    eye: Vec3,
    yaw: f32,
    pitch: f32,
}

impl Fly {
    fn from(camera: &Camera) -> Self {
        let forward = -camera.view.row(2).truncate();
        Self { eye: camera.eye, yaw: forward.x.atan2(-forward.z), pitch: forward.y.clamp(-1.0, 1.0).asin() }
    }

    fn forward(&self) -> Vec3 {
        let ((sin_yaw, cos_yaw), (sin, cos)) = (self.yaw.sin_cos(), self.pitch.sin_cos());
        Vec3::new(sin_yaw * cos, sin, -cos_yaw * cos)
    }
}

struct Viewer {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    depth: wgpu::Texture,
    gpu: Gpu,
    panel: Panel,
    scene: usize,
    stage: Stage,
    renderer: Renderer,
    overlays: Overlays,
    method: Method,
    keys: HashSet<KeyCode>,
    looking: bool,
    fly: Option<Fly>,
    frozen: Option<Camera>,
    paused: bool,
    help: bool,
    /// Where item buffers are drawn, while every frame is checked by one.
    check: Option<Canvas>,
    last: Instant,
    /// Time that the scene is behind.
    behind: f64,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.viewer.is_none() {
            match Viewer::new(self, event_loop) {
                Ok(viewer) => self.viewer = Some(viewer),
                Err(error) => {
                    self.failed = Some(error);
                    event_loop.exit();
                }
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(viewer) = &mut self.viewer else { return };
        let result = match event {
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::Resized(size) => {
                viewer.resize(size);
                Ok(())
            }
            WindowEvent::Focused(false) => {
                viewer.keys.clear();
                Ok(())
            }
            WindowEvent::MouseInput { state, button: MouseButton::Right, .. } => {
                viewer.looking = state == ElementState::Pressed;
                Ok(())
            }
            WindowEvent::KeyboardInput { event, .. } => match event.physical_key {
                PhysicalKey::Code(KeyCode::Escape) => {
                    event_loop.exit();
                    Ok(())
                }
                PhysicalKey::Code(key) if event.state == ElementState::Released => {
                    viewer.keys.remove(&key);
                    Ok(())
                }
                PhysicalKey::Code(key) if viewer.keys.insert(key) => {
                    viewer.press(key, &self.scenes, &self.options)
                }
                _ => Ok(()),
            },
            WindowEvent::RedrawRequested => viewer.redraw(),
            _ => Ok(()),
        };
        if let Err(error) = result {
            self.failed = Some(error);
            event_loop.exit();
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (Some(viewer), DeviceEvent::MouseMotion { delta: (x, y) }) = (&mut self.viewer, event)
            && viewer.looking
        {
            let fly = viewer.flying();
            fly.yaw += x as f32 * TURN;
            fly.pitch = (fly.pitch - y as f32 * TURN).clamp(-1.5, 1.5);
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some(viewer) = &self.viewer {
            viewer.window.request_redraw();
        }
    }
}

impl Viewer {
    fn new(app: &App, event_loop: &ActiveEventLoop) -> Result<Self, Box<dyn Error>> {
        let size = PhysicalSize::new(app.size.0, app.size.1);
        let attributes = Window::default_attributes().with_title("casca").with_inner_size(size);
        let window = Arc::new(event_loop.create_window(attributes)?);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let surface = instance.create_surface(window.clone())?;
        let gpu = Gpu::on(&instance, Some(&surface), app.software)?;
        let (width, height) = gpu.clamp(window.inner_size().into());
        let mut config = surface
            .get_default_config(&gpu.adapter, width, height)
            .ok_or("the adapter cannot draw to this window")?;
        // Colours are written as they are, without another encoding.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        config.format = formats.into_iter().find(|f| !f.is_srgb()).unwrap_or(config.format);
        surface.configure(&gpu.device, &config);
        let stage =
            stage_of(app.scenes.first().unwrap_or(&SceneName::Built(SceneKind::Spheres)), &app.options)?;
        Ok(Self {
            depth: gpu.texture((width, height), DEPTH),
            panel: Panel::new(&gpu, config.format),
            renderer: renderer_of(&gpu, config.format, &stage),
            window,
            surface,
            config,
            gpu,
            scene: 0,
            stage,
            overlays: Overlays::default(),
            method: app.method,
            keys: HashSet::new(),
            looking: false,
            fly: None,
            frozen: None,
            paused: false,
            help: true,
            check: None,
            last: Instant::now(),
            behind: 0.0,
        })
    }

    fn aspect(&self) -> f32 {
        self.config.width as f32 / self.config.height as f32
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        (self.config.width, self.config.height) = self.gpu.clamp(size.into());
        self.surface.configure(&self.gpu.device, &self.config);
        self.depth = self.gpu.texture((self.config.width, self.config.height), DEPTH);
        self.check = self.check.is_some().then(|| self.canvas());
    }

    fn canvas(&self) -> Canvas {
        Canvas::new(&self.gpu, (self.config.width, self.config.height))
    }

    /// The camera that flies, from where the path's is if it did not yet.
    fn flying(&mut self) -> &mut Fly {
        let camera = self.stage.path_camera(self.aspect());
        self.fly.get_or_insert_with(|| Fly::from(&camera))
    }

    fn press(
        &mut self,
        key: KeyCode,
        scenes: &[SceneName],
        options: &SceneOptions,
    ) -> Result<(), Box<dyn Error>> {
        match key {
            KeyCode::KeyF => {
                let camera = self.camera();
                self.frozen = self.frozen.is_none().then_some(camera);
                // The frustum tells what is frozen.
                if self.frozen.is_some() != self.overlays.is_on(Layer::Frustum) {
                    self.overlays.toggle(Layer::Frustum);
                }
            }
            KeyCode::KeyM => self.method = self.method.next(),
            KeyCode::KeyC => self.check = self.check.is_none().then(|| self.canvas()),
            KeyCode::KeyH => self.help ^= true,
            KeyCode::KeyP => self.fly = None,
            KeyCode::Space => self.paused ^= true,
            KeyCode::KeyN if !scenes.is_empty() => {
                self.scene = (self.scene + 1) % scenes.len();
                self.stage = stage_of(&scenes[self.scene], options)?;
                self.renderer = renderer_of(&self.gpu, self.config.format, &self.stage);
                (self.fly, self.frozen) = (None, None);
                self.overlays.forget_scene();
            }
            _ => {
                if let Some(layer) = LAYER_KEYS.iter().position(|k| *k == key) {
                    self.overlays.toggle(Layer::EVERY[layer]);
                }
            }
        }
        Ok(())
    }

    /// The camera that looks.
    fn camera(&self) -> Camera {
        let (aspect, grid) = (self.aspect(), &self.stage.world.grid);
        let reach = (grid.max - grid.min).length();
        match &self.fly {
            None => self.stage.path_camera(aspect),
            Some(fly) => {
                Camera::look_at(fly.eye, fly.eye + fly.forward(), 60.0, aspect, 1e-3 * reach, 4.0 * reach)
            }
        }
    }

    /// Moves the camera by the keys that are held.
    fn steer(&mut self, seconds: f32) {
        let held = |keys: &HashSet<KeyCode>, key| if keys.contains(&key) { 1.0 } else { 0.0 };
        let axis = |plus, minus| held(&self.keys, plus) - held(&self.keys, minus);
        let way = Vec3::new(
            axis(KeyCode::KeyD, KeyCode::KeyA),
            axis(KeyCode::KeyE, KeyCode::KeyQ),
            axis(KeyCode::KeyW, KeyCode::KeyS),
        );
        if way == Vec3::ZERO {
            return;
        }
        let grid = &self.stage.world.grid;
        let slow = if self.keys.contains(&KeyCode::ShiftLeft) { 0.3 } else { 0.06 };
        let speed = (grid.max - grid.min).length() * slow * seconds;
        let fly = self.flying();
        let forward = fly.forward();
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        fly.eye += (right * way.x + Vec3::Y * way.y + forward * way.z) * speed;
    }

    fn redraw(&mut self) -> Result<(), Box<dyn Error>> {
        let seconds = std::mem::replace(&mut self.last, Instant::now()).elapsed().as_secs_f64();
        self.steer(seconds.min(0.1) as f32);
        self.behind = (self.behind + seconds).min(2.0 * FRAME_SECONDS);
        if self.behind >= FRAME_SECONDS {
            self.behind -= FRAME_SECONDS;
            if !self.paused {
                self.stage.advance();
            }
        }
        let surface = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) | CurrentSurfaceTexture::Suboptimal(texture) => texture,
            CurrentSurfaceTexture::Outdated | CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                return Ok(());
            }
            _ => return Ok(()),
        };
        let watcher = self.camera();
        let culled_for = self.frozen.unwrap_or(watcher);
        let name = self.stage.world.name.clone();
        let scale = self.window.scale_factor() as f32;
        let Self { gpu, renderer, panel, overlays, check, method, .. } = self;
        let (frozen, help) = (self.frozen.is_some(), self.help);
        let target = surface.texture.create_view(&Default::default());
        let depth = self.depth.create_view(&Default::default());
        self.stage.frame(*method, &culled_for, &mut |frame| {
            let objects = (frame.geometry, frame.objects);
            let found = match check {
                Some(canvas) => Some(canvas.check(gpu, renderer, &culled_for, objects, &frame.visible)?),
                None => None,
            };
            let start = Instant::now();
            let list = coloured(frame.geometry, frame.objects, &frame.visible);
            let lost: &[usize] = found.as_ref().map_or(&[], |found| &found.lost);
            let marks = overlays.marks(&frame, lost)?;
            renderer.draw(gpu, Output::Picture, (&target, &depth), &watcher, &list, &marks);
            gpu.wait()?;
            let numbers = Numbers {
                scene: name.clone(),
                device: gpu.name.clone(),
                method: *method,
                frozen,
                visible: (frame.visible.len(), frame.objects.len()),
                times: (frame.time, start.elapsed()),
                check: found.as_ref().map(|found| (found.shown.len(), found.lost.len())),
                help,
            };
            let images =
                if overlays.is_on(Layer::Buffers) { frame.query.occlusion_images() } else { Vec::new() };
            panel.draw(gpu, &target, scale, &numbers, overlays, &images);
            Ok(())
        })?;
        self.window.pre_present_notify();
        self.gpu.queue.present(surface);
        // Nothing waits for the screen where it is not drawn to.
        if self.window.is_minimized() == Some(true) {
            std::thread::sleep(Duration::from_millis(50));
        }
        Ok(())
    }
}

fn stage_of(scene: &SceneName, options: &SceneOptions) -> Result<Stage, Box<dyn Error>> {
    Stage::new(scene.open(options)?)
}

fn renderer_of(gpu: &Gpu, format: wgpu::TextureFormat, stage: &Stage) -> Renderer {
    let mut renderer = Renderer::new(gpu, format, &stage.geometry);
    renderer.haze = haze(stage);
    renderer
}

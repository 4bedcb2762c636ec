//! A window and its loop.

use std::cell::RefCell;
use std::collections::HashSet;
use std::error::Error;
use std::sync::Arc;
use std::time::{Duration, Instant};

use wgpu::CurrentSurfaceTexture;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

use crate::canvas::Target;
use crate::gpu::{DEPTH, Gpu};
use crate::panel::Panel;

/// What is said where there is no window to be had.
const NO_WINDOW: &str = "no window can be opened (no display?): try --headless";
/// What is said where the adapter has no way to the window.
const NO_SURFACE: &str = "the graphics adapter cannot draw to a window: try --headless";
/// Frames that show words before a program starts: the first may be lost before the window is on the screen.
const WORDS: u32 = 2;

/// Nothing, or why the program ends.
pub type Done = Result<(), Box<dyn Error>>;

/// A program that draws to a window.
pub trait Demo {
    /// A key goes down. Escape is not reported: it closes the window. Nor are keys that a panel takes.
    ///
    /// # Errors
    /// The program ends.
    fn press(&mut self, key: KeyCode, screen: &Screen) -> Done;

    /// The mouse moves with its right button down, by pixels to the right and down.
    fn turn(&mut self, x: f32, y: f32, screen: &Screen);

    /// The window has another size.
    fn resize(&mut self, screen: &Screen);

    /// Time passes, in seconds since the last call.
    fn step(&mut self, seconds: f64, screen: &Screen);

    /// Draws a frame.
    ///
    /// # Errors
    /// The program ends.
    fn draw(&mut self, screen: &Screen, target: &Target) -> Done;

    /// Another program to go on with in this window; asked for after each frame.
    fn next(&mut self) -> Option<Start> {
        None
    }
}

/// A program that is to be started in a window.
pub struct Start {
    /// The title of the window.
    pub title: String,
    /// Starts it. Meanwhile the window shows the words "compiling shaders".
    pub make: Make,
}

/// Starts a program.
pub type Make = Box<dyn FnOnce(&Screen) -> Result<Box<dyn Demo>, Box<dyn Error>>>;

impl Start {
    /// A program that is started by `make`.
    pub fn new<D: Demo + 'static>(
        title: impl Into<String>,
        make: impl FnOnce(&Screen) -> Result<D, Box<dyn Error>> + 'static,
    ) -> Self {
        let make = |screen: &Screen| make(screen).map(|demo| Box::new(demo) as Box<dyn Demo>);
        Self { title: title.into(), make: Box::new(make) }
    }
}

/// The window as a program sees it.
pub struct Screen {
    /// The device.
    pub gpu: Gpu,
    /// The keys that are held.
    pub keys: HashSet<KeyCode>,
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    depth: wgpu::Texture,
    looking: bool,
    last: Instant,
    /// Frames still to be drawn, if they are counted.
    left: Option<u32>,
    panels: egui::Context,
    events: RefCell<egui_winit::State>,
}

impl Screen {
    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.config.width as f32 / self.config.height as f32
    }

    /// The format of its pixels.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Pixels for each point of text.
    pub fn scale(&self) -> f32 {
        self.window.scale_factor() as f32
    }

    /// Gives the window another title.
    pub fn set_title(&self, title: &str) {
        self.window.set_title(title);
    }

    /// The context of the panels in this window.
    pub(crate) fn panels(&self) -> &egui::Context {
        &self.panels
    }

    /// Mouse and keys since the last call, for panels.
    pub(crate) fn input(&self) -> egui::RawInput {
        self.events.borrow_mut().take_egui_input(&self.window)
    }

    /// The cursor that panels ask for, and their text for the clipboard.
    pub(crate) fn answer(&self, wishes: egui::PlatformOutput) {
        self.events.borrow_mut().handle_platform_output(&self.window, wishes);
    }

    fn new(options: &WindowOptions, event_loop: &ActiveEventLoop) -> Result<Self, Box<dyn Error>> {
        let size = PhysicalSize::new(options.size.0, options.size.1);
        let attributes = Window::default_attributes().with_inner_size(size);
        let window = Arc::new(event_loop.create_window(attributes).map_err(|_| NO_WINDOW)?);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let surface = instance.create_surface(window.clone()).map_err(|_| NO_SURFACE)?;
        let gpu = Gpu::on(&instance, Some(&surface), options.software)?;
        let (width, height) = gpu.clamp(window.inner_size().into());
        let mut config = surface.get_default_config(&gpu.adapter, width, height).ok_or(NO_SURFACE)?;
        // Colours are written as they are, without another encoding.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        config.format = formats.into_iter().find(|f| !f.is_srgb()).unwrap_or(config.format);
        surface.configure(&gpu.device, &config);
        let depth = gpu.texture((width, height), DEPTH);
        let (keys, last) = (HashSet::new(), Instant::now());
        let (panels, events) = panels_of(&window, &gpu);
        let (looking, left) = (false, options.frames);
        Ok(Self { gpu, keys, window, surface, config, depth, looking, last, left, panels, events })
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        (self.config.width, self.config.height) = self.gpu.clamp(size.into());
        self.surface.configure(&self.gpu.device, &self.config);
        self.depth = self.gpu.texture(self.size(), DEPTH);
    }

    /// Makes way for the panels of another program: those of the last one are drawn with its own textures.
    fn forget_panels(&mut self) {
        (self.panels, self.events) = panels_of(&self.window, &self.gpu);
    }

    /// Has `demo` draw a frame, and shows it.
    fn redraw(&mut self, demo: &mut dyn Demo) -> Done {
        let seconds = std::mem::replace(&mut self.last, Instant::now()).elapsed().as_secs_f64();
        demo.step(seconds, self);
        self.show(&mut |screen, target| demo.draw(screen, target))?;
        self.left = self.left.map(|left| left.saturating_sub(1));
        Ok(())
    }

    /// Shows a frame.
    fn show(&mut self, draw: &mut dyn FnMut(&Self, &Target) -> Done) -> Done {
        let texture = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(texture) | CurrentSurfaceTexture::Suboptimal(texture) => texture,
            CurrentSurfaceTexture::Outdated | CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                return Ok(());
            }
            _ => return Ok(()),
        };
        draw(self, &Target::new(&texture.texture, &self.depth))?;
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        // Where no panel asks for them, events would pile up.
        drop(self.input());
        // Nothing waits for the screen where it is not drawn to.
        if self.window.is_minimized() == Some(true) {
            std::thread::sleep(Duration::from_millis(50));
        }
        Ok(())
    }
}

/// The context of panels in a window, and what gives it mouse and keys.
fn panels_of(window: &Window, gpu: &Gpu) -> (egui::Context, RefCell<egui_winit::State>) {
    let panels = egui::Context::default();
    let side = gpu.device.limits().max_texture_dimension_2d as usize;
    let (id, scale) = (egui::ViewportId::ROOT, window.scale_factor() as f32);
    let events = egui_winit::State::new(panels.clone(), id, window, Some(scale), None, Some(side));
    (panels, events.into())
}

/// The window to open.
#[derive(Debug, Clone, Copy)]
pub struct WindowOptions {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Whether a software adapter draws.
    pub software: bool,
    /// The window closes by itself after so many frames, for tests.
    pub frames: Option<u32>,
}

/// Opens a window, starts a program in it and stays until it is closed.
///
/// # Errors
/// There is no display or no adapter, and those of the program.
pub fn open(options: &WindowOptions, start: Start) -> Done {
    let event_loop = EventLoop::new().map_err(|_| NO_WINDOW)?;
    let mut program = Program { options, start: Some(start), running: None, failed: None };
    event_loop.run_app(&mut program).map_err(|_| "the window system has ended the program")?;
    program.failed.map_or(Ok(()), Err)
}

struct Program<'a> {
    options: &'a WindowOptions,
    start: Option<Start>,
    running: Option<(Screen, Shown)>,
    failed: Option<Box<dyn Error>>,
}

/// What a window shows.
enum Shown {
    /// Words, for so many frames; then a program is started.
    Words(Start, Box<Panel>, u32),
    /// A program. For a moment there is none.
    Demo(Option<Box<dyn Demo>>),
}

impl Shown {
    fn words(screen: &Screen, start: Start) -> Self {
        screen.set_title(&start.title);
        Self::Words(start, Box::new(Panel::new(&screen.gpu, screen.format())), WORDS)
    }

    fn demo(&mut self) -> Option<&mut dyn Demo> {
        match self {
            Self::Demo(Some(demo)) => Some(&mut **demo),
            _ => None,
        }
    }

    /// Draws a frame, and goes on to what comes next.
    fn redraw(&mut self, screen: &mut Screen) -> Done {
        match self {
            Self::Words(_, panel, left) if *left > 0 => {
                *left -= 1;
                screen.show(&mut |screen, target| {
                    panel.say(&screen.gpu, target, screen.scale(), "compiling shaders");
                    Ok(())
                })
            }
            Self::Words(..) => {
                if let Self::Words(start, ..) = std::mem::replace(self, Self::Demo(None)) {
                    *self = Self::Demo(Some((start.make)(screen)?));
                }
                screen.last = Instant::now();
                Ok(())
            }
            Self::Demo(None) => Ok(()),
            Self::Demo(Some(demo)) => {
                screen.redraw(&mut **demo)?;
                if let Some(start) = demo.next() {
                    screen.forget_panels();
                    *self = Self::words(screen, start);
                }
                Ok(())
            }
        }
    }
}

impl Program<'_> {
    fn end_if_failed(&mut self, event_loop: &ActiveEventLoop, result: Done) {
        if let Err(error) = result {
            self.failed = Some(error);
            event_loop.exit();
        }
    }
}

impl ApplicationHandler for Program<'_> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        // It is called again when a suspended program goes on.
        let Some(start) = self.start.take() else { return };
        let started = Screen::new(self.options, event_loop).map(|screen| {
            let shown = Shown::words(&screen, start);
            self.running = Some((screen, shown));
        });
        self.end_if_failed(event_loop, started);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some((screen, shown)) = &mut self.running else { return };
        let taken = screen.events.borrow_mut().on_window_event(&screen.window, &event).consumed;
        let result = match event {
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::Resized(size) => {
                screen.resize(size);
                if let Some(demo) = shown.demo() {
                    demo.resize(screen);
                }
                Ok(())
            }
            WindowEvent::Focused(false) => {
                screen.keys.clear();
                Ok(())
            }
            WindowEvent::MouseInput { state, button: MouseButton::Right, .. } => {
                screen.looking = state == ElementState::Pressed && !taken;
                Ok(())
            }
            WindowEvent::KeyboardInput { event, .. } => match (event.physical_key, shown.demo()) {
                (PhysicalKey::Code(KeyCode::Escape), _) => {
                    event_loop.exit();
                    Ok(())
                }
                (PhysicalKey::Code(key), _) if event.state == ElementState::Released => {
                    screen.keys.remove(&key);
                    Ok(())
                }
                (PhysicalKey::Code(key), Some(demo)) if !taken && screen.keys.insert(key) => {
                    demo.press(key, screen)
                }
                _ => Ok(()),
            },
            WindowEvent::RedrawRequested => {
                let drawn = shown.redraw(screen);
                if screen.left == Some(0) {
                    event_loop.exit();
                }
                drawn
            }
            _ => Ok(()),
        };
        self.end_if_failed(event_loop, result);
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        let Some((screen, shown)) = &mut self.running else { return };
        if let (Some(demo), DeviceEvent::MouseMotion { delta: (x, y) }) = (shown.demo(), event)
            && screen.looking
        {
            demo.turn(x as f32, y as f32, screen);
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        if let Some((screen, _)) = &self.running {
            screen.window.request_redraw();
        }
    }
}

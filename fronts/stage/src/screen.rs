//! The window as a program sees it.

use std::cell::RefCell;
use std::collections::HashSet;
use std::error::Error;
use std::sync::Arc;

use glam::Vec3;
use wgpu::CurrentSurfaceTexture;
use winit::dpi::PhysicalSize;
use winit::keyboard::KeyCode;
use winit::window::{Window, WindowAttributes};

use crate::canvas::Target;
use crate::fly::{Fingers, way};
use crate::gpu::{DEPTH, Gpu, IS_PAGE};
use crate::timing::Instant;

/// What is said where there is no window to be had.
pub(crate) const NO_WINDOW: &str = "no window can be opened (no display?): try --headless";
/// What is said where the adapter has no way to the window.
const NO_SURFACE: &str = if IS_PAGE {
    "this browser cannot draw: neither WebGPU nor WebGL 2 can be had"
} else {
    "the graphics adapter cannot draw to a window: try --headless"
};

/// Nothing, or why the program ends.
pub type Done = Result<(), Box<dyn Error>>;

/// The window to open, and where.
#[derive(Debug, Clone)]
pub(crate) struct Wanted {
    pub(crate) attributes: WindowAttributes,
    pub(crate) software: bool,
    pub(crate) frames: Option<u32>,
    /// Ways to draw that are tried.
    pub(crate) backends: wgpu::Backends,
}

/// The window as a program sees it.
pub struct Screen {
    /// The device.
    pub gpu: Gpu,
    /// The keys that are held.
    pub keys: HashSet<KeyCode>,
    pub(crate) window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    depth: wgpu::Texture,
    pub(crate) looking: bool,
    pub(crate) fingers: Fingers,
    pub(crate) last: Instant,
    /// Frames still to be drawn, if they are counted.
    pub(crate) left: Option<u32>,
    /// The context of the panels in this window.
    pub(crate) panels: egui::Context,
    pub(crate) events: RefCell<egui_winit::State>,
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

    /// Mouse and keys since the last call, for panels.
    pub(crate) fn input(&self) -> egui::RawInput {
        self.events.borrow_mut().take_egui_input(&self.window)
    }

    /// The way that keys and fingers ask for in so many seconds, at a speed of 1: right, up and
    /// forward. W and S, A and D, E and Q; longer with Shift.
    pub fn way(&self, seconds: f64) -> Vec3 {
        // A frame that took longer, such as the first, makes no leap.
        (way(&self.keys) + Vec3::Z * self.fingers.forward()) * seconds.min(0.1) as f32
    }

    pub(crate) async fn new(wanted: Wanted, window: Arc<Window>) -> Result<Self, Box<dyn Error>> {
        let mut described = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        described.backends &= wanted.backends;
        let instance = wgpu::util::new_instance_with_webgpu_detection(described).await;
        let surface = instance.create_surface(window.clone()).map_err(|_| NO_SURFACE)?;
        let gpu = Gpu::request(&instance, Some(&surface), wanted.software).await?;
        let (width, height) = gpu.clamp(window.inner_size().into());
        let mut config = surface.get_default_config(&gpu.adapter, width, height).ok_or(NO_SURFACE)?;
        // Colours are written as they are, without another encoding.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        config.format = formats.into_iter().find(|f| !f.is_srgb()).unwrap_or(config.format);
        surface.configure(&gpu.device, &config);
        let depth = gpu.texture((width, height), DEPTH);
        let (keys, last) = (HashSet::new(), Instant::now());
        let (panels, events) = panels_of(&window, &gpu);
        let (looking, fingers, left) = (false, Fingers::default(), wanted.frames);
        Ok(Self { gpu, keys, window, surface, config, depth, looking, fingers, last, left, panels, events })
    }

    /// Takes over another size.
    pub(crate) fn resize(&mut self, size: PhysicalSize<u32>) {
        (self.config.width, self.config.height) = self.gpu.clamp(size.into());
        self.surface.configure(&self.gpu.device, &self.config);
        self.depth = self.gpu.texture(self.size(), DEPTH);
    }

    /// Makes way for the panels of another program: those of the last one are drawn with its own
    /// textures.
    pub(crate) fn forget_panels(&mut self) {
        (self.panels, self.events) = panels_of(&self.window, &self.gpu);
    }

    /// Shows a frame.
    pub(crate) fn show(&mut self, draw: &mut dyn FnMut(&Self, &Target) -> Done) -> Done {
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
        // Nothing waits for a screen that is not drawn to. A page is not asked for frames then.
        #[cfg(not(target_arch = "wasm32"))]
        if self.window.is_minimized() == Some(true) {
            std::thread::sleep(std::time::Duration::from_millis(50));
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

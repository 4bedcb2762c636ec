//! A program in the canvas of a page.

use web_sys::HtmlCanvasElement;
use winit::event_loop::EventLoop;
use winit::platform::web::{EventLoopExtWebSys, WindowAttributesExtWebSys};
use winit::window::Window;

use crate::screen::{NO_WINDOW, Wanted};
use crate::window::{Hands, Listener, Program, Start};

/// Starts a program in a canvas and returns. It draws with WebGPU, or else with WebGL 2; with
/// `is_webgl` only with that. The page moves it with what is returned, and `listener` is told what
/// it shows, or that nothing can be drawn.
///
/// # Errors
/// There is one already in this page.
pub fn open(
    canvas: HtmlCanvasElement,
    is_webgl: bool,
    start: Start,
    listener: Listener,
) -> Result<Hands, Box<dyn std::error::Error>> {
    let event_loop = EventLoop::with_user_event().build().map_err(|_| NO_WINDOW)?;
    // Tab and the keys of the browser stay with the browser.
    let attributes = Window::default_attributes()
        .with_canvas(Some(canvas))
        .with_prevent_default(false)
        .with_focusable(true);
    let backends = if is_webgl { wgpu::Backends::GL } else { wgpu::Backends::all() };
    let wanted = Wanted { attributes, software: false, frames: None, backends };
    let hands = event_loop.create_proxy();
    let mut program = Program::new(wanted, start, hands.clone());
    program.listener = Some(listener);
    event_loop.spawn_app(program);
    Ok(Hands(hands))
}

//! A window and its loop.

use std::error::Error;
use std::time::Instant;

use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::WindowId;

use crate::canvas::Target;
use crate::panel::Panel;
use crate::screen::NO_WINDOW;
pub use crate::screen::{Done, Screen, WindowOptions};

/// Frames that show words before a program starts: the first may be lost before the window is on
/// the screen.
const WORDS: u32 = 2;

/// A program that draws to a window.
pub trait Demo {
    /// A key goes down. Escape is not reported: it closes the window. Nor are keys that a panel
    /// takes.
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
                let seconds = std::mem::replace(&mut screen.last, Instant::now()).elapsed().as_secs_f64();
                demo.step(seconds, screen);
                screen.show(&mut |screen, target| demo.draw(screen, target))?;
                screen.left = screen.left.map(|left| left.saturating_sub(1));
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

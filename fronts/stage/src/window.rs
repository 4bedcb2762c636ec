//! A window and its loop.

use std::error::Error;
use std::sync::Arc;

use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{DeviceEvent, DeviceId, ElementState, MouseButton, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::keyboard::{KeyCode, PhysicalKey};
use winit::window::{Window, WindowId};

use crate::canvas::Target;
use crate::dial::{Dials, Turned};
use crate::gpu::{Gpu, IS_PAGE};
use crate::panel::Panel;
use crate::report::Report;
pub use crate::screen::{Done, Screen};
use crate::screen::{NO_WINDOW, Wanted};
use crate::timing::Instant;

/// Frames that show words before a program starts: the first may be lost before the window is on
/// the screen.
const WORDS: u32 = 2;
/// A page is told of every so many frames: to write its text anew takes time.
const TOLD: u32 = 8;

/// A program that draws to a window.
pub trait Demo {
    /// Lists all that can be set, and sets what was turned: see [`Dials`]. Keys are not given where
    /// the panel takes them; Escape closes the window, and H hides its panel.
    ///
    /// # Errors
    /// The program ends.
    fn dials(&mut self, dials: &mut Dials, screen: &Screen) -> Done;

    /// The mouse moves with a button down, or a finger, by pixels to the right and down.
    fn turn(&mut self, x: f32, y: f32, screen: &Screen);

    /// The window has another size.
    fn resize(&mut self, _: &Screen) {}

    /// Time passes, in seconds since the last call.
    fn step(&mut self, seconds: f64, screen: &Screen);

    /// Draws a frame.
    ///
    /// # Errors
    /// The program ends.
    fn draw(&mut self, screen: &Screen, target: &Target) -> Done;

    /// What it says about itself, for the panel of a window or for a page; without the dials.
    fn report(&self, screen: &Screen) -> Report;
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

/// What reaches a program from outside of its window: from the buttons of a page.
pub enum Order {
    /// A key is held, or let go.
    Hold(KeyCode, bool),
    /// All keys are let go.
    LetGo,
    /// It turns by pixels to the right and down.
    Turn(f32, f32),
    /// A dial is set.
    Set(String, f64),
    /// Another program takes its place.
    Start(Start),
}

/// What a page is told.
pub enum Told<'a> {
    /// The device that draws is there.
    Opened(&'a Gpu),
    /// The title of the program that starts.
    Title(&'a str),
    /// What it shows, once every few frames.
    Report(&'a Report),
    /// Why it cannot go on, or another one cannot start.
    Failed(&'a str),
}

/// Takes what a page is told.
pub type Listener = Box<dyn FnMut(Told<'_>)>;

/// What wakes the loop beside the window.
pub(crate) enum Event {
    /// The window is there, or why it is not.
    Opened(Result<Box<Screen>, Box<dyn Error>>),
    /// Something is to be done.
    Order(Order),
}

/// Gives orders to a program. They are done at its next turn; after its end they are lost.
#[derive(Clone)]
pub struct Hands(pub(crate) EventLoopProxy<Event>);

impl Hands {
    /// Gives an order.
    pub fn order(&self, order: Order) {
        // After the end of the loop nobody is there.
        let _ = self.0.send_event(Event::Order(order));
    }
}

/// Opens a window of a size in pixels, starts a program in it and stays until it is closed, which it
/// is by itself after so many frames, if that is said. A software adapter draws if it is wanted.
///
/// # Errors
/// There is no display or no adapter, and those of the program.
pub fn open((width, height): (u32, u32), software: bool, frames: Option<u32>, start: Start) -> Done {
    let event_loop = EventLoop::with_user_event().build().map_err(|_| NO_WINDOW)?;
    let attributes = Window::default_attributes().with_inner_size(PhysicalSize::new(width, height));
    let wanted = Wanted { attributes, software, frames, backends: wgpu::Backends::all() };
    let mut program = Program::new(wanted, start, event_loop.create_proxy());
    event_loop.run_app(&mut program).map_err(|_| "the window system has ended the program")?;
    program.failed.map_or(Ok(()), Err)
}

pub(crate) struct Program {
    wanted: Wanted,
    start: Option<Start>,
    hands: EventLoopProxy<Event>,
    running: Option<(Screen, Shown)>,
    pub(crate) listener: Option<Listener>,
    /// Frames until the listener is told again.
    untold: u32,
    failed: Option<Box<dyn Error>>,
}

/// What a window shows.
enum Shown {
    /// Words, for so many frames; then a program is started. If it cannot be, the one before goes
    /// on.
    Words(Start, Box<Panel>, u32, Option<Box<Running>>),
    /// A program. For a moment there is none.
    Demo(Option<Box<Running>>),
}

/// A program, and the panel that shows its report.
struct Running {
    demo: Box<dyn Demo>,
    panel: Panel,
    is_hidden: bool,
}

/// Gives a program what was turned. Returns its report, with its dials.
fn turned(demo: &mut dyn Demo, turned: Turned, screen: &Screen) -> Result<Report, Box<dyn Error>> {
    let mut dials = Dials::new(turned);
    demo.dials(&mut dials, screen)?;
    Ok(Report { dials: dials.listed, ..demo.report(screen) })
}

impl Shown {
    fn words(screen: &Screen, start: Start, before: Option<Box<Running>>) -> Self {
        screen.window.set_title(&start.title);
        Self::Words(start, Box::new(Panel::new(&screen.gpu, screen.format())), WORDS, before)
    }

    fn demo(&mut self) -> Option<&mut dyn Demo> {
        match self {
            Self::Demo(Some(running)) => Some(&mut *running.demo),
            _ => None,
        }
    }

    /// Draws a frame, and goes on to what comes next.
    fn redraw(&mut self, screen: &mut Screen) -> Done {
        match self {
            Self::Words(_, panel, left, _) if *left > 0 => {
                *left -= 1;
                screen.show(&mut |screen, target| {
                    panel.say(&screen.gpu, target, screen.scale(), "compiling shaders");
                    Ok(())
                })
            }
            Self::Words(..) => {
                if let Self::Words(start, _, _, before) = std::mem::replace(self, Self::Demo(None)) {
                    match (start.make)(screen) {
                        Ok(demo) => {
                            let (panel, is_hidden) = (Panel::on(screen), IS_PAGE);
                            *self = Self::Demo(Some(Box::new(Running { demo, panel, is_hidden })));
                        }
                        Err(why) => {
                            *self = Self::Demo(before);
                            return Err(why);
                        }
                    }
                }
                screen.last = Instant::now();
                Ok(())
            }
            Self::Demo(None) => Ok(()),
            Self::Demo(Some(running)) => {
                let Running { demo, panel, is_hidden } = &mut **running;
                let seconds = std::mem::replace(&mut screen.last, Instant::now()).elapsed().as_secs_f64();
                demo.step(seconds, screen);
                let mut found = Turned::Nothing;
                screen.show(&mut |screen, target| {
                    demo.draw(screen, target)?;
                    if !*is_hidden {
                        let report = turned(&mut **demo, Turned::Nothing, screen)?;
                        found = panel.report(screen, target, &report);
                    }
                    Ok(())
                })?;
                if found != Turned::Nothing {
                    turned(&mut **demo, found, screen)?;
                }
                screen.left = screen.left.map(|left| left.saturating_sub(1));
                Ok(())
            }
        }
    }
}

impl Program {
    pub(crate) fn new(wanted: Wanted, start: Start, hands: EventLoopProxy<Event>) -> Self {
        let start = Some(start);
        Self { wanted, start, hands, running: None, listener: None, untold: 0, failed: None }
    }

    /// Ends a program that failed. A page says why, and goes on if it can.
    fn end_if_failed(&mut self, event_loop: &ActiveEventLoop, result: Done) {
        let Err(error) = result else { return };
        if let Some(listener) = &mut self.listener {
            return listener(Told::Failed(&error.to_string()));
        }
        self.failed = Some(error);
        event_loop.exit();
    }

    /// Tells the listener what is shown.
    fn tell(&mut self) {
        let (Some(listener), Some((screen, shown))) = (&mut self.listener, &mut self.running) else { return };
        match shown {
            Shown::Words(start, ..) => listener(Told::Title(&start.title)),
            Shown::Demo(Some(running)) if self.untold == 0 => {
                self.untold = TOLD;
                match turned(&mut *running.demo, Turned::Nothing, screen) {
                    Ok(report) => listener(Told::Report(&report)),
                    Err(why) => listener(Told::Failed(&why.to_string())),
                }
            }
            Shown::Demo(_) => self.untold = self.untold.saturating_sub(1),
        }
    }

    /// Does what was ordered.
    fn obey(&mut self, order: Order) -> Done {
        let Some((screen, shown)) = &mut self.running else { return Ok(()) };
        self.untold = 0;
        match (order, shown.demo()) {
            (Order::LetGo, _) => screen.keys.clear(),
            (Order::Hold(key, false), _) => drop(screen.keys.remove(&key)),
            (Order::Hold(key, true), Some(demo)) => {
                if screen.keys.insert(key) {
                    turned(demo, Turned::Key(key), screen)?;
                }
            }
            (Order::Turn(x, y), Some(demo)) => demo.turn(x, y, screen),
            (Order::Set(name, value), Some(demo)) => {
                turned(demo, Turned::Dial(name, value, false), screen)?;
            }
            (Order::Start(start), _) => {
                screen.forget_panels();
                screen.keys.clear();
                let before = match std::mem::replace(shown, Shown::Demo(None)) {
                    Shown::Words(_, _, _, demo) | Shown::Demo(demo) => demo,
                };
                *shown = Shown::words(screen, start, before);
            }
            (_, None) => {}
        }
        Ok(())
    }

    /// Draws a frame.
    fn redraw(&mut self, event_loop: &ActiveEventLoop) -> Done {
        let Some((screen, shown)) = &mut self.running else { return Ok(()) };
        shown.redraw(screen)?;
        if screen.left == Some(0) {
            event_loop.exit();
        }
        screen.gpu.trouble().map_or(Ok(()), |why| Err(why.into()))
    }
}

/// Opens a window. Its screen comes as an event: in a page only after this has returned.
fn open_screen(wanted: &Wanted, event_loop: &ActiveEventLoop, hands: EventLoopProxy<Event>) -> Done {
    let window = event_loop.create_window(wanted.attributes.clone()).map_err(|_| NO_WINDOW)?;
    let screen = Screen::new(wanted.clone(), Arc::new(window));
    let opened = async move {
        // After the end of the loop nobody waits for it.
        let _ = hands.send_event(Event::Opened(screen.await.map(Box::new)));
    };
    #[cfg(not(target_arch = "wasm32"))]
    pollster::block_on(opened);
    #[cfg(target_arch = "wasm32")]
    wasm_bindgen_futures::spawn_local(opened);
    Ok(())
}

impl ApplicationHandler<Event> for Program {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        // It is called again when a suspended program goes on.
        if self.start.is_none() || self.running.is_some() {
            return;
        }
        let opened = open_screen(&self.wanted, event_loop, self.hands.clone());
        self.end_if_failed(event_loop, opened);
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        let done = match event {
            Event::Opened(Ok(screen)) => {
                if let Some(listener) = &mut self.listener {
                    listener(Told::Opened(&screen.gpu));
                }
                if let Some(start) = self.start.take() {
                    let shown = Shown::words(&screen, start, None);
                    self.running = Some((*screen, shown));
                }
                Ok(())
            }
            Event::Opened(Err(why)) => Err(why),
            Event::Order(order) => self.obey(order),
        };
        self.end_if_failed(event_loop, done);
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
            WindowEvent::MouseInput { state, button: MouseButton::Left | MouseButton::Right, .. } => {
                screen.looking = state == ElementState::Pressed && !taken;
                Ok(())
            }
            WindowEvent::Touch(touch) => {
                if let (Some((x, y)), Some(demo)) = (screen.fingers.follow(&touch, taken), shown.demo()) {
                    demo.turn(x, y, screen);
                }
                Ok(())
            }
            WindowEvent::KeyboardInput { event, .. } => match (event.physical_key, shown.demo()) {
                (PhysicalKey::Code(KeyCode::Escape), _) if self.listener.is_none() => {
                    event_loop.exit();
                    Ok(())
                }
                (PhysicalKey::Code(KeyCode::KeyH), _) if self.listener.is_none() => {
                    let pressed = event.state == ElementState::Pressed && !event.repeat && !taken;
                    if let (true, Shown::Demo(Some(running))) = (pressed, shown) {
                        running.is_hidden ^= true;
                    }
                    Ok(())
                }
                (PhysicalKey::Code(key), _) if event.state == ElementState::Released => {
                    screen.keys.remove(&key);
                    Ok(())
                }
                (PhysicalKey::Code(key), Some(demo)) if !taken && screen.keys.insert(key) => {
                    self.untold = 0;
                    turned(demo, Turned::Key(key), screen).map(|_| ())
                }
                _ => Ok(()),
            },
            WindowEvent::RedrawRequested => {
                let drawn = self.redraw(event_loop);
                self.tell();
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

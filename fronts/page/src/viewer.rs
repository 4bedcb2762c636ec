//! What the script of the page calls.

use casca_scenes::name::SceneName;
use casca_stage::page;
use casca_stage::window::{Hands, Order, Told};
use casca_stage::winit::keyboard::KeyCode;
use casca_viewer::scene::window::First;
use casca_viewer::{scene, systems};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use crate::told::json_of;

/// Keys that the page can hold, by their names in `KeyboardEvent.code`.
const KEYS: [(&str, KeyCode); 7] = [
    ("KeyW", KeyCode::KeyW),
    ("KeyA", KeyCode::KeyA),
    ("KeyS", KeyCode::KeyS),
    ("KeyD", KeyCode::KeyD),
    ("KeyQ", KeyCode::KeyQ),
    ("KeyE", KeyCode::KeyE),
    ("ShiftLeft", KeyCode::ShiftLeft),
];

/// The viewer in a canvas.
#[wasm_bindgen]
pub struct Viewer {
    hands: Hands,
}

fn refused(why: impl ToString) -> JsError {
    JsError::new(&why.to_string())
}

#[wasm_bindgen]
impl Viewer {
    /// Starts the system that a command line such as "view rooms --at 40" names. The viewer calls
    /// `told` with messages in JSON, many times a second. With `webgl` it draws with WebGL 2 even
    /// where there is WebGPU.
    ///
    /// # Errors
    /// There is no such system, it has no such options, or there is a viewer already.
    #[wasm_bindgen(constructor)]
    pub fn new(
        canvas: HtmlCanvasElement,
        words: &str,
        webgl: bool,
        told: js_sys::Function,
    ) -> Result<Self, JsError> {
        console_error_panic_hook::set_once();
        let start = systems::start(&words.split_whitespace().collect::<Vec<_>>()).map_err(refused)?;
        let listener = move |what: Told<'_>| {
            // An error of the page's own script is on its console.
            let _ = told.call1(&JsValue::NULL, &JsValue::from_str(&json_of(&what).to_string()));
        };
        let hands = page::open(canvas, webgl, start, Box::new(listener)).map_err(refused)?;
        Ok(Self { hands })
    }

    /// Shows the system that a command line names, in place of the one before.
    ///
    /// # Errors
    /// There is no such system, or it has no such options.
    pub fn show(&self, words: &str) -> Result<(), JsError> {
        let start = systems::start(&words.split_whitespace().collect::<Vec<_>>()).map_err(refused)?;
        self.hands.order(Order::Start(start));
        Ok(())
    }

    /// Shows the scene in the bytes of a .glb file.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn file(&self, name: &str, bytes: &[u8]) -> Result<(), JsError> {
        let given = SceneName::Given(name.to_owned(), bytes.into());
        given.open(&Default::default()).map_err(refused)?;
        let method = scene::playback::Method::Point;
        let start = scene::window::start(vec![given], &Default::default(), method, First::Path);
        self.hands.order(Order::Start(start));
        Ok(())
    }

    /// Holds a key, or lets it go; others than those that fly are passed over.
    pub fn hold(&self, key: &str, down: bool) {
        if let Some((_, key)) = KEYS.iter().find(|(name, _)| *name == key) {
            self.hands.order(Order::Hold(*key, down));
        }
    }

    /// Lets all keys go.
    #[wasm_bindgen(js_name = letGo)]
    pub fn let_go(&self) {
        self.hands.order(Order::LetGo);
    }

    /// Turns the camera as the mouse does, by pixels to the right and down.
    pub fn turn(&self, x: f32, y: f32) {
        if x.is_finite() && y.is_finite() {
            self.hands.order(Order::Turn(x, y));
        }
    }

    /// Sets a dial of the last report to the nearest number that it has.
    pub fn set(&self, dial: &str, value: f64) {
        self.hands.order(Order::Set(dial.to_owned(), value));
    }
}

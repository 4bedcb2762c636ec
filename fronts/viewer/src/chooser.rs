//! The window that a start without arguments opens: a list to choose from.

use casca_stage::canvas::Target;
use casca_stage::dial::Dials;
use casca_stage::panel::Panel;
use casca_stage::report::Report;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;

use crate::systems::System;

/// Keys of the systems.
const KEYS: [KeyCode; 6] =
    [KeyCode::Digit1, KeyCode::Digit2, KeyCode::Digit3, KeyCode::Digit4, KeyCode::Digit5, KeyCode::Digit6];

/// A window with a list of systems; it goes on with the one that is chosen.
pub fn start(choices: &'static [System]) -> Start {
    Start::new("casca", move |screen: &Screen| {
        Ok(Chooser { choices, panel: Panel::new(&screen.gpu, screen.format()), chosen: None })
    })
}

struct Chooser {
    choices: &'static [System],
    panel: Panel,
    chosen: Option<System>,
}

/// The start of the system that was chosen. Its files are read only in `make`, while the window
/// shows words: that takes a moment.
fn started(choice: System) -> Start {
    let make = move |screen: &Screen| {
        let start = choice.start()?;
        screen.set_title(&start.title);
        (start.make)(screen)
    };
    Start { title: format!("casca: {}", choice.name), make: Box::new(make) }
}

impl Demo for Chooser {
    fn dials(&mut self, dials: &mut Dials, _: &Screen) -> Done {
        for (number, (system, key)) in self.choices.iter().zip(KEYS).enumerate() {
            let button = format!("{}   {}: {}", number + 1, system.name, system.line);
            if dials.button(&button, Some(key)) {
                self.chosen = Some(*system);
            }
        }
        Ok(())
    }

    fn turn(&mut self, _: f32, _: f32, _: &Screen) {}

    fn step(&mut self, _: f64, _: &Screen) {}

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        self.panel.clear(&screen.gpu, target);
        Ok(())
    }

    fn report(&self, _: &Screen) -> Report {
        let lines = [
            "casca: what can be seen",
            "Choose with the mouse, or with the number of a line. Escape closes the window.",
        ];
        Report {
            lines: lines.map(str::to_owned).to_vec(),
            keys: "casca-viewer NAME FILE shows a file of yours; --help lists all options.",
            ..Report::default()
        }
    }

    fn next(&mut self) -> Option<Start> {
        self.chosen.take().map(started)
    }
}

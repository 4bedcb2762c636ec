//! The window that a start without arguments opens: a list to choose from.

use casca_stage::canvas::Target;
use casca_stage::egui::{self, Align2, Button, RichText};
use casca_stage::panel::{Panel, controls};
use casca_stage::report::Report;
use casca_stage::window::{Demo, Done, Screen, Start};
use casca_stage::winit::keyboard::KeyCode;

use crate::systems::System;

/// Keys of the systems.
const KEYS: [KeyCode; 9] = [
    KeyCode::Digit1,
    KeyCode::Digit2,
    KeyCode::Digit3,
    KeyCode::Digit4,
    KeyCode::Digit5,
    KeyCode::Digit6,
    KeyCode::Digit7,
    KeyCode::Digit8,
    KeyCode::Digit9,
];
/// Points across a button.
const WIDE: f32 = 560.0;

/// A window with a list of systems; it goes on with the one that is chosen.
pub fn start(choices: &'static [System]) -> Start {
    Start::new("casca", move |screen: &Screen| {
        Ok(Chooser { choices, panel: Panel::on(screen), chosen: None })
    })
}

struct Chooser {
    choices: &'static [System],
    panel: Panel,
    chosen: Option<System>,
}

/// Starts what was chosen. Reading and making it takes a moment, so it happens after the words of
/// the window.
fn started(choice: System) -> Start {
    let make = move |screen: &Screen| {
        let start = choice.start()?;
        screen.set_title(&start.title);
        (start.make)(screen)
    };
    Start { title: format!("casca: {}", choice.name), make: Box::new(make) }
}

impl Demo for Chooser {
    fn press(&mut self, key: KeyCode, _: &Screen) -> Done {
        let number = KEYS.iter().position(|k| *k == key);
        self.chosen = number.and_then(|i| self.choices.get(i)).copied().or(self.chosen);
        Ok(())
    }

    fn turn(&mut self, _: f32, _: f32, _: &Screen) {}

    fn resize(&mut self, _: &Screen) {}

    fn step(&mut self, _: f64, _: &Screen) {}

    fn draw(&mut self, screen: &Screen, target: &Target) -> Done {
        let Self { choices, panel, chosen } = self;
        panel.clear(&screen.gpu, target);
        panel.control(screen, target, &mut |context| {
            controls(context, "choices", Align2::CENTER_CENTER, [0.0, 0.0], &mut |ui| {
                ui.label(RichText::new("casca: what can be seen").size(26.0).strong());
                ui.label("Choose with the mouse, or with the number of a line. Escape closes the window.");
                ui.add_space(10.0);
                for (choice, number) in choices.iter().zip(1..) {
                    if row(ui, number, choice) {
                        *chosen = Some(*choice);
                    }
                }
                ui.add_space(10.0);
                ui.label("casca-viewer NAME FILE shows a file of yours; --help lists all options.");
            });
        });
        Ok(())
    }

    // A page has a list of its own.
    fn report(&self, _: &Screen) -> Report {
        Report::default()
    }

    fn set(&mut self, _: &str, _: f64, _: &Screen) -> Done {
        Ok(())
    }

    fn next(&mut self) -> Option<Start> {
        self.chosen.take().map(started)
    }
}

/// A button with the name of a system and what it shows; whether it was pressed.
fn row(ui: &mut egui::Ui, number: u32, choice: &System) -> bool {
    let name = RichText::new(format!("{number}   {}", choice.name)).size(18.0);
    let pressed = ui.add(Button::new(name).min_size(egui::vec2(WIDE, 34.0))).clicked();
    ui.label(choice.line);
    ui.add_space(6.0);
    pressed
}

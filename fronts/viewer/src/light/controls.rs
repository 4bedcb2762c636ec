//! What the sliders of the window set.

use casca_radiosity::lit::{Light, LightKind};
use casca_stage::dial::Dial;
use casca_stage::egui::{
    CollapsingHeader, ComboBox, DragValue, Grid, Response, ScrollArea, Slider, SliderClamping, Ui,
};
use glam::Vec3;

use crate::light::layer::Layer;
use crate::light::options::{EXPOSURES, Options};
use crate::light::renderer::Settings;

/// Cells along the longest axis that the slider offers.
const RESOLUTIONS: std::ops::RangeInclusive<u32> = 16..=256;
/// Rays of a state that the slider offers.
const RAYS: std::ops::RangeInclusive<u32> = 4..=512;
/// The slider goes through multiples of this many cells.
const CELLS: f64 = 8.0;
/// The strongest that a light can be made, as a factor.
const STRONGEST: f32 = 10.0;
/// Metres that a light moves for each pixel of the mouse, as a share of the scene's length.
const DRAG: f32 = 0.002;
/// The height of the list of lights, in points; more of them are scrolled.
const LIST: f32 = 190.0;

/// A light, how strong it is, and whether it shines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// The light of the scene, where it was moved to.
    pub light: Light,
    /// A factor of its strength.
    pub strength: f32,
    /// Whether it shines.
    pub on: bool,
}

impl Lamp {
    fn shines(&self) -> Light {
        Light { color: if self.on { self.light.color * self.strength } else { Vec3::ZERO }, ..self.light }
    }
}

/// All that can be set.
#[derive(Debug, Clone, PartialEq)]
pub struct Controls {
    /// Cells and rays that are wanted.
    pub settings: Settings,
    /// Light times this is shown.
    pub exposure: f32,
    /// The layer that is shown.
    pub layer: Layer,
    /// Whether the balls move.
    pub moving: bool,
    /// The lights.
    pub lamps: Vec<Lamp>,
    /// While a slider of the settings is held: the cache is made again when it is let go.
    pub held: bool,
}

impl Controls {
    /// As the command line says.
    pub fn new(options: &Options, lights: &[Light]) -> Self {
        let lamp = |&light: &Light| Lamp { light, strength: 1.0, on: true };
        Self {
            settings: options.settings(),
            exposure: options.exposure,
            layer: Layer::Picture,
            moving: true,
            lamps: lights.iter().map(lamp).collect(),
            held: false,
        }
    }

    /// The lights as they shine.
    pub fn lights(&self) -> Vec<Light> {
        self.lamps.iter().map(Lamp::shines).collect()
    }

    /// Shows sliders and boxes for everything, for a scene so many metres long.
    pub fn show(&mut self, ui: &mut Ui, length: f32) {
        self.sizes(ui);
        slider(ui, &mut self.exposure, EXPOSURES, EXPOSURE);
        ui.checkbox(&mut self.moving, MOVING);
        ComboBox::from_label(LAYER).selected_text(self.layer.name()).show_ui(ui, |ui| {
            for layer in Layer::EVERY {
                ui.selectable_value(&mut self.layer, layer, layer.name());
            }
        });
        if self.lamps.is_empty() {
            ui.label("no lights but surfaces that emit");
            return;
        }
        CollapsingHeader::new(format!("lights: {}", self.lamps.len())).default_open(true).show(ui, |ui| {
            ScrollArea::vertical().max_height(LIST).show(ui, |ui| {
                Grid::new("lights").show(ui, |ui| {
                    for (number, lamp) in self.lamps.iter_mut().enumerate() {
                        ui.push_id(number, |ui| ui.checkbox(&mut lamp.on, kind(&lamp.light)));
                        ui.push_id(number, |ui| slider(ui, &mut lamp.strength, 0.0..=STRONGEST, "strength"));
                        ui.end_row();
                        ui.label("");
                        ui.push_id(number, |ui| place(ui, &mut lamp.light, length * DRAG));
                        ui.end_row();
                    }
                });
            });
        });
    }

    /// The sliders of what the cache is made with; returns that of the resolution.
    fn sizes(&mut self, ui: &mut Ui) -> Response {
        let cells = Slider::new(&mut self.settings.resolution, RESOLUTIONS).step_by(CELLS).text(CELLS_NAME);
        let cells = ui.add(cells.clamping(SliderClamping::Edits));
        let rays = Slider::new(&mut self.settings.rays, RAYS).logarithmic(true).text(RAYS_NAME);
        let rays = ui.add(rays.clamping(SliderClamping::Edits));
        self.held = cells.dragged() || rays.dragged();
        cells
    }
}

/// Names of dials, as the panel has them.
const CELLS_NAME: &str = "cells";
const RAYS_NAME: &str = "rays of a surface in a cell";
const EXPOSURE: &str = "exposure";
const MOVING: &str = "balls move";
const LAYER: &str = "layer";

/// For pages: the same by names, but for the places of lights.
impl Controls {
    /// What can be set.
    pub fn dials(&self) -> Vec<Dial> {
        let wide = |range: std::ops::RangeInclusive<u32>| f64::from(*range.start())..=f64::from(*range.end());
        let exposures = f64::from(*EXPOSURES.start())..=f64::from(*EXPOSURES.end());
        let layer = Layer::EVERY.iter().position(|layer| *layer == self.layer);
        let mut dials = vec![
            Dial::choice(LAYER, Layer::EVERY.map(Layer::name), layer.unwrap_or(0)),
            Dial::number(CELLS_NAME, self.settings.resolution, wide(RESOLUTIONS), CELLS),
            Dial::number(RAYS_NAME, self.settings.rays, wide(RAYS), 1.0),
            Dial::number(EXPOSURE, self.exposure, exposures, 0.0),
            Dial::switch(MOVING, self.moving),
        ];
        for (number, lamp) in self.lamps.iter().enumerate() {
            let [on, strength] = names(number, lamp);
            dials.push(Dial::switch(&on, lamp.on));
            dials.push(Dial::number(&strength, lamp.strength, 0.0..=f64::from(STRONGEST), 0.0));
        }
        dials
    }

    /// Sets one of them.
    pub fn set(&mut self, dial: &str, value: f64) {
        let on = value != 0.0;
        match dial {
            LAYER => self.layer = Layer::EVERY.get(value as usize).copied().unwrap_or(self.layer),
            CELLS_NAME => self.settings.resolution = value as u32,
            RAYS_NAME => self.settings.rays = value as u32,
            EXPOSURE => self.exposure = value as f32,
            MOVING => self.moving = on,
            name => {
                for (number, lamp) in self.lamps.iter_mut().enumerate() {
                    let [switch, strength] = names(number, lamp);
                    match name {
                        _ if name == switch => lamp.on = on,
                        _ if name == strength => lamp.strength = value as f32,
                        _ => {}
                    }
                }
            }
        }
    }
}

/// The names of a lamp's dials: whether it shines, and how strong.
fn names(number: usize, lamp: &Lamp) -> [String; 2] {
    let name = format!("light {}: {}", number + 1, kind(&lamp.light));
    [name.clone(), format!("{name}, strength")]
}

/// A slider for a number. A value from outside of its range stays until it is moved.
fn slider(ui: &mut Ui, value: &mut f32, range: std::ops::RangeInclusive<f32>, text: &str) -> Response {
    ui.add(Slider::new(value, range).logarithmic(true).clamping(SliderClamping::Edits).text(text))
}

fn kind(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Directional { .. } => "sun",
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
    }
}

/// Where a light is: a sun's height and turn in degrees, the place of others in metres.
fn place(ui: &mut Ui, light: &mut Light, speed: f32) {
    match &mut light.kind {
        LightKind::Directional { direction, .. } => {
            let (mut height, mut turn) = angles(*direction);
            ui.horizontal(|ui| {
                let low =
                    ui.add(DragValue::new(&mut height).range(-90.0..=90.0).prefix("height ").suffix("°"));
                let turned =
                    ui.add(DragValue::new(&mut turn).range(-180.0..=180.0).prefix("turn ").suffix("°"));
                if low.union(turned).changed() {
                    *direction = sunbeam(height, turn);
                }
            });
        }
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
            ui.horizontal(|ui| {
                for (axis, name) in ["x ", "y ", "z "].into_iter().enumerate() {
                    ui.add(DragValue::new(&mut position[axis]).speed(speed).prefix(name).suffix(" m"));
                }
            });
        }
    }
}

/// How high a sun stands whose light goes along a direction, and how far it is turned from z to x,
/// in degrees.
fn angles(direction: Vec3) -> (f32, f32) {
    let to = -direction.normalize_or(Vec3::NEG_Y);
    (to.y.clamp(-1.0, 1.0).asin().to_degrees(), to.x.atan2(to.z).to_degrees())
}

/// Where the light of a sun at such angles goes.
fn sunbeam(height: f32, turn: f32) -> Vec3 {
    let ((sin, cos), (x, z)) = (height.to_radians().sin_cos(), turn.to_radians().sin_cos());
    -Vec3::new(cos * x, sin, cos * z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::parsed;
    use casca_radiosity::lit::Kind;
    use casca_stage::dial::Setting;
    use casca_stage::egui::{Context, Event, Modifiers, PointerButton, Pos2, RawInput, Rect, vec2};

    fn controls(words: &[&str]) -> Controls {
        let options = parsed::<Options>(words).unwrap();
        Controls::new(&options, &Kind::CornellPoint.build().lights)
    }

    /// Shows something once, with what the mouse did.
    fn pass(context: &Context, events: Vec<Event>, show: &mut dyn FnMut(&mut Ui)) {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0)));
        let input = RawInput { screen_rect, events, ..Default::default() };
        context.run_ui(input, |ui| show(ui)).drop_without_applying_deltas();
    }

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
    }

    #[test]
    fn a_slider_that_is_drawn_sets_the_resolution_when_it_is_let_go() {
        let (context, mut controls) = (Context::default(), controls(&["--resolution", "12"]));
        let mut place = Rect::NOTHING;
        for _ in 0..2 {
            pass(&context, Vec::new(), &mut |ui| place = controls.sizes(ui).rect);
        }
        // A value of the command line outside of the slider's range stays.
        assert_eq!((controls.settings.resolution, controls.held), (12, false));
        let at = Pos2::new(place.left() + 50.0, place.center().y);
        pass(&context, vec![Event::PointerMoved(at)], &mut |ui| drop(controls.sizes(ui)));
        pass(&context, vec![button(at, true)], &mut |ui| drop(controls.sizes(ui)));
        let to = at + vec2(30.0, 0.0);
        pass(&context, vec![Event::PointerMoved(to)], &mut |ui| drop(controls.sizes(ui)));
        let cells = controls.settings.resolution;
        assert!(controls.held && (17..256).contains(&cells), "{controls:?}");
        assert!(cells.is_multiple_of(CELLS as u32));
        pass(&context, vec![button(to, false)], &mut |ui| drop(controls.sizes(ui)));
        assert!(!controls.held && controls.settings.resolution == cells);
    }

    #[test]
    fn what_is_shown_changes_nothing_by_itself() {
        let mut controls = controls(&["--resolution", "12", "--rays", "3", "--sun", "1,-2,0.5"]);
        let before = controls.clone();
        let context = Context::default();
        for _ in 0..3 {
            pass(&context, Vec::new(), &mut |ui| controls.show(ui, 5.0));
        }
        assert_eq!(before, controls);
        assert_eq!(controls.settings, Settings { resolution: 12, rays: 3, window: 0 });
    }

    #[test]
    fn dials_have_names_of_their_own_and_set_what_they_show() {
        let mut controls = controls(&[]);
        let dials = controls.dials();
        for (i, dial) in dials.iter().enumerate() {
            assert!(dials[..i].iter().all(|other| other.name != dial.name), "{dial:?}");
            // Another value than it has.
            let value = match &dial.setting {
                Setting::Number { value, range, .. } if value == range.end() => *range.start(),
                Setting::Number { range, .. } => *range.end(),
                Setting::Switch(on) => f64::from(u8::from(!on)),
                Setting::Choice { chosen, names } => ((chosen + 1) % names.len()) as f64,
                Setting::Button => continue,
            };
            let before = controls.clone();
            controls.set(&dial.name, value);
            assert_ne!(before, controls, "{dial:?}");
            let now = controls.dials();
            let changed = |(a, b): (&Dial, &Dial)| a.setting != b.setting;
            assert_eq!(now.iter().zip(&before.dials()).filter(|&pair| changed(pair)).count(), 1, "{dial:?}");
        }
    }

    #[test]
    fn lights_that_are_off_shine_black_and_others_as_strong_as_is_set() {
        let mut controls = controls(&[]);
        let color = controls.lamps[0].light.color;
        controls.lamps[0].strength = 0.5;
        assert_eq!(controls.lights()[0].color, color * 0.5);
        controls.lamps[0].on = false;
        assert_eq!(controls.lights()[0].color, Vec3::ZERO);
    }

    #[test]
    fn a_sun_is_turned_and_turned_back() {
        for direction in [Vec3::new(0.3, -0.8, 0.2), Vec3::NEG_Y, Vec3::X, Vec3::new(-1.0, 0.5, -1.0)] {
            let (height, turn) = angles(direction);
            assert!(sunbeam(height, turn).abs_diff_eq(direction.normalize(), 1e-5), "{direction}");
        }
        assert_eq!(angles(Vec3::NEG_Y).0, 90.0);
    }
}

//! What the window and the page can set.

use std::ops::RangeInclusive;

use casca_radiosity::Light;
use casca_stage::dial::Dial;
use glam::Vec3;

use crate::light::layer::Layer;
use crate::light::options::{EXPOSURES, Options};
use crate::light::renderer::Settings;

/// The strongest that a light can be made, as a factor.
const STRONGEST: f64 = 10.0;
/// Names of dials.
const LAYER: &str = "layer";
const CELLS: &str = "cells";
const RAYS: &str = "rays of a surface in a cell";
const EXPOSURE: &str = "exposure";
const MOVING: &str = "balls move";

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
    /// The box of the scene: lamps stay in it.
    bounds: (Vec3, Vec3),
}

impl Controls {
    /// As the command line says, for the lights of a scene with these bounds.
    pub fn new(options: &Options, lights: &[Light], bounds: (Vec3, Vec3)) -> Self {
        let lamp = |&light: &Light| Lamp { light, strength: 1.0, on: true };
        Self {
            settings: options.settings(),
            exposure: options.exposure,
            layer: Layer::Picture,
            moving: true,
            lamps: lights.iter().map(lamp).collect(),
            bounds,
        }
    }

    /// The lights as they shine.
    pub fn lights(&self) -> Vec<Light> {
        let shines = |lamp: &Lamp| lamp.light.scaled(if lamp.on { lamp.strength } else { 0.0 });
        self.lamps.iter().map(shines).collect()
    }

    /// What can be set.
    pub fn dials(&self) -> Vec<Dial> {
        let exposures = f64::from(*EXPOSURES.start())..=f64::from(*EXPOSURES.end());
        let layer = Layer::EVERY.iter().position(|layer| *layer == self.layer);
        let mut dials = vec![
            Dial::choice(LAYER, Layer::EVERY.map(Layer::name), layer.unwrap_or(0)),
            Dial::number(CELLS, self.settings.resolution, 16.0..=256.0, 8.0),
            Dial::number(RAYS, self.settings.rays, 4.0..=512.0, 1.0),
            Dial::number(EXPOSURE, self.exposure, exposures, 0.0),
            Dial::switch(MOVING, self.moving),
        ];
        for (number, lamp) in self.lamps.iter().enumerate() {
            let name = name(number, lamp);
            dials.push(Dial::switch(&name, lamp.on));
            dials.push(Dial::number(&format!("{name}, strength"), lamp.strength, 0.0..=STRONGEST, 0.0));
            for (what, value, range) in lamp.place(self.bounds) {
                dials.push(Dial::number(&format!("{name}, {what}"), value, range, 0.0));
            }
        }
        dials
    }

    /// Sets one of them.
    pub fn set(&mut self, dial: &str, value: f64) {
        let on = value != 0.0;
        match dial {
            LAYER => self.layer = Layer::EVERY.get(value as usize).copied().unwrap_or(self.layer),
            CELLS => self.settings.resolution = value as u32,
            RAYS => self.settings.rays = value as u32,
            EXPOSURE => self.exposure = value as f32,
            MOVING => self.moving = on,
            dial => {
                for (number, lamp) in self.lamps.iter_mut().enumerate() {
                    match dial.strip_prefix(&name(number, lamp)) {
                        Some("") => lamp.on = on,
                        Some(", strength") => lamp.strength = value as f32,
                        Some(what) => lamp.put(what.trim_start_matches(", "), value as f32),
                        None => {}
                    }
                }
            }
        }
    }
}

/// The name of a lamp's dials.
fn name(number: usize, lamp: &Lamp) -> String {
    let kind = match lamp.light {
        Light::Sun { .. } => "sun",
        Light::Point { .. } => "point",
        Light::Spot { .. } => "spot",
    };
    format!("light {}: {kind}", number + 1)
}

impl Lamp {
    /// Where it is, number by number: a sun's height and turn in degrees, the place of others in
    /// metres.
    fn place(&self, (min, max): (Vec3, Vec3)) -> Vec<(&'static str, f32, RangeInclusive<f64>)> {
        match self.light {
            Light::Sun { direction, .. } => {
                let (height, turn) = angles(direction);
                vec![("height", height, -90.0..=90.0), ("turn", turn, -180.0..=180.0)]
            }
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                let axis = |axis: usize| (position[axis], f64::from(min[axis])..=f64::from(max[axis]));
                let names = ["x", "y", "z"].into_iter().enumerate();
                names.map(|(i, name)| (name, axis(i).0, axis(i).1)).collect()
            }
        }
    }

    /// Sets one of these numbers.
    fn put(&mut self, what: &str, value: f32) {
        match &mut self.light {
            Light::Sun { direction, .. } => {
                let (height, turn) = angles(*direction);
                let (height, turn) = if what == "height" { (value, turn) } else { (height, value) };
                *direction = sunbeam(height, turn);
            }
            Light::Point { position, .. } | Light::Spot { position, .. } => {
                if let Some(axis) = ["x", "y", "z"].iter().position(|name| *name == what) {
                    position[axis] = value;
                }
            }
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

    fn controls() -> Controls {
        let scene = Kind::CornellPoint.build();
        Controls::new(&parsed::<Options>(&[]).unwrap(), &scene.lights, scene.bounds())
    }

    #[test]
    fn dials_have_names_of_their_own_and_set_what_they_show() {
        let mut controls = controls();
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
    fn lights_that_are_off_shine_black_and_a_sun_is_turned_and_turned_back() {
        let mut controls = controls();
        let shines = |controls: &Controls| controls.lights()[0].incident(Vec3::ONE).map(|i| i.irradiance);
        let whole = shines(&controls).unwrap();
        controls.lamps[0].strength = 0.5;
        assert!(shines(&controls).unwrap().abs_diff_eq(whole * 0.5, 1e-5 * whole.max_element()));
        controls.lamps[0].on = false;
        assert_eq!(shines(&controls), None);
        for direction in [Vec3::new(0.3, -0.8, 0.2), Vec3::NEG_Y, Vec3::X, Vec3::new(-1.0, 0.5, -1.0)] {
            let (height, turn) = angles(direction);
            assert!(sunbeam(height, turn).abs_diff_eq(direction.normalize(), 1e-5), "{direction}");
        }
    }
}

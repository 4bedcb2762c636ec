//! Settings of a program by their names, so that a window and a page show the same ones.

use std::ops::RangeInclusive;

use winit::keyboard::KeyCode;

/// A setting, and how it is set.
#[derive(Debug, Clone, PartialEq)]
pub struct Dial {
    /// Its name; no other dial of the program has it.
    pub name: String,
    /// The setting.
    pub setting: Setting,
}

/// How a dial is set. All are set by a number.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// A number.
    Number {
        /// The number.
        value: f64,
        /// What it is set to. The number of a command line may lie outside.
        range: RangeInclusive<f64>,
        /// From one value to the next; 0 if any value will do.
        step: f64,
    },
    /// On, which is 1, or off, which is 0.
    Switch(bool),
    /// One of several, by its place among them.
    Choice {
        /// Their names.
        names: Vec<String>,
        /// The place of the one that is chosen.
        chosen: usize,
    },
    /// Something that is done when it is set to 1.
    Button,
}

impl Dial {
    /// The number nearest to `value` that this dial can be set to; `None` if that is none.
    fn nearest(&self, value: f64) -> Option<f64> {
        let value = Some(value).filter(|v| v.is_finite())?;
        match &self.setting {
            Setting::Number { range, step, .. } => {
                let whole = if *step > 0.0 { (value / step).round() * step } else { value };
                Some(whole.clamp(*range.start(), *range.end()))
            }
            Setting::Switch(_) => Some(f64::from(u8::from(value != 0.0))),
            Setting::Choice { names, .. } => {
                Some(value).filter(|v| v.fract() == 0.0 && *v >= 0.0 && *v < names.len() as f64)
            }
            Setting::Button => Some(1.0),
        }
    }
}

/// What was turned.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Turned {
    /// Nothing: dials are only listed.
    #[default]
    Nothing,
    /// A dial of this name, to a number; it may still be held.
    Dial(String, f64, bool),
    /// The dial of this key.
    Key(KeyCode),
}

/// The dials of a program, in a walk that lists all of them and sets the one that was turned: see
/// [`crate::window::Demo::dials`].
#[derive(Debug, Default)]
pub struct Dials {
    pub(crate) listed: Vec<Dial>,
    turned: Turned,
}

impl Dials {
    pub(crate) fn new(turned: Turned) -> Self {
        Self { listed: Vec::new(), turned }
    }

    /// Whether the dial that was turned is still held: what takes long can wait until it is let go.
    pub fn is_held(&self) -> bool {
        matches!(self.turned, Turned::Dial(_, _, true))
    }

    /// A number from a range. Whether it was turned.
    pub fn number(&mut self, name: &str, value: &mut f32, range: RangeInclusive<f32>) -> bool {
        let range = (*range.start()).into()..=(*range.end()).into();
        let turned = self.add(name, Setting::Number { value: (*value).into(), range, step: 0.0 }, &[]);
        turned.inspect(|turned| *value = *turned as f32).is_some()
    }

    /// A whole number from a range, in steps. Whether it was turned.
    pub fn whole(&mut self, name: &str, value: &mut u32, range: RangeInclusive<u32>, step: u32) -> bool {
        let range = (*range.start()).into()..=(*range.end()).into();
        let setting = Setting::Number { value: (*value).into(), range, step: step.into() };
        self.add(name, setting, &[]).inspect(|turned| *value = *turned as u32).is_some()
    }

    /// On or off, also by a key. Whether it was changed.
    pub fn switch(&mut self, name: &str, key: Option<KeyCode>, on: &mut bool) -> bool {
        let before = *on;
        *on = self.add(name, Setting::Switch(before), key.as_slice()).map_or(before, |turned| turned != 0.0);
        *on != before
    }

    /// One of several by its place, also by a key for each, or by one that chooses the next. Whether
    /// another was chosen.
    pub fn choice(
        &mut self,
        name: &str,
        keys: &[KeyCode],
        names: impl IntoIterator<Item = impl Into<String>>,
        chosen: &mut usize,
    ) -> bool {
        let (before, names) = (*chosen, names.into_iter().map(Into::into).collect());
        let turned = self.add(name, Setting::Choice { names, chosen: before }, keys);
        *chosen = turned.map_or(before, |turned| turned as usize);
        *chosen != before
    }

    /// Something to do, also by a key. Whether it is to be done.
    pub fn button(&mut self, name: &str, key: Option<KeyCode>) -> bool {
        self.add(name, Setting::Button, key.as_slice()).is_some()
    }

    /// Lists a dial. If it was turned, what to.
    fn add(&mut self, name: &str, setting: Setting, keys: &[KeyCode]) -> Option<f64> {
        let dial = Dial { name: name.to_owned(), setting };
        let value = match &self.turned {
            Turned::Dial(turned, value, _) if turned == name => dial.nearest(*value),
            Turned::Key(key) => keys.iter().position(|k| k == key).and_then(|place| match &dial.setting {
                Setting::Switch(on) => Some(f64::from(u8::from(!on))),
                Setting::Choice { names, chosen } if keys.len() == 1 => {
                    Some(((chosen + 1) % names.len()) as f64)
                }
                _ => dial.nearest(place as f64),
            }),
            _ => None,
        };
        self.listed.push(dial);
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number, a choice, a switch and a button: their values after something was turned.
    fn after(turned: Turned) -> (u32, usize, bool, bool) {
        let (mut samples, mut look, mut on) = (20_u32, 0, false);
        let mut dials = Dials::new(turned);
        dials.whole("samples", &mut samples, 8..=512, 4);
        dials.choice("look", &[KeyCode::Digit1, KeyCode::Digit2], ["plain", "lit"], &mut look);
        dials.switch("on", Some(KeyCode::Space), &mut on);
        let done = dials.button("go", Some(KeyCode::KeyG));
        assert_eq!(dials.listed.len(), 4);
        (samples, look, on, done)
    }

    #[test]
    fn dials_take_the_nearest_number_that_they_have_and_keys_turn_them() {
        let set = |name: &str, value| after(Turned::Dial(name.to_owned(), value, false));
        let before = after(Turned::Nothing);
        assert_eq!(before, (20, 0, false, false));
        assert_eq!([21.0, 1e9, -3.0].map(|wish| set("samples", wish).0), [20, 512, 8]);
        assert_eq!([1.0, 2.0, -1.0, 0.5].map(|wish| set("look", wish).1), [1, 0, 0, 0]);
        assert!(set("on", 7.0).2 && set("go", 1.0).3);
        for name in ["samples", "look", "on", "go", "none"] {
            assert_eq!([f64::NAN, f64::INFINITY].map(|wish| set(name, wish)), [before; 2], "{name}");
        }
        assert_eq!(after(Turned::Key(KeyCode::Digit2)), (20, 1, false, false));
        assert_eq!(after(Turned::Key(KeyCode::Space)), (20, 0, true, false));
        assert_eq!(after(Turned::Key(KeyCode::KeyG)), (20, 0, false, true));
    }
}

//! Settings of a program by their names, so that a window and a page show the same ones.

use std::ops::RangeInclusive;

/// A setting, and how it is set.
#[derive(Debug, Clone, PartialEq)]
pub struct Dial {
    /// Its name; no other dial of the program has it.
    pub name: String,
    /// The setting.
    pub setting: Setting,
}

/// How a dial is set. All are set by a number: see [`crate::window::Demo::set`].
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
    /// A number from a range.
    pub fn number(name: &str, value: impl Into<f64>, range: RangeInclusive<f64>, step: f64) -> Self {
        Self { name: name.to_owned(), setting: Setting::Number { value: value.into(), range, step } }
    }

    /// On or off.
    pub fn switch(name: &str, on: bool) -> Self {
        Self { name: name.to_owned(), setting: Setting::Switch(on) }
    }

    /// One of several.
    pub fn choice(name: &str, names: impl IntoIterator<Item = impl Into<String>>, chosen: usize) -> Self {
        let names = names.into_iter().map(Into::into).collect();
        Self { name: name.to_owned(), setting: Setting::Choice { names, chosen } }
    }

    /// Something to do.
    pub fn button(name: &str) -> Self {
        Self { name: name.to_owned(), setting: Setting::Button }
    }

    /// The number nearest to `value` that this dial can be set to; `None` if that is none.
    pub fn nearest(&self, value: f64) -> Option<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dials_take_the_nearest_number_that_they_have() {
        let number = Dial::number("samples", 20.0, 8.0..=512.0, 4.0);
        for (wish, taken) in [(21.0, 20.0), (1e9, 512.0), (-3.0, 8.0)] {
            assert_eq!(number.nearest(wish), Some(taken), "{wish}");
        }
        let choice = Dial::choice("look", ["plain", "lit"], 0);
        for (wish, taken) in [(1.0, Some(1.0)), (2.0, None), (-1.0, None), (0.5, None)] {
            assert_eq!(choice.nearest(wish), taken, "{wish}");
        }
        assert_eq!(Dial::switch("on", false).nearest(7.0), Some(1.0));
        for dial in [number, choice, Dial::switch("on", true), Dial::button("go")] {
            assert_eq!((dial.nearest(f64::NAN), dial.nearest(f64::INFINITY)), (None, None), "{dial:?}");
        }
    }
}

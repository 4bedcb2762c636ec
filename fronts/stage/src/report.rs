//! What programs say about themselves, for windows and pages to show.

use crate::dial::Dial;

/// What a program says about itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// What it says, line by line.
    pub lines: Vec<String>,
    /// The meanings of the colours.
    pub legend: Vec<Entry>,
    /// What can be set.
    pub dials: Vec<Dial>,
    /// What keys and mouse do. A page says it in its own words.
    pub keys: &'static str,
}

/// How a legend shows a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sample {
    /// A filled box.
    Area,
    /// A line.
    Line,
    /// A line around an area of another colour.
    Framed([u8; 3]),
}

/// An entry of a legend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Entry {
    /// Red, green, blue, opacity.
    pub colour: [u8; 4],
    /// How it is shown.
    pub sample: Sample,
    /// Its meaning.
    pub text: String,
}

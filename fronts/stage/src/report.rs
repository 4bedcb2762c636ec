//! What programs say about themselves, for windows and pages to show.

use crate::dial::Dial;
use crate::panel::Entry;

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

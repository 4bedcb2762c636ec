//! The laboratory: experiments whose results make up the report, `docs/report.md`.
//!
//! Each experiment is a function from a [`Lab`] to a [`Section`]: text, tables and charts.
//! [`write()`] puts sections together. What is compared goes through a [`Contender`], so that
//! the library and the methods of today's engines are measured by the same code.

mod against;
mod aggressive;
pub mod buffer;
pub mod coherence;
mod contender;
mod front;
#[cfg(feature = "light")]
pub mod light;
pub mod lines;
mod machine;
pub mod points;
pub mod reach;
mod report;
mod scaling;
mod section;
mod shadows;
pub mod sight;
mod stability;
mod stage;
mod thesis;
pub mod tradeoff;
mod upkeep;
mod walker;
mod worlds;

use std::path::PathBuf;

pub use against::against;
pub use aggressive::aggressive;
pub use contender::{Contender, FrameInput};
pub use front::{Cost, distance, front};
pub use report::{HEAD, ReportError, write};
pub use scaling::{Reach, scaling, scaling_to};
pub use section::{Block, Section, Table};
pub use shadows::shadows;
pub use stability::stability;
pub use thesis::thesis;
pub use tradeoff::tradeoff;
pub use upkeep::upkeep;

/// Why an experiment failed.
pub type LabError = Box<dyn std::error::Error + Send + Sync>;

/// An experiment: a section of the report.
pub type Experiment = fn(&Lab) -> Result<Section, LabError>;

/// All experiments by name, in the order of the report.
pub const EXPERIMENTS: &[(&str, Experiment)] = &[
    ("tradeoff", tradeoff),
    ("against", against),
    ("stability", stability),
    ("thesis", thesis),
    ("upkeep", upkeep),
    ("scaling", scaling),
    ("reach", reach::reach),
    ("coherence", coherence::coherence),
    ("sight", sight::sight),
    ("shadows", shadows),
    ("aggressive", aggressive),
];

/// Pictures are this many times as wide as high.
const ASPECT: f32 = 16.0 / 9.0;

/// What experiments are told.
pub struct Lab<'a> {
    /// Takes less of everything, for a smoke run; the figures are of no use then.
    pub quick: bool,
    /// Seed of all that is random.
    pub seed: u64,
    /// glTF files that join the procedural scenes.
    pub files: Vec<PathBuf>,
    /// The folder that charts and tables are written into.
    pub folder: PathBuf,
    /// Is told what is being done.
    pub progress: &'a dyn Fn(&str),
}

impl Lab<'_> {
    /// The first value in a full run, the second in a quick one.
    pub fn pick<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// A number with commas between its thousands.
fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// The median of some values, which are sorted; 0 of none.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The value that 99 of 100 of some values do not exceed; sorts them. 0 of none.
pub fn p99(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (values.len() * 99).div_ceil(100);
    rank.checked_sub(1).map_or(0.0, |i| values[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundredth_of_the_values_may_exceed_the_percentile() {
        let mut values: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        assert_eq!((p99(&mut values), median(&mut values)), (198.0, 101.0));
        assert_eq!((p99(&mut [3.0, 1.0]), p99(&mut [])), (3.0, 0.0));
    }

    #[test]
    fn thousands_are_grouped() {
        assert_eq!(
            [0, 999, 1000, 67_792, 1_000_000].map(grouped),
            ["0", "999", "1,000", "67,792", "1,000,000"]
        );
    }
}

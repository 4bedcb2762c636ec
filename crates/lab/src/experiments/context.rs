//! What experiments are told, the scenes that they walk through, and how figures of many values are
//! written.

use std::path::{Path, PathBuf};

use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::import;
use casca_scenes::world::World;

/// Why an experiment failed.
pub type LabError = Box<dyn std::error::Error + Send + Sync>;

/// Pictures are this many times as wide as high.
pub(crate) const ASPECT: f32 = 16.0 / 9.0;

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
    /// Gets a message at each step.
    pub progress: &'a dyn Fn(&str),
}

impl Lab<'_> {
    /// The first value in a full run, the second in a quick one.
    pub fn pick<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }
}

/// A scene to walk through, by name or file.
#[derive(Debug, Clone)]
pub(crate) enum Place<'a> {
    Built(SceneKind),
    File(&'a Path),
}

/// The procedural scenes of solids, then the files of the lab.
pub(crate) fn places<'a>(lab: &'a Lab) -> Vec<Place<'a>> {
    let built = SceneKind::SOLIDS.iter().copied().map(Place::Built);
    built.chain(lab.files.iter().map(|f| Place::File(f))).collect()
}

impl Place<'_> {
    /// Builds or loads it.
    ///
    /// # Errors
    /// As [`import::load`].
    pub(crate) fn open(&self, lab: &Lab) -> Result<World, LabError> {
        Ok(match self {
            Self::Built(kind) => build(*kind, &SceneOptions { seed: lab.seed, ..SceneOptions::default() }),
            Self::File(path) => import::load(path)?,
        })
    }
}

/// A number with commas between its thousands.
pub(crate) fn grouped(n: usize) -> String {
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

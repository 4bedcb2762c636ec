//! What the experiments share: their settings, rows, tables and charts.

use super::case::order_name;
use super::gather::Gather;
use super::metric::{Difference, less_noise};
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, Tile, lines};
use casca_scenes::lit::HdrImage;

/// Cells along an axis.
pub(super) const SIZES: [u32; 3] = [32, 64, 128];
/// Cells along an axis where something else varies.
pub(super) const MIDDLE: u32 = 64;
/// Steps of cones, in diameters: those of the thesis.
pub(super) const STEPS: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.5];
/// What all charts over cells have below.
pub(super) const BY_SIZE: &str = "N: voxels along an axis (logarithmic)";
pub(super) const BY_STEP: &str = "step of the cones, in diameters (logarithmic)";
pub(super) const BY_TIME: &str = "time for all pixels, ms (logarithmic)";
pub(super) const ERROR: &str = "error: RMSE less noise, over the mean of the truth";
pub(super) const FLIP: &str = "FLIP, 0 to 1";

/// A tile of a sheet.
pub(super) fn tile(caption: impl Into<String>, image: &HdrImage, exposure: f32) -> Tile {
    Tile { caption: caption.into(), width: image.size().0, rgb: image.srgb(exposure) }
}

/// A number of three digits; empty if it is not known.
pub(super) fn digits(value: f64) -> String {
    if value.is_nan() { String::new() } else { format!("{value:.3}") }
}

/// The mean of the values that are known.
pub(super) fn mean_of(values: impl Iterator<Item = f64>) -> f64 {
    let known: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    known.iter().sum::<f64>() / known.len().max(1) as f64
}

/// What a chart says.
pub(super) struct Words<'a> {
    pub(super) title: &'a str,
    pub(super) subtitle: &'a str,
    /// What the axis below counts.
    pub(super) across: &'a str,
    /// What the axis on the left counts.
    pub(super) up: &'a str,
}

/// Draws a chart with logarithmic numbers below and adds it to a section.
pub(super) fn chart(
    lab: &Lab,
    section: &mut Section,
    file: &str,
    words: &Words,
    all: &[Line],
) -> Result<(), LabError> {
    let axes = (&Axis::log(words.across), &Axis::linear(words.up));
    lines(&lab.folder.join(file), words.title, words.subtitle, axes, all)?;
    section.picture(file, words.title);
    Ok(())
}

/// The cones of charts by resolution.
pub(super) const CONES: Gather = Gather::Cones { count: 16, step: 0.5, corrected: true };
/// The walks beside them.
pub(super) const WALKS: Gather = Gather::Walks(64);

/// Light of one order in a scene by one way of gathering.
pub(super) struct Row {
    pub(super) scene: String,
    /// How often it was scattered.
    pub(super) order: u32,
    pub(super) n: u32,
    pub(super) gather: Gather,
    pub(super) difference: Difference,
    pub(super) noise: f64,
    /// Milliseconds for the voxels with their light, the pyramid, and the gathering for all pixels.
    pub(super) ms: [f64; 3],
}

impl Row {
    /// The error or, by its name, FLIP.
    pub(super) fn value(&self, measure: &str) -> f64 {
        if measure == "flip" { self.difference.flip } else { less_noise(self.difference.rmse, self.noise) }
    }
}

impl Gather {
    pub(super) fn words(&self) -> String {
        match self {
            Self::Cones { count, step, corrected } => {
                format!("{count} cones, step {step}{}", if *corrected { "" } else { ", not corrected" })
            }
            Self::Walks(count) => format!("{count} walks"),
        }
    }
}

pub(super) fn table(name: &str, rows: &[Row]) -> Table {
    let columns = [
        "scene",
        "light",
        "N",
        "gathered by",
        "error",
        "RMSE",
        "noise",
        "FLIP",
        "voxels, ms",
        "pyramid, ms",
        "gather, ms",
    ];
    let mut table = Table::new(name, &columns);
    for r in rows {
        let light = order_name(r.order).to_owned();
        let first = [r.scene.clone(), light, r.n.to_string(), r.gather.words()];
        let last = [r.value("error"), r.difference.rmse, r.noise, r.difference.flip].map(digits);
        table.row(first.into_iter().chain(last).chain(r.ms.map(|v| format!("{v:.1}"))));
    }
    table
}

//! Estimates beside rays: how well they agree.

use casca_lines::occlusion::{AoOptions, BasePlane, Estimator};
use casca_lines::sets::generate::Family;
use casca_lines::slabs::Slices;

use super::case::{Case, SAMPLES, Sampling, Way};
use super::score::{Score, mean};
use crate::experiments::{LabError, Table};

/// The rows of a grid that is coarser than the picture: less noise where lines are thin, less
/// detail where they are dense.
pub const FEW_ROWS: u32 = 192;

/// The sets that are compared.
pub const FAMILIES: [Family; 5] =
    [Family::Spiral, Family::PomPom, Family::Reservoir, Family::Abc, Family::Parallel];

/// The agreement of one estimator on one set.
#[derive(Debug, Clone)]
pub struct Agreement {
    /// The set.
    pub family: Family,
    /// The estimator's name.
    pub way: String,
    /// Rows of columns in the grid, and slices of a column.
    pub grid: (u32, u32),
    /// The factor or k; `None` if there is nothing to fit.
    pub fitted: Option<f32>,
    /// The agreement with rays.
    pub score: Score,
    /// The mean of the estimates.
    pub mean: f64,
    /// The mean of the rays.
    pub truth: f64,
    /// Microseconds for a pixel, on one thread.
    pub micros: f64,
}

/// All estimators on one set.
///
/// # Errors
/// If the library refuses a value.
pub fn compare(family: Family, case: &Case, sampling: &Sampling) -> Result<Vec<Agreement>, LabError> {
    let samples = Case::samples(SAMPLES, sampling.seed)?;
    let mut rows = Vec::new();
    let fine = (sampling.canvas, Slices::S128);
    let few = FEW_ROWS.min(sampling.canvas);
    let mut tries: Vec<(Way, u32, Slices, BasePlane)> =
        Way::ALL.map(|w| (w, fine.0, fine.1, BasePlane::Tangent)).to_vec();
    tries.insert(1, (Way::MeanOfRatios, fine.0, fine.1, BasePlane::ThesisSign));
    tries.push((Way::OpticalDepth, few, Slices::S128, BasePlane::Tangent));
    tries.push((Way::OpticalDepth, few, Slices::S256, BasePlane::Tangent));
    tries.push((Way::OpticalDepth, (few / 3).max(1), Slices::S128, BasePlane::Tangent));
    for (way, height, slices, plane) in tries {
        let grid = case.grid(height, slices)?;
        let options = AoOptions { plane, ..case.fitted(&grid, &samples, way)? };
        let (values, micros) = Case::estimate(&grid, &samples, options, &case.receivers, sampling.seconds)?;
        let fitted = match options.estimator {
            Estimator::MeanOfRatios { factor } | Estimator::RatioOfSums { factor } => Some(factor),
            Estimator::Extinction { k } => Some(k),
            Estimator::OpticalDepth { .. } | Estimator::Rays { .. } | Estimator::Places { .. } => None,
        };
        let sign = if plane == BasePlane::ThesisSign { ", literal sign" } else { "" };
        rows.push(Agreement {
            family,
            way: format!("{}{sign}", way.name()),
            grid: (height, slices.count()),
            fitted,
            score: Score::of(&values, &case.truth),
            mean: mean(&values),
            truth: mean(&case.truth),
            micros,
        });
    }
    Ok(rows)
}

/// A row for each estimator on each set.
pub fn table(rows: &[Agreement]) -> Table {
    let columns = [
        "set",
        "estimator",
        "rows",
        "slices",
        "fitted",
        "Pearson",
        "Spearman",
        "RMSE",
        "mean",
        "mean of rays",
        "µs a pixel",
        "nearest",
    ];
    let mut table = Table::new("lines", &columns);
    for row in rows {
        let best = nearest(rows, row.family).is_some_and(|n| std::ptr::eq(n, row));
        table.row([
            row.family.name().to_owned(),
            row.way.clone(),
            row.grid.0.to_string(),
            row.grid.1.to_string(),
            row.fitted.map_or(String::new(), |f| format!("{f:.2}")),
            format!("{:.3}", row.score.pearson),
            format!("{:.3}", row.score.spearman),
            format!("{:.3}", row.score.rmse),
            format!("{:.3}", row.mean),
            format!("{:.3}", row.truth),
            format!("{:.1}", row.micros),
            if best { "yes" } else { "" }.to_owned(),
        ]);
    }
    table
}

/// What the table says.
pub fn finding(rows: &[Agreement], sampling: &Sampling) -> String {
    let said = FAMILIES.iter().filter_map(|&f| nearest(rows, f)).map(|r| {
        let Agreement { family, way, grid: (height, slices), score, .. } = r;
        format!(
            "{}: {:.3}, {:.3} ({way}, {height} rows, {slices} slices)",
            family.name(),
            score.pearson,
            score.rmse
        )
    });
    format!(
        "The occlusion at up to {} pixels of {} x {} against {} cosine-weighted rays at each, of the length of the hemisphere's \
         radius ({} of the extent), in tubes of half a pixel. `fitted` is the factor or k of least RMSE on the same set; the optical \
         depth has none. `nearest` marks the least RMSE of a set. Pearson and RMSE of that row: **{}**.",
        sampling.receivers,
        sampling.canvas,
        sampling.canvas,
        sampling.rays * sampling.rays,
        super::case::RADIUS,
        said.collect::<Vec<_>>().join("; "),
    )
}

/// The row of a set with the least RMSE.
pub fn nearest(rows: &[Agreement], family: Family) -> Option<&Agreement> {
    let of = rows.iter().filter(|r| r.family == family);
    of.min_by(|a, b| a.score.rmse.total_cmp(&b.score.rmse))
}

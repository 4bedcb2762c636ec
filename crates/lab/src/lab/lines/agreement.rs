//! Estimates beside rays: their agreement and their times.

use casca_lines::generate::Family;
use casca_lines::occlusion::{AoOptions, BasePlane, Estimator};
use casca_lines::slabs::Slices;

use super::case::{Case, Effort, SAMPLES, Way};
use super::score::{Score, mean, rmse, straight_line};
use crate::lab::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, lines as line_chart, palette};

/// The rows of a grid that is coarser than the picture: less noise where lines are thin, less detail where they are dense.
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
pub fn compare(family: Family, case: &Case, effort: &Effort) -> Result<Vec<Agreement>, LabError> {
    let samples = Case::samples(SAMPLES, effort.seed)?;
    let mut rows = Vec::new();
    let fine = (effort.canvas, Slices::S128);
    let few = FEW_ROWS.min(effort.canvas);
    let mut tries: Vec<(Way, u32, Slices, BasePlane)> =
        Way::ALL.map(|w| (w, fine.0, fine.1, BasePlane::Tangent)).to_vec();
    tries.insert(1, (Way::MeanOfRatios, fine.0, fine.1, BasePlane::ThesisSign));
    tries.push((Way::OpticalDepth, few, Slices::S128, BasePlane::Tangent));
    tries.push((Way::OpticalDepth, few, Slices::S256, BasePlane::Tangent));
    tries.push((Way::OpticalDepth, (few / 3).max(1), Slices::S128, BasePlane::Tangent));
    for (way, height, slices, plane) in tries {
        let grid = case.grid(height, slices)?;
        let options = AoOptions { plane, ..case.fitted(&grid, &samples, way)? };
        let (values, micros) = Case::estimate(&grid, &samples, options, &case.receivers, effort.repeats)?;
        let fitted = match options.estimator {
            Estimator::MeanOfRatios { factor } | Estimator::RatioOfSums { factor } => Some(factor),
            Estimator::Extinction { k } => Some(k),
            Estimator::OpticalDepth { .. } => None,
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
    ];
    let mut table = Table::new("lines", &columns);
    for row in rows {
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
        ]);
    }
    table
}

/// What the table says.
pub fn finding(rows: &[Agreement], effort: &Effort) -> String {
    let best = |family: Family| {
        let of = rows.iter().filter(|r| r.family == family);
        of.min_by(|a, b| a.score.rmse.total_cmp(&b.score.rmse))
    };
    let said = FAMILIES
        .iter()
        .filter_map(|&f| best(f))
        .map(|r| format!("{} {:.3} and {:.3}", r.family.name(), r.score.pearson, r.score.rmse));
    format!(
        "The occlusion at up to {} pixels of {} x {} against {} cosine-weighted rays at each, of the length of the hemisphere's \
         radius ({} of the extent), in tubes of half a pixel. `fitted` is the factor or k of least RMSE on the same set; the optical \
         depth has none. Pearson and RMSE of the best estimator: **{}**.",
        effort.receivers,
        effort.canvas,
        effort.canvas,
        effort.rays * effort.rays,
        super::case::RADIUS,
        said.collect::<Vec<_>>().join(", "),
    )
}

/// Errors and times by the number of samples, as a table and two charts.
///
/// # Errors
/// If the library refuses a value, or a file cannot be written.
pub fn by_samples(lab: &Lab, case: &Case, effort: &Effort, section: &mut Section) -> Result<(), LabError> {
    let numbers: &[u32] =
        if lab.quick { &[8, 32, SAMPLES] } else { &[8, 16, 32, 64, 96, 128, SAMPLES, 256, 512] };
    let columns = ["estimator", "samples", "RMSE to 3000 samples", "RMSE to rays", "µs a pixel"];
    let mut table = Table::new("lines_samples", &columns);
    let (mut by_time, mut by_number, mut words) = (Vec::new(), Vec::new(), Vec::new());
    let (mut nearest, mut powers) = (Vec::new(), Vec::new());
    for (number, way) in [Way::MeanOfRatios, Way::Extinction, Way::OpticalDepth].into_iter().enumerate() {
        let rows = if way == Way::OpticalDepth { FEW_ROWS.min(effort.canvas) } else { effort.canvas };
        let grid = case.grid(rows, Slices::S128)?;
        let options = case.fitted(&grid, &Case::samples(SAMPLES, effort.seed)?, way)?;
        let many = Case::samples(lab.pick(3000, 600), effort.seed + 1)?;
        let (reference, _) = Case::estimate(&grid, &many, options, &case.receivers, 1)?;
        let (mut errors, mut truths, mut times) = (Vec::new(), Vec::new(), Vec::new());
        for &n in numbers {
            let samples = Case::samples(n, effort.seed)?;
            let (values, micros) = Case::estimate(&grid, &samples, options, &case.receivers, effort.repeats)?;
            let (own, true_one) = (rmse(&values, &reference), rmse(&values, &case.truth));
            table.row([
                way.name().to_owned(),
                n.to_string(),
                format!("{own:.4}"),
                format!("{true_one:.4}"),
                format!("{micros:.1}"),
            ]);
            if n == SAMPLES {
                nearest.push(format!("{} {true_one:.3}", way.name()));
            }
            errors.push((f64::from(n), own));
            truths.push((micros, true_one));
            times.push((f64::from(n), micros));
        }
        let logs: Vec<(f64, f64)> = errors.iter().map(|(n, e)| (n.ln(), e.max(1e-9).ln())).collect();
        let (offset, slope, share) = straight_line(&times);
        let power = straight_line(&logs).1;
        words.push(format!("{}: N^{power:.2}, {offset:.1} + {slope:.3} N µs (r² {share:.3})", way.name()));
        powers.push(format!("{} N^{power:.2}", way.name()));
        by_time.push(Line::new(way.name(), palette::other(number), truths));
        by_number.push(Line::new(way.name(), palette::other(number), errors));
    }
    section.text(format!(
        "Noise against the number N of samples (the root of the mean square of the differences from 3000 samples), and the time \
         of a pixel. Powers of N and straight lines of least squares: **{}**.",
        words.join("; ")
    ));
    section.rows("all numbers of samples", table);
    line_chart(
        &lab.folder.join("lines_error_by_time.svg"),
        &format!("Difference from rays with {SAMPLES} samples: {}", nearest.join(", ")),
        "Spiral. Root mean square difference from rays (RMSE) against the time of a pixel on one thread, 8 to 512 samples.",
        (&Axis::log("µs a pixel"), &Axis::linear("RMSE to rays")),
        &by_time,
    )?;
    section.picture(
        "lines_error_by_time.svg",
        "The error to rays against the time of a pixel, for three estimators and 8 to 512 samples.",
    );
    line_chart(
        &lab.folder.join("lines_error_by_samples.svg"),
        &format!("Noise falls with the number N of samples: {}", powers.join(", ")),
        "Spiral. Root mean square difference from the same estimator with 3000 samples.",
        (&Axis::log("samples"), &Axis::log("RMSE to 3000 samples")),
        &by_number,
    )?;
    section.picture("lines_error_by_samples.svg", "The noise against the number of samples.");
    Ok(())
}

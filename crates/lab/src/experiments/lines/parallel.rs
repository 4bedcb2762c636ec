//! The known failure: lines along the view, by the width of the columns.

use casca_lines::sets::generate::Family;
use casca_lines::slabs::Slices;

use super::case::{Case, SAMPLES, Sampling, Way};
use super::score::Score;
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, lines as line_chart, palette};

/// What one estimator makes of a set.
struct Rows {
    /// Rows of the grid, and Pearson.
    points: Vec<(f64, f64)>,
    /// What the text says of lines along the view.
    said: Vec<String>,
}

/// The agreement of an estimator with rays on a set, by the rows of the grid.
fn measure(
    family: Family,
    case: &Case,
    way: Way,
    sampling: &Sampling,
    shares: &[u32],
    table: &mut Table,
) -> Result<Rows, LabError> {
    let samples = Case::samples(SAMPLES, sampling.seed)?;
    let mut said = Vec::new();
    let mut points = Vec::new();
    let mut best: Option<(u32, Score)> = None;
    for rows in shares.iter().map(|s| (sampling.canvas / s).max(1)) {
        let grid = case.grid(rows, Slices::S128)?;
        let options = case.fitted(&grid, &samples, way)?;
        let (values, _) = Case::estimate(&grid, &samples, options, &case.receivers, 0.0)?;
        let score = Score::of(&values, &case.truth);
        table.row([
            family.name().to_owned(),
            way.name().to_owned(),
            rows.to_string(),
            format!("{:.3}", score.pearson),
            format!("{:.3}", score.spearman),
            format!("{:.3}", score.rmse),
            format!("{:.3}", super::score::mean(&values)),
            format!("{:.3}", super::score::mean(&case.truth)),
        ]);
        points.push((f64::from(rows), score.pearson));
        if best.is_none_or(|(_, b)| score.pearson > b.pearson) {
            best = Some((rows, score));
        }
        if family == Family::Parallel && rows == sampling.canvas {
            said.push(format!("{} at {rows} rows: {:.3} and {:.3}", way.name(), score.pearson, score.rmse));
        }
    }
    if let (Family::Parallel, Some((rows, b))) = (family, best) {
        said.push(format!(
            "{} at its highest Pearson, {rows} rows: {:.3} and {:.3}",
            way.name(),
            b.pearson,
            b.rmse
        ));
    }
    Ok(Rows { points, said })
}

/// The agreement of estimators with rays by the rows of the grid, on lines along the view and on
/// another set.
///
/// # Errors
/// If the library refuses a value, or a chart cannot be written.
pub fn by_rows(
    lab: &Lab,
    [parallel, other]: [&Case; 2],
    sampling: &Sampling,
    section: &mut Section,
) -> Result<(), LabError> {
    let shares: &[u32] = if lab.quick { &[1, 3] } else { &[1, 2, 3, 4, 6, 8, 12, 16, 24] };
    let columns = ["set", "estimator", "rows", "Pearson", "Spearman", "RMSE", "mean", "mean of rays"];
    let mut table = Table::new("lines_by_rows", &columns);
    let mut drawn = Vec::new();
    let mut said = Vec::new();
    let sets = [(Family::Parallel, parallel), (Family::Spiral, other)];
    for (number, (family, case)) in sets.into_iter().enumerate() {
        for (way, style) in [
            (Way::MeanOfRatios, palette::other(2 * number).dashed()),
            (Way::OpticalDepth, palette::other(2 * number + 1)),
        ] {
            let rows = measure(family, case, way, sampling, shares, &mut table)?;
            said.extend(rows.said);
            drawn.push(Line::new(format!("{}, {}", family.name(), way.name()), style, rows.points));
        }
    }
    section.text(format!(
        "The known failure: lines along the view. Each lies in one column of the grid; columns of a pixel are so narrow that few \
         samples meet a line. Wider columns mend it. Pearson and RMSE on these lines, by the rows of the grid (the thesis' factor is fitted \
         anew for each grid): **{}**. The other set \
         shows what wider columns cost where lines run in all directions.",
        said.join("; ")
    ));
    section.table(table);
    line_chart(
        &lab.folder.join("lines_by_rows.svg"),
        "Lines along the view need wide columns; a spiral loses by very wide ones",
        &format!(
            "Correlation with rays (Pearson) against the rows of the grid, {SAMPLES} samples; the picture has {} rows.",
            sampling.canvas
        ),
        (&Axis::log("rows of the grid"), &Axis::linear("Pearson")),
        &drawn,
    )?;
    section.picture(
        "lines_by_rows.svg",
        "The correlation with rays against the rows of the grid, for lines along the view and a spiral.",
    );
    Ok(())
}

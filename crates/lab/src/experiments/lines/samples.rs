//! Noise and time by the number of samples.

use casca_lines::slabs::Slices;

use super::agreement::FEW_ROWS;
use super::case::{Case, SAMPLES, Sampling, Way};
use super::score::{rmse, straight_line};
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, lines as line_chart, palette};

/// One estimator by the number of samples.
struct Series {
    /// Samples and the root of the mean square of the differences from very many samples.
    errors: Vec<(f64, f64)>,
    /// Microseconds of a pixel and the error to rays.
    truths: Vec<(f64, f64)>,
    /// Samples and microseconds of a pixel.
    times: Vec<(f64, f64)>,
    /// The error to rays with the usual number of samples, in words.
    nearest: String,
}

/// Numbers of samples: those that are tried, and the one that they are compared with.
struct Numbers<'a> {
    few: &'a [u32],
    most: u32,
}

/// Measures an estimator with several numbers of samples.
fn measure(
    case: &Case,
    way: Way,
    sampling: &Sampling,
    numbers: &Numbers,
    table: &mut Table,
) -> Result<Series, LabError> {
    let name = way.name();
    let rows = if way == Way::OpticalDepth { FEW_ROWS.min(sampling.canvas) } else { sampling.canvas };
    let grid = case.grid(rows, Slices::S128)?;
    let options = case.fitted(&grid, &Case::samples(SAMPLES, sampling.seed)?, way)?;
    let many = Case::samples(numbers.most, sampling.seed + 1)?;
    let (reference, _) = Case::estimate(&grid, &many, options, &case.receivers, 0.0)?;
    let (mut errors, mut truths, mut times) = (Vec::new(), Vec::new(), Vec::new());
    let mut nearest = String::new();
    for &n in numbers.few {
        let samples = Case::samples(n, sampling.seed)?;
        let (values, micros) = Case::estimate(&grid, &samples, options, &case.receivers, sampling.seconds)?;
        let (own, true_one) = (rmse(&values, &reference), rmse(&values, &case.truth));
        let numbers = [format!("{own:.4}"), format!("{true_one:.4}"), format!("{micros:.1}")];
        table.row([name.to_owned(), n.to_string()].into_iter().chain(numbers));
        if n == SAMPLES {
            nearest = format!("{name} {true_one:.3}");
        }
        errors.push((f64::from(n), own));
        truths.push((micros, true_one));
        times.push((f64::from(n), micros));
    }
    Ok(Series { errors, truths, times, nearest })
}

/// Errors and times by the number of samples, as a table and three charts.
///
/// # Errors
/// If the library refuses a value, or a file cannot be written.
pub fn by_samples(
    lab: &Lab,
    case: &Case,
    sampling: &Sampling,
    section: &mut Section,
) -> Result<(), LabError> {
    let numbers: &[u32] =
        if lab.quick { &[8, 32, SAMPLES] } else { &[8, 16, 32, 64, 96, 128, SAMPLES, 256, 512] };
    let most = lab.pick(3000, 600);
    let noise = format!("RMSE to {most} samples");
    let mut table =
        Table::new("lines_samples", &["estimator", "samples", &noise, "RMSE to rays", "µs a pixel"]);
    let (mut by_time, mut by_number, mut time_by_number) = (Vec::new(), Vec::new(), Vec::new());
    let (mut words, mut nearest, mut powers, mut slopes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (number, way) in [Way::MeanOfRatios, Way::Extinction, Way::OpticalDepth].into_iter().enumerate() {
        let (name, style) = (way.name(), palette::other(number));
        let Series { errors, truths, times, nearest: near } =
            measure(case, way, sampling, &Numbers { few: numbers, most }, &mut table)?;
        nearest.push(near);
        let logs: Vec<(f64, f64)> = errors.iter().map(|(n, e)| (n.ln(), e.max(1e-9).ln())).collect();
        let (offset, slope, share) = straight_line(&times);
        let power = straight_line(&logs).1;
        words.push(format!("{name}: N^{power:.2}, {offset:.1} + {slope:.3} N µs (r² {share:.4})"));
        powers.push(format!("{name} N^{power:.2}"));
        slopes.push(format!("{name} {offset:.1} + {slope:.3} N"));
        by_time.push(Line::new(name, style, truths));
        by_number.push(Line::new(name, style, errors));
        time_by_number.push(Line::new(name, style, times));
    }
    section.text(format!(
        "Noise against the number N of samples (the root of the mean square of the differences from {most} samples), and the time \
         of a pixel. Powers of N and straight lines of least squares: **{}**.",
        words.join("; ")
    ));
    section.rows("all numbers of samples", table);
    let range = format!("{} to {} samples", numbers[0], numbers[numbers.len() - 1]);
    let mut chart =
        |file: &str, title: String, about: String, axes: (Axis, Axis), drawn: &[Line], caption: &str| {
            section.picture(file, caption);
            line_chart(&lab.folder.join(file), &title, &about, (&axes.0, &axes.1), drawn)
        };
    chart(
        "lines_error_by_time.svg",
        format!("Difference from rays with {SAMPLES} samples: {}", nearest.join(", ")),
        format!("Spiral. RMSE to rays against the time of a pixel on one thread, {range}."),
        (Axis::log("µs a pixel"), Axis::linear("RMSE to rays")),
        &by_time,
        "The error to rays against the time of a pixel, for three estimators.",
    )?;
    chart(
        "lines_error_by_samples.svg",
        format!("Noise falls with the number N of samples: {}", powers.join(", ")),
        format!("Spiral. RMSE to the same estimator with {most} samples."),
        (Axis::log("samples"), Axis::log(&noise)),
        &by_number,
        "The noise against the number of samples.",
    )?;
    chart(
        "lines_time_by_samples.svg",
        format!("Time is a straight line in the number N of samples: {} µs", slopes.join(", ")),
        format!("Spiral. Time of a pixel on one thread, {range}."),
        (Axis::linear("samples"), Axis::linear("µs a pixel")),
        &time_by_number,
        "The time of a pixel against the number of samples.",
    )?;
    Ok(())
}

//! How much an estimate changes when nothing changes but the grid, the zoom, or the place of the
//! picture.

use casca_lines::occlusion::{AoOptions, SetChoice};
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::{Lens, View};
use glam::{DMat4, DQuat, DVec3};

use super::agreement::FEW_ROWS;
use super::case::{Case, Receiver, SAMPLES, Sampling, Way};
use super::score::{mean, rmse};
use crate::experiments::{Lab, LabError, Section, Table};
use crate::pictures::{Axis, Line, lines as line_chart, palette};

/// A method whose stability is measured.
struct Method {
    name: &'static str,
    options: AoOptions,
    /// Rows of the grid; `None` for those of the picture.
    rows: Option<u32>,
}

fn methods(case: &Case, sampling: &Sampling) -> Result<Vec<Method>, LabError> {
    let samples = Case::samples(SAMPLES, sampling.seed)?;
    let thesis = case.fitted(&case.grid(sampling.canvas, Slices::S128)?, &samples, Way::MeanOfRatios)?;
    let best = AoOptions::new(case.radius, case.line_radius);
    let screen = AoOptions { choice: SetChoice::Screen, ..thesis };
    Ok(vec![
        Method { name: "thesis", options: screen, rows: None },
        Method { name: "thesis, sets by the surface", options: thesis, rows: None },
        Method { name: "optical depth", options: best, rows: None },
        Method { name: "optical depth, few rows", options: best, rows: Some(FEW_ROWS.min(sampling.canvas)) },
    ])
}

/// Receivers of one view in the eye space of another, as far as it shows them.
fn seen(case: &Case, view: &View) -> Vec<Option<Receiver>> {
    let change = view.eye_from_world() * case.view.eye_from_world().inverse();
    let place = |(_, f): &Receiver| {
        let mut f = *f;
        f.position = change.transform_point3(f.position.as_dvec3()).as_vec3();
        f.tangent = (change.matrix3 * f.tangent.as_dvec3()).as_vec3();
        view.pixel(f.position).map(|pixel| (pixel, f))
    };
    case.receivers.iter().map(place).collect()
}

fn turned(view: &View, degrees: f64) -> Result<View, LabError> {
    // About the upward direction, through the middle of the scene.
    let middle = DVec3::new(0.0, 0.0, -(view.depths()[0] + view.depths()[1]) / 2.0);
    let turn = DMat4::from_quat(DQuat::from_rotation_y(degrees.to_radians()));
    let about = DMat4::from_translation(middle) * turn * DMat4::from_translation(-middle);
    Ok(View::new(about * DMat4::from(view.eye_from_world()), view.lens(), view.depths(), view.size())?)
}

fn zoomed(view: &View, times: f64) -> Result<View, LabError> {
    let lens = match view.lens() {
        Lens::Orthographic { half_height } => Lens::Orthographic { half_height: half_height / times },
        Lens::Perspective { fov_y } => Lens::Perspective { fov_y: fov_y / times },
    };
    Ok(View::new(DMat4::from(view.eye_from_world()), lens, view.depths(), view.size())?)
}

/// The estimates of a method at receivers of a view.
fn estimates(
    case: &Case,
    method: &Method,
    view: &View,
    receivers: &[Receiver],
    seed: u64,
) -> Result<Vec<f64>, LabError> {
    let coarse = view.with_height(method.rows.unwrap_or(view.size()[1]))?;
    let grid = SlabGrid::of_lines(&case.lines, &coarse, Slices::S128, SpanRule::Span);
    Ok(Case::estimate(&grid, &Case::samples(SAMPLES, seed)?, method.options, receivers, 0.0)?.0)
}

/// Receivers that two views show, in both.
fn pairs(case: &Case, view: &View) -> (Vec<Receiver>, Vec<Receiver>) {
    let now = seen(case, view);
    case.receivers.iter().zip(&now).filter_map(|(a, b)| Some((*a, (*b)?))).unzip()
}

/// Adds tables and charts: means by the grid and the zoom, changes by motion, and flicker.
///
/// # Errors
/// If the library refuses a value, or a chart cannot be written.
pub fn stability(lab: &Lab, case: &Case, sampling: &Sampling, section: &mut Section) -> Result<(), LabError> {
    let methods = methods(case, sampling)?;
    by_grid(lab, case, sampling, &methods, section)?;
    by_zoom(case, sampling, &methods, section)?;
    by_motion(case, sampling, &methods, section)?;
    flicker(lab, case, sampling, &methods, section)
}

fn by_grid(
    lab: &Lab,
    case: &Case,
    sampling: &Sampling,
    methods: &[Method],
    section: &mut Section,
) -> Result<(), LabError> {
    let samples = Case::samples(SAMPLES, sampling.seed)?;
    let c = sampling.canvas;
    let grids = [
        (c / 4, Slices::S128),
        (c / 2, Slices::S128),
        (c, Slices::S128),
        (2 * c, Slices::S128),
        (4 * c, Slices::S128),
        (c, Slices::S256),
    ];
    let mut table = Table::new("lines_by_grid", &["rows", "slices", "thesis", "optical depth"]);
    let mut means = Vec::new();
    for (height, slices) in grids {
        let grid = case.grid(height, slices)?;
        let of = |m: &Method| -> Result<f64, LabError> {
            Ok(mean(&Case::estimate(&grid, &samples, m.options, &case.receivers, 0.0)?.0))
        };
        let both = [of(&methods[0])?, of(&methods[2])?];
        let cells = [height.to_string(), slices.count().to_string()];
        table.row(cells.into_iter().chain(both.map(|m| format!("{m:.3}"))));
        means.push((height, slices, both));
    }
    let spread = |i: usize| {
        let values = means.iter().map(|m| m.2[i]);
        values.clone().fold(0.0, f64::max) / values.fold(f64::MAX, f64::min).max(1e-9)
    };
    let truth = mean(&case.truth);
    section.text(format!(
        "Mean occlusion at the same points of the spiral by grids of other rows and slices, with nothing else changed; rays give \
         {truth:.3}. **The greatest mean over the least: {:.2} with the thesis' shares, {:.2} with lengths.**",
        spread(0),
        spread(1)
    ));
    section.table(table);
    let line = |i: usize, name: &str| {
        let some = means.iter().filter(|m| m.1 == Slices::S128);
        Line::new(name, palette::other(i), some.map(|m| (f64::from(m.0), m.2[i])).collect())
    };
    let rays = (c / 4, 4 * c);
    let rays = Line::new(
        "rays",
        palette::EXACT.dashed(),
        vec![(f64::from(rays.0), truth), (f64::from(rays.1), truth)],
    );
    line_chart(
        &lab.folder.join("lines_mean_by_rows.svg"),
        "Shares of set slices fade with a finer grid; lengths hardly do",
        "Spiral. Mean occlusion at the same points, 128 slices; the factor of the thesis' shares is fitted at one grid.",
        (&Axis::log("rows of the grid"), &Axis::linear("mean occlusion")),
        &[line(0, "thesis"), line(1, "optical depth"), rays],
    )?;
    section.picture("lines_mean_by_rows.svg", "The mean occlusion against the rows of the grid.");
    Ok(())
}

fn by_zoom(
    case: &Case,
    sampling: &Sampling,
    methods: &[Method],
    section: &mut Section,
) -> Result<(), LabError> {
    let mut columns = vec!["zoom", "points"];
    columns.extend(methods.iter().map(|m| m.name));
    let mut table = Table::new("lines_by_zoom", &columns);
    for times in [0.5, 1.0, 2.0, 4.0] {
        let view = zoomed(&case.view, times)?;
        let (before, after) = pairs(case, &view);
        let mut row = vec![times.to_string(), before.len().to_string()];
        for method in methods {
            let old = mean(&estimates(case, method, &case.view, &before, sampling.seed)?);
            let new = mean(&estimates(case, method, &view, &after, sampling.seed)?);
            row.push(format!("{:.2}", new / old.max(1e-9)));
        }
        table.row(row);
    }
    section.text(
        "The mean occlusion after a zoom over that before it, at the points of the spiral that both views show. The lines and their \
         radius stay the same, so that rays would give 1.",
    );
    section.table(table);
    Ok(())
}

fn by_motion(
    case: &Case,
    sampling: &Sampling,
    methods: &[Method],
    section: &mut Section,
) -> Result<(), LabError> {
    let views = [
        ("a pixel to the right", case.view.moved_by_pixels(1.0, 0.0)),
        ("3 pixels and 5 rows", case.view.moved_by_pixels(3.0, 5.0)),
        ("a third of a pixel", case.view.moved_by_pixels(0.33, 0.0)),
        ("turned by 0.2°", turned(&case.view, 0.2)?),
        ("turned by 10°", turned(&case.view, 10.0)?),
        ("zoomed to twice the size", zoomed(&case.view, 2.0)?),
        ("twice the rows", case.view.with_height(2 * sampling.canvas)?),
    ];
    let mut columns = vec!["change"];
    columns.extend(methods.iter().map(|m| m.name));
    columns.push("rays");
    let mut table = Table::new("lines_motion", &columns);
    for (name, view) in views {
        let (before, after) = pairs(case, &view);
        let mut row = vec![name.to_owned()];
        for method in methods {
            let old = estimates(case, method, &case.view, &before, sampling.seed)?;
            row.push(format!("{:.3}", rmse(&old, &estimates(case, method, &view, &after, sampling.seed)?)));
        }
        let rays = rmse(&case.rays(&case.view, &before, sampling), &case.rays(&view, &after, sampling));
        row.push(format!("{rays:.3}"));
        table.row(row);
    }
    section.text(
        "Change of the occlusion at the same points of the spiral from one frame to the next (root of the mean square) when the view \
         moves. Where columns are a pixel wide, whole pixels change nothing but the numbers of pixels: all that changes then is \
         flicker. Columns of few rows are wider: lines fall into other parts of them. Rays change only where \
         the hemisphere turns with the viewer.",
    );
    section.table(table);
    Ok(())
}

/// The change since the first frame while the picture slides over the scene.
fn flicker(
    lab: &Lab,
    case: &Case,
    sampling: &Sampling,
    methods: &[Method],
    section: &mut Section,
) -> Result<(), LabError> {
    let steps = lab.pick(12, 2);
    let mut table = Table::new("lines_flicker", &["method", "pixels", "change"]);
    let mut drawn = Vec::new();
    for (number, method) in methods.iter().enumerate() {
        let mut points = vec![(0.0, 0.0)];
        for step in 1..=steps {
            let pixels = f64::from(step) / 4.0;
            let view = case.view.moved_by_pixels(pixels, 0.0);
            let (before, after) = pairs(case, &view);
            let old = estimates(case, method, &case.view, &before, sampling.seed)?;
            let change = rmse(&old, &estimates(case, method, &view, &after, sampling.seed)?);
            table.row([method.name.to_owned(), pixels.to_string(), format!("{change:.4}")]);
            points.push((pixels, change));
        }
        drawn.push(Line::new(method.name, palette::other(number), points));
    }
    section.text(
        "The change since the first frame while the picture slides sideways by quarters of a pixel. The thesis chooses the set of \
         samples by the pixel: a line that reaches the next pixel gets another set, and its noise changes. Chosen by the line and the \
         place along it, the set stays. Between whole pixels the grid cuts lines anew; that change is left in all methods.",
    );
    section.rows("the change of each step of a slow motion", table);
    line_chart(
        &lab.folder.join("lines_flicker.svg"),
        "Samples chosen by the pixel keep changing; samples chosen by the line repeat at whole pixels",
        "Spiral. Change of the occlusion since the first frame at the same points, while the picture slides sideways.",
        (&Axis::linear("pixels"), &Axis::linear("RMS change")),
        &drawn,
    )?;
    section
        .picture("lines_flicker.svg", "The change of the occlusion while the picture slides over the scene.");
    Ok(())
}

//! How much an estimate changes when nothing changes but the grid, the zoom, or the place of the picture.

use casca_lines::occlusion::{AoOptions, SetChoice};
use casca_lines::slabs::{SlabGrid, Slices, SpanRule};
use casca_lines::view::{Lens, View};
use glam::{DMat4, DQuat, DVec3};

use super::agreement::FEW_ROWS;
use super::case::{Case, Effort, Receiver, SAMPLES, Way};
use super::score::{mean, rmse};
use crate::lab::{LabError, Section, Table};

/// A method whose stability is measured.
struct Method {
    name: &'static str,
    options: AoOptions,
    /// Rows of the grid; `None` for those of the picture.
    rows: Option<u32>,
}

fn methods(case: &Case, effort: &Effort) -> Result<Vec<Method>, LabError> {
    let samples = Case::samples(SAMPLES, effort.seed)?;
    let thesis = case.fitted(&case.grid(effort.canvas, Slices::S128)?, &samples, Way::MeanOfRatios)?;
    let best = AoOptions::new(case.radius, case.line_radius);
    let screen = AoOptions { choice: SetChoice::Screen, ..thesis };
    Ok(vec![
        Method { name: "thesis", options: screen, rows: None },
        Method { name: "thesis, sets by the surface", options: thesis, rows: None },
        Method { name: "optical depth", options: best, rows: None },
        Method { name: "optical depth, few rows", options: best, rows: Some(FEW_ROWS.min(effort.canvas)) },
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

/// Adds two tables: means by the grid, and changes by motion.
///
/// # Errors
/// If the library refuses a value.
pub fn stability(case: &Case, effort: &Effort, section: &mut Section) -> Result<(), LabError> {
    let samples = Case::samples(SAMPLES, effort.seed)?;
    let methods = methods(case, effort)?;
    let c = effort.canvas;
    let grids = [(c / 2, Slices::S128), (c, Slices::S128), (2 * c, Slices::S128), (c, Slices::S256)];
    let mut table = Table::new("lines_by_grid", &["rows", "slices", "thesis", "optical depth"]);
    let mut means = Vec::new();
    for (height, slices) in grids {
        let grid = case.grid(height, slices)?;
        let of = |m: &Method| -> Result<f64, LabError> {
            Ok(mean(&Case::estimate(&grid, &samples, m.options, &case.receivers, 1)?.0))
        };
        let (thesis, depth) = (of(&methods[0])?, of(&methods[2])?);
        table.row([
            height.to_string(),
            slices.count().to_string(),
            format!("{thesis:.3}"),
            format!("{depth:.3}"),
        ]);
        means.push((thesis, depth));
    }
    let spread = |of: fn(&(f64, f64)) -> f64| {
        let values = means.iter().map(of);
        values.clone().fold(0.0, f64::max) / values.fold(f64::MAX, f64::min).max(1e-9)
    };
    section.text(format!(
        "Mean occlusion at the same points of the spiral by grids of other rows and slices, with nothing else changed; rays give \
         {:.3}. **The greatest mean over the least: {:.2} with the thesis' shares, {:.2} with lengths.**",
        mean(&case.truth),
        spread(|m| m.0),
        spread(|m| m.1)
    ));
    section.table(table);

    let views = [
        ("a pixel to the right", case.view.moved_by_pixels(1.0, 0.0)),
        ("3 pixels and 5 rows", case.view.moved_by_pixels(3.0, 5.0)),
        ("a third of a pixel", case.view.moved_by_pixels(0.33, 0.0)),
        ("turned by 0.2°", turned(&case.view, 0.2)?),
        ("turned by 10°", turned(&case.view, 10.0)?),
        ("zoomed to twice the size", zoomed(&case.view, 2.0)?),
    ];
    let mut columns = vec!["change"];
    columns.extend(methods.iter().map(|m| m.name));
    columns.push("rays");
    let mut table = Table::new("lines_motion", &columns);
    for (name, view) in views {
        let now = seen(case, &view);
        let both: Vec<(Receiver, Receiver)> =
            case.receivers.iter().zip(&now).filter_map(|(a, b)| Some((*a, (*b)?))).collect();
        let (before, after): (Vec<Receiver>, Vec<Receiver>) = both.into_iter().unzip();
        let mut row = vec![name.to_owned()];
        for method in &methods {
            let height = method.rows.unwrap_or(c);
            let estimate = |view: &View, receivers: &[Receiver]| -> Result<Vec<f64>, LabError> {
                let view = view.with_height(height)?;
                let grid = SlabGrid::of_lines(&case.lines, &view, Slices::S128, SpanRule::Span);
                Ok(Case::estimate(&grid, &samples, method.options, receivers, 1)?.0)
            };
            row.push(format!("{:.3}", rmse(&estimate(&case.view, &before)?, &estimate(&view, &after)?)));
        }
        let rays = rmse(&case.rays(&case.view, &before, effort), &case.rays(&view, &after, effort));
        row.push(format!("{rays:.3}"));
        table.row(row);
    }
    section.text(
        "Change of the occlusion at the same points of the spiral from one frame to the next (root of the mean square) when the view \
         moves. Whole pixels change nothing but the numbers of pixels: all that changes then is flicker. Rays change, too, where \
         the hemisphere turns with the viewer, and by their own noise.",
    );
    section.table(table);
    Ok(())
}

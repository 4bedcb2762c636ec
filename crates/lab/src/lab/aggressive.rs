//! The aggressive mode: what share of the pixels is lost for what gain.

use casca::{AggressiveOpacity, Method, Query, Settings};

use super::walker::{Walker, item_buffer};
use super::worlds::{Place, places};
use super::{Lab, LabError, Section, Table, median};
use crate::drive::view_of;
use crate::measure::timed;
use crate::oracle::NONE;
use crate::pictures::{Axis, Line, lines};
use crate::scenes::SceneKind;
use crate::world::{Object, Shape};

/// Shares of a cell from which on it counts as opaque.
const SHARES: [f32; 7] = [0.95, 0.85, 0.75, 0.6, 0.5, 0.35, 0.2];

/// Worlds with more triangles are left out: to test a point in a closed mesh goes through all of its
/// triangles.
const MOST_TRIANGLES: usize = 100_000;

/// What a threshold gave, summed over frames.
#[derive(Default)]
struct Sum {
    cells: u64,
    ms: Vec<f64>,
    found: usize,
    lost: usize,
    pixels: u64,
}

/// Cells opaque above a threshold: pixels lost against objects saved, on scenes whose solids fill cells.
///
/// # Errors
/// If a scene cannot be read, or a picture not be written.
pub fn aggressive(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Aggressive mode: cells that are mostly solid");
    let mut table = Table::new(
        "aggressive",
        &[
            "scene",
            "opaque from",
            "cells added",
            "ms",
            "PVS",
            "PVS/EVS",
            "objects lost in a frame",
            "pixels lost, %",
        ],
    );
    let mut settings = Settings::default();
    settings.method = Method::Cell;
    let frames = lab.pick(30, 2);
    let mut chart = Vec::new();
    let (mut spared, mut large) = (Vec::new(), Vec::new());
    for place in places(lab) {
        let quick = matches!(place, Place::Built(SceneKind::Rooms));
        // The crowd's hundred thousand are hidden by whole cells of walls.
        let crowd = matches!(place, Place::Built(SceneKind::Crowd));
        if crowd || lab.quick && !quick {
            continue;
        }
        let world = place.open(lab)?;
        (lab.progress)(&world.name);
        let triangles = |o: &Object| match &o.shape {
            Shape::Mesh { mesh, .. } => mesh.triangles.len(),
            _ => 0,
        };
        if world.objects.iter().map(triangles).sum::<usize>() > MOST_TRIANGLES {
            large.push(world.name.clone());
            continue;
        }
        let mut walker = Walker::new(world)?;
        let made = AggressiveOpacity::for_shares(&walker.driver(0).scene, &SHARES)?;
        let opacities: Vec<Option<AggressiveOpacity>> =
            std::iter::once(None).chain(made.into_iter().map(Some)).collect();
        if opacities.iter().flatten().all(|o| o.cells().count() == 0) {
            spared.push(walker.world.name.clone());
            continue;
        }
        let mut query = Query::with_settings(settings)?;
        let mut exact = item_buffer(lab.pick(1920, 320));
        let mut sums: Vec<Sum> = opacities.iter().map(|_| Sum::default()).collect();
        let (mut visible_sum, mut pixels) = (0usize, 0u64);
        walker.walk::<LabError>(frames, |walker, _, frame| {
            let visible = walker.visible(frame, &mut exact);
            visible_sum += visible.len();
            pixels += exact.items().len() as u64;
            let (driver, view) = (walker.driver(0), view_of(&frame.camera)?);
            for (opacity, sum) in opacities.iter().zip(&mut sums) {
                let (pvs, time) = timed(|| match opacity {
                    None => Ok(query.run(&driver.scene, &view)),
                    Some(opacity) => query.run_aggressive(&driver.scene, &view, opacity),
                });
                let pvs = pvs?;
                sum.cells = opacity.as_ref().map_or(0, |o| o.cells().count());
                sum.ms.push(time.as_secs_f64() * 1e3);
                sum.found += driver.count(pvs, &walker.world.objects);
                sum.lost += visible.iter().filter(|&&i| !driver.sees(pvs, i)).count();
                let lost = exact.items().iter().filter(|&&i| i != NONE && !driver.sees(pvs, i as usize));
                sum.pixels += lost.count() as u64;
            }
            Ok(())
        })?;
        let mut points = Vec::new();
        for (opacity, sum) in opacities.iter().zip(&mut sums) {
            let ratio = sum.found as f64 / visible_sum.max(1) as f64;
            let lost = sum.pixels as f64 / pixels.max(1) as f64 * 100.0;
            points.push((ratio, lost));
            table.row([
                walker.world.name.clone(),
                opacity.as_ref().map_or("whole cells".to_owned(), |o| format!("{:.0}%", o.share() * 100.0)),
                sum.cells.to_string(),
                format!("{:.3}", median(&mut sum.ms)),
                format!("{:.1}", sum.found as f64 / frames as f64),
                format!("{ratio:.3}"),
                format!("{:.2}", sum.lost as f64 / frames as f64),
                format!("{lost:.3}"),
            ]);
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        chart.push(Line::new(walker.world.name.clone(), points));
    }
    section.text(format!(
        "The thesis' \"approximate PVS by an opacity threshold\": for `cell`, static cells that are filled to a share count as \
         opaque (`Query::run_aggressive`). It is not conservative, off unless called by that name, and its results say so. \
         Each scene's first row, and its point without losses in the chart, is the exact method. Pixels are those of an exact item buffer that \
         show an object which the set lacks.{}{}",
        match large.as_slice() {
            [] => String::new(),
            names => format!(" Left out for their more than {MOST_TRIANGLES} triangles: {}.", names.join(", ")),
        },
        match spared.as_slice() {
            [] => String::new(),
            names => format!(" Nothing to gain on {}: no static closed solids, so no cells to fill.", names.join(", ")),
        }
    ));
    let file = "aggressive.png";
    lines(
        &lab.folder.join(file),
        "Aggressive opacity: what a smaller set costs",
        &Axis { label: "objects found visible / objects visible".to_owned(), log: false, holds: vec![1.0] },
        &Axis::linear("pixels lost, %"),
        &chart,
    )?;
    section.picture(
        file,
        "Pixels lost against the size of the set, from whole opaque cells (right, nothing lost) to cells a fifth full (left)",
    );
    section.table(table);
    Ok(section)
}

//! The aggressive mode: what share of the pixels is lost for what gain.

use casca::{AggressiveOpacity, Method, Query};

use super::walker::{Walker, item_buffer};
use super::worlds::{Place, places};
use super::{Lab, LabError, Section, Table, median};
use casca_scenes::drive::view_of;
use casca_scenes::generated::SceneKind;
use casca_scenes::measure::timed;
use casca_scenes::world::{Object, Shape};
use casca_truth::oracle::NONE;

/// Shares of a cell from which on it counts as opaque.
const SHARES: [f32; 7] = [0.95, 0.85, 0.75, 0.6, 0.5, 0.35, 0.2];

/// Worlds with more triangles are left out: to test a point in a closed mesh goes through all of
/// its triangles.
const MOST_TRIANGLES: usize = 100_000;

/// The results of a threshold, summed over frames.
#[derive(Default)]
struct Sum {
    cells: u64,
    ms: Vec<f64>,
    found: usize,
    lost: usize,
    pixels: u64,
}

/// The heads of the table of all thresholds.
const COLUMNS: [&str; 8] = [
    "scene",
    "opaque from",
    "cells added",
    "ms",
    "PVS",
    "PVS/visible",
    "objects lost in a frame",
    "pixels lost, %",
];

/// A walk with all thresholds.
struct Walked {
    name: String,
    /// From which share on cells counted as opaque, and what came of it.
    sums: Vec<(Option<AggressiveOpacity>, Sum)>,
    /// Objects visible, and pixels, summed over frames.
    visible: usize,
    pixels: u64,
}

/// Walks through a world; `None` if no threshold adds a cell.
fn walk(lab: &Lab, frames: usize, mut walker: Walker) -> Result<Option<Walked>, LabError> {
    let made = AggressiveOpacity::for_shares(&walker.driver(0).scene, &SHARES)?;
    if made.iter().all(|o| o.cells().next().is_none()) {
        return Ok(None);
    }
    let opacities = std::iter::once(None).chain(made.into_iter().map(Some));
    let mut sums: Vec<_> = opacities.map(|opacity| (opacity, Sum::default())).collect();
    let mut query = Query::with_method(Method::cell())?;
    let mut exact = item_buffer(lab.pick(1920, 320));
    let (mut visible_sum, mut pixels) = (0usize, 0u64);
    walker.walk::<LabError>(frames, |walker, _, frame| {
        let visible = walker.visible(frame, &mut exact);
        visible_sum += visible.len();
        pixels += exact.items().len() as u64;
        let (driver, view) = (walker.driver(0), view_of(&frame.camera)?);
        for (opacity, sum) in &mut sums {
            let (pvs, time) = timed(|| match opacity {
                None => Ok(query.run(&driver.scene, &view)),
                Some(opacity) => query.run_aggressive(&driver.scene, &view, opacity),
            });
            let pvs = pvs?;
            sum.cells = opacity.as_ref().map_or(0, |o| o.cells().count() as u64);
            sum.ms.push(time.as_secs_f64() * 1e3);
            sum.found += driver.count(pvs, &walker.world.objects);
            sum.lost += visible.iter().filter(|&&i| !driver.sees(pvs, i)).count();
            let lost = exact.items().iter().filter(|&&i| i != NONE && !driver.sees(pvs, i as usize));
            sum.pixels += lost.count() as u64;
        }
        Ok(())
    })?;
    Ok(Some(Walked { name: walker.world.name.clone(), sums, visible: visible_sum, pixels }))
}

/// The thresholds of a walk, and their rows.
fn steps(walked: Walked, frames: usize, table: &mut Table) -> Scene {
    let mut steps = Vec::new();
    for (opacity, mut sum) in walked.sums {
        let ratio = sum.found as f64 / walked.visible.max(1) as f64;
        let lost = sum.pixels as f64 / walked.pixels.max(1) as f64 * 100.0;
        let share = opacity.as_ref().map(AggressiveOpacity::share);
        steps.push(Step { share, ratio, lost });
        table.row([
            walked.name.clone(),
            share.map_or("whole cells".to_owned(), |share| format!("{:.0}%", share * 100.0)),
            sum.cells.to_string(),
            format!("{:.3}", median(&mut sum.ms)),
            format!("{:.1}", sum.found as f64 / frames as f64),
            format!("{ratio:.3}"),
            format!("{:.2}", sum.lost as f64 / frames as f64),
            format!("{lost:.3}"),
        ]);
    }
    Scene { name: walked.name, steps }
}

fn triangles(object: &Object) -> usize {
    match &object.shape {
        Shape::Mesh { mesh, .. } => mesh.triangles.len(),
        _ => 0,
    }
}

/// Cells opaque above a threshold: pixels lost against objects saved, on scenes whose solids fill
/// cells.
///
/// # Errors
/// If a scene cannot be read.
pub fn aggressive(lab: &Lab) -> Result<Section, LabError> {
    let mut section = Section::new("Aggressive mode: cells that are mostly solid");
    let mut table = Table::new("aggressive", &COLUMNS);
    let frames = lab.pick(30, 2);
    let mut found = Vec::new();
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
        let name = world.name.clone();
        if world.objects.iter().map(triangles).sum::<usize>() > MOST_TRIANGLES {
            large.push(name);
            continue;
        }
        match walk(lab, frames, Walker::new(world)?)? {
            Some(walked) => found.push(steps(walked, frames, &mut table)),
            None => spared.push(name),
        }
    }
    let left_out = |names: &[String], why: &str| match names {
        [] => String::new(),
        names => format!(" {}: {why}.", names.join(", ")),
    };
    section.text(format!(
        "The thesis' \"approximate PVS by an opacity threshold\": for `cell`, static cells that are filled \
         to a share count as opaque (`Query::run_aggressive`). It is not conservative. A pixel is lost if an \
         item buffer shows an object there that the PVS lacks. Means over {frames} frames of each \
         walk.{}{}",
        left_out(&large, "left out for the number of triangles"),
        left_out(&spared, "nothing to gain, for no static closed solids fill cells"),
    ));
    section.table(summary(&found));
    section.rows("All thresholds as CSV", table);
    Ok(section)
}

/// A threshold on a scene: the share from which cells count as opaque, or none; PVS/visible;
/// percent of pixels lost.
#[derive(Debug, Clone, Copy)]
struct Step {
    share: Option<f32>,
    ratio: f64,
    lost: f64,
}

/// The thresholds of a scene, from exact to the lowest share.
struct Scene {
    name: String,
    steps: Vec<Step>,
}

impl Scene {
    /// The tightest set without a lost pixel.
    fn lossless(&self) -> Option<&Step> {
        self.steps.iter().filter(|s| s.lost == 0.0).min_by(|a, b| a.ratio.total_cmp(&b.ratio))
    }
}

fn summary(scenes: &[Scene]) -> Table {
    let columns = [
        "scene",
        "PVS/visible, exact",
        "tightest without a lost pixel",
        "opaque from, %",
        "PVS/visible at the lowest share",
        "pixels lost there, %",
    ];
    let mut table = Table::new("aggressive-summary", &columns);
    for scene in scenes {
        let (Some(exact), Some(least), Some(last)) =
            (scene.steps.first(), scene.lossless(), scene.steps.last())
        else {
            continue;
        };
        table.row([
            scene.name.clone(),
            format!("{:.2}", exact.ratio),
            format!("{:.2}", least.ratio),
            least.share.map_or("100".to_owned(), |s| format!("{:.0}", s * 100.0)),
            format!("{:.2}", last.ratio),
            format!("{:.3}", last.lost),
        ]);
    }
    table
}

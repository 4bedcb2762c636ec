//! The aggressive mode: what share of the pixels is lost for what gain.

use casca::{AggressiveOpacity, Method, Query};

use super::walker::{Walker, item_buffer};
use super::{Lab, LabError, Place, Section, Table, places};
use casca_scenes::drive::view_of;
use casca_scenes::generated::SceneKind;
use casca_scenes::world::{Object, Shape};
use casca_truth::oracle::NONE;

/// Shares of a cell from which on it counts as opaque.
const SHARES: [f32; 7] = [0.95, 0.85, 0.75, 0.6, 0.5, 0.35, 0.2];

/// Worlds with more triangles are left out: to test a point in a closed mesh goes through all of
/// its triangles.
const MOST_TRIANGLES: usize = 100_000;

/// A threshold on a walk: the share from which on cells count as opaque, or none, and sums over
/// frames.
struct Step {
    opacity: Option<AggressiveOpacity>,
    found: usize,
    /// Pixels of objects that the set lacks.
    lost: u64,
}

/// A walk with all thresholds, from exact to the lowest share.
struct Walked {
    name: String,
    steps: Vec<Step>,
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
    let mut steps: Vec<Step> = opacities.map(|opacity| Step { opacity, found: 0, lost: 0 }).collect();
    let mut query = Query::with_method(Method::cell())?;
    let mut exact = item_buffer(lab.pick(1920, 320));
    let (mut visible, mut pixels) = (0, 0);
    walker.walk::<LabError>(frames, |walker, _, frame| {
        visible += walker.visible(frame, &mut exact).len();
        pixels += exact.items().len() as u64;
        let (driver, view) = (walker.driver(0), view_of(&frame.camera)?);
        for step in &mut steps {
            let pvs = match &step.opacity {
                None => query.run(&driver.scene, &view),
                Some(opacity) => query.run_aggressive(&driver.scene, &view, opacity)?,
            };
            step.found += driver.count(pvs, &walker.world.objects);
            let lost = exact.items().iter().filter(|&&i| i != NONE && !driver.sees(pvs, i as usize));
            step.lost += lost.count() as u64;
        }
        Ok(())
    })?;
    Ok(Some(Walked { name: walker.world.name.clone(), steps, visible, pixels }))
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
            Some(walked) => found.push(walked),
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
    Ok(section)
}

fn summary(walks: &[Walked]) -> Table {
    let columns = [
        "scene",
        "PVS/visible, exact",
        "tightest without a lost pixel",
        "opaque from, %",
        "PVS/visible at the lowest share",
        "pixels lost there, %",
    ];
    let mut table = Table::new("aggressive-summary", &columns);
    for walked in walks {
        let ratio = |step: &Step| step.found as f64 / walked.visible.max(1) as f64;
        let lossless = walked.steps.iter().filter(|s| s.lost == 0).min_by_key(|s| s.found);
        let (Some(exact), Some(least), Some(last)) = (walked.steps.first(), lossless, walked.steps.last())
        else {
            continue;
        };
        table.row([
            walked.name.clone(),
            format!("{:.2}", ratio(exact)),
            format!("{:.2}", ratio(least)),
            least.opacity.as_ref().map_or("100".to_owned(), |o| format!("{:.0}", o.share() * 100.0)),
            format!("{:.2}", ratio(last)),
            format!("{:.3}", last.lost as f64 / walked.pixels.max(1) as f64 * 100.0),
        ]);
    }
    table
}

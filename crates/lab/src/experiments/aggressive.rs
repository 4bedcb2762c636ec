//! The thesis' aggressive mode: cells that are mostly solid pass for opaque. What share of the pixels
//! is lost for what gain. **Not conservative**: the library has no such mode.
//!
//! For the method by cells only those wholly inside solids hide. Here a box that hides fills each
//! cell that static boxes and balls fill to a share.

use std::collections::HashMap;

use casca::{Method, Query};
use glam::{IVec3, Vec3};

use super::walker::{Walker, item_buffer};
use super::{Lab, LabError, Place, Section, Table, places};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::generated::SceneKind;
use casca_scenes::world::{Motion, Object, Shape, World};
use casca_truth::oracle::NONE;

/// Shares of a cell from which on it counts as opaque.
const SHARES: [f32; 7] = [0.95, 0.85, 0.75, 0.6, 0.5, 0.35, 0.2];

/// Points along each edge of a cell at which its filling is sampled: one for each bit of a word.
const SAMPLES: i32 = 4;

/// A threshold on a walk: the share from which on cells count as opaque, or none, and sums over
/// frames.
struct Step {
    share: Option<f32>,
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

/// For each cell that static boxes and balls touch, the sampled points in them.
fn fillings(world: &World) -> HashMap<IVec3, u64> {
    let size = world.grid.cell;
    let mut filled = HashMap::new();
    for object in world.objects.iter().filter(|o| o.occludes && matches!(o.motion, Motion::Static)) {
        let (min, max) = match object.shape {
            Shape::Box { min, max } => (min, max),
            Shape::Sphere { center, radius } => (center - radius, center + radius),
            Shape::Mesh { .. } => continue,
        };
        let holds = |p: Vec3| match object.shape {
            Shape::Sphere { center, radius } => p.distance(center) <= radius,
            _ => p.cmpge(min).all() && p.cmple(max).all(),
        };
        let cell = |p: Vec3| (p / size).floor().as_ivec3();
        let (lo, hi) = (cell(min.max(world.grid.min)), cell(max.min(world.grid.max)));
        let cells = (lo.z..=hi.z).flat_map(|z| (lo.y..=hi.y).map(move |y| (y, z)));
        for cell in cells.flat_map(|(y, z)| (lo.x..=hi.x).map(move |x| IVec3::new(x, y, z))) {
            let points = filled.entry(cell).or_insert(0u64);
            for i in 0..SAMPLES.pow(3) {
                let at = IVec3::new(i % SAMPLES, i / SAMPLES % SAMPLES, i / (SAMPLES * SAMPLES));
                let share = (at.as_vec3() + 0.5) / SAMPLES as f32;
                *points |= u64::from(holds((cell.as_vec3() + share) * size)) << i;
            }
        }
    }
    filled
}

/// The world in which boxes fill all cells from a share on; `None` if there are none.
fn with_share(world: &World, filled: &HashMap<IVec3, u64>, share: f32) -> Result<Option<Driver>, LabError> {
    let least = share * SAMPLES.pow(3) as f32;
    let filled = filled.iter().filter(|(_, points)| points.count_ones() as f32 >= least);
    let mut cells: Vec<IVec3> = filled.map(|(cell, _)| *cell).collect();
    cells.sort_by_key(IVec3::to_array);
    let boxes = cells.iter().map(|cell| {
        let min = cell.as_vec3() * world.grid.cell;
        let shape = Shape::Box { min, max: min + world.grid.cell };
        Object { name: String::new(), shape, motion: Motion::Static, occludes: true, tested: false }
    });
    let objects: Vec<Object> = world.objects.iter().cloned().chain(boxes).collect();
    let driver = Driver::with(&objects, world.grid.cell, None, |_, desc| desc, |_| ())?;
    Ok((!cells.is_empty()).then_some(driver))
}

/// Walks through a world; `None` if no threshold adds a cell.
fn walk(lab: &Lab, frames: usize, mut walker: Walker) -> Result<Option<Walked>, LabError> {
    let mut steps = vec![Step { share: None, found: 0, lost: 0 }];
    let filled = fillings(&walker.world);
    for share in SHARES {
        if let Some(driver) = with_share(&walker.world, &filled, share)? {
            walker.add_driver(driver);
            steps.push(Step { share: Some(share), found: 0, lost: 0 });
        }
    }
    if steps.len() == 1 {
        return Ok(None);
    }
    let mut query = Query::with_method(Method::cell())?;
    let mut exact = item_buffer(lab.pick(1920, 320));
    let (mut visible, mut pixels) = (0, 0);
    walker.walk::<LabError>(frames, |walker, _, frame| {
        visible += walker.visible(frame, &mut exact).len();
        pixels += exact.items().len() as u64;
        let view = view_of(&frame.camera)?;
        for (i, step) in steps.iter_mut().enumerate() {
            let driver = walker.driver(i);
            let pvs = query.run(&driver.scene, &view);
            step.found += driver.count(pvs, &walker.world.objects);
            let lost = exact.items().iter().filter(|&&i| i != NONE && !driver.sees(pvs, i as usize));
            step.lost += lost.count() as u64;
        }
        Ok(())
    })?;
    Ok(Some(Walked { name: walker.world.name.clone(), steps, visible, pixels }))
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
    let mut spared = Vec::new();
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
        match walk(lab, frames, Walker::new(world)?)? {
            Some(walked) => found.push(walked),
            None => spared.push(name),
        }
    }
    let left_out = match &spared[..] {
        [] => String::new(),
        names => format!(" {}: nothing to gain, for no static boxes or balls fill cells.", names.join(", ")),
    };
    section.text(format!(
        "The thesis' \"approximate PVS by an opacity threshold\": for `cell`, cells that static boxes and \
         balls fill to a share count as opaque. It is not conservative, and no mode of the library. A pixel \
         is lost if an item buffer shows an object there that the PVS lacks. Means over {frames} frames of \
         each walk.{left_out}"
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
            least.share.map_or("100".to_owned(), |share| format!("{:.0}", share * 100.0)),
            format!("{:.2}", ratio(last)),
            format!("{:.3}", last.lost as f64 / walked.pixels.max(1) as f64 * 100.0),
        ]);
    }
    table
}

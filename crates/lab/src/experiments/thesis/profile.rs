//! Where the time goes (section 4.7): upkeep of visible and of hidden objects as shares of upkeep and
//! query. Rendering the PVS is left out.

use casca::Method;

use super::super::stage::{Stage, Telling};
use super::super::{ASPECT, Lab, LabError};
use super::setting::{Finding, across, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::FRAME_SECONDS;

/// Frames before the first that counts: hidden objects get their volumes in them.
const WARM: usize = 20;

pub(super) fn run(lab: &Lab) -> Result<Vec<Finding>, LabError> {
    let (frames, repeats) = (lab.pick(100, 5), lab.pick(3, 2));
    let options = SceneOptions { seed: lab.seed, frames: frames + WARM, ..SceneOptions::default() };
    let mut world = build(SceneKind::Spheres, &options);
    let cell = across(&world, 70);
    // By `cell` and by `point`: percent of a frame for all upkeep and for hidden objects, and the
    // objects of a set.
    let mut found = [[0.0; 3]; 2];
    for (method, found) in [Method::cell(), Method::point()].into_iter().zip(&mut found) {
        let mut stage = Stage::new(&world, cell, method, Telling::Always)?;
        let (mut upkeep, mut of_hidden, mut queries, mut objects) = (0.0, 0.0, 0.0, 0);
        for frame in 0..frames + WARM {
            (lab.progress)(&format!("profile, frame {frame}"));
            let moved = world.set_frame(frame);
            let view = view_of(&world.camera(frame, ASPECT))?;
            let now = frame as f64 * FRAME_SECONDS;
            let (visible, hidden) = stage.upkeep_split(now, &world.objects, &moved)?;
            let query = stage.look(&view, repeats);
            let feedback = stage.end()?;
            if frame >= WARM {
                upkeep += visible + hidden + feedback;
                of_hidden += hidden + feedback;
                queries += query;
                objects += stage.found().count();
            }
        }
        let percent = |part: f64| ratio(part, upkeep + queries) * 100.0;
        *found = [percent(upkeep), percent(of_hidden), objects as f64 / frames as f64];
    }
    let [cell, point] = found;
    Ok(vec![
        (
            "4.7",
            "Bringing the grid up to date takes about 55% of a frame, hidden objects about 5%.".to_owned(),
            format!(
                "`cell`: {:.0}%, hidden objects {:.0}%; `point`: {:.0}% and {:.0}%.",
                cell[0], cell[1], point[0], point[1]
            ),
        ),
        (
            "4.7",
            "About 500 of 5,000 spheres are drawn in a frame where about 100 are visible.".to_owned(),
            format!("The PVS has {:.0} objects with `cell`, {:.0} with `point`.", cell[2], point[2]),
        ),
    ])
}

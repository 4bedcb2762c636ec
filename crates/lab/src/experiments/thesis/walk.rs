//! A walk of 150 frames: its cost (section 4.3, figure 4.4) and the PVS against what is visible
//! (section 4.4, figure 4.5). A frame is upkeep, query and the drawing of the PVS by a software depth
//! buffer, which stands for the graphics card; the depth buffer alone draws all 5,000 objects.

use casca::Method;

use super::super::stage::{Stage, Telling, ms};
use super::super::walker::visible_in;
use super::super::{ASPECT, Lab, LabError, median};
use super::setting::{COARSE, EXACT, FINE, Finding, SCREEN, cell, mean, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::FRAME_SECONDS;
use casca_truth::baselines::Hzb;
use casca_truth::oracle::ItemBuffer;

/// Milliseconds of drawing, the least of two.
fn drawn(depth: &mut Hzb, mut draw: impl FnMut(&mut Hzb)) -> f64 {
    let mut once = || ms(timed(|| draw(depth)).1);
    once().min(once())
}

pub(super) fn run(lab: &Lab) -> Result<Vec<Finding>, LabError> {
    let frames = lab.pick(150, 30);
    let every = lab.pick(2, 10);
    let mut world =
        build(SceneKind::Spheres, &SceneOptions { seed: lab.seed, frames, ..SceneOptions::default() });
    let mut stages = Vec::new();
    for (method, dims) in [
        (Method::cell(), COARSE),
        (Method::cell(), FINE),
        (Method::point(), COARSE),
        (Method::point(), FINE),
        (Method::Frustum, FINE),
    ] {
        stages.push(Stage::new(&world, cell(&world, dims), method, Telling::Always)?);
    }
    // Of each way, frame by frame: milliseconds, and objects found.
    let mut times = vec![Vec::new(); stages.len()];
    let mut found = vec![Vec::new(); stages.len()];
    let (mut alone, mut visible) = (Vec::new(), Vec::new());
    let mut buffer = ItemBuffer::new(EXACT.0, EXACT.1);
    let mut depth = Hzb::new(SCREEN.0, SCREEN.1);
    for frame in 0..frames {
        (lab.progress)(&format!("walk, frame {frame}"));
        let moved = world.set_frame(frame);
        let (objects, camera) = (&world.objects, world.camera(frame, ASPECT));
        let view = view_of(&camera)?;
        let measured = frame % every == every / 2;
        for (i, stage) in stages.iter_mut().enumerate() {
            let before = stage.upkeep(frame as f64 * FRAME_SECONDS, objects, &moved)?;
            let query = stage.look(&view, if measured { 3 } else { 1 });
            let after = stage.end()?;
            if measured {
                let drawing = drawn(&mut depth, |d| d.draw_all(objects, stage.found(), &camera));
                times[i].push(before + query + after + drawing);
                found[i].push(stage.found().count() as f64);
            }
        }
        if measured {
            alone.push(drawn(&mut depth, |d| d.draw_all(objects, 0..objects.len(), &camera)));
            visible.push(visible_in(&mut buffer, objects, &camera).len() as f64);
        }
    }
    let (alone, visible) = (median(&mut alone), mean(&visible));
    let faster: Vec<f64> = times.iter_mut().map(|t| ratio(alone, median(t))).collect();
    let accuracy: Vec<f64> = found.iter().map(|f| ratio(mean(f), visible)).collect();
    Ok(vec![
        (
            "4.3, fig. 4.4; 5",
            "On average about 10 times as fast as the depth buffer alone with 50x30x50 cells, 4 times with \
             100x60x100."
                .to_owned(),
            format!(
                "`cell` {:.1} and {:.1} times, `point` {:.1} and {:.1}, `frustum` {:.1}.",
                faster[0], faster[1], faster[2], faster[3], faster[4]
            ),
        ),
        (
            "4.3, fig. 4.4",
            "Twice the resolution more than halves the frame rate.".to_owned(),
            format!(
                "A frame takes {:.2} times as long for `cell`, {:.2} for `point`.",
                ratio(faster[0], faster[1]),
                ratio(faster[2], faster[3])
            ),
        ),
        (
            "4.4, fig. 4.5; 5",
            "The PVS is about twice what is visible with 100x60x100 cells, about six times with 50x30x50."
                .to_owned(),
            format!(
                "`cell` {:.2} and {:.2}, `point` {:.2} and {:.2}, `frustum` {:.2}.",
                accuracy[1], accuracy[0], accuracy[3], accuracy[2], accuracy[4]
            ),
        ),
    ])
}

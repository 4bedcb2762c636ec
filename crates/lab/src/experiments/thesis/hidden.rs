//! Hidden dynamic objects (section 4.2, figure 4.3): among the 5,000 spheres stands a closed bunker in
//! which more and more small spheres move; the camera stands still. The time of a frame is upkeep
//! (clock, reports, feedback) and query.

use casca::Method;

use super::super::stage::{Stage, Telling, frame_of, ms};
use super::super::{ASPECT, Lab, LabError, median};
use super::setting::{COARSE, FINE, Finding, SCREEN, cell, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::FRAME_SECONDS;
use casca_truth::baselines::Hzb;

/// The thesis' time for 500 hidden objects, the milliseconds that twice the resolution adds, and
/// those of a frame with 10,000.
const THESIS: (f64, f64, f64) = (3.4, 0.20, 10.0);
const COUNTS: [usize; 3] = [0, 500, 10_000];
/// Frames between two steps of settling.
const STRIDE: usize = 10;

/// Milliseconds of upkeep and query by each of [`COUNTS`].
type Row = [[f64; 2]; 3];

pub(super) fn run(lab: &Lab) -> Result<Vec<Finding>, LabError> {
    let (settle, frames) = (lab.pick(60, 8), lab.pick(31, 3));
    let ways = [
        (Method::cell(), COARSE, Telling::OnExpiry),
        (Method::cell(), FINE, Telling::OnExpiry),
        (Method::cell(), FINE, Telling::Always),
        (Method::point(), FINE, Telling::OnExpiry),
        (Method::Frustum, FINE, Telling::Always),
    ];
    let mut rows: [Row; 5] = Default::default();
    let mut drawn = [0.0; 3];
    let mut depth = Hzb::new(SCREEN.0, SCREEN.1);
    for (n, count) in COUNTS.into_iter().enumerate() {
        (lab.progress)(&format!("{count} hidden objects"));
        let options = SceneOptions { seed: lab.seed, bunker: Some(count), ..SceneOptions::default() };
        let mut world = build(SceneKind::Spheres, &options);
        let camera = world.camera(world.frames / 2, ASPECT);
        let view = view_of(&camera)?;
        let mut stages = Vec::new();
        for (method, dims, telling) in ways {
            stages.push((Stage::new(&world, cell(&world, dims), method, telling)?, [Vec::new(), Vec::new()]));
        }
        let mut drawing = Vec::new();
        for step in 0..settle + frames {
            let measured = step >= settle;
            let frame = frame_of(step, settle, STRIDE);
            let moved = world.set_frame(frame);
            for (stage, times) in &mut stages {
                let before = stage.upkeep(frame as f64 * FRAME_SECONDS, &world.objects, &moved)?;
                let asked = stage.look(&view, if measured { 2 } else { 1 });
                let after = stage.end()?;
                if measured {
                    times[0].push(before + after);
                    times[1].push(asked);
                }
            }
            if measured && drawing.len() < 5 {
                let objects = &world.objects;
                let movers = objects.len() - count..objects.len();
                drawing.push(ms(timed(|| depth.draw_all(objects, movers, &camera)).1));
            }
        }
        for (row, (_, times)) in rows.iter_mut().zip(&mut stages) {
            row[n] = times.each_mut().map(|t| median(t));
        }
        drawn[n] = median(&mut drawing);
    }
    Ok(findings(&rows, &drawn))
}

fn findings([coarse, fine, always, point, frustum]: &[Row; 5], drawn: &[f64; 3]) -> Vec<Finding> {
    let place = "4.2, fig. 4.3";
    let frames = |row: &Row| ratio(row[2].iter().sum(), row[0].iter().sum());
    let queries = |row: &Row| ratio(row[2][1], row[0][1]);
    let upkeep = |a: &Row, i: usize, b: &Row, j: usize| ratio(a[i][0], b[j][0]);
    let (thesis_500, more, thesis_10_000) = THESIS;
    vec![
        (
            place,
            "The depth buffer alone grows linearly with hidden objects; the method stays constant."
                .to_owned(),
            format!(
                "From 500 to 10,000 hidden objects the depth buffer's time for them grows {:.1} times. From \
                 none to 10,000, frames with `frustum` take {:.2} times as long, queries of `cell` {:.2}, of \
                 `point` {:.2}, and whole frames of `point` {:.2} (100x60x100, reported on expiry).",
                ratio(drawn[2], drawn[1]),
                frames(frustum),
                queries(fine),
                queries(point),
                frames(point)
            ),
        ),
        (
            place,
            format!(
                "Upkeep of 500 takes {thesis_500} ms; frames with more than 10,000 about {thesis_10_000} ms: \
                 at most {:.1} times as long for 20 times the objects.",
                thesis_10_000 / thesis_500
            ),
            format!(
                "Upkeep of 10,000 is {:.1} times that of 500 (`cell`, 50x30x50, reported on expiry), {:.1} \
                 times (100x60x100) where all are reported in every frame.",
                upkeep(coarse, 2, coarse, 1),
                upkeep(always, 2, always, 1)
            ),
        ),
        (
            place,
            format!(
                "Twice the resolution along each axis: upkeep times {:.2}.",
                (thesis_500 + more) / thesis_500
            ),
            format!(
                "Times {:.2} with 500 hidden objects, {:.2} with 10,000.",
                upkeep(fine, 1, coarse, 1),
                upkeep(fine, 2, coarse, 2)
            ),
        ),
    ]
}

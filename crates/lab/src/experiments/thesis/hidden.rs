//! Hidden dynamic objects (section 4.2, figure 4.3): among the 5,000 spheres stands a closed bunker in
//! which more and more small spheres move; the camera stands still. The time of a frame is upkeep
//! (clock, reports, feedback) and query.

use casca::{Method, View};

use super::super::stage::{Stage, Telling, frame_of, ms};
use super::super::{ASPECT, Lab, LabError, Section, Table, median};
use super::setting::{COARSE, FINE, Finding, SCREEN, at, grid, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::FRAME_SECONDS;
use casca_truth::baselines::Hzb;

/// The thesis' time for 500 hidden objects, the milliseconds that twice the resolution adds, and
/// those of a frame with 10,000.
const THESIS: (f64, f64, f64) = (3.4, 0.20, 10.0);
/// Frames between two steps of settling.
const STRIDE: usize = 10;

/// One way to take a frame: its name, and milliseconds of upkeep and query by number of objects.
struct Row {
    name: &'static str,
    upkeep: Vec<(f64, f64)>,
    query: Vec<(f64, f64)>,
}

impl Row {
    fn frame(&self) -> Vec<(f64, f64)> {
        self.upkeep.iter().zip(&self.query).map(|(u, q)| (u.0, u.1 + q.1)).collect()
    }
}

pub(super) fn run(lab: &Lab, section: &mut Section) -> Result<Vec<Finding>, LabError> {
    let counts = [0, 500, 10_000];
    let (settle, frames) = (lab.pick(60, 8), lab.pick(31, 3));
    let ways = [
        ("cell, 50x30x50", Method::cell(), COARSE, Telling::OnExpiry),
        ("cell, 100x60x100", Method::cell(), FINE, Telling::OnExpiry),
        ("cell, 100x60x100, all reported", Method::cell(), FINE, Telling::Always),
        ("point, 50x30x50", Method::point(), COARSE, Telling::OnExpiry),
        ("point, 100x60x100", Method::point(), FINE, Telling::OnExpiry),
        ("frustum, all reported", Method::Frustum, FINE, Telling::Always),
    ];
    let mut rows: Vec<Row> =
        ways.iter().map(|w| Row { name: w.0, upkeep: Vec::new(), query: Vec::new() }).collect();
    let mut depth = Hzb::new(SCREEN.0, SCREEN.1);
    let mut drawn = Vec::new();
    for &count in &counts {
        (lab.progress)(&format!("{count} hidden objects"));
        let options =
            SceneOptions { seed: lab.seed, bunker: true, hidden_extra: count, ..SceneOptions::default() };
        let mut world = build(SceneKind::Spheres, &options);
        let camera = world.camera(world.frames / 2, ASPECT);
        let view: View = view_of(&camera)?;
        let mut stages = Vec::new();
        for (_, method, dims, telling) in ways {
            stages.push(Stage::new(&world, &grid(&world, dims)?, method, telling)?);
        }
        let mut upkeep = vec![Vec::new(); ways.len()];
        let mut query = vec![Vec::new(); ways.len()];
        let mut drawing = Vec::new();
        for step in 0..settle + frames {
            let measured = step >= settle;
            let frame = frame_of(step, settle, STRIDE);
            let moved = world.set_frame(frame);
            for (i, stage) in stages.iter_mut().enumerate() {
                let before = stage.upkeep(frame as f64 * FRAME_SECONDS, &world.objects, &moved)?;
                let asked = stage.look(&view, if measured { 2 } else { 1 });
                let after = stage.end()?;
                if measured {
                    upkeep[i].push(before + after);
                    query[i].push(asked);
                }
            }
            if measured && drawing.len() < 5 {
                let objects = &world.objects;
                let movers = objects.len() - count..objects.len();
                drawing.push(ms(timed(|| depth.draw_all(objects, movers, &camera)).1));
            }
        }
        let n = count as f64;
        for (i, row) in rows.iter_mut().enumerate() {
            row.upkeep.push((n, median(&mut upkeep[i])));
            row.query.push((n, median(&mut query[i])));
        }
        drawn.push((n, median(&mut drawing)));
    }
    section.rows("Hidden dynamic objects as CSV", table(&rows, &counts));
    Ok(findings(&rows, &drawn))
}

fn table(rows: &[Row], counts: &[usize]) -> Table {
    let columns = ["way", "hidden objects", "upkeep, ms", "query, ms", "frame, ms"];
    let mut table = Table::new("thesis-hidden", &columns);
    for r in rows {
        for &count in counts {
            let (u, q) = (at(&r.upkeep, count as f64), at(&r.query, count as f64));
            let times = [format!("{u:.4}"), format!("{q:.3}"), format!("{:.3}", u + q)];
            table.row([r.name.to_owned(), count.to_string()].into_iter().chain(times));
        }
    }
    table
}

fn findings(rows: &[Row], drawn: &[(f64, f64)]) -> Vec<Finding> {
    let place = "4.2, fig. 4.3";
    let [coarse, fine] = [&rows[0], &rows[1]];
    let growth = |p: &[(f64, f64)]| ratio(at(p, 10_000.0), at(p, 0.0));
    vec![
        Finding::new(
            place,
            "The depth buffer alone grows linearly with hidden objects; the method stays constant.",
            format!(
                "From 500 to 10,000 hidden objects the depth buffer's time for them grows {:.1} times. From \
                 none to 10,000, frames with `frustum` take {:.2} times as long, queries of `cell` {:.2}, of \
                 `point` {:.2}, and whole frames of `point` {:.2} (100x60x100, reported on expiry).",
                ratio(at(drawn, 10_000.0), at(drawn, 500.0)),
                growth(&rows[5].frame()),
                growth(&fine.query),
                growth(&rows[4].query),
                growth(&rows[4].frame())
            ),
        ),
        Finding::new(
            place,
            format!(
                "Upkeep of 500 takes {} ms; frames with more than 10,000 about {} ms: at most {:.1} times as \
                 long for 20 times the objects.",
                THESIS.0,
                THESIS.2,
                THESIS.2 / THESIS.0
            ),
            format!(
                "Upkeep of 10,000 is {:.1} times that of 500 (`cell`, 50x30x50, reported on expiry), {:.1} \
                 times (100x60x100) where all are reported in every frame.",
                ratio(at(&coarse.upkeep, 10_000.0), at(&coarse.upkeep, 500.0)),
                ratio(at(&rows[2].upkeep, 10_000.0), at(&rows[2].upkeep, 500.0))
            ),
        ),
        Finding::new(
            place,
            format!(
                "Twice the resolution along each axis: upkeep times {:.2}.",
                (THESIS.0 + THESIS.1) / THESIS.0
            ),
            format!(
                "Times {:.2} with 500 hidden objects, {:.2} with 10,000.",
                ratio(at(&fine.upkeep, 500.0), at(&coarse.upkeep, 500.0)),
                ratio(at(&fine.upkeep, 10_000.0), at(&coarse.upkeep, 10_000.0))
            ),
        ),
    ]
}

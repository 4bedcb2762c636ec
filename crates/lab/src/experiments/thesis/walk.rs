//! A walk of 150 frames: its cost (section 4.3, figure 4.4) and the PVS against what is visible
//! (section 4.4, figure 4.5). A frame is upkeep, query and the drawing of the PVS by a software depth
//! buffer, which stands for the graphics card; the depth buffer alone draws all 5,000 objects.

use casca::Method;

use super::super::stage::{Stage, Telling, ms};
use super::super::walker::visible_in;
use super::super::{ASPECT, Lab, LabError, Section, Table, median};
use super::setting::{COARSE, EXACT, FINE, Finding, SCREEN, grid, mean, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::FRAME_SECONDS;
use casca_truth::baselines::Hzb;
use casca_truth::oracle::ItemBuffer;

/// A way through the walk, frame by frame.
#[derive(Default)]
struct Row {
    name: &'static str,
    /// Upkeep, query and drawing, in milliseconds.
    upkeep: Vec<f64>,
    query: Vec<f64>,
    drawing: Vec<f64>,
    found: Vec<f64>,
    lost: usize,
}

impl Row {
    fn frame(&self) -> Vec<f64> {
        self.upkeep.iter().zip(&self.query).zip(&self.drawing).map(|((u, q), d)| u + q + d).collect()
    }
}

/// Milliseconds of drawing, the least of two.
fn drawn(depth: &mut Hzb, mut draw: impl FnMut(&mut Hzb)) -> f64 {
    let mut once = || ms(timed(|| draw(depth)).1);
    once().min(once())
}

fn middle(values: &[f64]) -> f64 {
    median(&mut values.to_vec())
}

pub(super) fn run(lab: &Lab, section: &mut Section) -> Result<Vec<Finding>, LabError> {
    let frames = lab.pick(150, 30);
    let every = lab.pick(2, 10);
    let mut world =
        build(SceneKind::Spheres, &SceneOptions { seed: lab.seed, frames, ..SceneOptions::default() });
    let ways = [
        ("cell, 50x30x50", Method::cell(), COARSE),
        ("cell, 100x60x100", Method::cell(), FINE),
        ("point, 50x30x50", Method::point(), COARSE),
        ("point, 100x60x100", Method::point(), FINE),
        ("frustum", Method::Frustum, FINE),
    ];
    let mut rows: Vec<Row> = ways.iter().map(|w| Row { name: w.0, ..Row::default() }).collect();
    let mut stages = Vec::new();
    for (_, method, dims) in ways {
        stages.push(Stage::new(&world, &grid(&world, dims)?, method, Telling::Always)?);
    }
    let mut hzb = Row { name: "hzb, 1280x720", ..Row::default() };
    let (mut alone, mut visible) = (Vec::new(), Vec::new());
    let mut buffer = ItemBuffer::new(EXACT.0, EXACT.1);
    let mut depth = Hzb::new(SCREEN.0, SCREEN.1);
    for frame in 0..frames {
        (lab.progress)(&format!("walk, frame {frame}"));
        let moved = world.set_frame(frame);
        let camera = world.camera(frame, ASPECT);
        let view = view_of(&camera)?;
        let measured = frame % every == every / 2;
        let seen = if measured { visible_in(&mut buffer, &world.objects, &camera) } else { Vec::new() };
        for (stage, row) in stages.iter_mut().zip(&mut rows) {
            let before = stage.upkeep(frame as f64 * FRAME_SECONDS, &world.objects, &moved)?;
            let query = stage.look(&view, if measured { 3 } else { 1 });
            let after = stage.end()?;
            if measured {
                row.upkeep.push(before + after);
                row.query.push(query);
                row.found.push(stage.found().count() as f64);
                row.lost += seen.iter().filter(|&&i| !stage.sees(i)).count();
                row.drawing.push(drawn(&mut depth, |d| d.draw_all(&world.objects, stage.found(), &camera)));
            }
        }
        if measured {
            let objects = &world.objects;
            let in_frustum: Vec<usize> = stages[4].found().collect();
            let mut found = Vec::new();
            hzb.query.push(drawn(&mut depth, |d| found = d.frame(objects, &in_frustum, &camera)));
            hzb.upkeep.push(0.0);
            hzb.drawing.push(drawn(&mut depth, |d| d.draw_all(objects, found.iter().copied(), &camera)));
            hzb.found.push(found.len() as f64);
            hzb.lost += seen.iter().filter(|i| !found.contains(i)).count();
            alone.push(drawn(&mut depth, |d| d.draw_all(objects, 0..objects.len(), &camera)));
            visible.push(seen.len() as f64);
        }
    }
    rows.push(hzb);
    table(section, &rows, &alone, &visible);
    Ok(findings(&rows, &alone, &visible))
}

/// The times and sets of each way.
fn table(section: &mut Section, rows: &[Row], alone: &[f64], visible: &[f64]) {
    let columns = [
        "way",
        "upkeep, ms",
        "query, ms",
        "drawing, ms",
        "times as fast as drawing all",
        "mean PVS",
        "PVS/visible",
        "visible objects lost in a frame",
    ];
    let mut table = Table::new("thesis-walk", &columns);
    let text = |v: &[f64]| format!("{:.3}", middle(v));
    for r in rows {
        table.row([
            r.name.to_owned(),
            text(&r.upkeep),
            text(&r.query),
            text(&r.drawing),
            format!("{:.2}", ratio(middle(alone), middle(&r.frame()))),
            format!("{:.1}", mean(&r.found)),
            format!("{:.2}", ratio(mean(&r.found), mean(visible))),
            format!("{:.2}", r.lost as f64 / visible.len().max(1) as f64),
        ]);
    }
    section.rows("The walk as CSV", table);
}

fn findings(rows: &[Row], alone: &[f64], visible: &[f64]) -> Vec<Finding> {
    let faster = |i: usize| ratio(middle(alone), middle(&rows[i].frame()));
    let accuracy = |i: usize| ratio(mean(&rows[i].found), mean(visible));
    vec![
        Finding::new(
            "4.3, fig. 4.4; 5",
            "On average about 10 times as fast as the depth buffer alone with 50x30x50 cells, 4 times with 100x60x100.",
            format!(
                "`cell` {:.1} and {:.1} times, `point` {:.1} and {:.1}, `frustum` {:.1}.",
                faster(0),
                faster(1),
                faster(2),
                faster(3),
                faster(4)
            ),
        ),
        Finding::new(
            "4.3, fig. 4.4",
            "Twice the resolution more than halves the frame rate.",
            format!(
                "A frame takes {:.2} times as long for `cell`, {:.2} for `point`.",
                ratio(faster(0), faster(1)),
                ratio(faster(2), faster(3))
            ),
        ),
        Finding::new(
            "4.4, fig. 4.5; 5",
            "The PVS is about twice what is visible with 100x60x100 cells, about six times with 50x30x50.",
            format!(
                "`cell` {:.2} and {:.2}, `point` {:.2} and {:.2}, `frustum` {:.2}.",
                accuracy(1),
                accuracy(0),
                accuracy(3),
                accuracy(2),
                accuracy(4)
            ),
        ),
    ]
}

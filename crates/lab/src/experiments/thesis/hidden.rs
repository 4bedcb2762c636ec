//! Hidden dynamic objects (section 4.2, figure 4.3).

use casca::{Method, View};

use super::super::stage::{Stage, Telling, frame_of, ms};
use super::super::{ASPECT, Lab, LabError, Section, Table, grouped, median};
use super::setting::{COARSE, FINE, Finding, SCREEN, grid, ratio, style};
use crate::pictures::palette::{CELL, Marker, Style, THESIS as GIVEN, other};
use crate::pictures::{Axis, Line, lines};
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

fn at(points: &[(f64, f64)], x: f64) -> f64 {
    points.iter().find(|p| p.0 == x).map_or(0.0, |p| p.1)
}

pub(super) fn run(lab: &Lab, section: &mut Section) -> Result<Vec<Finding>, LabError> {
    let counts: Vec<usize> = lab.pick(vec![0, 125, 250, 500, 1000, 2000, 5000, 10_000], vec![0, 500, 10_000]);
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
    draw(lab, section, &rows, &drawn, &counts)?;
    Ok(findings(&rows, &drawn))
}

fn draw(
    lab: &Lab,
    section: &mut Section,
    rows: &[Row],
    drawn: &[(f64, f64)],
    counts: &[usize],
) -> Result<(), LabError> {
    section.text(
        "### Hidden dynamic objects (section 4.2)\n\nAmong the 5,000 spheres stands a closed bunker in which more and \
         more small spheres move; the camera stands still. The time of a frame is upkeep (clock, reports, feedback) and \
         query. Hidden objects are reported when their bounding volumes expire, as in the thesis, or all in every frame.",
    );
    let look = |name: &str| match name.contains("all reported") && name.starts_with("cell") {
        true => Style { marker: Marker::Hexagon, ..CELL },
        false => style(name),
    };
    let count = Axis { label: "hidden dynamic objects".to_owned(), ..Axis::linear("") };
    let mut all: Vec<Line> = rows.iter().map(|r| Line::new(r.name, look(r.name), r.frame())).collect();
    all.push(Line::new("drawing the hidden objects into a depth buffer", other(8), drawn.to_vec()));
    let file = "thesis-hidden-frame.svg";
    let last = counts.last().copied().unwrap_or(0) as f64;
    let growth = |p: Vec<(f64, f64)>| ratio(at(&p, last), at(&p, 0.0));
    let many = grouped(last as usize);
    let title = format!(
        "{many} hidden moving objects make a frame of point {:.2} times as long, one of frustum culling {:.1} times",
        growth(rows[4].frame()),
        growth(rows[5].frame())
    );
    let subtitle = "Upkeep and query, without drawing the visible objects. Dashed: 50x30x50 cells.";
    let y = Axis::log("time of a frame, ms, median");
    lines(&lab.folder.join(file), &title, subtitle, (&count, &y), &all)?;
    section.picture(file, &title);

    let relative = |r: &Row| {
        let base = at(&r.upkeep, 500.0);
        let points = r.upkeep.iter().filter(|p| p.0 > 0.0);
        Line::new(r.name, look(r.name), points.map(|p| (p.0, ratio(p.1, base))).collect())
    };
    let mut all: Vec<Line> = rows.iter().filter(|r| !r.name.starts_with("frustum")).map(relative).collect();
    let most = THESIS.2 / THESIS.0;
    all.push(Line::dots(
        "thesis, 50x30x50 (at 10,000: a whole frame)",
        GIVEN,
        vec![(500.0, 1.0), (10_000.0, most)],
    ));
    let file = "thesis-hidden-upkeep.svg";
    let title = format!(
        "From 500 to {many} hidden objects, upkeep grows {:.1} times if they are reported on expiry, {:.1} times if always",
        ratio(at(&rows[1].upkeep, last), at(&rows[1].upkeep, 500.0)),
        ratio(at(&rows[2].upkeep, last), at(&rows[2].upkeep, 500.0))
    );
    let subtitle =
        "Upkeep relative to that of 500 hidden objects; the title is about cell with 100x60x100 cells.";
    let (x, y) = (Axis::log("hidden dynamic objects"), Axis::log("upkeep / upkeep of 500 objects"));
    lines(&lab.folder.join(file), &title, subtitle, (&x, &y), &all)?;
    section.picture(file, &title);

    let mut table =
        Table::new("thesis-hidden", &["way", "hidden objects", "upkeep, ms", "query, ms", "frame, ms"]);
    for r in rows {
        for n in [0.0, 500.0, last] {
            let (u, q) = (at(&r.upkeep, n), at(&r.query, n));
            table.row([
                r.name.to_owned(),
                format!("{n}"),
                format!("{u:.4}"),
                format!("{q:.3}"),
                format!("{:.3}", u + q),
            ]);
        }
    }
    section.rows("All times as CSV", table);
    Ok(())
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
                "From 500 to 10,000 hidden objects the depth buffer's time for them grows {:.1} times. From none to \
                 10,000, frames with `frustum` take {:.2} times as long, queries of `cell` {:.2}, of `point` {:.2}, and \
                 whole frames of `point` {:.2} (100x60x100, reported on expiry).",
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

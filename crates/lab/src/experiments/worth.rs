//! What a frame costs with each method: the time of the query, and what the objects of its set are
//! worth. A walking camera; buffers that ship come from a file.

use casca::{KeptOptions, Method, PointOptions, Query};

use super::walker::{item_buffer, visible_in};
use super::{ASPECT, BUFFER, Contender, FrameInput, Lab, LabError, Place, Section, Table, grouped};
use crate::pictures::{WorthLine, worth as draw};
use casca_scenes::drive::{Driver, fitted_cell, view_of};
use casca_scenes::generated::{SceneKind, WalkOptions, walking};
use casca_scenes::world::World;

/// Occlusion buffers that ship, measured beside `balanced` on the same walks by programs that are
/// not in this repository. Scenes that it names are walked.
const BUFFERS: &str = include_str!("../../../../docs/report/buffers.csv");
/// Frames after a jump to another place that do not count.
const SETTLE: usize = 5;
/// Times of buffers are shares of the time of this one.
const BALANCED: &str = "casca balanced";

/// How much is measured.
#[derive(Debug, Clone, Copy)]
struct Sampling {
    walk: WalkOptions,
    /// Times that each walk is made; the least time of a frame counts.
    rounds: usize,
    /// One frame in this many is compared with exact visibility.
    judge: usize,
    /// Pixels of a row of the item buffer.
    width: usize,
}

fn contenders() -> Result<Vec<Contender>, LabError> {
    let mut hzb = Contender::hzb(BUFFER.0, BUFFER.1);
    hzb.setting = "hzb".to_owned();
    Ok(vec![
        Contender::casca("frustum only", Method::Frustum)?,
        hzb,
        Contender::casca("casca fast", Method::Point(PointOptions::fast()))?,
        Contender::casca(BALANCED, Method::Point(PointOptions::balanced()))?,
        Contender::kept("casca kept", KeptOptions::new())?,
    ])
}

/// Walks through a world with all methods.
fn measure(world: World, sampling: &Sampling) -> Result<Vec<WorthLine>, LabError> {
    let mut world = walking(world, ASPECT, &sampling.walk);
    world.set_frame(0);
    let driver = Driver::new(&world, fitted_cell(&world)?, |_| ())?;
    let (mut frustum, mut exact) = (Query::with_method(Method::Frustum)?, item_buffer(sampling.width));
    let new = |contender: Contender| WorthLine::new(&world.name, &contender.setting);
    let mut lines: Vec<WorthLine> = contenders()?.into_iter().map(new).collect();
    let mut least = vec![vec![f64::INFINITY; lines.len()]; world.frames];
    let (mut frames, mut judged) = (0.0, 0.0);
    for round in 0..sampling.rounds {
        let mut contenders = contenders()?;
        for (number, least) in least.iter_mut().enumerate() {
            let camera = world.camera(number, ASPECT);
            let in_frustum = driver.found(frustum.run(&driver.scene, &view_of(&camera)?));
            let input = FrameInput {
                driver: &driver,
                objects: &world.objects,
                in_frustum: &in_frustum,
                camera: &camera,
            };
            let (first, counts) = (round == 0, number % sampling.walk.frames.max(1) >= SETTLE);
            let judges = first && number % sampling.judge == sampling.judge / 2;
            let visible = if judges { visible_in(&mut exact, &world.objects, &camera) } else { Vec::new() };
            // Each frame starts with another one, so that none is always the one after the judgement.
            let count = contenders.len();
            for i in (0..count).map(|turn| (turn + number) % count) {
                let ms = contenders[i].run(&input)?.as_secs_f64() * 1e3;
                if counts {
                    least[i] = least[i].min(ms);
                    lines[i].set += if first { contenders[i].found().len() as f64 } else { 0.0 };
                }
                lines[i].visible += visible.len() as f64;
                lines[i].lost += visible.iter().filter(|&&o| !contenders[i].sees(o)).count() as f64;
            }
            frames += f64::from(u8::from(first && counts));
            judged += f64::from(u8::from(judges));
        }
    }
    for (i, line) in lines.iter_mut().enumerate() {
        line.ms = least.iter().map(|ms| ms[i]).filter(|ms| ms.is_finite()).sum::<f64>() / frames;
        (line.set, line.visible, line.lost) = (line.set / frames, line.visible / judged, line.lost / judged);
    }
    // It is given the objects in the frustum.
    lines[1].ms += lines[0].ms;
    Ok(lines)
}

/// The rows of a table as CSV, by columns.
fn rows(csv: &str) -> impl Iterator<Item = Vec<&str>> {
    csv.lines().skip(1).map(|row| row.split(',').collect())
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}

/// What was measured, as [`worth`] writes it, with the buffers that ship.
pub fn lines_of(worth: &str) -> Vec<WorthLine> {
    let mut lines = Vec::new();
    for row in rows(worth) {
        let [ms, set, visible, lost] = [2, 3, 4, 5].map(|i| number(row[i]));
        lines.push(WorthLine { ms, set, visible, lost, ..WorthLine::new(row[0], row[1]) });
    }
    for row in rows(BUFFERS) {
        let balanced = lines.iter().find(|line| line.scene == row[0] && line.method == BALANCED);
        let Some(balanced) = balanced else { continue };
        let [share, set, visible, lost] = [2, 3, 4, 5].map(|i| number(row[i]));
        // As many objects for each visible one.
        let (ms, set) = (share * balanced.ms, set / visible * balanced.visible);
        let line = WorthLine { ms, set, visible: balanced.visible, lost, ..WorthLine::new(row[0], row[1]) };
        lines.push(line);
    }
    lines
}

/// What a frame costs with each method, on the scenes that buffers that ship were measured on.
///
/// # Errors
/// If a scene cannot be read or is refused, or the chart not be written.
pub fn worth(lab: &Lab) -> Result<Section, LabError> {
    let (stretches, frames) = lab.pick((8, 45), (1, 12));
    let walk = WalkOptions { movers: 0, stretches, frames, seed: lab.seed };
    let sampling =
        Sampling { walk, rounds: lab.pick(5, 1), judge: lab.pick(18, 6), width: lab.pick(1920, 160) };
    let columns = ["scene", "method", "ms", "objects found", "visible", "lost in a frame"];
    let mut table = Table::new("worth", &columns);
    let built = SceneKind::ALL.iter().copied().map(Place::Built);
    let known = |name: &str| rows(BUFFERS).any(|row| row[0] == name);
    for place in built.chain(lab.files.iter().map(|f| Place::File(f))) {
        let world = place.open(lab)?;
        if !known(&world.name) || lab.quick && world.name != "harbour" {
            continue;
        }
        (lab.progress)(&world.name);
        for line in measure(world, &sampling)? {
            let [set, visible, lost] = [line.set, line.visible, line.lost].map(|v| format!("{v:.2}"));
            table.row([line.scene, line.method, format!("{:.4}", line.ms), set, visible, lost]);
        }
    }
    let lines = lines_of(&table.csv());
    let file = "worth.svg";
    draw(&lab.folder.join(file), &lines)?;
    let mut section = Section::new("What a hidden object is worth");
    let origin = rows(BUFFERS).next().map_or(String::new(), |row| format!("{} on {}", row[6], row[7]));
    section.text(format!(
        "A frame costs the time of its query, and the objects of its set times what one is worth: what it \
         costs to draw, skin or send. A person walks at 60 frames a second, as below, {} frames in \
         {stretches} places of each still scene; a frame counts with the least of {} walks, and times are \
         means over frames. `kept` is a `KeptQuery`, `hzb` has {}x{} pixels. Masked \
         Occlusion Culling (320x180 pixels, AVX2) and a rasterizer of baked quads (320x184, AVX2) are not \
         in this repository: their times are shares of that of `balanced` in one run of the same frames at \
         commit {origin}.",
        grouped(stretches * (frames - SETTLE)),
        sampling.rounds,
        BUFFER.0,
        BUFFER.1
    ));
    section.picture(
        file,
        "Milliseconds of a frame against what an object is worth, by each method on each scene",
    );
    section.text(finding(&lines));
    section.rows("All methods as CSV", table);
    let head: Vec<&str> = BUFFERS.lines().next().unwrap_or_default().split(',').collect();
    let mut buffers = Table::new("buffers", &head);
    rows(BUFFERS).for_each(|row| buffers.row(row.into_iter().map(str::to_owned)));
    section.rows("Buffers that ship as CSV", buffers);
    Ok(section)
}

/// From which worth of an object on, in microseconds, and up to 100, a method costs less than
/// another one: 0 if always, infinite if never.
fn from(ours: &WorthLine, theirs: &WorthLine) -> f64 {
    let worth = (ours.ms - theirs.ms) / (theirs.set - ours.set) * 1e3;
    match (ours.ms <= theirs.ms, ours.set < theirs.set) {
        (true, smaller) if smaller || worth > 100.0 => 0.0,
        (false, true) if worth <= 100.0 => worth,
        _ => f64::INFINITY,
    }
}

/// From which worth on the better of some methods costs less than each other one, in words.
fn beaten(lines: &[WorthLine], ours: &[&str]) -> String {
    let than = ["frustum only", "hzb", "MOC", "rasterizer"].map(|name| {
        let theirs: Vec<&WorthLine> = lines.iter().filter(|l| l.method == name).collect();
        let ours = |scene: &str| -> Vec<&WorthLine> {
            lines.iter().filter(|l| l.scene == scene && ours.contains(&l.method.as_str())).collect()
        };
        let least = |t: &&WorthLine| ours(&t.scene).iter().map(|o| from(o, t)).fold(f64::INFINITY, f64::min);
        let mut worths: Vec<f64> = theirs.iter().map(least).filter(|worth| worth.is_finite()).collect();
        worths.sort_by(f64::total_cmp);
        let from = match (worths.first(), worths.last()) {
            (Some(first), Some(last)) if last - first < 0.5 => format!(" (from {last:.0} µs)"),
            (Some(first), Some(last)) => format!(" (from {first:.0} to {last:.0} µs)"),
            _ => String::new(),
        };
        let name = if name == "frustum only" { "frustum culling alone" } else { name };
        format!("{name} in {} of {} scenes{from}", worths.len(), theirs.len())
    });
    than.join(", ")
}

/// What the chart shows, in words.
pub fn finding(lines: &[WorthLine]) -> String {
    let of_casca = |l: &&WorthLine| l.method.starts_with("casca");
    let lossy = |l: &&WorthLine| l.lost > 0.0;
    let buffers = || lines.iter().filter(|l| !of_casca(l) && l.method != "frustum only");
    format!(
        "With a fresh query a frame costs less than with {}. With results kept for a walking camera it costs \
         less than with {}. In the other scenes it costs more, even at 100 µs an object. Buffers lose visible \
         objects in {} of {} walks (dashed), casca in {}.",
        beaten(lines, &["casca fast", BALANCED]),
        beaten(lines, &["casca kept"]),
        buffers().filter(lossy).count(),
        buffers().count(),
        lines.iter().filter(of_casca).filter(lossy).count()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_set_pays_from_a_worth_on() {
        let line = |ms, set| WorthLine { ms, set, ..WorthLine::new("city", "hzb") };
        let (slow, quick) = (line(2.0, 100.0), line(1.0, 150.0));
        assert_eq!(from(&slow, &quick), 20.0);
        assert_eq!((from(&line(0.5, 100.0), &quick), from(&line(2.0, 149.0), &quick)), (0.0, f64::INFINITY));
        assert!(from(&quick, &slow).is_infinite());
        assert_eq!(from(&line(1.0, 100.0), &line(1.2, 99.0)), 0.0);
        let ours = WorthLine { method: "casca kept".to_owned(), ..slow };
        let said = finding(&[ours, WorthLine { lost: 0.1, ..quick }]);
        assert!(said.contains(
            "less than with frustum culling alone in 0 of 0 scenes, hzb in 1 of 1 scenes (from 20 µs)"
        ));
        assert!(said.ends_with("in 1 of 1 walks (dashed), casca in 0."), "{said}");
    }
}

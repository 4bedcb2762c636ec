//! A land larger than a grid: what a drive through it costs while pages come and go.

mod drive;
mod land;

pub use drive::{Drive, Frame, Sampling, drive};

use super::{Lab, LabError, Section, Table, grouped, median, p99};
use crate::pictures::palette::{CELL, POINT, other};
use crate::pictures::{Axis, Line, lines};

/// Frames of a point of the chart of times.
const BIN: usize = 50;

impl Sampling {
    /// A drive of eight kilometres, or a smoke run.
    pub fn new(lab: &Lab) -> Self {
        Self {
            frames: lab.pick(2000, 140),
            step: lab.pick(4.0, 24.0),
            radius: lab.pick(3, 1),
            window: lab.pick(16, 4),
            budget: lab.pick(6144, 2048),
            density: lab.pick(1.0, 0.1),
            judge: lab.pick(100, 20),
            width: lab.pick(640, 160),
            rays: 4,
            cars: lab.pick(200, 20),
            seed: lab.seed,
        }
    }
}

/// Drives through a land of 10 km by 10 km, with cells of a metre.
///
/// # Errors
/// If a chart cannot be written, and as the library's.
pub fn world(lab: &Lab) -> Result<Section, LabError> {
    world_to(lab).map(|(section, _)| section)
}

/// As [`world`], with the drive.
///
/// # Errors
/// As [`world`].
pub fn world_to(lab: &Lab) -> Result<(Section, Drive), LabError> {
    let sampling = Sampling::new(lab);
    let told = |done: usize| {
        if done.is_multiple_of(100) {
            (lab.progress)(&format!("frame {} of {}", grouped(done), grouped(sampling.frames)));
        }
    };
    let drive = drive(&sampling, told)?;
    let mut section = Section::on_its_own_page("A world larger than a grid");
    section.text(text(&sampling, &drive));
    section.table(times(&drive));
    charts(lab, &mut section, &drive)?;
    section.rows("All frames as CSV", frames(&drive));
    Ok((section, drive))
}

fn text(sampling: &Sampling, drive: &Drive) -> String {
    let last = drive.frames.last().copied().unwrap_or_default();
    let most = drive.frames.iter().map(|f| f.objects).max().unwrap_or(0);
    let bytes = || drive.frames.iter().filter(|f| f.bytes > 0);
    let least = bytes().map(|f| f.bytes).min().unwrap_or(0) as f64 / 1e6;
    let peak = bytes().map(|f| f.bytes).max().unwrap_or(0) as f64 / 1e6;
    let [lost, lost_kept] = drive.lost;
    format!(
        "A drive of {:.1} km through a land of 10 km by 10 km, made page by page from a seed, with cells of 1 m and pages of 512 m: towns, woods and \
         hills, {} kilometres from the origin of the world. Pages up to {} away from the eye's are loaded, of {:.0} objects on the mean, up to {} in all; \
         {} were loaded and {} dropped on the way. The window has {}x2x{} pages, and {} cars drive through them. A frame takes up to {} bricks of objects in \
         and out, and as many into the next scene while the window moves, which it did {} times. **Of {} visible objects in {} frames compared with exact \
         visibility, queries lost {} and kept queries {}**; all frames in which the window moved are among them. Sets are {:.2} times what is visible. \
         The world takes {least:.0} to {peak:.0} MB.\n\nTimes are of one thread. `Scene::shift_origin` on the scene at the end takes {:.0} ms, and to \
         move the window at once {:.0} ms: what the steps spread over many frames.",
        (last.way + sampling.step) / 1e3,
        grouped(4700),
        sampling.radius,
        drive.page_objects.iter().sum::<f64>() / drive.page_objects.len().max(1) as f64,
        grouped(most),
        drive.loaded,
        drive.dropped,
        sampling.window,
        sampling.window,
        sampling.cars,
        sampling.budget,
        drive.frames.iter().filter(|f| f.shifted).count(),
        grouped(drive.visible),
        grouped(drive.judged),
        grouped(lost),
        grouped(lost_kept),
        drive.found as f64 / drive.visible.max(1) as f64,
        drive.shift_origin,
        drive.at_once,
    )
}

/// Times of the steps of frames.
fn times(drive: &Drive) -> Table {
    let mut table = Table::new("world-times", &["step", "times", "median, ms", "p99, ms", "greatest, ms"]);
    let mut add = |name: &str, mut values: Vec<f64>| {
        let most = values.iter().copied().fold(0.0, f64::max);
        let figures = [median(&mut values), p99(&mut values), most].map(|v| format!("{v:.3}"));
        table.row([name.to_owned(), values.len().to_string()].into_iter().chain(figures));
    };
    let of = |which: &dyn Fn(&Frame) -> bool, value: &dyn Fn(&Frame) -> f64| {
        drive.frames.iter().filter(|f| which(f)).map(value).collect::<Vec<f64>>()
    };
    add("begin_frame, nothing to do", of(&|f| !f.streams && !f.shifting, &|f| f.begin));
    add("begin_frame, pages come or go", of(&|f| f.streams && !f.shifting, &|f| f.begin));
    add("begin_frame, the window moves", of(&|f| f.shifting && !f.shifted, &|f| f.begin));
    add("begin_frame, the window has moved", of(&|f| f.shifted, &|f| f.begin));
    add("moves of cars", of(&|f| !f.shifting, &|f| f.moves));
    add("moves of cars, the window moves", of(&|f| f.shifting, &|f| f.moves));
    add("query", of(&|f| !f.shifted, &|f| f.query));
    add("query, the window has moved", of(&|f| f.shifted, &|f| f.query));
    add("kept query", of(&|f| !f.shifted && f.kept > 0.0, &|f| f.kept));
    add("kept query, the window has moved", of(&|f| f.shifted, &|f| f.kept));
    add("end_frame", of(&|_| true, &|f| f.end));
    add("objects of a page made and checked, on any thread", drive.prepare.clone());
    add("an old scene dropped, on any thread", drive.retire.clone());
    table
}

fn charts(lab: &Lab, section: &mut Section, drive: &Drive) -> Result<(), LabError> {
    let bins = |value: fn(&Frame) -> f64| -> Vec<(f64, f64)> {
        let greatest = |bin: &[Frame]| bin.iter().map(value).fold(0.0, f64::max);
        drive.frames.chunks(BIN).map(|bin| (bin[0].way / 1e3, greatest(bin))).collect()
    };
    let most = |moves: bool| {
        let of = drive.frames.iter().filter(|f| f.shifting == moves && !f.shifted);
        of.map(|f| f.begin).fold(0.0, f64::max)
    };
    let title = format!(
        "Pages that come and go take up to {:.0} ms of a frame, a window that moves up to {:.0}",
        most(false),
        most(true)
    );
    let subtitle = format!("The greatest time of {BIN} frames, on the clock of the thread.");
    let all = [
        Line::new("query", POINT, bins(|f| f.query)),
        Line::new("begin_frame", CELL, bins(|f| f.begin)),
        Line::new(
            "begin_frame, the window moves",
            other(0),
            bins(|f| if f.shifting { f.begin } else { 0.0 }),
        ),
    ];
    let axes = (&Axis::linear("way, km"), &Axis::linear("time, ms"));
    lines(&lab.folder.join("world-times.svg"), &title, &subtitle, axes, &all)?;
    section.picture("world-times.svg", &title);
    let counted = || drive.frames.iter().filter(|f| f.bytes > 0);
    let title = "Memory follows what is loaded, and both scenes while the window moves";
    let all = [
        Line::new("memory, MB", POINT, counted().map(|f| (f.way / 1e3, f.bytes as f64 / 1e6)).collect()),
        Line::new(
            "objects, thousands",
            CELL,
            counted().map(|f| (f.way / 1e3, f.objects as f64 / 1e3)).collect(),
        ),
    ];
    let axes = (&Axis::linear("way, km"), &Axis::linear("MB, and thousands of objects"));
    lines(&lab.folder.join("world-memory.svg"), title, "Scenes and descriptions of objects.", axes, &all)?;
    section.picture("world-memory.svg", title);
    Ok(())
}

/// A row for each frame.
fn frames(drive: &Drive) -> Table {
    let columns = [
        "way, m",
        "begin_frame, ms",
        "moves, ms",
        "query, ms",
        "kept query, ms",
        "end_frame, ms",
        "objects",
        "found",
        "pages come or go",
        "window moves",
        "window has moved",
        "memory, MB",
    ];
    let mut table = Table::new("world", &columns);
    for f in drive.frames.iter().filter(|f| f.bytes > 0 || f.shifted) {
        let times = [f.begin, f.moves, f.query, f.kept, f.end].map(|v| format!("{v:.3}"));
        let marks = [f.streams, f.shifting, f.shifted].map(|v| u8::from(v).to_string());
        let memory = if f.bytes > 0 { format!("{:.1}", f.bytes as f64 / 1e6) } else { String::new() };
        let first = std::iter::once(format!("{:.1}", f.way)).chain(times);
        table.row(first.chain([f.objects.to_string(), f.found.to_string()]).chain(marks).chain([memory]));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_drive_loses_nothing_and_streams_and_shifts() {
        let (progress, folder) = (|_: &str| (), std::env::temp_dir());
        let lab = Lab { quick: true, seed: 1, files: Vec::new(), folder, progress: &progress };
        let drive = drive(&Sampling::new(&lab), |_| ()).unwrap();
        assert_eq!(drive.lost, [0, 0]);
        assert!(drive.judged >= 3 && drive.visible > 50 && drive.found >= drive.visible);
        assert!(drive.loaded > 9 && drive.dropped > 3, "{} {}", drive.loaded, drive.dropped);
        assert!(drive.frames.iter().any(|f| f.shifted) && !drive.retire.is_empty());
        assert_eq!(times(&drive).rows.len(), 13);
        assert!(!frames(&drive).rows.is_empty());
    }
}

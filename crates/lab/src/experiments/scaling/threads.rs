//! Queries of many views by several threads.

use casca::{Query, View};
use rayon::ThreadPoolBuilder;

use super::super::{LabError, Section, Table};
use super::bench::Bench;
use super::measure::{cameras, set_up};
use crate::pictures::palette::{EXACT, other};
use crate::pictures::{Axis, Line, lines};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed_by_wall;

const SCENES: [SceneKind; 3] = [SceneKind::Spheres, SceneKind::City, SceneKind::Terrain];
/// Views of one call.
const VIEWS: usize = 64;

/// The numbers of threads that are tried: powers of two up to the number of cores, and that number.
fn counts() -> Vec<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counts: Vec<usize> = (0..).map(|i| 1 << i).take_while(|&n| n < cores).collect();
    counts.push(cores);
    counts
}

pub(super) fn run(bench: &Bench, section: &mut Section) -> Result<(), LabError> {
    let (counts, repeats) = (counts(), bench.walks().repeats);
    let cores = counts.last().copied().unwrap_or(1);
    section.text(format!(
        "### Threads\n\n`Query::run_all` over {VIEWS} views of a walk, as one call, with 1 to {cores} threads: this machine has no more."
    ));
    let mut table =
        Table::new("scaling-threads", &["scene", "threads", "ms of a call", "views a second", "speed-up"]);
    let (mut all, mut gains) = (Vec::new(), Vec::new());
    for (i, kind) in SCENES.into_iter().enumerate() {
        (bench.lab.progress)(&format!("threads, {}", kind.name()));
        let world = build(kind, &SceneOptions { seed: bench.lab.seed, ..SceneOptions::default() });
        let (driver, _) = set_up(&world)?;
        let views: Vec<View> = cameras(&world, VIEWS).iter().map(view_of).collect::<Result<_, _>>()?;
        let mut queries: Vec<Query> = views.iter().map(|_| Query::new()).collect();
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut alone = 0.0;
        for &threads in &counts {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            let mut least = f64::INFINITY;
            // The first call takes memory.
            for call in 0..=repeats.max(1) {
                let time =
                    pool.install(|| timed_by_wall(|| Query::run_all(&mut queries, &driver.scene, &views)).1);
                least = if call > 0 { least.min(time.as_secs_f64()) } else { least };
            }
            alone = if threads == 1 { least } else { alone };
            let gain = alone / least.max(f64::MIN_POSITIVE);
            points.push((threads as f64, gain));
            table.row([
                kind.name().to_owned(),
                threads.to_string(),
                format!("{:.3}", least * 1e3),
                format!("{:.0}", views.len() as f64 / least.max(f64::MIN_POSITIVE)),
                format!("{gain:.2}"),
            ]);
            if threads == cores {
                gains.push(gain);
            }
        }
        all.push(Line::new(kind.name(), other(i), points));
    }
    let ideal = [1.0, cores as f64].map(|n| (n, n)).to_vec();
    all.push(Line::new("if threads cost nothing", EXACT.dashed(), ideal));
    let title = format!(
        "{cores} threads answer {:.2} to {:.2} times as many views a second as one",
        gains.iter().copied().fold(f64::INFINITY, f64::min),
        gains.iter().copied().fold(0.0, f64::max)
    );
    let file = "scaling-threads.svg";
    let axes = (&Axis::linear("threads"), &Axis::linear("views a second, over those of one thread"));
    lines(&bench.lab.folder.join(file), &title, "The best of several calls.", axes, &all)?;
    section.picture(file, &title);
    section.rows("All calls as CSV", table);
    Ok(())
}

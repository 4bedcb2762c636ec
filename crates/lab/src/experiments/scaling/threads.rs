//! Queries of many views, and of one, by several threads.

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
    one_query(bench, section, &counts)
}

/// Scenes of which a query takes long.
const SLOW: [SceneKind; 4] = [SceneKind::Town, SceneKind::Forest, SceneKind::Valley, SceneKind::Terrain];

/// Single queries whose work threads share, each view by itself.
fn one_query(bench: &Bench, section: &mut Section, counts: &[usize]) -> Result<(), LabError> {
    let walks = bench.walks();
    section.text(
        "One query at a time, of which the threads share the work (`Query::set_parallel`): the least time of each view, and the mean of those.",
    );
    let mut table = Table::new("scaling-query-threads", &["scene", "threads", "ms of a query", "speed-up"]);
    let mut all = Vec::new();
    for (i, kind) in SLOW.into_iter().enumerate() {
        (bench.lab.progress)(&format!("threads of one query, {}", kind.name()));
        let world = build(kind, &SceneOptions { seed: bench.lab.seed, ..SceneOptions::default() });
        let (driver, _) = set_up(&world)?;
        let views: Vec<View> = cameras(&world, walks.views).iter().map(view_of).collect::<Result<_, _>>()?;
        let mut query = Query::new();
        query.set_parallel(true);
        let (mut points, mut alone) = (Vec::new(), 0.0);
        for &threads in counts {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build()?;
            let mut least = vec![f64::INFINITY; views.len()];
            for _ in 0..=walks.repeats.max(1) * 5 {
                for (view, least) in views.iter().zip(&mut least) {
                    let run = || timed_by_wall(|| query.run(&driver.scene, view).len()).1;
                    *least = least.min(pool.install(run).as_secs_f64());
                }
            }
            let mean = least.iter().sum::<f64>() / least.len().max(1) as f64;
            alone = if threads == 1 { mean } else { alone };
            let gain = alone / mean.max(f64::MIN_POSITIVE);
            points.push((threads as f64, gain));
            let (time, gain) = (format!("{:.3}", mean * 1e3), format!("{gain:.2}"));
            table.row([kind.name().to_owned(), threads.to_string(), time, gain]);
        }
        all.push(Line::new(kind.name(), other(i), points));
    }
    let cores = counts.last().copied().unwrap_or(1) as f64;
    all.push(Line::new("if all work were shared", EXACT.dashed(), [1.0, cores].map(|n| (n, n)).to_vec()));
    let title = "One query, shared by threads";
    let file = "scaling-query-threads.svg";
    let axes = (&Axis::linear("threads"), &Axis::linear("times as fast as one thread"));
    lines(&bench.lab.folder.join(file), title, "The least time of each view.", axes, &all)?;
    section.picture(file, title);
    section.rows("All queries as CSV", table);
    Ok(())
}

//! Single figures beside their targets.

use casca::{Aabb, GridSpec, Query};

use super::super::upkeep::arena::Arena;
use super::super::{ASPECT, Effort, LabError, Section, Table, grouped, median};
use super::bench::Bench;
use super::measure::{Row, set_up};
use super::{preparation, worlds};
use casca_scenes::drive::{Driver, view_of};
use casca_scenes::measure::timed;
use casca_scenes::world::FRAME_SECONDS;

/// Movers in the hall of the updates.
const MOVERS: usize = 10_000;
/// Frames before the first that counts, in which hidden objects come into their volumes.
const SETTLE: usize = 40;

/// A figure with its target.
struct Figure {
    what: String,
    value: f64,
    unit: &'static str,
    target: f64,
    /// Whether the target is the least that the value should be, instead of the most.
    least: bool,
}

impl Figure {
    fn new(what: impl Into<String>, value: f64, unit: &'static str, target: f64) -> Self {
        Self { what: what.into(), value, unit, target, least: false }
    }

    fn is_met(&self) -> bool {
        if self.least { self.value >= self.target } else { self.value <= self.target }
    }
}

/// Nanoseconds to report one mover that is seen, and one that is in a volume: medians over frames.
fn updates(bench: &Bench) -> Result<[f64; 2], LabError> {
    let (count, frames) = if bench.effort == Effort::Quick { (500, 3) } else { (MOVERS, 30) };
    let arena = Arena { count, hidden: true, fast: false, seed: bench.lab.seed };
    let open = Arena { hidden: false, ..arena };
    let mut medians = [0.0; 2];
    for (which, arena) in [open, arena].into_iter().enumerate() {
        let mut world = arena.build();
        let grid = GridSpec::fit(Aabb::new(world.grid.min, world.grid.max), count)?;
        let mut driver = Driver::new(&world, &grid, |_| ())?;
        let mut query = Query::new();
        let mut each = Vec::new();
        for frame in 0..SETTLE + frames {
            let moved = world.set_frame(frame);
            driver.scene.begin_frame(frame as f64 * FRAME_SECONDS)?;
            let held = |&&i: &&usize| matches!(driver.scene.tbv(driver.id(i)), Ok(Some(_)));
            let (hidden, seen): (Vec<usize>, Vec<usize>) = moved.iter().partition(held);
            let (chosen, rest) = if which == 0 { (seen, hidden) } else { (hidden, seen) };
            driver.update(&world.objects, &rest)?;
            let (updated, time) = timed(|| driver.update(&world.objects, &chosen));
            updated?;
            if frame >= SETTLE && !chosen.is_empty() {
                each.push(time.as_secs_f64() * 1e9 / chosen.len() as f64);
            }
            query.run(&driver.scene, &view_of(&world.camera(frame, ASPECT))?);
            driver.scene.end_frame([query.pvs()])?;
        }
        medians[which] = median(&mut each);
    }
    Ok(medians)
}

fn all(bench: &Bench, hidden: &[Row], movers: &[Row]) -> Result<Vec<Figure>, LabError> {
    (bench.lab.progress)("single figures");
    let [seen, held] = updates(bench)?;
    let mut figures = vec![
        Figure::new("update of a visible mover", seen, "ns", 250.0),
        Figure::new("update of a hidden mover", held, "ns", 80.0),
    ];
    let count = bench.sizes([10_000], [100_000], [1_000_000]).last().copied().unwrap_or(0);
    let (driver, seconds) = set_up(&worlds::scatter(count, bench.lab.seed))?;
    let (small, memory) = (grouped(count), driver.scene.memory().total() as f64);
    drop(driver);
    figures.push(Figure::new(format!("setup of {small} small static spheres"), seconds, "s", 5.0));
    figures.push(Figure::new(format!("memory of {small} small static spheres"), memory / 1e6, "MB", 300.0));
    if let Some(last) = hidden.last() {
        let objects = grouped(last.objects);
        figures.push(Figure::new(
            format!("setup of the largest scene of hidden objects, {objects}"),
            last.setup,
            "s",
            5.0,
        ));
        figures.push(Figure::new(
            format!("memory of the largest scene of hidden objects, {objects}"),
            last.memory / 1e6,
            "MB",
            300.0,
        ));
    }
    if let Some(last) = movers.last() {
        let what = format!("query that finds {} visible movers", grouped(last.found.round() as usize));
        figures.push(Figure::new(what, last.point.median, "ms", 15.0));
    }
    let triangles = bench.sizes([10_000], [1_000_000], []);
    let soup = worlds::soup(triangles[0], bench.lab.seed);
    let (seconds, triangles, _) = preparation::prepare(std::slice::from_ref(&soup))?;
    let rate = triangles as f64 / seconds.max(f64::MIN_POSITIVE);
    let what = format!("preparation of a soup of {} triangles, on one core", grouped(triangles));
    figures.push(Figure { least: true, ..Figure::new(what, rate, "triangles a second", 1e6) });
    Ok(figures)
}

pub(super) fn run(
    bench: &Bench,
    section: &mut Section,
    hidden: &[Row],
    movers: &[Row],
) -> Result<(), LabError> {
    let mut table = Table::new("scaling-figures", &["figure", "measured", "unit", "target", "met"]);
    for f in all(bench, hidden, movers)? {
        let digits = if f.value < 10.0 { 2 } else { 0 };
        let met = if f.is_met() { "yes" } else { "no" };
        let bound = if f.least { "at least" } else { "at most" };
        table.row([
            f.what,
            format!("{:.digits$}", f.value),
            f.unit.to_owned(),
            format!("{bound} {}", grouped(f.target as usize)),
            met.to_owned(),
        ]);
    }
    section.text(format!(
        "### Single figures\n\nUpdates are those of {} slow spheres in the hall of the upkeep experiment: visible ones in the open, hidden \
         ones behind the wall, in their volumes. The targets are those for a million objects, 100,000 movers and a million triangles, which \
         only a full run has. The spheres of the hall are larger than the small ones, up to 5.5 m in radius.",
        grouped(MOVERS)
    ));
    section.table(table);
    Ok(())
}

//! How times and memory grow: with hidden and visible objects, triangles, pixels and threads.

mod bench;
mod charts;
mod figures;
mod measure;
mod preparation;
mod resolution;
mod sharing;
#[cfg(test)]
mod tests;
mod threads;
mod worlds;

use self::bench::Bench;
use self::charts::{Chart, growth, queries, setups, table};
use self::measure::Row;
use super::upkeep::arena::Arena;
use super::{Effort, Lab, LabError, Section, grouped};
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::World;

/// How the default method scales, as far as the report goes.
///
/// # Errors
/// If a picture cannot be written, or a scene is refused.
pub fn scaling(lab: &Lab) -> Result<Section, LabError> {
    scaling_to(lab, lab.pick(Effort::Full, Effort::Quick))
}

/// How the default method scales, up to sizes that are chosen.
///
/// # Errors
/// As [`scaling()`].
pub fn scaling_to(lab: &Lab, effort: Effort) -> Result<Section, LabError> {
    let bench = Bench { lab, effort };
    let mut section = Section::on_its_own_page("Scaling");
    let walks = bench.walks();
    section.text(format!(
        "Fresh queries of `point` at its default options from {} views, each with the least of {} runs; medians and 99th \
         percentiles (p99) over the views. `hzb` has 320x180 pixels and gets the objects in the frustum for nothing. One thread, grids of \
         `GridSpec::fit`. *Setup* makes the scene and inserts all objects; *memory* is `Scene::memory().total()` after the queries.",
        walks.views, walks.repeats
    ));
    let hidden = hidden(&bench, &mut section)?;
    let movers = movers(&bench, &mut section)?;
    let solids = solids(&bench, &mut section)?;
    let ground = triangles(&bench, &mut section)?;
    let setup = [
        ("static spheres, most hidden", &hidden),
        ("movers", &movers),
        ("static spheres that hide", &solids),
    ];
    setups(lab, &mut section, &setup)?;
    let series = [("hidden", &hidden), ("movers", &movers), ("solids", &solids), ("triangles", &ground)];
    section.rows("All sizes as CSV", table(&series));
    preparation::run(&bench, &mut section)?;
    resolution::run(&bench, &mut section)?;
    threads::run(&bench, &mut section)?;
    sharing::run(&bench, &mut section)?;
    figures::run(&bench, &mut section, &hidden, &movers)?;
    Ok(section)
}

/// More and more objects beyond the walls of a hall of spheres.
fn hidden(bench: &Bench, section: &mut Section) -> Result<Vec<Row>, LabError> {
    section.text(
        "### Hidden objects\n\nThe 5,000 spheres of the thesis stand in a hall with closed walls; more and more static spheres \
         lie beyond them, as densely, where nobody sees them.",
    );
    let sizes = bench.sizes([500, 2000], [5000, 20_000, 100_000], [300_000, 1_000_000]);
    let options = |n| SceneOptions { seed: bench.lab.seed, beyond_walls: Some(n), ..SceneOptions::default() };
    let rows = bench.series("hidden objects", &sizes, |n| build(SceneKind::Spheres, &options(n)))?;
    let (point, hzb) = (growth(&rows, |r| r.point.median), growth(&rows, |r| r.hzb.median));
    let title = format!(
        "With {} times as many hidden objects, a query of point takes {point:.2} times as long, one of hzb {hzb:.2} times",
        grouped(growth(&rows, |r| r.size).round() as usize)
    );
    let chart = Chart { file: "scaling-hidden.svg", title, of: "hidden objects" };
    queries(bench.lab, section, &chart, &rows)?;
    Ok(rows)
}

/// The finding of a chart about visible objects.
fn for_each_visible(rows: &[Row], of: &str) -> String {
    let last = rows.last().map_or((0.0, 0.0), |r| (r.found, r.point.median));
    format!(
        "{:.0} times the {of}: a query takes {:.0} times as long, {:.2} ms for the {} that are found",
        growth(rows, |r| r.found),
        growth(rows, |r| r.point.median),
        last.1,
        grouped(last.0.round() as usize)
    )
}

/// Movers in the open that hide nothing.
fn movers(bench: &Bench, section: &mut Section) -> Result<Vec<Row>, LabError> {
    section.text(
        "### Visible objects\n\nSmall spheres that move and hide nothing, in an open hall: nearly all that lie in the view are \
         visible. Then static spheres that hide others, side by side on a shell around the eye, so that all are visible; `hzb` does not draw those that are smaller than a pixel.",
    );
    let sizes = bench.sizes([100, 500], [100, 1000, 10_000], [30_000, 100_000]);
    let seed = bench.lab.seed;
    let build = |count| {
        // The view holds about five of six.
        let arena = Arena { count: count * 6 / 5, hidden: false, fast: false, seed };
        World { frames: 150, ..arena.build() }
    };
    let rows = bench.series("visible movers", &sizes, build)?;
    let title = for_each_visible(&rows, "visible movers");
    let chart = Chart { file: "scaling-movers.svg", title, of: "moving objects, most of them visible" };
    queries(bench.lab, section, &chart, &rows)?;
    Ok(rows)
}

/// Occluders that are all visible.
fn solids(bench: &Bench, section: &mut Section) -> Result<Vec<Row>, LabError> {
    let sizes = bench.sizes([100, 500], [100, 1000, 10_000], [30_000, 100_000]);
    let rows = bench.series("visible occluders", &sizes, |n| worlds::shell(n, bench.lab.seed))?;
    let title = for_each_visible(&rows, "visible occluders");
    let chart = Chart { file: "scaling-occluders.svg", title, of: "spheres that hide, all of them visible" };
    queries(bench.lab, section, &chart, &rows)?;
    Ok(rows)
}

/// The same ground with more and more triangles.
fn triangles(bench: &Bench, section: &mut Section) -> Result<Vec<Row>, LabError> {
    section.text(
        "### Triangles\n\nThe same rolling ground of 320 m, as 100 meshes with more and more triangles, and 2,000 boxes on it. The \
         eye is 1.7 m above it.",
    );
    let sizes = bench.sizes([2000, 20_000], [10_000, 100_000, 1_000_000], [10_000_000]);
    let rows = bench.series("triangles", &sizes, |n| worlds::ground(n, bench.lab.seed))?;
    let (point, hzb) = (growth(&rows, |r| r.point.median), growth(&rows, |r| r.hzb.median));
    let title = format!(
        "{:.0} times the triangles: a query of point takes {point:.1} times as long, one of hzb {hzb:.0} times",
        growth(&rows, |r| r.size)
    );
    let chart = Chart { file: "scaling-triangles.svg", title, of: "triangles of the ground" };
    queries(bench.lab, section, &chart, &rows)?;
    Ok(rows)
}

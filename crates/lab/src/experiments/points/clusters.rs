//! Hidden point removal by clusters: errors against their number.

use casca_points::cluster::{Clustering, Passes, Radius, cluster_count};

use super::judge::{COLUMNS, Confusion};
use super::study::{ByClusters, Study, best, by_clusters, by_hull, spherical, steps, sweep};
use crate::experiments::{LabError, Table, median};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::measure::timed;

/// The ways to choose the radius for clusters.
const WAYS: [(&str, Radius, Passes); 4] = [
    ("radius as given", Radius::AsGiven, Passes::One),
    ("radius rescaled", Radius::Rescaled, Passes::One),
    ("rescaled, two passes", Radius::Rescaled, Passes::Two),
    // By hand: the best of many radii.
    ("radius by hand", Radius::AsGiven, Passes::One),
];

/// Errors of grids and octrees by the number of clusters.
pub(super) fn clusters(study: &mut Study, radius: f64) -> Result<(), LabError> {
    let grids = study.lab.pick(vec![8, 16, 24, 37, 64, 128], vec![16, 37]);
    let leaves = study.lab.pick(vec![256, 64, 32, 17, 8, 4, 2], vec![64, 17]);
    let values = steps(0.0, 3.5, study.lab.pick(0.25, 0.5));
    let grids = grids.into_iter().map(|n| (format!("grid {n}^3"), Clustering::Grid { cells: [n; 3] }));
    let leaves = leaves.into_iter().map(|n| (format!("octree {n}"), Clustering::Octree { max_points: n }));
    let hare = study.hare();
    let points = hare.places();
    let of_hull = time(|| by_hull(hare, spherical(radius)).map(|_| ()))?;
    let heads: Vec<&str> =
        ["clusters of", "clusters", "way", "log10 R", "time / HPR"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::new("points-clusters", &heads);
    let mut errors: [[Vec<(f64, f64)>; 4]; 2] = Default::default();
    let mut of_thesis: Vec<f64> = Vec::new();
    for (name, clustering) in grids.chain(leaves) {
        (study.lab.progress)(&format!("clusters: {name}"));
        let count = cluster_count(&points, clustering)?;
        for (i, (way, scale, passes)) in WAYS.into_iter().enumerate() {
            let ask = |log| {
                let how = ByClusters { clustering, radius: scale, passes };
                by_clusters(hare, spherical(log), how)
            };
            let (log, counts) = match i {
                3 => best(&sweep(hare, &values, ask)?),
                _ => (radius, Confusion::of(&hare.truth, &ask(radius)?)),
            };
            let share = time(|| ask(log).map(|_| ()))? / of_hull;
            let cells =
                [name.clone(), count.to_string(), way.to_owned(), format!("{log:.2}"), format!("{share:.2}")];
            table.row(cells.into_iter().chain(counts.cells()));
            let kind = usize::from(name.starts_with("octree"));
            errors[kind][i].push((count as f64, counts.error()));
            if i == 1 && ["grid 37^3", "octree 17"].contains(&name.as_str()) {
                of_thesis.push(counts.error());
            }
        }
    }
    let mut drawn = Vec::new();
    for (kind, name) in ["grid", "octree"].into_iter().enumerate() {
        for (i, (way, ..)) in WAYS.into_iter().enumerate() {
            let style = if kind == 0 { other(i).dashed() } else { other(i) };
            drawn.push(Line::new(format!("{name}, {way}"), style, errors[kind][i].clone()));
        }
    }
    let worst = of_thesis.iter().copied().fold(0.0, f64::max);
    let title =
        format!("With the thesis' numbers of clusters and a rescaled radius E is at most {worst:.1}%");
    let file = "points-clusters.svg";
    let axes = (&Axis::log("clusters for the points of the hare"), &Axis::log("E, percent"));
    lines(
        &study.lab.folder.join(file),
        &title,
        "Fewer clusters are faster and err more. Dashed: grids.",
        axes,
        &drawn,
    )?;
    study.section.text(format!(
        "### Clusters\n\nHPR of one centroid for each cell of a grid or leaf of an octree, on the hare, with log10 R = {radius:.2}. *As given* keeps that radius \
         for the centroids; they are farther apart, so that the far side shows between them. *Rescaled* divides it by the points for each cluster. \
         *By hand* is the best of {} radii. Times are those of one run on a shared machine, over the time of HPR with all points.",
        values.len()
    ));
    study.section.picture(file, &title);
    study.section.table(table);
    study.target(
        "Grid 37^3 and octree 17 on the hare with the rescaled radius, the worse E",
        worst,
        6.0,
        "%",
    );
    Ok(())
}

/// The median time of three calls in seconds.
fn time(mut call: impl FnMut() -> Result<(), LabError>) -> Result<f64, LabError> {
    let mut times = Vec::new();
    for _ in 0..3 {
        let (done, time) = timed(&mut call);
        done?;
        times.push(time.as_secs_f64());
    }
    Ok(median(&mut times))
}

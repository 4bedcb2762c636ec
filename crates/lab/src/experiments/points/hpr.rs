//! Hidden point removal: its radius, its kernels, and noise.

use bitvec::vec::BitVec;
use casca_points::hpr::Kernel;
use casca_points::spacing::automatic_radius;
use casca_points::splat::{Bias, Filter, Radius, SplatOptions};

use super::cloud::Cloud;
use super::judge::{COLUMNS, Confusion};
use super::study::{
    ByClusters, RADII, SIZE, Study, Sweep, best, by_clusters, by_hull, by_splats, line, spherical, steps,
    sweep,
};
use crate::experiments::{LabError, Table};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};

/// Errors against the radius, for all clouds. Returns the best radius for the hare.
pub(super) fn radius(study: &mut Study) -> Result<f64, LabError> {
    let values = steps(0.0, 5.0, study.lab.pick(0.25, 1.0));
    let heads: Vec<&str> = ["cloud", "radius", "log10 R"].into_iter().chain(COLUMNS).collect();
    let mut rows = Table::new("points-radius", &heads);
    let mut table = Table::new("points-radius-best", &heads);
    let mut all: Vec<(String, Sweep)> = Vec::new();
    for cloud in &study.clouds {
        (study.lab.progress)(&format!("radius of HPR, {}", cloud.name));
        let found = sweep(cloud, &values, |r| by_hull(cloud, spherical(r)))?;
        let cells = |way: &str, (r, counts): &(f64, Confusion)| {
            [cloud.name.clone(), way.to_owned(), format!("{r:.2}")].into_iter().chain(counts.cells())
        };
        found.iter().for_each(|at| rows.row(cells("given", at)));
        table.row(cells("by hand", &best(&found)));
        let own = sweep(cloud, &[automatic(cloud)?], |r| by_hull(cloud, spherical(r)))?;
        table.row(cells("automatic", &own[0]));
        all.push((cloud.name.clone(), found));
    }
    let (best_radius, counts) = best(&all[0].1);
    study.section.text(
        "### HPR: the radius\n\nA small radius hides points in hollows, a large one lets points of the far side through the gaps between points. The \
         table has the best radius of each cloud by hand, and an automatic one. A gap of the angle a shows points that are less than R a^2 / 4 behind it; so with \
         R = 4 r^2 / s, for the largest distance r and the automatic radius s of splats, points are hidden that lie a spacing or more behind a gap of a spacing.",
    );
    let file = "points-radius.svg";
    let title =
        format!("HPR of the hare errs least at log10 R = {best_radius:.2}: E is {:.2}%", counts.error());
    let drawn = [
        Line::new("false hidden", other(0), line(&all[0].1, |c| c.percent(c.false_hidden))),
        Line::new("false visible", other(1), line(&all[0].1, |c| c.percent(c.false_visible))),
        Line::new("E, half of their sum", other(2).dashed(), line(&all[0].1, Confusion::error)),
    ];
    let axes = (
        &Axis::linear("log10 R"),
        &Axis { holds: vec![0.01, 100.0], ..Axis::log("percent of the truly visible points") },
    );
    let subtitle = "Each kind of error by the radius; without a mark there is no such error.";
    lines(&study.lab.folder.join(file), &title, subtitle, axes, &drawn)?;
    study.section.picture(file, &title);
    let file = "points-radius-clouds.svg";
    let drawn: Vec<Line> = all
        .iter()
        .enumerate()
        .map(|(i, (name, s))| Line::new(name, other(i), line(s, Confusion::error)))
        .collect();
    let least: Vec<String> = all.iter().map(|(name, s)| format!("{name} {:.2}", best(s).0)).collect();
    let title = format!("The best log10 R by cloud: {}", least.join(", "));
    let axes = (&Axis::linear("log10 R"), &Axis::log("E, percent"));
    lines(&study.lab.folder.join(file), &title, "E by the radius.", axes, &drawn)?;
    study.section.picture(file, &title);
    study.section.table(table);
    study.section.rows("All radii as CSV", rows);
    study.target("HPR of the hare at its best radius, E", counts.error(), 2.0, "%");
    Ok(best_radius)
}

/// The logarithm of a radius that needs no hand: see the text of [`radius`].
fn automatic(cloud: &Cloud) -> Result<f64, LabError> {
    let eye = cloud.look.eye;
    let farthest = cloud.points.iter().map(|p| p.distance(eye)).fold(0.0, f32::max);
    let ratio = 4.0 * farthest / automatic_radius(&cloud.points)?;
    Ok(f64::from(ratio).log10().max(0.0))
}

/// Errors of the exponential kernel.
pub(super) fn exponential(study: &mut Study) -> Result<(), LabError> {
    let logs = steps(-4.5, 0.0, study.lab.pick(0.25, 1.5));
    let heads: Vec<&str> = ["gamma"].into_iter().chain(COLUMNS).collect();
    let (mut table, hare) = (Table::new("points-exponential", &heads), study.hare());
    let kernel = |log: f64| Kernel::Exponential { gamma: -(10_f64.powf(log)) };
    let found = sweep(hare, &logs, |log| by_hull(hare, kernel(log)))?;
    for (log, counts) in &found {
        table.row([format!("{:.5}", -(10_f64.powf(*log)))].into_iter().chain(counts.cells()));
    }
    let (log, counts) = best(&found);
    study.section.text(format!(
        "### HPR: the exponential kernel\n\nA point at the distance r goes to r^gamma (Katz & Tal 2015). On the hare E is {:.2}% at the best gamma, {:.5}.",
        counts.error(),
        -(10_f64.powf(log))
    ));
    study.section.rows("All exponents as CSV", table);
    Ok(())
}

/// Errors against noise, for all operators.
pub(super) fn noise(study: &mut Study, radius: f64) -> Result<(), LabError> {
    let sigmas = study.lab.pick(vec![0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2], vec![0.0, 3e-3]);
    let values = steps(0.5, 3.5, study.lab.pick(0.25, 1.0));
    let hare = study.hare();
    let names = [
        "HPR, radius as without noise",
        "HPR, best radius",
        "octree clusters of 17",
        "splats, automatic radius",
    ];
    let heads: Vec<&str> = ["noise", "method", "parameter"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::new("points-noise", &heads);
    let mut errors: [Vec<(f64, f64)>; 4] = Default::default();
    for sigma in sigmas {
        (study.lab.progress)(&format!("noise of {sigma}"));
        let noisy = hare.noisy(sigma as f32, study.lab.seed);
        let judge = |found: BitVec| Confusion::of(&noisy.truth, &found);
        let tuned = best(&sweep(&noisy, &values, |r| by_hull(&noisy, spherical(r)))?);
        let size = automatic_radius(&noisy.points)?;
        let splats = SplatOptions {
            radius: Radius::Same(size),
            bias: Bias::World(RADII * size),
            filter: Filter::Max,
            slopes: false,
        };
        let answers = [
            (radius, judge(by_hull(&noisy, spherical(radius))?)),
            tuned,
            (radius, judge(by_clusters(&noisy, spherical(radius), ByClusters::OCTREE)?)),
            (f64::from(size), judge(by_splats(&noisy, SIZE, &splats)?)),
        ];
        for (i, (parameter, counts)) in answers.iter().enumerate() {
            let cells = [format!("{sigma}"), names[i].to_owned(), format!("{parameter:.4}")];
            table.row(cells.into_iter().chain(counts.cells()));
            errors[i].push((sigma, counts.error()));
        }
    }
    let last = |i: usize| errors[i].last().map_or(0.0, |p| p.1);
    let title = format!(
        "With noise of 1% of the diagonal E is {:.0}% for HPR, {:.0}% at the best radius for the noise, {:.0}% for clusters, {:.0}% for splats",
        last(0),
        last(1),
        last(2),
        last(3)
    );
    let drawn: Vec<Line> = errors
        .into_iter()
        .zip(names)
        .enumerate()
        .map(|(i, (e, name))| Line::new(name, other(i), e))
        .collect();
    let axes = (
        &Axis::log("standard deviation of the noise over the diagonal of the bounding box"),
        &Axis::linear("E, percent"),
    );
    let file = "points-noise.svg";
    lines(
        &study.lab.folder.join(file),
        &title,
        "E on the hare. The truth is that of the points without noise.",
        axes,
        &drawn,
    )?;
    study.section.text(
        "### Noise\n\nNoise lifts points off the surface. HPR finds those hidden that end up behind their neighbours. Splats have the automatic radius \
         of the noisy points and a tolerance of 3.5 such radii, which both grow with the noise.",
    );
    study.section.picture(file, &title);
    study.section.table(table);
    Ok(())
}

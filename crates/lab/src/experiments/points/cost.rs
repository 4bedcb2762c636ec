//! Time by the number of points.

use casca_points::cluster::{Clustering, Passes, Radius as ClusterRadius, visible_clusters};
use casca_points::hpr::visible_points;
use casca_points::splat::{Filter, Radius, SplatOptions};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cloud::Cloud;
use super::hare::hare;
use super::sample::Sampler;
use super::study::{Study, THESIS_BIAS, spherical};
use crate::experiments::{Effort, LabError, Table, grouped, median};
use crate::pictures::palette::other;
use crate::pictures::{Axis, Line, lines};
use casca_scenes::measure::timed_by_wall;
use casca_scenes::random::generator;

/// The size of pictures.
const SIZE: (u32, u32) = (1024, 768);
/// Points that one generator draws: results do not depend on threads.
const CHUNK: usize = 1 << 16;
/// Up to so many points the median of three runs is taken; more take seconds each.
const REPEATED: usize = 3_000_000;

/// Random points of the hare, as many as asked for.
fn random(count: usize, seed: u64) -> Result<(Vec<Vec3>, f32), LabError> {
    let mesh = hare(110);
    let sampler = Sampler::new(&mesh).ok_or("the hare has no area")?;
    let mut points = vec![Vec3::ZERO; count];
    points.par_chunks_mut(CHUNK).enumerate().for_each(|(i, chunk)| {
        let mut random = generator(seed.wrapping_add(i as u64), 0xc057);
        chunk.iter_mut().for_each(|p| *p = sampler.draw(&mut random).point);
    });
    Ok((points, (sampler.area() / count as f64).sqrt() as f32))
}

/// Nanoseconds for each point: the median of some runs, after one that does not count if there are
/// several.
fn nanoseconds(
    count: usize,
    mut call: impl FnMut() -> Result<usize, LabError>,
) -> Result<(f64, usize), LabError> {
    let runs = if count <= REPEATED { 3 } else { 1 };
    let mut found = if runs > 1 { call()? } else { 0 };
    let mut times = Vec::new();
    for _ in 0..runs {
        // Several threads share the work of splats.
        let (answer, time) = timed_by_wall(&mut call);
        found = answer?;
        times.push(time.as_secs_f64() * 1e9 / count as f64);
    }
    Ok((median(&mut times), found))
}

/// The operators that are timed.
const OPERATORS: [&str; 4] = ["HPR", "clusters (octree 17)", "splats, no filter", "splats, max filter"];

/// Nanoseconds for each point, and the points found visible, by operator; `None` for hulls if they
/// are not asked for.
fn operators(
    count: usize,
    hulls: bool,
    seed: u64,
    radius: f64,
) -> Result<[Option<(f64, usize)>; 4], LabError> {
    let look = Cloud::hare(1000).look;
    let (camera, eye) = (look.camera(SIZE)?, look.eye.as_dvec3());
    let (points, spacing) = random(count, seed)?;
    // A random surface has gaps: its spacing is no bound for them.
    let splat = |filter| {
        let options =
            SplatOptions { radius: Radius::Same(spacing), bias: THESIS_BIAS, filter, slopes: false };
        Ok(casca_points::splat::visible_points(&points, &camera, &options)?.visible.count_ones())
    };
    let splats =
        [Some(nanoseconds(count, || splat(Filter::None))?), Some(nanoseconds(count, || splat(Filter::Max))?)];
    if !hulls {
        return Ok([None, None, splats[0], splats[1]]);
    }
    let places: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let kernel = spherical(radius);
    let hull = nanoseconds(count, || Ok(visible_points(&places, eye, kernel)?.count_ones()))?;
    let octree = Clustering::Octree { max_points: 17 };
    let ask = || visible_clusters(&places, eye, kernel, octree, ClusterRadius::Rescaled, Passes::One);
    let clusters = nanoseconds(count, || Ok(ask()?.count_ones()))?;
    Ok([Some(hull), Some(clusters), splats[0], splats[1]])
}

/// Charts the time of a point.
pub(super) fn cost(study: &mut Study, effort: Effort, radius: f64) -> Result<(), LabError> {
    let (hulls, splats) = match effort {
        Effort::Quick => (10_000, 30_000),
        Effort::Short => (1_000_000, 10_000_000),
        Effort::Full => (10_000_000, 100_000_000),
    };
    let mut table = Table::new(
        "points-cost",
        &["points", "operator", "ns a point", "million points a second", "found visible"],
    );
    let mut series: [Vec<(f64, f64)>; 4] = Default::default();
    let sizes =
        (0..).map(|i| [10_000, 30_000][i % 2] * 10_usize.pow(i as u32 / 2)).take_while(|&n| n <= splats);
    for count in sizes {
        (study.lab.progress)(&format!("cost: {} points", grouped(count)));
        let measured = operators(count, count <= hulls, study.lab.seed, radius)?;
        for (i, measured) in measured.into_iter().enumerate() {
            let Some((time, found)) = measured else { continue };
            table.row([
                count.to_string(),
                OPERATORS[i].to_owned(),
                format!("{time:.2}"),
                format!("{:.1}", 1e3 / time),
                found.to_string(),
            ]);
            series[i].push((count as f64, time));
        }
    }
    let last = |i: usize| series[i].last().copied().unwrap_or_default();
    let title = format!(
        "A point takes {:.0} ns by HPR of {} points and {:.1} ns by splats of {}",
        last(0).1,
        grouped(last(0).0 as usize),
        last(3).1,
        grouped(last(3).0 as usize)
    );
    let drawn: Vec<Line> = series
        .into_iter()
        .zip(OPERATORS)
        .enumerate()
        .map(|(i, (s, name))| Line::new(name, other(i), s))
        .collect();
    let axes = (&Axis::log("points"), &Axis::log("nanoseconds a point"));
    let file = "points-cost.svg";
    let threads = rayon::current_num_threads();
    let subtitle = format!(
        "Random points of the hare. HPR and clusters run on one thread, splats on {threads}, with a picture of {}x{} pixels.",
        SIZE.0, SIZE.1
    );
    lines(&study.lab.folder.join(file), &title, &subtitle, axes, &drawn)?;
    study.section.text(format!(
        "### Cost\n\nThe time of a point by the number of points, the median of three runs, one run from {} points on. Few points of a splat image pay for its pixels.",
        grouped(REPEATED)
    ));
    study.section.picture(file, &title);
    study.section.table(table);
    Ok(())
}

//! Cost and accuracy against the resolution of the grid (section 4.6, figures 4.7 and 4.8): the 4,800
//! static spheres from some viewpoints of the walk, on grids of cubic cells with N of them along the
//! longest axis. The solution point is the N of the fastest frame: query, and drawing the PVS in
//! software.

use casca::{Aabb, Method, View, cell_for};

use super::super::stage::{Stage, Telling, ms};
use super::super::walker::visible_in;
use super::super::{ASPECT, Lab, LabError};
use super::setting::{EXACT, Finding, SCREEN, across, mean, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::{Camera, Motion};
use casca_truth::baselines::Hzb;
use casca_truth::oracle::ItemBuffer;

/// A method on a grid of `cells` along the longest axis; milliseconds and objects of each
/// viewpoint.
struct Run {
    cells: u32,
    method: usize,
    stage: Stage,
    query: Vec<f64>,
    drawing: Vec<f64>,
    found: Vec<f64>,
}

/// A point on the curves of one method.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    cells: f64,
    query: f64,
    frame: f64,
    ratio: f64,
}

const METHODS: [Method; 2] = [Method::cell(), Method::point()];

/// The point where a value is least.
fn best(points: &[Point], value: fn(&Point) -> f64) -> Point {
    points.iter().copied().min_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or_default()
}

/// The value of a curve at x, on the straight line between the points around it.
fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let i = points.partition_point(|p| p.0 < x);
    match (i.checked_sub(1).and_then(|j| points.get(j)), points.get(i)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0),
        (a, b) => a.or(b).map_or(0.0, |p| p.1),
    }
}

fn curve(points: &[Point], value: fn(&Point) -> f64) -> Vec<(f64, f64)> {
    points.iter().map(|p| (p.cells, value(p))).collect()
}

pub(super) fn run(lab: &Lab) -> Result<Vec<Finding>, LabError> {
    let cells: Vec<u32> =
        lab.pick(vec![10, 20, 25, 30, 40, 55, 70, 85, 100, 130, 160], vec![10, 25, 70, 100, 160]);
    let viewpoints: Vec<usize> = lab.pick(vec![15, 45, 75, 105, 135], vec![75]);
    let repeats = lab.pick(5, 2);
    let mut world = build(SceneKind::Spheres, &SceneOptions { seed: lab.seed, ..SceneOptions::default() });
    world.objects.retain(|o| o.motion == Motion::Static);
    let region = Aabb::new(world.grid.min, world.grid.max);
    let fit = ((region.max - region.min).max_element() / cell_for(region, world.objects.len())?).round();
    let cameras: Vec<Camera> = viewpoints.iter().map(|&f| world.camera(f, ASPECT)).collect();
    let views: Vec<View> = cameras.iter().map(view_of).collect::<Result<_, _>>()?;
    let mut buffer = ItemBuffer::new(EXACT.0, EXACT.1);
    let visible: Vec<f64> =
        cameras.iter().map(|c| visible_in(&mut buffer, &world.objects, c).len() as f64).collect();
    let mut runs = Vec::new();
    for &cells in &cells {
        (lab.progress)(&format!("{cells} cells along the longest axis"));
        let cell = across(&world, cells);
        for (method, kind) in METHODS.iter().enumerate() {
            let stage = Stage::new(&world, cell, *kind, Telling::Always)?;
            let none = || vec![f64::INFINITY; views.len()];
            runs.push(Run { cells, method, stage, query: none(), drawing: none(), found: none() });
        }
    }
    let mut frustum = Stage::new(&world, across(&world, 64), Method::Frustum, Telling::Always)?;
    let mut in_frustum = vec![0.0; views.len()];
    let mut depth = Hzb::new(SCREEN.0, SCREEN.1);
    for round in 0..repeats {
        (lab.progress)(&format!("resolutions, round {round}"));
        for (v, view) in views.iter().enumerate() {
            frustum.look(view, 1);
            in_frustum[v] = frustum.found().count() as f64;
            for r in &mut runs {
                r.query[v] = r.query[v].min(r.stage.look(view, 2));
                let ((), drawing) = timed(|| depth.draw_all(&world.objects, r.stage.found(), &cameras[v]));
                r.drawing[v] = r.drawing[v].min(ms(drawing));
                r.found[v] = r.stage.found().count() as f64;
            }
        }
    }
    let exact = mean(&visible);
    let points = |method: usize| -> Vec<Point> {
        let runs = runs.iter().filter(|r| r.method == method);
        runs.map(|r| Point {
            cells: f64::from(r.cells),
            query: mean(&r.query),
            frame: mean(&r.query) + mean(&r.drawing),
            ratio: ratio(mean(&r.found), exact),
        })
        .collect()
    };
    let (cell, point) = (points(0), points(1));
    // Objects in the frustum over objects visible.
    let in_frustum = ratio(mean(&in_frustum), exact);
    let (cell_best, point_best) = (best(&cell, |p| p.frame), best(&point, |p| p.query));
    let at = |n: f64| between(&curve(&cell, |p| p.ratio), n);
    // As good as frustum culling: within a hundredth of it.
    let useless = cell.iter().take_while(|p| p.ratio > 0.99 * in_frustum).last();
    Ok(vec![
        (
            "4.6, fig. 4.7",
            "The fastest frames are at about 70x70x70 cells, the solution point.".to_owned(),
            format!(
                "`cell` is fastest at N = {} (query alone: {}), `point` by its query at {}; `cell_for` \
                 chooses {fit}, where a query of `point` takes {:.2} times the best.",
                cell_best.cells,
                best(&cell, |p| p.query).cells,
                point_best.cells,
                ratio(between(&curve(&point, |p| p.query), f64::from(fit)), point_best.query)
            ),
        ),
        (
            "4.6, fig. 4.8",
            "PVS/visible 3.6 at N = 70, 3.2 at 100.".to_owned(),
            format!(
                "`cell` {:.2} at 70, {:.2} at 100; `point` {:.2} to {:.2} over all N.",
                at(70.0),
                at(100.0),
                point.iter().map(|p| p.ratio).fold(f64::INFINITY, f64::min),
                point.iter().map(|p| p.ratio).fold(0.0, f64::max)
            ),
        ),
        (
            "4.6, fig. 4.8",
            "Below N = 25 no better than frustum culling.".to_owned(),
            match useless {
                Some(p) => format!("`cell` is no better than `frustum` (within 1%) up to N = {}.", p.cells),
                None => format!("`cell` is better than `frustum` at every N from {} on.", cell[0].cells),
            },
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_straight_between_their_points_and_flat_beyond() {
        let curve = [(10.0, 1.0), (20.0, 3.0)];
        assert_eq!([5.0, 10.0, 15.0, 20.0, 30.0].map(|x| between(&curve, x)), [1.0, 1.0, 2.0, 3.0, 3.0]);
        assert_eq!(between(&[], 1.0), 0.0);
    }
}

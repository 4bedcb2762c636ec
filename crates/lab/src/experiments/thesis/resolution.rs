//! Cost and accuracy against the resolution of the grid (section 4.6, figures 4.7 and 4.8).

use casca::{Aabb, GridSpec, Method, View};

use super::super::stage::{Stage, Telling, ms};
use super::super::walker::visible_in;
use super::super::{ASPECT, Lab, LabError, Section, Table};
use super::setting::{EXACT, Finding, SCREEN, mean, ratio, style};
use crate::pictures::palette::{CELL, FRUSTUM, Marker, POINT, Style, THESIS};
use crate::pictures::{Axis, Line, lines};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::measure::timed;
use casca_scenes::world::{Camera, Motion};
use casca_truth::baselines::Hzb;
use casca_truth::oracle::ItemBuffer;

/// The thesis' solution point, its PVS/visible there and at 100, and the resolution below which
/// it hides nothing.
const THESIS_BEST: (f64, f64) = (70.0, 3.6);
const THESIS_FINE: (f64, f64) = (100.0, 3.2);
const THESIS_COARSE: f64 = 25.0;

/// A method on a grid of `cells` along the longest axis; milliseconds and objects of each
/// viewpoint.
struct Run {
    cells: u32,
    method: usize,
    stage: Stage,
    query: Vec<f64>,
    drawing: Vec<f64>,
    found: Vec<f64>,
    lost: usize,
}

/// A point on the curves of one method.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    cells: f64,
    query: f64,
    frame: f64,
    ratio: f64,
    lost: f64,
}

const METHODS: [(&str, Method); 2] = [("cell", Method::cell()), ("point", Method::point())];

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

pub(super) fn run(lab: &Lab, section: &mut Section) -> Result<Vec<Finding>, LabError> {
    let cells: Vec<u32> = lab.pick(
        vec![10, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100, 110, 120, 130, 140, 150, 160],
        vec![10, 25, 70, 100, 160],
    );
    let viewpoints: Vec<usize> = lab.pick(vec![15, 45, 75, 105, 135], vec![75]);
    let repeats = lab.pick(5, 2);
    let mut world = build(SceneKind::Spheres, &SceneOptions { seed: lab.seed, ..SceneOptions::default() });
    world.objects.retain(|o| o.motion == Motion::Static);
    let region = Aabb::new(world.grid.min, world.grid.max);
    let fit = GridSpec::fit(region, world.objects.len())?.dims.max_element();
    let cameras: Vec<Camera> = viewpoints.iter().map(|&f| world.camera(f, ASPECT)).collect();
    let views: Vec<View> = cameras.iter().map(view_of).collect::<Result<_, _>>()?;
    let mut buffer = ItemBuffer::new(EXACT.0, EXACT.1);
    let visible: Vec<Vec<usize>> =
        cameras.iter().map(|c| visible_in(&mut buffer, &world.objects, c)).collect();
    let mut runs = Vec::new();
    for &cells in &cells {
        (lab.progress)(&format!("{cells} cells along the longest axis"));
        let grid = GridSpec::with_cells(region, cells)?;
        for (method, (_, kind)) in METHODS.iter().enumerate() {
            let stage = Stage::new(&world, &grid, *kind, Telling::Always)?;
            let none = || vec![f64::INFINITY; views.len()];
            runs.push(Run { cells, method, stage, query: none(), drawing: none(), found: none(), lost: 0 });
        }
    }
    let mut frustum =
        Stage::new(&world, &GridSpec::with_cells(region, 64)?, Method::Frustum, Telling::Always)?;
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
                if round == 0 {
                    r.lost += visible[v].iter().filter(|&&i| !r.stage.sees(i)).count();
                }
            }
        }
    }
    let exact = mean(&visible.iter().map(|v| v.len() as f64).collect::<Vec<_>>());
    let points = |method: usize| -> Vec<Point> {
        let runs = runs.iter().filter(|r| r.method == method);
        runs.map(|r| Point {
            cells: f64::from(r.cells),
            query: mean(&r.query),
            frame: mean(&r.query) + mean(&r.drawing),
            ratio: ratio(mean(&r.found), exact),
            lost: r.lost as f64 / views.len() as f64,
        })
        .collect()
    };
    let found = Found {
        methods: [points(0), points(1)],
        vfc: ratio(mean(&in_frustum), exact),
        fit: f64::from(fit),
        exact,
    };
    found.draw(lab, section, views.len())?;
    Ok(found.findings())
}

struct Found {
    methods: [Vec<Point>; 2],
    /// Objects in the frustum over objects visible.
    vfc: f64,
    /// What the library would choose.
    fit: f64,
    exact: f64,
}

impl Found {
    fn draw(&self, lab: &Lab, section: &mut Section, views: usize) -> Result<(), LabError> {
        let [cell, point] = &self.methods;
        section.text(format!(
            "### The resolution of the grid (section 4.6)\n\nThe 4,800 static spheres seen at 55 degrees (the \
             mean of {views} viewpoints of the walk), on grids of cubic cells with N of them along the \
             longest axis. The *solution point* is the N of the fastest frame: query, and drawing the PVS in software; for `point`, of \
             the fastest query. \
             `GridSpec::fit` chooses N = {}; {:.0} objects are visible.",
            self.fit, self.exact
        ));
        self.draw_cost(lab, section)?;
        self.draw_accuracy(lab, section)?;
        let columns = [
            "N",
            "cell: query, ms",
            "cell: frame, ms",
            "cell: PVS/visible",
            "point: query, ms",
            "point: frame, ms",
            "point: PVS/visible",
            "visible objects lost",
        ];
        let mut table = Table::new("thesis-resolution", &columns);
        for (c, p) in cell.iter().zip(point) {
            let (query, frame, ratio) = (format!("{:.3}", c.query), c.frame, c.ratio);
            table.row([
                format!("{}", c.cells),
                query,
                format!("{frame:.2}"),
                format!("{ratio:.2}"),
                format!("{:.3}", p.query),
                format!("{:.2}", p.frame),
                format!("{:.3}", p.ratio),
                format!("{}", c.lost + p.lost),
            ]);
        }
        section.rows("All resolutions as CSV", table);
        Ok(())
    }

    fn draw_cost(&self, lab: &Lab, section: &mut Section) -> Result<(), LabError> {
        let [cell, point] = &self.methods;
        let (frame, query) = (|p: &Point| p.frame, |p: &Point| p.query);
        let mut all = Vec::new();
        for ((name, _), points) in METHODS.iter().zip(&self.methods) {
            all.push(Line::new(format!("{name}: query and drawing"), style(name), curve(points, frame)));
            all.push(Line::new(format!("{name}: query alone"), style(name).dashed(), curve(points, query)));
        }
        let mark = |name: String, style: Style, x: f64, points: &[(f64, f64)]| {
            Line::dots(name, style, vec![(x, between(points, x))])
        };
        let (cells, points) = (curve(cell, frame), curve(point, query));
        let (slow, fast) = (best(cell, frame), best(point, query));
        let star = |style: Style| Style { marker: Marker::Star, ..style };
        all.push(mark("thesis: fastest at about 70".to_owned(), THESIS, THESIS_BEST.0, &cells));
        all.push(mark(format!("cell: fastest at {}", slow.cells), star(CELL), slow.cells, &cells));
        all.push(mark(format!("point: fastest at {}", fast.cells), star(POINT), fast.cells, &points));
        let fit = Style { marker: Marker::Hexagon, ..THESIS };
        all.push(mark(format!("GridSpec::fit chooses {}", self.fit), fit, self.fit, &points));
        let file = "thesis-resolution-cost.svg";
        let times = |points: &[Point]| {
            let most = points.iter().map(|p| p.query).fold(0.0, f64::max);
            ratio(most, best(points, |p| p.query).query)
        };
        let title = format!(
            "Over all grids, the slowest query of point takes {:.1} times the fastest, that of cell {:.0} times",
            times(point),
            times(cell)
        );
        let subtitle = "Time by the number of cells along the longest axis, mean over the viewpoints; drawing is in software.";
        let x = Axis::linear("N, cells along the longest axis");
        lines(&lab.folder.join(file), &title, subtitle, (&x, &Axis::log("time, ms")), &all)?;
        section.picture(file, &title);
        Ok(())
    }

    fn draw_accuracy(&self, lab: &Lab, section: &mut Section) -> Result<(), LabError> {
        let [cell, point] = &self.methods;
        let ends = |points: &[Point]| {
            let ratios = || points.iter().map(|p| p.ratio);
            (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max))
        };
        let span = cell.first().zip(cell.last()).map_or((10.0, 160.0), |(a, b)| (a.cells, b.cells));
        let all = [
            Line::new("cell", CELL, curve(cell, |p| p.ratio)),
            Line::new("point", POINT, curve(point, |p| p.ratio)),
            Line::new("frustum", FRUSTUM, vec![(span.0, self.vfc), (span.1, self.vfc)]),
            Line::dots("thesis: 3.6 at 70, 3.2 at 100", THESIS, vec![THESIS_BEST, THESIS_FINE]),
        ];
        let file = "thesis-resolution-pvs.svg";
        let ((tight, wide), (least, most)) = (ends(point), ends(cell));
        let title = format!(
            "For each visible object, point finds {tight:.2} to {wide:.2} on any grid, cell {most:.1} on the coarsest \
             and {least:.1} on the finest"
        );
        let y = Axis { holds: vec![1.0], ..Axis::log("PVS/visible") };
        let x = Axis::linear("N, cells along the longest axis");
        lines(
            &lab.folder.join(file),
            &title,
            "Objects found for each visible one; 1 is exact.",
            (&x, &y),
            &all,
        )?;
        section.picture(file, &title);
        Ok(())
    }

    fn findings(&self) -> Vec<Finding> {
        let [cell, point] = &self.methods;
        let (frame, query) = (|p: &Point| p.frame, |p: &Point| p.query);
        let (cell_best, point_best) = (best(cell, frame), best(point, query));
        let at = |n: f64| between(&curve(cell, |p| p.ratio), n);
        // As good as frustum culling: within a hundredth of it.
        let useless = cell.iter().take_while(|p| p.ratio > 0.99 * self.vfc).last();
        vec![
            Finding::new(
                "4.6, fig. 4.7",
                "The fastest frames are at about 70x70x70 cells, the solution point.",
                format!(
                    "`cell` is fastest at N = {} (query alone: {}), `point` by its query at {}; `GridSpec::fit` \
                     chooses {}, where a query of `point` takes {:.2} times the best.",
                    cell_best.cells,
                    best(cell, query).cells,
                    point_best.cells,
                    self.fit,
                    ratio(between(&curve(point, query), self.fit), point_best.query)
                ),
            ),
            Finding::new(
                "4.6, fig. 4.8",
                format!(
                    "PVS/visible {} at N = {}, {} at {}.",
                    THESIS_BEST.1, THESIS_BEST.0, THESIS_FINE.1, THESIS_FINE.0
                ),
                format!(
                    "`cell` {:.2} at 70, {:.2} at 100; `point` {:.2} to {:.2} over all N.",
                    at(THESIS_BEST.0),
                    at(THESIS_FINE.0),
                    point.iter().map(|p| p.ratio).fold(f64::INFINITY, f64::min),
                    point.iter().map(|p| p.ratio).fold(0.0, f64::max)
                ),
            ),
            Finding::new(
                "4.6, fig. 4.8",
                format!("Below N = {THESIS_COARSE} no better than frustum culling."),
                match useless {
                    Some(p) => {
                        format!("`cell` is no better than `frustum` (within 1%) up to N = {}.", p.cells)
                    }
                    None => format!(
                        "`cell` is better than `frustum` at every N from {} on.",
                        cell.first().map_or(0.0, |p| p.cells)
                    ),
                },
            ),
        ]
    }
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

    #[test]
    fn the_best_point_has_the_least_value() {
        let point = |cells, frame| Point { cells, frame, ..Point::default() };
        let points = [point(10.0, 3.0), point(70.0, 1.0), point(160.0, 2.0)];
        assert_eq!(best(&points, |p| p.frame).cells, 70.0);
        assert_eq!(best(&[], |p| p.frame).cells, 0.0);
    }
}

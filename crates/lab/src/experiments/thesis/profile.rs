//! Where the time goes (section 4.7). Reports and feedback are timed directly. The library has no
//! clocks inside a query, so its parts are estimates from differences: a step of the walk costs as
//! much as in the empty scene, a test of an object as much as among objects that hide nothing, and
//! the rest is occlusion. Rendering the PVS is left out.

use casca::{GridSpec, Method, Query};

use super::super::stage::{Stage, Telling};
use super::super::{ASPECT, Lab, LabError, Section, Table};
use super::setting::{Finding, ratio};
use casca_scenes::drive::view_of;
use casca_scenes::generated::{SceneKind, SceneOptions, build};
use casca_scenes::world::{FRAME_SECONDS, World};

const PARTS: [&str; 8] = [
    "visible objects into the grid",
    "upkeep of hidden objects",
    "walk and tests",
    "occluders: caps",
    "occlusion: drawing",
    "refinement",
    "rendering",
    "the rest",
];

/// Percent of each part in the thesis: the grid takes about 55, hidden objects about 5 of those.
const THESIS: [f64; 8] = [50.0, 5.0, 20.4, 2.4, 13.3, 0.0, 5.6, 3.3];

/// Frames before the first that counts: hidden objects get their volumes in them.
const WARM: usize = 20;

/// Milliseconds of a query and what it did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Cost {
    time: f64,
    /// Cells walked or occlusion tests made: what the walk is charged by.
    steps: f64,
    objects: f64,
}

impl Cost {
    fn of(stage: &Stage, query: &mut Query, view: &casca::View, times: usize) -> Self {
        let time = stage.ask(query, view, times);
        let s = query.pvs().stats();
        let (steps, objects) = match query.method() {
            Method::Cell(_) => (s.cells_visited as f64, f64::from(s.objects_tested)),
            _ => (0.0, f64::from(s.occlusion_tests)),
        };
        Self { time, steps, objects }
    }
}

/// The part of a query that is walk and tests, by what these cost where nothing hides: `empty`
/// without objects, `open` with objects that hide nothing. At most all of it.
fn walk_part(run: Cost, empty: Cost, open: Cost) -> f64 {
    let step = ratio(empty.time, empty.steps);
    // Without steps to charge it by, the empty run is what every query costs.
    let fixed = if empty.steps > 0.0 { 0.0 } else { empty.time };
    let object = ratio((open.time - fixed - step * open.steps).max(0.0), open.objects);
    (fixed + step * run.steps + object * run.objects).min(run.time)
}

pub(super) fn run(lab: &Lab, section: &mut Section) -> Result<Vec<Finding>, LabError> {
    let frames = lab.pick(100, 5);
    let repeats = lab.pick(3, 2);
    let options = SceneOptions { seed: lab.seed, frames: frames + WARM, ..SceneOptions::default() };
    let mut world = build(SceneKind::Spheres, &options);
    let mut open = build(SceneKind::Spheres, &options);
    open.objects.iter_mut().for_each(|o| o.occludes = false);
    let mut empty = build(SceneKind::Spheres, &SceneOptions { scale: 0.0, ..options });
    empty.objects.clear();
    let grid = GridSpec::with_cells(casca::Aabb::new(world.grid.min, world.grid.max), 70)?;
    let stage = |w: &World, method| Stage::new(w, &grid, method, Telling::Always);
    let mut totals = [[0.0; 8]; 2];
    let mut sizes = [0.0; 2];
    for (method, total) in [Method::cell(), Method::point()].into_iter().zip(&mut totals) {
        let (mut real, mut bare, none) =
            (stage(&world, method)?, stage(&open, method)?, stage(&empty, method)?);
        let unrefined = match method {
            Method::Point(options) => Method::Point(options.refine_squares(0).refine_patches(0)),
            other => other,
        };
        let mut rough = Query::with_method(unrefined)?;
        for frame in 0..frames + WARM {
            (lab.progress)(&format!("profile, frame {frame}"));
            let moved = world.set_frame(frame);
            open.set_frame(frame);
            let now = frame as f64 * FRAME_SECONDS;
            let view = view_of(&world.camera(frame, ASPECT))?;
            let (visible, hidden) = real.upkeep_split(now, &world.objects, &moved)?;
            bare.upkeep(now, &open.objects, &moved)?;
            let mut whole = real.look(&view, repeats);
            let rest = Cost::of(&real, &mut rough, &view, repeats);
            // Only `point` refines: both are the same query otherwise.
            whole = if method == Method::cell() { whole.min(rest.time) } else { whole };
            let time = rest.time.min(whole);
            let empty = Cost::of(&none, &mut rough, &view, repeats);
            bare.look(&view, 1);
            let unhidden = Cost::of(&bare, &mut rough, &view, repeats);
            let walk = walk_part(Cost { time, ..rest }, empty, unhidden);
            let feedback = real.end()?;
            bare.end()?;
            if frame < WARM {
                continue;
            }
            sizes[usize::from(method == Method::point())] += real.query().pvs().len() as f64;
            for (sum, part) in
                total.iter_mut().zip([visible, hidden + feedback, walk, 0.0, time - walk, whole - time])
            {
                *sum += part / frames as f64;
            }
        }
    }
    section.rows("The profile as CSV", table(&totals));
    Ok(findings(&totals, sizes.map(|s| s / frames as f64)))
}

fn percent(parts: &[f64; 8]) -> [f64; 8] {
    let sum: f64 = parts.iter().sum();
    parts.map(|p| ratio(p, sum) * 100.0)
}

fn table(totals: &[[f64; 8]; 2]) -> Table {
    let columns = ["part", "thesis, %", "cell, %", "cell, ms", "point, %", "point, ms"];
    let mut table = Table::new("thesis-profile", &columns);
    let shares = totals.map(|t| percent(&t));
    for (i, part) in PARTS.iter().enumerate() {
        let [cell, point] = [0, 1].map(|m| [format!("{:.1}", shares[m][i]), format!("{:.4}", totals[m][i])]);
        table.row([(*part).to_owned(), format!("{:.1}", THESIS[i])].into_iter().chain(cell).chain(point));
    }
    table
}

fn findings(totals: &[[f64; 8]; 2], sizes: [f64; 2]) -> Vec<Finding> {
    let [cell, point] = totals.map(|t| percent(&t));
    vec![
        Finding::new(
            "4.7",
            "Bringing the grid up to date takes about 55% of a frame, hidden objects about 5%.",
            format!(
                "`cell`: {:.0}%, hidden objects {:.0}%; `point`: {:.0}% and {:.0}%.",
                cell[0] + cell[1],
                cell[1],
                point[0] + point[1],
                point[1]
            ),
        ),
        Finding::new(
            "4.7",
            "The walk takes 20.4%, occlusion and caps 15.7%.",
            format!(
                "`cell`: {:.0}% and {:.0}%; `point`: {:.0}% and, with refinement, {:.0}%.",
                cell[2],
                cell[3] + cell[4],
                point[2],
                point[4] + point[5]
            ),
        ),
        Finding::new(
            "4.7",
            "About 500 of 5,000 spheres are drawn in a frame where about 100 are visible.",
            format!("The PVS has {:.0} objects with `cell`, {:.0} with `point`.", sizes[0], sizes[1]),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_walk_is_charged_by_steps_and_objects() {
        let empty = Cost { time: 1.0, steps: 100.0, objects: 0.0 };
        let open = Cost { time: 2.0, steps: 100.0, objects: 10.0 };
        // 20 steps of 0.01 and 5 objects of 0.1.
        let run = Cost { time: 3.0, steps: 20.0, objects: 5.0 };
        assert!((walk_part(run, empty, open) - 0.7).abs() < 1e-12);
        assert_eq!(walk_part(Cost { time: 0.5, ..run }, empty, open), 0.5);
        let fixed = Cost { time: 1.0, ..Cost::default() };
        assert!((walk_part(run, fixed, Cost { time: 2.0, steps: 0.0, objects: 10.0 }) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn the_shares_of_the_thesis_make_a_whole() {
        assert!((THESIS.iter().sum::<f64>() - 100.0).abs() < 1e-9);
        assert_eq!(percent(&[1.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0])[5], 75.0);
    }
}

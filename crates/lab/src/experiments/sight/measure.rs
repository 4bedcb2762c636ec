//! Measuring the answers to questions on one scene.

use casca::{Aabb, Query};
use glam::Vec3;

use super::questions::questions;
use crate::experiments::buffer::least;
use crate::experiments::walker::{Snapshot, Walker};
use crate::experiments::{LabError, median};
use casca_scenes::drive::view_of;
use casca_scenes::world::{Motion, Object, Shape, World};
use casca_truth::baselines::NineRays;
use casca_truth::oracle::{Frustum, RayOracle};

/// How much is asked.
#[derive(Debug, Clone, Copy)]
pub struct Sampling {
    /// Frames of the walk, evenly spread.
    pub frames: usize,
    /// Boxes in a frame, and points.
    pub questions: usize,
    /// Exact rays to a box, at most.
    pub samples: usize,
    /// Times that the query of a frame is run and its questions are asked; the least time counts.
    pub repeats: usize,
    /// Seed of the questions.
    pub seed: u64,
}

/// What was measured on one scene.
#[derive(Debug, Clone, Default)]
pub struct SightCost {
    /// The scene's name.
    pub scene: String,
    /// Milliseconds of the query whose buffers are asked: the least of some runs, the median of the
    /// frames.
    pub query_ms: f64,
    /// Nanoseconds of a question about a box, likewise.
    pub box_ns: f64,
    /// The same for a point.
    pub point_ns: f64,
    /// The same for a box by nine rays.
    pub nine_ns: f64,
    /// Boxes and points that exact rays reach and that were called hidden.
    pub wrong: usize,
    /// Boxes that exact rays reach.
    pub visible: usize,
    /// Boxes that no exact ray reaches.
    pub hidden: usize,
    /// Those of the hidden boxes that were called visible.
    pub kept: usize,
    /// Those of the visible boxes that nine rays called hidden.
    pub lost: usize,
}

/// A share in percent; 0 of nothing.
fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

impl SightCost {
    /// Percentage of the boxes that exact rays reach.
    pub fn visible_share(&self) -> f64 {
        percent(self.visible, self.visible + self.hidden)
    }

    /// Percentage of the hidden boxes that were called visible.
    pub fn called_visible(&self) -> f64 {
        percent(self.kept, self.hidden)
    }

    /// Percentage of the visible boxes that nine rays called hidden.
    pub fn lost_by_rays(&self) -> f64 {
        percent(self.lost, self.visible)
    }
}

/// The answers to some questions, and the nanoseconds that each took: the least of some runs.
fn ask<T>(questions: &[T], repeats: usize, answer: impl Fn(&T) -> bool) -> (Vec<bool>, f64) {
    let mut answers = Vec::with_capacity(questions.len());
    let seconds = least(repeats, || {
        answers.clear();
        answers.extend(questions.iter().map(&answer));
    });
    (answers, seconds * 1e9 / questions.len().max(1) as f64)
}

/// The exact visibility of a scene's questions.
struct Truth {
    rays: RayOracle,
    samples: usize,
}

impl Truth {
    /// Which boxes and which points a frame shows.
    fn of(&self, objects: &[Object], frame: &Snapshot, boxes: &[Aabb], points: &[Vec3]) -> [Vec<bool>; 2] {
        let frustum = Frustum::new(&frame.camera);
        // Boxes asked for are objects that hide nothing, after those of the scene.
        let asked = boxes.iter().map(|b| Object {
            name: String::new(),
            shape: Shape::Box { min: b.min, max: b.max },
            motion: Motion::Static,
            occludes: false,
            tested: true,
        });
        let first = objects.len();
        let all: Vec<Object> = objects.iter().cloned().chain(asked).collect();
        let candidates: Vec<usize> = (first..all.len()).collect();
        let mut shown = vec![false; boxes.len()];
        for found in self.rays.probe_camera(&all, &frustum, &candidates, self.samples, 1).seen {
            shown[found.object - first] = true;
        }
        [shown, points.iter().map(|p| self.rays.surely_shows(&frustum, p.as_dvec3())).collect()]
    }
}

/// Times of the frames.
#[derive(Default)]
struct Times {
    query: Vec<f64>,
    boxes: Vec<f64>,
    points: Vec<f64>,
    rays: Vec<f64>,
}

/// Walks through a world, asks in some frames, and compares the answers with exact rays. `progress`
/// is told how many frames are done.
///
/// # Errors
/// As the library's, if the world is refused.
pub fn measure(
    world: World,
    sampling: &Sampling,
    mut progress: impl FnMut(usize),
) -> Result<SightCost, LabError> {
    let mut walker = Walker::new(world)?;
    let mut truth = Truth { rays: RayOracle::new(&walker.world.objects), samples: sampling.samples };
    let mut nine = NineRays::new(&walker.world.objects);
    let moving: Vec<usize> = (0..walker.world.objects.len())
        .filter(|&i| walker.world.objects[i].motion != Motion::Static)
        .collect();
    let mut cost = SightCost { scene: walker.world.name.clone(), ..SightCost::default() };
    let (mut query, mut times, mut done) = (Query::new(), Times::default(), 0);
    walker.walk::<LabError>(sampling.frames, |walker, number, frame| {
        let (scene, objects) = (&walker.driver(0).scene, &walker.world.objects);
        let seed = sampling.seed.wrapping_add((number as u64) << 32);
        let (boxes, points) = questions(&walker.world.grid, &frame.camera, sampling.questions, seed);
        truth.rays.update(objects, &moving);
        nine.update(objects);
        let [boxes_shown, points_shown] = truth.of(objects, frame, &boxes, &points);

        let view = view_of(&frame.camera)?;
        let query_s = least(sampling.repeats, || {
            query.run(scene, &view);
        });
        let sight = query.sight(scene).ok_or("the query has not run")?;
        let (seen, box_ns) = ask(&boxes, sampling.repeats, |b| sight.may_see_box(b));
        let (seen_points, point_ns) = ask(&points, sampling.repeats, |&p| sight.may_see_point(p));
        let eye = frame.camera.eye;
        let (reached, nine_ns) = ask(&boxes, sampling.repeats, |b| nine.sees_box(eye, b.min, b.max));

        times.query.push(query_s * 1e3);
        times.boxes.push(box_ns);
        times.points.push(point_ns);
        times.rays.push(nine_ns);
        for ((&shown, &seen), &reached) in boxes_shown.iter().zip(&seen).zip(&reached) {
            cost.visible += usize::from(shown);
            cost.hidden += usize::from(!shown);
            cost.wrong += usize::from(shown && !seen);
            cost.kept += usize::from(seen && !shown);
            cost.lost += usize::from(shown && !reached);
        }
        cost.wrong +=
            points_shown.iter().zip(&seen_points).filter(|(shown, seen)| **shown && !**seen).count();
        done += 1;
        progress(done);
        Ok(())
    })?;
    cost.query_ms = median(&mut times.query);
    cost.box_ns = median(&mut times.boxes);
    cost.point_ns = median(&mut times.points);
    cost.nine_ns = median(&mut times.rays);
    Ok(cost)
}

//! Frames: coherent and kept queries, while the camera goes by tiny and by large steps, and objects
//! come and go.

use casca::{CameraQuery, KeptOptions, KeptQuery, Method, PointOptions, Query};
use glam::{DQuat, DVec3, Vec3};

use super::super::dice::{direction, turned, way};
use super::rims::Start;
use super::stage::{Place, Stage};
use super::views::{Camera, camera, limits};
use crate::numeric::attack::{LAST_PLACE_F32, WITHIN_TURN_F32};

/// Frames of a scene.
const FRAMES: u32 = 12;
const OBJECTS: usize = 400;
/// Points that are asked for beside the objects.
const POINTS: usize = 6000;

/// The places of a camera: one, then outermost ones that its kept sets hold for, then others close
/// by and far off.
fn places(stage: &mut Stage, around: bool, mask: u64, reach: f32, angle: f32) -> Vec<Camera> {
    let limits = limits(stage, around);
    let (eye, forward) = (stage.eye(), direction(&mut stage.dice));
    let up = forward.any_orthonormal_vector();
    let mut all: Vec<Camera> = Vec::new();
    all.extend(camera(eye, forward, up, &limits, mask));
    for number in 0..7 {
        let way = way(&mut stage.dice);
        let (step, turn) = match number {
            0..=3 => (f64::from(reach), f64::from(angle) * WITHIN_TURN_F32),
            4 => (f64::from(stage.unit) * 1e-5, 1e-5),
            5 => (f64::from(reach) * 0.5, f64::from(angle) * 0.5),
            _ => (f64::from(stage.unit), 0.5),
        };
        let turn = if around { DQuat::IDENTITY } else { turned(&mut stage.dice, turn) };
        let at = inside(eye, way, step);
        let to = |v: Vec3| (turn * v.as_dvec3()).as_vec3();
        all.extend(camera(at, to(forward), to(up), &limits, mask));
    }
    all
}

/// A place in single precision that is no farther than a step away.
fn inside(eye: Vec3, way: DVec3, step: f64) -> Vec3 {
    let from = eye.as_dvec3();
    let places = (0..20).map(|i| (from + way * step * (1.0 - LAST_PLACE_F32 * f64::from(1 << i))).as_vec3());
    places.into_iter().find(|p| (p.as_dvec3() - from).length() <= step).unwrap_or(eye)
}

/// Plays frames of one scene.
pub fn play(mut stage: Stage, around: bool) -> Stage {
    let mask = stage.mask();
    let reach = stage.unit * 10f32.powf(stage.dice.between(-4.0, -0.4));
    let angle = 10f32.powf(stage.dice.between(-3.0, -0.5));
    let cameras = places(&mut stage, around, mask, reach, angle);
    let Some(first) = cameras.first() else { return stage };
    let forward = first.forward;
    let walls = 8 + stage.dice.below(16);
    (0..walls).for_each(|_| stage.wall(|d| around || d.dot(forward) > 0.2, false));
    for number in 0..OBJECTS + POINTS {
        let place = number % cameras.len();
        let Camera { eye, truth, .. } = &cameras[place];
        let seen = |p: DVec3| truth.sight(p).is_some();
        stage.aim(Start::Eye(*eye), Place::View(place as u8), number < OBJECTS, seen);
    }
    stage.insert_targets();
    let options = PointOptions::fast().coherent(true).pixel_degrees(0.5);
    let queries = [options, PointOptions::balanced().coherent(true)];
    let mut queries = queries.map(|o| Query::with_method(Method::Point(o)).unwrap_or_default());
    // A camera that goes by more than half of these gets a result for one view.
    let kept = KeptOptions::new().reach(4.0 * reach).turn(4.0 * angle);
    let mut kept = [(); 2].map(|()| KeptQuery::with_options(kept).unwrap_or_default());
    let mut job = None;
    for frame in 0..FRAMES {
        let _ = stage.scene.begin_frame(f64::from(frame) / 60.0);
        if frame > 0 && stage.dice.once_in(2) {
            change(&mut stage, forward, around);
        }
        // Twice at the first place, then anywhere.
        let place = if frame < 2 { 0 } else { stage.dice.below(cameras.len() as u32) as usize };
        let view = &cameras[place].view;
        let here = |w: &super::stage::Witness| w.place == Place::View(place as u8);
        for query in &mut queries {
            let pvs = query.run(&stage.scene, view).clone();
            stage.check("coherent", mask, here, &pvs);
            stage.ask("coherent, sight", mask, here, query);
        }
        if let Some(result) = job.take() {
            kept[1].install(result, &stage.scene);
        }
        for (number, kept) in kept.iter_mut().enumerate() {
            let held = kept.is_valid_for(&stage.scene, view);
            let pvs = kept.run(&stage.scene, view).clone();
            let way = match (held, number) {
                (false, _) => "kept, found",
                (true, 0) => "kept, held",
                (true, _) => "kept, prepared",
            };
            stage.check(way, mask, here, &pvs);
            // Dynamic occluders are not in the answers.
            stage.ask("kept, sight", mask, here, kept);
        }
        job = Some(kept[1].prepare(&stage.scene, view).run());
        let all = queries.iter().map(CameraQuery::pvs).chain(kept.iter().map(CameraQuery::pvs));
        let _ = stage.scene.end_frame(all);
    }
    stage
}

/// Objects come, go, or change their layers.
fn change(stage: &mut Stage, forward: Vec3, around: bool) {
    for _ in 0..1 + stage.dice.below(3) {
        let (walls, targets) = (stage.walls.len() as u32, stage.targets.len() as u32);
        match stage.dice.below(6) {
            0 | 1 if walls > 0 => {
                let i = stage.dice.below(walls) as usize;
                stage.toggle(true, i);
            }
            2 => stage.wall(|d| around || d.dot(forward) > 0.2, false),
            3 => stage.relayer(),
            _ if targets > 0 => {
                for _ in 0..10 {
                    let i = stage.dice.below(targets) as usize;
                    stage.toggle(false, i);
                }
            }
            _ => {}
        }
    }
}

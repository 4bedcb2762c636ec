//! Jumps, broken promises and a clock that does not run evenly.

use glam::Vec3;

use super::case::{Case, Dice, placed};
use super::walks::{Walk, shifted};
use crate::lab::{Lab, LabError};
use crate::scenes::SceneKind;
use crate::world::{FRAME_SECONDS, Motion, Shape};

/// The scene's objects move inside this box.
const ROOM: [Vec3; 2] = [Vec3::new(6.0, 6.0, 6.0), Vec3::new(94.0, 54.0, 94.0)];

fn center(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Sphere { center, .. } => *center,
        Shape::Box { min, max } => (*min + *max) * 0.5,
        Shape::Mesh { transform, .. } => transform.translation.into(),
    }
}

/// Frames a 30th of a second apart whose moving objects sway by what they promise, from any place on.
fn swaying(walk: &Walk, seed: u64, name: &str, frames: usize, times: impl Fn(usize) -> f64) -> Case {
    let mut case = walk
        .still(name, (0..frames).filter_map(|i| walk.cameras.get(i % walk.cameras.len().max(1)).copied()));
    let mut dice = Dice::new(seed, 3);
    let mut last = 0.0;
    let mut shapes: Vec<Shape> = case.objects.iter().map(|o| o.shape.clone()).collect();
    for number in 0..frames {
        let time = times(number);
        // However far the clock jumps, objects stay in their room.
        let passed = if number == 0 { 0.0 } else { (time - last).abs().min(60.0) as f32 };
        last = time;
        let mut moves = Vec::new();
        for (i, object) in case.objects.iter().enumerate() {
            let Motion::Dynamic { max_speed } = object.motion else { continue };
            let step = dice.ball() * (0.9 * max_speed * passed);
            let target = (center(&shapes[i]) + step).clamp(ROOM[0], ROOM[1]);
            // A clamped step is shorter only if it started inside.
            let by = target - center(&shapes[i]);
            if by.length() <= 0.9 * max_speed * passed {
                shapes[i] = shifted(&shapes[i], by);
            }
            moves.push((i, shapes[i].clone()));
        }
        if let Some(shot) = case.shots.get_mut(number) {
            (shot.moves, shot.time) = (moves, time);
        }
    }
    case
}

/// All cases.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let walk = Walk::new(SceneKind::Spheres, lab.seed, lab.pick(12, 4))?;
    let mut cases = vec![walk.case("spheres, a walk").calm()];

    // The camera jumps to and fro along the walk and looks back every other time.
    let mut jumps = walk.case("spheres, camera jumps each frame");
    let n = jumps.shots.len().max(1);
    for (i, shot) in jumps.shots.iter_mut().enumerate() {
        let from = &walk.cameras[i * 5 % n];
        let turn = glam::Quat::from_rotation_y(if i % 2 == 0 { 0.0 } else { std::f32::consts::PI });
        shot.camera = placed(from, from.eye, turn);
    }
    cases.push(jumps);

    // Objects appear anywhere, far from where they were; nothing is promised about that.
    let mut dice = Dice::new(lab.seed, 4);
    let mut beamed = walk.case("spheres, moving objects jump anywhere each frame");
    for shot in &mut beamed.shots {
        for (_, shape) in &mut shot.moves {
            *shape = shifted(shape, dice.point(ROOM[0], ROOM[1]) - center(shape));
        }
    }
    cases.push(beamed);

    for factor in [10.0f32, 1000.0, f32::INFINITY] {
        let mut broken = walk.case(if factor.is_finite() {
            format!("spheres, objects {factor} times as fast as promised")
        } else {
            "spheres, objects that promised to stand still move".to_owned()
        });
        for object in &mut broken.objects {
            if let Motion::Dynamic { max_speed } = &mut object.motion {
                *max_speed /= factor;
            }
        }
        cases.push(broken);
    }

    let frames = lab.pick(12, 5);
    let step = FRAME_SECONDS;
    let mut add = |name: &str, calm: bool, times: &dyn Fn(usize) -> f64| {
        let mut case = swaying(&walk, lab.seed, name, frames, times);
        case.unreported = true;
        cases.push(if calm { case.calm() } else { case });
    };
    add("spheres, unreported while hidden", true, &|i| i as f64 * step);
    add("spheres, unreported, time runs backwards", false, &|i| 1000.0 - i as f64 * step);
    add("spheres, unreported, time leaps to and fro by 10 s", false, &|i| {
        if i % 2 == 0 { 100.0 } else { 90.0 }
    });
    add("spheres, unreported, time stands still", false, &|_| 5.0);
    add("spheres, unreported, frames an hour apart", false, &|i| i as f64 * 3600.0);
    add("spheres, unreported, frames 1e15 s apart", false, &|i| i as f64 * 1e15);
    add("spheres, unreported, clock starts at -1e9 s", false, &|i| -1e9 + i as f64 * step);
    let mut moved = swaying(&walk, lab.seed, "spheres, reported, time runs backwards", frames, |i| {
        1000.0 - i as f64 * step
    });
    moved.unreported = false;
    cases.push(moved);
    Ok(cases)
}

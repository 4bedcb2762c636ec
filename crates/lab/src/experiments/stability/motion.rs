//! Jumps, broken promises and a clock that does not run evenly.

use glam::Vec3;

use super::case::{ASPECT, Case, Shot, block, dice, placed, solid, sphere};
use super::walks::Walk;
use crate::experiments::{Lab, LabError};
use casca_scenes::generated::SceneKind;
use casca_scenes::world::{Camera, FRAME_SECONDS, Motion, Object, Shape};

/// The scene's objects move inside this box.
const ROOM: [Vec3; 2] = [Vec3::new(6.0, 6.0, 6.0), Vec3::new(94.0, 54.0, 94.0)];

fn center(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Sphere { center, .. } => *center,
        Shape::Box { min, max } => (*min + *max) * 0.5,
        Shape::Mesh { transform, .. } => transform.translation.into(),
    }
}

/// Of the moving crowd's box, in metres.
const SIZE: Vec3 = Vec3::new(40.0, 16.0, 40.0);

/// A crowd that moves straight ahead between walls, at 95 % of the speeds that it promised.
struct Crowd {
    objects: Vec<Object>,
    /// Index, place at the start, velocity and radius.
    movers: Vec<(usize, Vec3, Vec3, f32)>,
    frames: usize,
    seed: u64,
}

impl Crowd {
    fn new(lab: &Lab) -> Self {
        let mut dice = dice(lab.seed, 3);
        let mut objects = Vec::new();
        for i in 0..24 {
            let at = dice.point(Vec3::ZERO, SIZE).with_y(0.0);
            let size = if i % 2 == 0 { Vec3::new(9.0, SIZE.y, 2.0) } else { Vec3::new(2.0, SIZE.y, 9.0) };
            objects.push(solid("wall", block(at.min(SIZE - size), at.min(SIZE - size) + size)));
        }
        let mut movers = Vec::new();
        for _ in 0..lab.pick(300, 150) {
            let (radius, speed) = (dice.range(0.1, 0.4), dice.range(1.0, 10.0));
            let way = dice.ball().normalize_or(Vec3::X) * (0.95 * speed);
            let at = dice.point(Vec3::splat(1.0), SIZE - 1.0);
            movers.push((objects.len(), at, way, radius));
            let motion = Motion::Dynamic { max_speed: speed };
            objects.push(Object { motion, ..solid("mover", sphere(at, radius)) });
        }
        Self { objects, movers, frames: lab.pick(24, 8), seed: lab.seed }
    }

    /// Frames at some times of the clock, seen from a new place every `stay` frames.
    fn case(
        &self,
        name: &str,
        near: f32,
        stay: usize,
        time: impl Fn(usize) -> f64,
    ) -> Result<Case, LabError> {
        let mut dice = dice(self.seed, 4);
        let mut way = 0.0;
        let mut shots = Vec::new();
        let mut camera = None;
        for number in 0..self.frames {
            // However far the clock goes, up or down, the crowd has moved on for a while.
            let passed = if number == 0 { 0.0 } else { (time(number) - time(number - 1)).abs().min(2.0) };
            way += passed as f32;
            // Straight on, and back from the sides of the box.
            let fold = |x: f32, room: f32| {
                let around = (x - 1.0).rem_euclid(2.0 * (room - 2.0));
                1.0 + around.min(2.0 * (room - 2.0) - around)
            };
            let place = |at: Vec3, v: Vec3| {
                let p = at + v * way;
                Vec3::new(fold(p.x, SIZE.x), fold(p.y, SIZE.y), fold(p.z, SIZE.z))
            };
            let moves = self.movers.iter().map(|&(i, at, v, r)| (i, sphere(place(at, v), r))).collect();
            if number % stay.max(1) == 0 {
                let (eye, at) = (dice.point(Vec3::splat(0.5), SIZE - 0.5), dice.point(Vec3::ZERO, SIZE));
                camera = Some(Camera::look_at(eye, at, 60.0, ASPECT, near, 100.0));
            }
            let Some(camera) = camera else { continue };
            shots.push(Shot { camera, moves, time: time(number) });
        }
        Ok(Case::new(name, self.objects.clone(), 0.5, shots))
    }
}

/// All cases.
pub(super) fn cases(lab: &Lab) -> Result<Vec<Case>, LabError> {
    let walk = Walk::new(SceneKind::Spheres, lab.seed, lab.pick(12, 4))?;
    let mut cases = vec![walk.case("spheres, a walk")];

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
    let mut dice = dice(lab.seed, 14);
    let mut beamed = walk.case("spheres, moving objects jump anywhere each frame");
    for shot in &mut beamed.shots {
        for (_, shape) in &mut shot.moves {
            *shape = shape.moved(dice.point(ROOM[0], ROOM[1]) - center(shape));
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

    let crowd = Crowd::new(lab);
    let step = FRAME_SECONDS;
    let even = |i: usize| i as f64 * step;
    cases.push(crowd.case("moving crowd", 0.1, 6, even)?);
    cases.push(crowd.case("moving crowd, camera jumps each frame", 0.1, 1, even)?);
    cases.push(crowd.case("moving crowd, near plane at 4 m", 4.0, 6, even)?);
    cases.push(crowd.case("moving crowd, reported, time runs backwards", 0.1, 6, |i| 1000.0 - even(i))?);
    let mut add = |name: &str, near: f32, stay: usize, time: &dyn Fn(usize) -> f64| {
        crowd.case(&format!("unreported crowd{name}"), near, stay, time).map(|case| {
            cases.push(Case { unreported: true, ..case });
        })
    };
    add("", 0.1, 6, &even)?;
    add(", camera jumps each frame", 0.1, 1, &even)?;
    add(", near plane at 4 m", 4.0, 6, &even)?;
    add(", near plane at 4 m, camera jumps each frame", 4.0, 1, &even)?;
    add(", time runs backwards", 0.1, 6, &|i| 1000.0 - even(i))?;
    add(", time leaps to and fro by 2 s", 0.1, 6, &|i| if i % 2 == 0 { 102.0 } else { 100.0 })?;
    add(", time stands still", 0.1, 6, &|_| 5.0)?;
    add(", frames an hour apart", 0.1, 6, &|i| i as f64 * 3600.0)?;
    add(", frames 1e15 s apart", 0.1, 6, &|i| i as f64 * 1e15)?;
    add(", clock from -1e9 s on", 0.1, 6, &|i| -1e9 + even(i))?;
    Ok(cases)
}

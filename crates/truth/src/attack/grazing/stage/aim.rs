//! Aims: points closely past outlines, and tiny objects that have them.

use casca::{Aabb, Bounds, Instance, Obb, Sphere};
use glam::{Affine3A, DMat3, DVec3, Vec3};

use super::super::super::dice::{Dice, turn};
use super::super::super::solid::{Solid, exact};
use super::super::super::views::outermost;
use super::super::rims::Start;
use super::{Graze, Place, Stage, Target, Witness};
use crate::numeric::attack::{LEAST_INSTANCE, ON_BALL, ON_CORNER};

/// Aims that no point in single precision is found for are given up after this many tries.
const TRIES: u32 = 6;

impl Stage<'_> {
    /// A place closely past the outline of a wall, as seen from a start, the direction away from
    /// it, and the wall's shape.
    pub fn graze(&mut self, start: &Start) -> Option<Graze> {
        let (point, out, shape) = self.rim(|solid, dice| solid.rim(start, dice))?;
        Some((point + out * self.gap(start, point), out, shape))
    }

    /// An eye in a ball that looks as far past an edge as any eye in it does, and a place closely
    /// past that edge as [`Stage::graze`] tells it.
    pub fn outermost(&mut self, eye: DVec3, reach: f64) -> Option<(DVec3, Graze)> {
        let (point, out, shape) = self.rim(|solid, dice| solid.rim_of_ball(eye, reach, dice))?;
        let at = outermost(eye, out, reach);
        Some((at, (point + out * self.gap(&Start::Eye(at), point), out, shape)))
    }

    fn rim(
        &mut self,
        find: impl Fn(&Solid, &mut Dice) -> Option<(DVec3, DVec3)>,
    ) -> Option<(DVec3, DVec3, usize)> {
        if self.walls.is_empty() {
            return None;
        }
        let wall = &self.walls[self.dice.below(self.walls.len() as u32) as usize].wall;
        let (point, out) = find(&wall.solid, &mut self.dice)?;
        Some((point, out, wall.shape))
    }

    /// How far past an edge a ray goes.
    fn gap(&mut self, start: &Start, point: DVec3) -> f64 {
        let dice = &mut self.dice;
        let unit = match dice.below(3) {
            0 => 1.0,
            1 => start.toward(point).length().min(f64::from(self.unit) * 100.0),
            _ => f64::from(self.unit),
        };
        // Where coordinates are small, far smaller gaps are told apart.
        let least = if self.step > 0.0 { -11.0 } else { -7.0 };
        unit * 10f64.powf(least + (-2.0 - least) * dice.real())
    }

    /// A point behind a place, as seen from a start, rounded away from what it passes.
    pub fn behind(&mut self, start: &Start, place: DVec3, out: DVec3) -> DVec3 {
        let dice = &mut self.dice;
        // Views with a reach hide least of what is farthest.
        let most = if dice.once_in(6) { 5.0 } else { 1.3 };
        let beyond = 10f64.powf(-6.0 + (most + 6.0) * dice.real());
        let point = match *start {
            Start::Eye(eye) => place + (place - eye) * beyond,
            Start::Before(along, _) => place + along * (beyond * f64::from(self.unit)),
        };
        rounded(point, out)
    }

    /// Puts an object into the list of targets that has the point, or one next to it; says which.
    pub fn target_at(&mut self, point: DVec3, out: DVec3, toward: DVec3) -> DVec3 {
        let dice = &mut self.dice;
        let size = f64::from(self.unit) * 10f64.powf(-7.0 + 6.0 * dice.real());
        let at = point.as_vec3();
        let (bounds, seen): (Bounds, DVec3) = match dice.below(16) {
            0..=6 => (Aabb::new(at, at).into(), point),
            7..=10 => {
                // A corner shows; the rest is behind the occluder, or behind the corner.
                let inwards = toward.normalize() - out * dice.pick(&[1.0, 1.0, 0.1, 4.0]);
                let other = (point + inwards * size).as_vec3();
                (Aabb::new(at.min(other), at.max(other)).into(), point)
            }
            11..=13 => {
                let ball = Sphere::new((point - out * size).as_vec3(), size as f32);
                let center = ball.center.as_dvec3();
                (ball.into(), center + out * f64::from(ball.radius) * ON_BALL)
            }
            14 => {
                let half = Vec3::splat(size as f32);
                let rotation = turn(dice);
                let axes = DMat3::from_quat(rotation.as_dquat().normalize());
                let corner = DVec3::from_array(std::array::from_fn(|i| axes.col(i).dot(out).signum()));
                let corner = axes * (corner * half.as_dvec3());
                let center = (point - corner).as_vec3();
                (Obb::new(center, half, rotation).into(), center.as_dvec3() + corner * ON_CORNER)
            }
            _ => {
                let scale = Vec3::splat((size as f32).max(LEAST_INSTANCE * self.unit));
                let rotation = turn(dice);
                let transform = Affine3A::from_scale_rotation_translation(scale, rotation, at);
                let exact = exact(transform);
                let corners = DVec3::AXES.map(|c| exact.transform_point3(c));
                let most = corners.into_iter().max_by(|a, b| a.dot(out).total_cmp(&b.dot(out)));
                match Instance::new(self.meshes.speck.clone(), transform) {
                    Ok(instance) => (instance.into(), most.unwrap_or(point)),
                    Err(_) => (Aabb::new(at, at).into(), point),
                }
            }
        };
        self.target(bounds);
        seen
    }

    /// Puts an object into the list of targets; says where.
    pub fn target(&mut self, bounds: Bounds) -> usize {
        let (layers, dynamic) = (self.layers(), self.moving && self.dice.once_in(4));
        self.targets.push(Target { bounds, layers, dynamic, id: None });
        self.targets.len() - 1
    }

    /// Aims at a tiny object, or at a point of none, closely past an occluder. Only points for which
    /// `inside` holds are aimed at.
    pub fn aim(&mut self, start: Start, place: Place, object: bool, inside: impl Fn(DVec3) -> bool) {
        for _ in 0..TRIES {
            if let Some(past) = self.graze(&start)
                && self.aim_past(start, place, past, object, &inside)
            {
                return;
            }
        }
    }

    /// Aims past a known place at an object, or at a point of none. Whether `inside` holds for it.
    pub fn aim_past(
        &mut self,
        start: Start,
        place: Place,
        (near, out, shape): Graze,
        object: bool,
        inside: &impl Fn(DVec3) -> bool,
    ) -> bool {
        let point = self.behind(&start, near, out);
        inside(point) && self.aim_at(start, place, (point, out, shape), object, inside)
    }

    /// Aims at an object that has a point, or at the point. Whether `inside` holds for it.
    pub fn aim_at(
        &mut self,
        start: Start,
        place: Place,
        (point, out, shape): Graze,
        object: bool,
        inside: &impl Fn(DVec3) -> bool,
    ) -> bool {
        if !object {
            self.witness(None, start, place, point, shape);
            return true;
        }
        let point = self.target_at(point, out, start.toward(point));
        if !inside(point) {
            self.targets.pop();
            return false;
        }
        self.witness(Some(self.targets.len() - 1), start, place, point, shape);
        true
    }

    /// Takes a point for one to look at.
    pub fn witness(&mut self, target: Option<usize>, start: Start, place: Place, point: DVec3, shape: usize) {
        let mut witness = Witness { target, point, start, place, shape, cut: 0, doubt: 0 };
        for (i, standing) in self.walls.iter().enumerate() {
            witness.look(&standing.wall, 1 << i);
        }
        self.witnesses.push(witness);
    }
}

/// A point in single precision, rounded along each axis to the side that `out` points to.
pub fn rounded(point: DVec3, out: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| {
        let near = point[i] as f32;
        let short = (f64::from(near) - point[i]) * out[i] < 0.0;
        f64::from(match (short, out[i] > 0.0) {
            (false, _) => near,
            (true, true) => near.next_up(),
            (true, false) => near.next_down(),
        })
    }))
}

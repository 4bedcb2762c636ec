//! How a clip walks: to where, how far in a round, and how low its feet are.

use crate::mesh::{Mesh, Vertex};
use crate::skin::{Clip, Ending, Pose, Skeleton, Weights};
use glam::{Affine3A, Vec3};

/// Places of a clip at which feet are looked for.
const STEPS: u32 = 48;

/// A round whose feet go less far, in units, is no walk: they shuffle, or the clip itself moves the
/// animal on.
const LEAST_STRIDE: f32 = 0.1;

/// A vertex so near to the lowest place, in units, may be on the ground: legs turn as they
/// push, and lift it.
const NEAR_GROUND: f32 = 0.06;

/// How a clip walks, in units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gait {
    /// A unit vector without height.
    pub(super) ahead: Vec3,
    /// The way of one round, above 0: feet on the ground then slide least.
    pub(super) stride: f32,
    /// The height of the lowest vertex at any time.
    pub(super) low: f32,
}

impl Gait {
    /// That of what has no walk: a unit for a round, along z.
    pub(super) fn of_none(low: f32) -> Self {
        Self { ahead: Vec3::Z, stride: 1.0, low }
    }

    /// The gait of a mesh that a clip poses; `units` takes the posed mesh into units. Its feet go
    /// backwards on the ground, since it goes nowhere: the lowest vertex from time to time says
    /// where to, and the way is that of the vertex near the ground that goes there fastest, since
    /// the lowest may be a foot that is about to come down.
    pub(super) fn new(
        (mesh, weights): (&Mesh, &Weights),
        skeleton: &Skeleton,
        clip: &Clip,
        units: Affine3A,
    ) -> Self {
        let posed = |step: u32| -> Vec<Vec3> {
            let mut pose = Pose::rest(skeleton);
            let share = f64::from(step) / f64::from(STEPS);
            pose.set(skeleton, clip, share * f64::from(clip.seconds()), Ending::Clamp);
            let there = |(v, vertex): (usize, &Vertex)| {
                units.transform_point3(weights.blend(v, &pose).transform_point3(vertex.position))
            };
            mesh.vertices().iter().enumerate().map(there).collect()
        };
        // Places before and after each step.
        let steps = |each: &mut dyn FnMut(&[Vec3], &[Vec3])| {
            let mut last = posed(0);
            for step in 1..=STEPS {
                let next = posed(step);
                each(&last, &next);
                last = next;
            }
        };
        let (mut way, mut low) = (Vec3::ZERO, f32::INFINITY);
        steps(&mut |last, next| {
            low = last.iter().chain(next).map(|p| p.y).fold(low, f32::min);
            let height = |foot: &(&Vec3, &Vec3)| foot.0.y + foot.1.y;
            let foot = last.iter().zip(next).min_by(|a, b| height(a).total_cmp(&height(b)));
            way += foot.map_or(Vec3::ZERO, |(from, to)| from - to);
        });
        let Some(ahead) = way.with_y(0.0).try_normalize() else { return Self::of_none(low) };
        let mut stride = 0.0;
        steps(&mut |last, next| {
            let near = last.iter().zip(next).filter(|(from, to)| from.y.max(to.y) < low + NEAR_GROUND);
            stride += near.map(|(from, to)| (*from - *to).dot(ahead)).fold(0.0, f32::max);
        });
        if stride >= LEAST_STRIDE { Self { ahead, stride, low } } else { Self::of_none(low) }
    }
}

#[cfg(test)]
mod tests {
    use crate::skin::{Channel, Interpolation, Track};
    use glam::Quat;

    use super::*;
    use crate::scenes::animals::Animal;

    #[test]
    fn animals_walk_along_x_as_far_as_they_were_made_to() {
        for seed in 20..26 {
            let animal = Animal::new(seed, 48).unwrap();
            let (rig, mesh) = (animal.rig(), &animal.levels()[3]);
            let turn = Affine3A::from_quat(Quat::from_rotation_y(0.7));
            let found = Gait::new((mesh, &rig.weights[3]), &rig.skeleton, &rig.walk, turn);
            let share = found.stride / rig.stride;
            println!("seed {seed}: {share:.3} of the stride it was made with, {:?}", found.ahead);
            // Soles are below the feet of the skeleton, and knees push.
            assert!((1.0..1.4).contains(&share), "seed {seed}: {share}");
            assert!(found.ahead.dot(turn.transform_vector3(Vec3::X)) > 0.99, "seed {seed}");
            assert!((found.low - animal.aabb().min.y).abs() < 0.03, "seed {seed}: {}", found.low);
        }
    }

    #[test]
    fn what_does_not_step_looks_along_z() {
        let animal = Animal::new(1, 24).unwrap();
        let (rig, mesh) = (animal.rig(), &animal.levels()[3]);
        let up = Track::new(vec![0.0, 1.0], vec![Vec3::ZERO, Vec3::Y], Interpolation::Linear).unwrap();
        let clip = Clip::new(vec![(0, Channel::Translation(up))], &rig.skeleton).unwrap();
        for units in [Affine3A::IDENTITY, Affine3A::from_scale(Vec3::splat(f32::NAN))] {
            let found = Gait::new((mesh, &rig.weights[3]), &rig.skeleton, &clip, units);
            assert_eq!((found.ahead, found.stride), (Vec3::Z, 1.0));
        }
    }
}

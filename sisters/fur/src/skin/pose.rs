//! All joints at a time.

use glam::Affine3A;

use super::skeleton::{Local, Skeleton};
use super::track::{Channel, Clip};

/// Where all joints of a skeleton are: for each a matrix from the mesh at rest to the posed mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pose {
    locals: Vec<Local>,
    globals: Vec<Affine3A>,
    matrices: Vec<Affine3A>,
}

impl Pose {
    /// A skeleton at rest.
    pub fn rest(skeleton: &Skeleton) -> Self {
        let mut pose = Self::default();
        pose.set(skeleton, &Clip::default(), 0.0);
        pose
    }

    /// Sets it to that of a clip at a time in seconds, in the memory that it has. Clips begin anew
    /// behind their end. Times that are not finite count as 0; channels of joints that the skeleton
    /// lacks move nothing. Costs a binary search for each channel and two products of matrices for
    /// each joint.
    pub fn set(&mut self, skeleton: &Skeleton, clip: &Clip, time: f64) {
        let long = f64::from(clip.seconds());
        let time = if time.is_finite() && long > 0.0 { time.rem_euclid(long) as f32 } else { 0.0 };
        self.locals.clear();
        self.locals.extend(skeleton.joints().iter().map(|joint| joint.rest));
        for (joint, channel) in clip.channels() {
            let Some(local) = self.locals.get_mut(*joint) else { continue };
            match channel {
                Channel::Translation(track) => local.translation = track.at(time),
                Channel::Rotation(track) => local.rotation = track.at(time),
                Channel::Scale(track) => local.scale = track.at(time),
            }
        }
        self.globals.clear();
        self.matrices.clear();
        for (joint, local) in skeleton.joints().iter().zip(&self.locals) {
            let parent = joint.parent.map_or(Affine3A::IDENTITY, |parent| self.globals[parent]);
            let global = parent * local.matrix();
            self.globals.push(global);
            self.matrices.push(global * joint.inverse_bind);
        }
    }

    /// For each joint the matrix from the mesh at rest to the pose.
    pub fn matrices(&self) -> &[Affine3A] {
        &self.matrices
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;
    use crate::skin::{Interpolation, Joint, Track};

    #[test]
    fn joints_turn_around_their_places_and_take_their_children_along() {
        // An arm along x: the shoulder at 0, the elbow at 1.
        let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ZERO), Joint::at(Some(0), Vec3::X)]).unwrap();
        let turn = |angle| {
            let turns = vec![Quat::IDENTITY, Quat::from_rotation_z(angle)];
            Channel::Rotation(Track::new(vec![0.0, 2.0], turns, Interpolation::Linear).unwrap())
        };
        let clip = Clip::new(vec![(0, turn(1.0)), (1, turn(-2.0))], &skeleton).unwrap();
        let mut pose = Pose::rest(&skeleton);
        assert!(pose.matrices().iter().all(|m| m.abs_diff_eq(Affine3A::IDENTITY, 1e-6)));
        let hand = |pose: &Pose| pose.matrices()[1].transform_point3(Vec3::X * 2.0);
        let way = |angle: f32| Quat::from_rotation_z(angle) * Vec3::X;
        for (time, there) in [(1.0, 1.0), (3.0, 1.0), (-0.5, 1.5), (f64::NAN, 0.0), (f64::INFINITY, 0.0)] {
            pose.set(&skeleton, &clip, time);
            let want = way(0.5 * there) + way(-0.5 * there);
            assert!(hand(&pose).distance(want) < 1e-5, "{time}: {}", hand(&pose));
        }
        let far = Clip::new(vec![(2, turn(1.0))], &skeleton);
        assert_eq!(far.unwrap_err().to_string(), "channel 0 moves joint 2 of 2: numbers start at 0");
    }
}

//! Boxes that hold a posed mesh with its fur.

use casca::Aabb;
use glam::{Affine3A, Vec3, Vec3A};

use super::pose::Pose;
use super::weights::Weights;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::numeric::SKINNING_ERROR;
use crate::strands::Fur;

/// For each joint the box of the vertices that follow it, at rest: all that the bounds of poses
/// need of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinBounds {
    /// By joint; only joints that a vertex follows.
    boxes: Vec<(usize, Aabb)>,
    /// The greatest coordinate of the mesh at rest.
    magnitude: f32,
}

impl SkinBounds {
    /// The boxes of a mesh and its weights. They hold for its [levels](Mesh::levels), too, whose vertices are some of its own. Costs one pass.
    ///
    /// # Errors
    /// Refuses weights for another number of vertices.
    pub fn new(mesh: &Mesh, weights: &Weights) -> Result<Self, Error> {
        weights.check(mesh.vertices().len())?;
        let mut boxes: Vec<Option<Aabb>> = Vec::new();
        let mut magnitude = 0f32;
        for ((vertex, joints), shares) in mesh.vertices().iter().zip(weights.joints()).zip(weights.shares()) {
            let p = vertex.position;
            magnitude = magnitude.max(p.abs().max_element());
            for (joint, _) in joints.iter().zip(shares).filter(|(_, share)| **share > 0.0) {
                let joint = usize::from(*joint);
                boxes.resize(boxes.len().max(joint + 1), None);
                let old = boxes[joint].unwrap_or(Aabb::new(p, p));
                boxes[joint] = Some(Aabb::new(old.min.min(p), old.max.max(p)));
            }
        }
        let boxes = boxes.into_iter().enumerate().filter_map(|(joint, aabb)| Some((joint, aabb?))).collect();
        Ok(Self { boxes, magnitude })
    }

    /// A box that holds every layer of the fur in a pose, in the space of the posed mesh, rounded
    /// outwards. Costs a box for each joint that a vertex follows.
    ///
    /// It holds them whatever the weights are. A point of a layer is `x = p + e` at rest, where `p`
    /// is a vertex or a mean of the three of a triangle, and `e` is no longer than
    /// [`Fur::reach`]. For a vertex `p` it goes to `sum of w_j M_j x`, with shares `w_j` of joints
    /// that `p` follows, which are not negative and add up to 1: a convex mean of the points
    /// `M_j x`. Each `x` lies in the box of the vertices that follow `j`, wider by the reach, and
    /// an affine `M_j` takes that box into the box around its image; so all `M_j x` lie in the
    /// union of these, the mean in the box around the union. Points within a triangle of a layer
    /// are means of its corners. How far fur reaches scales with the joints, as the fur does.
    ///
    /// A pose that is not finite gives a box that is not finite, which scenes refuse.
    pub fn posed(&self, pose: &Pose, fur: &Fur) -> Aabb {
        let reach = Vec3A::splat(fur.reach(self.magnitude));
        let (mut min, mut max) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        let mut greatest = Vec3A::ZERO;
        let mut sound = true;
        for (joint, aabb) in &self.boxes {
            let m = pose.matrices().get(*joint).copied().unwrap_or(Affine3A::IDENTITY);
            let middle = Vec3A::from(aabb.min * 0.5 + aabb.max * 0.5);
            // Rounding of the middle must not make the box smaller.
            let half = (Vec3A::from(aabb.max) - middle).max(middle - Vec3A::from(aabb.min)) + reach;
            let size = |v: Vec3A| {
                m.matrix3.x_axis.abs() * v.x + m.matrix3.y_axis.abs() * v.y + m.matrix3.z_axis.abs() * v.z
            };
            let (there, wide) = (m.transform_point3a(middle), size(half));
            sound &= there.is_finite() && wide.is_finite();
            (min, max) = (min.min(there - wide), max.max(there + wide));
            greatest = greatest.max(size(middle.abs() + half) + m.translation.abs());
        }
        if !sound {
            return Aabb::new(Vec3::NAN, Vec3::NAN);
        }
        let margin = greatest * SKINNING_ERROR;
        Aabb::new((min - margin).into(), (max + margin).into())
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::samples::{ball, torus_mesh};
    use crate::skin::{Channel, Clip, Interpolation, Joint, Local, Skeleton, Track};
    use casca_scenes::random::Dice;

    fn turned(random: &mut Dice) -> Quat {
        Quat::from_axis_angle(random.ball().normalize(), random.range(0.0, 6.3))
    }

    /// Joints hung at random, of random scales, and a clip that moves all of them.
    fn creature(random: &mut Dice, joints: usize) -> (Skeleton, Clip) {
        let local = |random: &mut Dice| Local {
            translation: random.ball() * 2.0,
            rotation: turned(random),
            scale: Vec3::ONE + random.ball() * 0.5,
        };
        let made = (0..joints).map(|i| {
            let parent = (i > 0).then(|| random.range(0.0, i as f32) as usize);
            Joint { rest: local(random), ..Joint::at(parent, Vec3::ZERO) }
        });
        let skeleton = Skeleton::new(made.collect()).unwrap();
        let channels = (0..joints).flat_map(|i| {
            let keys = |random: &mut Dice| [0; 3].map(|_| local(random));
            let times = || vec![0.0, 0.5, 1.0];
            let places = keys(random).map(|l| l.translation).to_vec();
            let turns = keys(random).map(|l| l.rotation).to_vec();
            let scales = keys(random).map(|l| l.scale * 1.5).to_vec();
            let how = Interpolation::Linear;
            [
                (i, Channel::Translation(Track::new(times(), places, how).unwrap())),
                (i, Channel::Rotation(Track::new(times(), turns, how).unwrap())),
                (i, Channel::Scale(Track::new(times(), scales, how).unwrap())),
            ]
        });
        let channels = channels.collect();
        let clip = Clip::new(channels, &skeleton).unwrap();
        (skeleton, clip)
    }

    fn weights(random: &mut Dice, vertices: usize, skeleton: &Skeleton) -> Weights {
        let count = skeleton.joints().len() as f32;
        let joints: Vec<[u32; 4]> =
            (0..vertices).map(|_| [0; 4].map(|_| random.range(0.0, count) as u32)).collect();
        let share = |random: &mut Dice| if random.chance(0.4) { 0.0 } else { random.range(0.0, 1.0) };
        let shares: Vec<[f32; 4]> =
            joints.iter().map(|_| [1e-6, share(random), share(random), share(random)]).collect();
        Weights::new(&joints, &shares, skeleton).unwrap()
    }

    #[test]
    fn bounds_hold_every_layer_in_every_pose_whatever_the_weights_are() {
        let mut random = Dice::new(11, 0);
        let (mut held, mut tightest) = (0, f32::INFINITY);
        for case in 0..120 {
            let mesh = if case % 2 == 0 { ball(1) } else { torus_mesh(9) };
            let (skeleton, clip) = creature(&mut random, 1 + case % 7);
            let weights = weights(&mut random, mesh.vertices().len(), &skeleton);
            let fur = Fur {
                bend: random.ball() * 2.0,
                ..Fur::for_radius(1.0, random.range(0.0, 1.0), 0.2).unwrap()
            };
            let bounds = SkinBounds::new(&mesh, &weights).unwrap();
            let mut pose = Pose::rest(&skeleton);
            for _ in 0..4 {
                pose.set(&skeleton, &clip, f64::from(random.range(0.0, 1.0)));
                let posed = bounds.posed(&pose, &fur);
                let at = |v: usize, h: f32| {
                    let vertex = &mesh.vertices()[v];
                    weights.blend(v, &pose).transform_point3(fur.extruded(vertex.position, vertex.normal, h))
                };
                let mut need = (Vec3::INFINITY, Vec3::NEG_INFINITY);
                for t in mesh.triangles() {
                    let h = random.range(0.0, 1.0);
                    let [a, b] = [random.range(0.0, 1.0), random.range(0.0, 1.0)];
                    for h in [0.0, h, 1.0] {
                        let [p, q, r] = t.map(|v| at(v as usize, h));
                        for p in [p, q, r, p.lerp(q, a).lerp(r, b)] {
                            assert!(posed.contains(p), "case {case}: {p} is outside of {posed:?}");
                            need = (need.0.min(p), need.1.max(p));
                            held += 1;
                        }
                    }
                }
                let share = (need.1 - need.0) / (posed.max - posed.min);
                tightest = tightest.min(share.min_element());
            }
        }
        println!("{held} points of layers held; the box is at most {:.1} times too wide", 1.0 / tightest);
        // One joint that holds all: no wider than a turned box.
        assert!(held > 300_000 && tightest > 0.2, "{held} {tightest}");
    }

    #[test]
    fn at_rest_bounds_are_hardly_wider_than_those_of_the_mesh() {
        let mesh = ball(2);
        let skeleton = Skeleton::new(vec![Joint::at(None, Vec3::ONE), Joint::at(Some(0), Vec3::X)]).unwrap();
        let count = mesh.vertices().len();
        let weights =
            Weights::new(&vec![[0, 1, 1, 1]; count], &vec![[0.5, 0.5, 0.0, 0.0]; count], &skeleton).unwrap();
        let fur = Fur::for_radius(1.0, 0.1, 0.2).unwrap();
        let posed = SkinBounds::new(&mesh, &weights).unwrap().posed(&Pose::rest(&skeleton), &fur);
        let want = crate::visibility::inflate(mesh.aabb(), fur.reach(1.0));
        assert!(
            posed.min.distance(want.min) < 2e-5 && posed.max.distance(want.max) < 2e-5,
            "{posed:?} {want:?}"
        );
        let few = Weights::new(&[[0; 4]], &[[1.0; 4]], &skeleton).unwrap();
        assert!(matches!(SkinBounds::new(&mesh, &few), Err(Error::Count { found: 1, .. })));
    }

    #[test]
    fn poses_that_are_not_finite_give_boxes_that_scenes_refuse() {
        let big = Local { scale: Vec3::splat(1e9), ..Local::IDENTITY };
        let joint = |i: usize| Joint {
            rest: big,
            inverse_bind: Affine3A::IDENTITY,
            ..Joint::at(i.checked_sub(1), Vec3::ZERO)
        };
        let skeleton = Skeleton::new((0..6).map(joint).collect()).unwrap();
        let (mesh, count) = (ball(1), ball(1).vertices().len());
        let weights = Weights::new(&vec![[5; 4]; count], &vec![[1.0; 4]; count], &skeleton).unwrap();
        let fur = Fur::for_radius(1.0, 0.1, 0.2).unwrap();
        let posed = SkinBounds::new(&mesh, &weights).unwrap().posed(&Pose::rest(&skeleton), &fur);
        assert!(!posed.min.is_finite());
    }
}

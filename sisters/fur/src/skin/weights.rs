//! Which joints each vertex follows, and how much.

use std::collections::HashMap;

use glam::Affine3A;

use super::pose::Pose;
use super::skeleton::Skeleton;
use crate::error::Error;
use crate::mesh::Mesh;

/// Joints that a vertex can follow.
pub const PER_VERTEX: usize = 4;

/// For each vertex of a mesh four joints and their shares, which are not negative and add up to 1.
/// 24 bytes a vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    joints: Vec<[u16; PER_VERTEX]>,
    shares: Vec<[f32; PER_VERTEX]>,
}

impl Weights {
    /// Weights, one row of joints and one of shares a vertex; shares are scaled so that they add up
    /// to 1. A joint without share may be any that exists. Costs one pass.
    ///
    /// # Errors
    /// Refuses lists of different lengths, joints that the skeleton lacks, and shares that are
    /// negative, not finite or all zero.
    pub fn new(
        joints: &[[u32; PER_VERTEX]],
        shares: &[[f32; PER_VERTEX]],
        skeleton: &Skeleton,
    ) -> Result<Self, Error> {
        if joints.len() != shares.len() {
            return Err(Error::Count { what: "shares", found: shares.len(), expected: joints.len() });
        }
        let count = skeleton.joints().len();
        let mut made =
            Self { joints: Vec::with_capacity(joints.len()), shares: Vec::with_capacity(joints.len()) };
        for (vertex, (of, shares)) in joints.iter().zip(shares).enumerate() {
            let mut kept = [0; PER_VERTEX];
            for (slot, &joint) in kept.iter_mut().zip(of) {
                let known = u16::try_from(joint).ok().filter(|&j| usize::from(j) < count);
                *slot = known.ok_or(Error::follows(vertex, joint as usize, count))?;
            }
            let sum: f64 = shares.iter().map(|&s| f64::from(s)).sum();
            // NaN is not at least 0.
            if !(shares.iter().all(|s| *s >= 0.0) && sum > 0.0 && sum.is_finite()) {
                return Err(Error::Shares { vertex, shares: *shares });
            }
            made.joints.push(kept);
            made.shares.push(shares.map(|s| (f64::from(s) / sum) as f32));
        }
        Ok(made)
    }

    /// The joints of each vertex.
    pub fn joints(&self) -> &[[u16; PER_VERTEX]] {
        &self.joints
    }

    /// The share of each of these joints.
    pub fn shares(&self) -> &[[f32; PER_VERTEX]] {
        &self.shares
    }

    /// The weights for `to`, whose vertices have places of `from`, for which these weights are: for
    /// [ordered](Mesh::ordered) and welded meshes and for [levels](Mesh::levels). Of several
    /// vertices of `from` at one place the first counts, so that no seam opens. Costs a hash table
    /// of the vertices.
    ///
    /// # Errors
    /// Refuses a mesh with another number of vertices than these weights, and a vertex of `to` that
    /// is no vertex of `from`.
    pub fn carried(&self, from: &Mesh, to: &Mesh) -> Result<Self, Error> {
        self.check(from.vertices().len())?;
        let key = |p: glam::Vec3| p.to_array().map(|c| (c + 0.0).to_bits());
        let mut places = HashMap::with_capacity(from.vertices().len());
        for (number, vertex) in from.vertices().iter().enumerate() {
            places.entry(key(vertex.position)).or_insert(number);
        }
        let mut made = Self { joints: Vec::new(), shares: Vec::new() };
        for (vertex, v) in to.vertices().iter().enumerate() {
            let &of = places.get(&key(v.position)).ok_or(Error::Stranger { vertex })?;
            made.joints.push(self.joints[of]);
            made.shares.push(self.shares[of]);
        }
        Ok(made)
    }

    /// Refuses another number of vertices.
    pub(crate) fn check(&self, expected: usize) -> Result<(), Error> {
        match self.joints.len() {
            found if found == expected => Ok(()),
            found => Err(Error::Count { what: "weights", found, expected }),
        }
    }

    /// The blended matrix of a vertex, from the mesh at rest to the pose: the twin of what the
    /// vertex stage does. Joints that the pose lacks stay at rest; so does a vertex that does not
    /// exist.
    pub fn blend(&self, vertex: usize, pose: &Pose) -> Affine3A {
        let (Some(joints), Some(shares)) = (self.joints.get(vertex), self.shares.get(vertex)) else {
            return Affine3A::IDENTITY;
        };
        let mut sum = Affine3A::from_mat3(glam::Mat3::ZERO);
        for (&joint, &share) in joints.iter().zip(shares) {
            let m = pose.matrices().get(usize::from(joint)).copied().unwrap_or(Affine3A::IDENTITY);
            sum.matrix3 += m.matrix3 * share;
            sum.translation += m.translation * share;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::samples::ball;
    use crate::skin::Joint;
    use casca_scenes::random::Dice;

    fn skeleton(joints: usize) -> Skeleton {
        Skeleton::new((0..joints).map(|i| Joint::at(i.checked_sub(1), Vec3::X)).collect()).unwrap()
    }

    #[test]
    fn weights_are_normalised_and_absurd_ones_are_refused() {
        let two = skeleton(2);
        let weights = Weights::new(&[[1, 0, 0, 0]], &[[1.0, 3.0, 0.0, 0.0]], &two).unwrap();
        assert_eq!((weights.joints()[0], weights.shares()[0]), ([1, 0, 0, 0], [0.25, 0.75, 0.0, 0.0]));
        for joint in [2, 65_536, u32::MAX] {
            let refused = Weights::new(&[[0; 4], [0, joint, 0, 0]], &[[1.0; 4]; 2], &two);
            assert_eq!(refused, Err(Error::follows(1, joint as usize, 2)));
        }
        for shares in [[0.0; 4], [f32::NAN, 1.0, 0.0, 0.0], [2.0, -1.0, 0.0, 0.0], [f32::INFINITY; 4]] {
            let refused = Weights::new(&[[0; 4]], &[shares], &two);
            assert!(matches!(refused, Err(Error::Shares { vertex: 0, .. })), "{shares:?}");
        }
        assert!(matches!(Weights::new(&[[0; 4]], &[], &two), Err(Error::Count { .. })));
        // Tiny ones are not lost, and huge ones do not overflow.
        for share in [f32::MIN_POSITIVE * 1e-5, f32::MAX] {
            let weights = Weights::new(&[[0, 1, 0, 0]], &[[share, share, 0.0, 0.0]], &two).unwrap();
            assert_eq!(weights.shares()[0], [0.5, 0.5, 0.0, 0.0]);
        }
    }

    #[test]
    fn weights_follow_vertices_to_simplified_meshes() {
        let (mesh, mut random) = (ball(3), Dice::new(3, 0));
        let joints: Vec<[u32; 4]> =
            mesh.vertices().iter().map(|_| [random.range(0.0, 5.0) as u32; 4]).collect();
        let weights = Weights::new(&joints, &vec![[1.0; 4]; joints.len()], &skeleton(5)).unwrap();
        let simple = mesh.levels(2).unwrap().remove(1);
        let carried = weights.carried(&mesh, &simple).unwrap();
        assert_eq!(carried.joints().len(), simple.vertices().len());
        for (vertex, joints) in simple.vertices().iter().zip(carried.joints()) {
            let of = mesh.vertices().iter().position(|v| v.position == vertex.position).unwrap();
            assert_eq!(*joints, weights.joints()[of]);
        }
        assert_eq!(
            carried.carried(&simple, &mesh).map(drop).unwrap_err(),
            Error::Stranger {
                vertex: mesh.vertices().iter().position(|v| !simple.vertices().contains(v)).unwrap()
            }
        );
        assert!(matches!(weights.carried(&simple, &mesh), Err(Error::Count { .. })));
    }
}

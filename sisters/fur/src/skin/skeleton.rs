//! Joints and their parents.

use glam::{Affine3A, Quat, Vec3};

use crate::error::{Error, range};
use crate::numeric::{MAX_COORDINATE, MAX_JOINTS, UNIT_QUATERNION};

/// A place relative to a parent: scaled, then turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// How far it is moved.
    pub translation: Vec3,
    /// How it is turned: of length 1.
    pub rotation: Quat,
    /// How it is scaled along its own axes.
    pub scale: Vec3,
}

impl Local {
    /// Neither moved nor turned nor scaled.
    pub const IDENTITY: Self = Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE };

    /// The same as a matrix.
    pub fn matrix(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A joint of a skeleton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// The joint that it hangs from, which comes before it.
    pub parent: Option<usize>,
    /// Where it is at rest, relative to its parent.
    pub rest: Local,
    /// From the space of the mesh at rest to that of the joint.
    pub inverse_bind: Affine3A,
}

impl Joint {
    /// A joint that is moved from its parent and neither turned nor scaled; [`Skeleton::new`] finds
    /// its inverse bind matrix from the rest pose.
    pub fn at(parent: Option<usize>, offset: Vec3) -> Self {
        let rest = Local { translation: offset, ..Local::IDENTITY };
        Self { parent, rest, inverse_bind: Affine3A::from_mat3(glam::Mat3::ZERO) }
    }
}

/// Joints, parents before their children.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    joints: Vec<Joint>,
}

impl Skeleton {
    /// A skeleton of joints. A joint whose inverse bind matrix is all zero is bound where it rests.
    /// Costs one pass.
    ///
    /// # Errors
    /// Refuses no joints and more than 65,536, a parent that does not come before its child,
    /// numbers that are not finite or above 1e9, and rotations that are not of length 1.
    pub fn new(mut joints: Vec<Joint>) -> Result<Self, Error> {
        range("the number of joints", joints.len() as f64, 1.0, MAX_JOINTS as f64)?;
        let mut globals: Vec<Affine3A> = Vec::with_capacity(joints.len());
        for (number, joint) in joints.iter_mut().enumerate() {
            for value in [joint.rest.translation, joint.rest.scale].into_iter().flat_map(|v| v.to_array()) {
                range("a translation or scale of a joint", value.into(), -MOST, MOST)?;
            }
            let (length, off) = (f64::from(joint.rest.rotation.length()), UNIT_QUATERNION);
            range("the length of a rotation of a joint", length, 1.0 - off, 1.0 + off)?;
            joint.rest.rotation = joint.rest.rotation.normalize();
            let local = joint.rest.matrix();
            let global = match joint.parent {
                None => local,
                Some(parent) if parent < number => globals[parent] * local,
                Some(parent) => return Err(Error::Parent { joint: number, parent }),
            };
            globals.push(global);
            if joint.inverse_bind == Affine3A::from_mat3(glam::Mat3::ZERO) {
                joint.inverse_bind = global.inverse();
            }
            for value in joint.inverse_bind.to_cols_array() {
                range("a number of an inverse bind matrix", value.into(), -MOST, MOST)?;
            }
        }
        Ok(Self { joints })
    }

    /// The joints.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }
}

const MOST: f64 = MAX_COORDINATE as f64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_skeletons_are_refused() {
        let root = Joint::at(None, Vec3::ZERO);
        assert!(matches!(Skeleton::new(vec![]), Err(Error::Range { .. })));
        assert_eq!(
            Skeleton::new(vec![root, Joint::at(Some(1), Vec3::X)]),
            Err(Error::Parent { joint: 1, parent: 1 })
        );
        assert!(Skeleton::new(vec![root, Joint::at(Some(usize::MAX), Vec3::X)]).is_err());
        assert!(Skeleton::new(vec![root; MAX_JOINTS + 1]).is_err());
        for rest in [
            Local { translation: Vec3::NAN, ..Local::IDENTITY },
            Local { scale: Vec3::INFINITY, ..Local::IDENTITY },
            Local { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Local::IDENTITY },
            Local { rotation: Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0), ..Local::IDENTITY },
        ] {
            assert!(
                matches!(Skeleton::new(vec![Joint { rest, ..root }]), Err(Error::Range { .. })),
                "{rest:?}"
            );
        }
        // A joint without size has no inverse.
        let flat = Local { scale: Vec3::ZERO, ..Local::IDENTITY };
        assert!(Skeleton::new(vec![Joint { rest: flat, ..root }]).is_err());
    }

    #[test]
    fn joints_are_bound_where_they_rest() {
        let bent = Local { rotation: Quat::from_rotation_z(0.5), ..Local::IDENTITY };
        let joints =
            vec![Joint { rest: bent, ..Joint::at(None, Vec3::ZERO) }, Joint::at(Some(0), Vec3::X * 2.0)];
        let skeleton = Skeleton::new(joints).unwrap();
        let tip = Quat::from_rotation_z(0.5) * Vec3::X * 2.0;
        assert!(skeleton.joints()[1].inverse_bind.transform_point3(tip).length() < 1e-6);
    }
}

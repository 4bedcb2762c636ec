//! Plain geometric values of the public interface.

use glam::{Quat, Vec3};

use crate::error::{Error, finite3, not_negative};

/// An axis-aligned box in world units; both corners belong to it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Aabb {
    /// Least corner in world units.
    pub min: Vec3,
    /// Greatest corner in world units.
    pub max: Vec3,
}

impl Aabb {
    /// The box between two corners, in this order.
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The box around `center` that reaches `half` to each side.
    pub fn from_center(center: Vec3, half: Vec3) -> Self {
        Self { min: center - half, max: center + half }
    }

    /// The least box around all points; `None` without points. Costs the points.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        points.into_iter().map(|p| Self::new(p, p)).reduce(|a, b| a.union(&b))
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        self.min + (self.max - self.min) * 0.5
    }

    /// Whether a point lies inside or on the surface.
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// The least box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite3(what, self.min)?;
        finite3(what, self.max)?;
        if self.min.cmple(self.max).all() {
            Ok(())
        } else {
            Err(Error::InvertedBox { what, min: self.min, max: self.max })
        }
    }
}

/// A sphere in world units; its surface belongs to it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Sphere {
    /// Centre in world units.
    pub center: Vec3,
    /// Radius in world units, not negative.
    pub radius: f32,
}

impl Sphere {
    /// The sphere around `center`.
    pub const fn new(center: Vec3, radius: f32) -> Self {
        Self { center, radius }
    }

    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite3(what, self.center)?;
        not_negative(what, f64::from(self.radius))
    }
}

/// A box turned by a rotation, in world units; its surface belongs to it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Obb {
    /// Middle in world units.
    pub center: Vec3,
    /// Half the edge lengths along the axes of the box in world units, not negative.
    pub half: Vec3,
    /// From the axes of the box to those of the world. Its length does not matter, but must not
    /// be 0.
    pub rotation: Quat,
}

impl Obb {
    /// The box around `center` that reaches `half` to each side before it is turned.
    pub const fn new(center: Vec3, half: Vec3, rotation: Quat) -> Self {
        Self { center, half, rotation }
    }

    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite3(what, self.center)?;
        finite3(what, self.half)?;
        not_negative(what, f64::from(self.half.min_element()))?;
        let length = self.rotation.as_dquat().length();
        if length.is_normal() { Ok(()) } else { Err(Error::Rotation { what, rotation: self.rotation }) }
    }
}

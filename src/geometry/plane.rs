//! Planes and half-spaces.

use glam::{DVec3, DVec4, Vec3};

#[cfg(feature = "serde")]
use crate::error::{Error, finite3};
use crate::numeric::shape::DISTANCE;

/// Half of space: the points `p` with `normal.dot(p) + offset >= 0`, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Plane {
    /// Points into the half-space; any length but zero.
    pub normal: Vec3,
    /// Zero for planes through the origin.
    pub offset: f32,
}

#[cfg(feature = "serde")]
impl Plane {
    /// Refuses a plane without direction, as all functions do that take planes.
    pub(crate) fn check(&self, what: &'static str) -> Result<(), Error> {
        finite3(what, self.normal)?;
        if !self.offset.is_finite() {
            return Err(Error::NotFinite { what, value: DVec3::splat(f64::from(self.offset)) });
        }
        if self.normal == Vec3::ZERO { Err(Error::NoDirection { what }) } else { Ok(()) }
    }
}

/// A half-space in `f64`, and its plane: the points `p` with `normal.dot(p) + offset >= 0` are
/// inside. The normal has length 1 and points inwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfSpace {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

impl HalfSpace {
    /// Normalises a plane; `None` if it has no direction.
    pub(crate) fn new(v: DVec4) -> Option<Self> {
        let length = v.truncate().length();
        (length > 0.0 && length.is_finite() && v.w.is_finite())
            .then(|| Self { normal: v.truncate() / length, offset: v.w / length })
    }

    /// How far a point lies inside; negative outside.
    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p) + self.offset
    }

    /// How far a point lies outside; negative inside.
    pub(crate) fn beyond(&self, p: DVec3) -> f64 {
        -self.distance(p)
    }

    /// Margin for decisions about points with coordinates up to `largest`.
    pub(crate) fn margin(&self, largest: f64) -> f64 {
        DISTANCE * (largest + self.offset.abs())
    }
}

//! Extents of shapes along axes.

use glam::DVec3;

/// The extent of a shape along three axes at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    /// Coordinates of the middle along the axes.
    pub(crate) middle: DVec3,
    /// How far the shape reaches to both sides of it.
    pub(crate) half: DVec3,
    /// No coordinate of the shape in world space is greater.
    pub(crate) greatest: f64,
}

impl Extent {
    /// The extent of a shape that reaches `half` of an axis to both sides of `center`.
    pub(crate) fn new(axes: &[DVec3; 3], center: DVec3, half: impl Fn(DVec3) -> f64, greatest: f64) -> Self {
        let middle = DVec3::from_array(axes.map(|axis| center.dot(axis)));
        Self { middle, half: DVec3::from_array(axes.map(half)), greatest }
    }
}

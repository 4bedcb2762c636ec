//! Transforms of meshes, with the bounds and normals that follow from them.

use glam::{DAffine3, DMat3};

/// A transform, with the numbers that follow from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) affine: DAffine3,
    /// The greatest factor by which lengths grow is no larger.
    pub(crate) growth: f64,
    /// Points may lie this far from where the transform puts them.
    pub(crate) error: f64,
    /// Turns normals; `None` if the transform flattens space.
    pub(crate) normals: Option<DMat3>,
    /// Whether it turns, moves and scales all axes alike, and mirrors nothing.
    pub(crate) keeps_angles: bool,
}

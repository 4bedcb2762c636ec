//! Convex solids relative to an eye.

use glam::{DMat3, DVec3};

use crate::geometry::Block;
use crate::geometry::polytope::Part;

/// A convex solid relative to the origin of the rays, as occlusion buffers draw and test it.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Body<'a> {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Block(Block),
    /// A box around `center`; the columns of `axes` are its half-axes.
    Oriented {
        center: DVec3,
        axes: DMat3,
    },
    Part(Part<'a>),
}

//! Convex solids relative to an eye.

use glam::{DMat3, DVec3};

use crate::geometry::Block;
use crate::geometry::polytope::Polytope;

/// A convex solid relative to the origin of the rays, as occlusion buffers draw and test it. Lives
/// on the stack.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone)]
pub(crate) enum Body {
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
    Polytope(Polytope),
}

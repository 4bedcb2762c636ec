//! The hemisphere of a receiver (Benevides 2015, section 3.3.1).
//!
//! Lengths are in its radii, so that no product under- or overflows in scenes of very small or very
//! large units.

use glam::Vec3;

use crate::buffers::Fragment;
use crate::numeric::ALONG_VIEW;
use crate::view::View;

/// The hemisphere around a point of a line: its base is tangent to the line, its pole is turned to
/// the viewer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hemisphere {
    /// The receiver in eye space, in units of the scene.
    pub(super) middle: Vec3,
    pub(super) pole: Vec3,
    /// In units of the scene.
    pub(super) radius: f32,
    /// Directions of the disc of samples, normal to the direction of view.
    pub(super) across: [Vec3; 2],
    pub(super) perspective: bool,
}

impl Hemisphere {
    /// `None` for a receiver at or behind the eye of a perspective view.
    pub(super) fn new(at: &Fragment, radius: f32, view: &View) -> Option<Self> {
        let perspective = view.is_perspective();
        if !at.position.is_finite() || (perspective && at.position.z >= 0.0) {
            return None;
        }
        let away = view.away(at.position);
        let pole = -away - at.tangent * at.tangent.dot(-away);
        // A line along the view: every direction is normal to it but the one to the eye, which
        // shows best.
        let pole = if pole.length() > ALONG_VIEW { pole.normalize() } else { -away };
        let right = (Vec3::X - away * away.x).normalize_or(Vec3::Y);
        Some(Self { middle: at.position, pole, radius, across: [right, right.cross(away)], perspective })
    }

    /// The place in eye space, in units of the scene, of a point that is given from the receiver.
    pub(super) fn place(&self, from: Vec3) -> Vec3 {
        self.middle + from * self.radius
    }
}

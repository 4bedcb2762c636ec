//! How a camera moved from one view to the next, and where it will be if it goes on like that.

use glam::{DQuat, DVec3};

use crate::geometry::plane::HalfSpace;
use crate::view::{Origin, View};

/// A step of the eye, and a turn about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EyeMotion {
    pub(crate) step: DVec3,
    axis: DVec3,
    pub(crate) angle: f64,
}

impl EyeMotion {
    /// How a camera with an eye moved from one view to the next. Turns about the axis that it looks
    /// along do not count.
    pub(crate) fn between(before: &View, after: &View) -> Option<Self> {
        let step = after.eye()? - before.eye()?;
        let (from, to) = (before.cone()?.middle, after.cone()?.middle);
        let axis = from.cross(to);
        let angle = axis.length().atan2(from.dot(to));
        Some(Self { step, axis: axis.normalize_or_zero(), angle })
    }

    /// A multiple of the motion, but with a step and a turn no greater than these.
    pub(crate) fn times(self, many: f64, step: f64, angle: f64) -> Self {
        Self {
            step: (self.step * many).clamp_length_max(step),
            angle: (self.angle * many).min(angle),
            ..self
        }
    }
}

impl View {
    /// The view of the same camera after a motion.
    pub(crate) fn moved(&self, by: &EyeMotion) -> Self {
        let Origin::Eye { at, error } = self.origin else { return self.clone() };
        let next = at + by.step;
        // A camera that did not turn has no axis.
        let turned = by.axis != DVec3::ZERO;
        let turn = if turned { DQuat::from_axis_angle(by.axis, by.angle) } else { DQuat::IDENTITY };
        let moved = |plane: &HalfSpace| {
            let normal = (turn * plane.normal).normalize();
            HalfSpace { normal, offset: plane.distance(at) - normal.dot(next) }
        };
        let straight = self.clone().straight();
        let planes = straight.planes.iter().map(moved).collect();
        let straight = Self { origin: Origin::Eye { at: next, error }, planes, ..straight };
        if self.turn() > 0.0 { straight.opened(self.turn()) } else { straight }
    }
}

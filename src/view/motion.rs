//! Views of the same camera elsewhere: how it moved from one view to the next, where it will be if
//! it goes on like that, and its view in other coordinates.

use glam::{DQuat, DVec3};

use crate::geometry::plane::HalfSpace;
use crate::numeric::place::CARRIED;
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
    /// along do not count, nor those of views in all directions.
    pub(crate) fn between(before: &View, after: &View) -> Option<Self> {
        let step = after.eye()? - before.eye()?;
        let along = |view: &View| view.cone().map_or(DVec3::Z, |cone| cone.middle);
        let (from, to) = (along(before), along(after));
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

    /// The same view in coordinates that are greater by an offset. Its planes are moved outwards by
    /// the rounding of their own.
    pub(crate) fn carried(&self, by: DVec3) -> Self {
        let turn = self.turn();
        let straight = self.clone().straight();
        let room = CARRIED * by.length();
        let plane = |p: &HalfSpace| HalfSpace { offset: p.offset - p.normal.dot(by) + room, ..*p };
        let planes = straight.planes.iter().map(plane).collect();
        let origin = match straight.origin {
            Origin::Eye { at, error } => Origin::Eye { at: at + by, error },
            parallel @ Origin::Direction(_) => parallel,
        };
        let cuts = straight.cutting != 0 || matches!(origin, Origin::Direction(_));
        let widened = straight.widened + if cuts { room } else { 0.0 };
        let straight = Self { origin, planes, widened, ..straight };
        if self.turned.is_some() { straight.opened(turn) } else { straight }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Quat, Vec3, Vec4};

    use super::*;
    use crate::random::Random;

    #[test]
    fn a_carried_view_contains_all_that_it_did_and_its_eye() {
        let mut random = Random::new(8);
        let projection = Mat4::from_cols(Vec4::X * 0.974, Vec4::Y * 1.732, -Vec4::W, Vec4::Z * 0.1);
        for _ in 0..500 {
            let turn = Quat::from_rotation_y(random.within(-3.0, 3.0) as f32)
                * Quat::from_rotation_x(random.within(-1.0, 1.0) as f32);
            let view = View::perspective(Vec3::ZERO, projection * Mat4::from_quat(turn)).unwrap();
            let by = random.point(1e5);
            for view in [view.clone(), view.clone().with_reach(0.5).unwrap(), view.with_turn(0.2).unwrap()] {
                let there = view.carried(by);
                assert_eq!((there.eye(), there.turn(), there.reach()), (Some(by), view.turn(), view.reach()));
                assert_eq!(there.planes.len(), view.planes.len());
                for _ in 0..20 {
                    let p = random.point(50.0);
                    if view.planes.iter().all(|plane| plane.distance(p) >= 0.0) {
                        assert!(there.planes.iter().all(|plane| plane.distance(p + by) >= 0.0), "{p} {by}");
                    }
                }
                let sides = there.planes.iter().zip(0..).filter(|(_, i)| there.sides >> i & 1 != 0);
                assert!(sides.into_iter().all(|(plane, _)| plane.distance(by) >= 0.0));
            }
        }
    }
}

//! Views in other coordinates.

use glam::DVec3;

use crate::geometry::plane::HalfSpace;
use crate::numeric::world::CARRIED;
use crate::view::{Origin, View};

impl View {
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

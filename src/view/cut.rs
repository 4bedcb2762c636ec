//! What the near plane cuts into: solids against the convex region between it and the eye.
//!
//! That a solid lies outside of no half-space of the region does not say that they meet: seen from a large solid,
//! the region is a splinter. Its box is small, and is tested against the solid's own sides too.

use glam::DVec3;

use crate::geometry::{Block, Obb, Sphere};
use crate::object::Occluder;
use crate::shape::Shape;
use crate::view::View;

/// Boxes of regions count as larger by this share of the coordinates: far more than the rounding of their corners,
/// far less than matters to a solid.
const MARGIN: f64 = 1e-9;

/// Whether an occluder may meet a convex region that lies in `around`; in doubt, yes.
pub(crate) fn may_meet(occluder: &Occluder, region: &View, around: &Block) -> bool {
    let by = MARGIN * (1.0 + around.min.abs().max(around.max.abs()).max_element());
    let around = Block { min: around.min - by, max: around.max + by };
    match occluder {
        Occluder::Sphere(s) => ball_meets(s, &around) && region.may_see_sphere(s),
        Occluder::Oriented(b) => turned_meets(b, &around) && region.may_see_oriented(b),
        Occluder::Mesh(m) => m.surface_meets(&around),
        other => {
            let block = Block::new(other.bounds());
            let meets = around.min.cmple(block.max).all() && block.min.cmple(around.max).all();
            meets && region.may_see_block(&block)
        }
    }
}

fn ball_meets(s: &Sphere, around: &Block) -> bool {
    let (c, r) = (s.center.as_dvec3(), f64::from(s.radius));
    let away = (around.min - c).max(c - around.max).max(DVec3::ZERO);
    // Not written the other way round, so that NaN is doubt.
    let apart = away.length() > r + MARGIN * (r + c.abs().max_element());
    !apart
}

fn turned_meets(b: &Obb, around: &Block) -> bool {
    let (center, axes, margin) = b.parts();
    let turn = b.turn();
    let (middle, half) = ((around.min + around.max) * 0.5, (around.max - around.min) * 0.5);
    let apart = (0..3).any(|i| {
        let (way, own) = (turn.col(i), axes.col(i).length() * (1.0 + MARGIN));
        way.dot(middle - center).abs() > own + way.abs().dot(half) * (1.0 + MARGIN) + margin
    });
    !apart
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;

    #[test]
    fn a_large_solid_beside_a_splinter_does_not_meet_it() {
        let region = View::around(Vec3::ZERO).unwrap();
        let around = Block { min: DVec3::splat(-0.01), max: DVec3::splat(0.01) };
        let meets = |o: Occluder| may_meet(&o, &region, &around);
        let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
        // Its corner box holds the splinter; its nearest side is this far off.
        let beside = |gap: f32| {
            let center = Vec3::new(1.0, 1.0, 0.0).normalize() * (5.0 + gap);
            [Occluder::from(Obb::new(center, Vec3::splat(5.0), turn)), Sphere::new(center, 5.0).into()]
        };
        assert!(beside(0.1).into_iter().all(|o| o.block().contains(&around) && !meets(o)));
        assert!(beside(0.012).into_iter().all(meets), "the splinter's corner reaches as far as 0.014");
        assert!(beside(-1.0).into_iter().all(meets));
        assert!(meets(Sphere::new(Vec3::ZERO, 0.001).into()));
        assert!(!meets(crate::geometry::Aabb::new(Vec3::splat(0.1), Vec3::ONE).into()));
    }
}

//! The near plane: which solids it cuts into, so that rays may start inside of them.
//!
//! A solid that lies outside of no half-space of a region need not intersect the region: seen from
//! a large solid, the region between near plane and eye is a splinter. Its box is small, and is
//! compared with the solid's own sides too.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::plane::HalfSpace;
use crate::numeric::shape::REGION;
use crate::numeric::view::ALONG_RAYS;
use crate::object::Occluder;
use crate::view::{Origin, View};

impl View {
    /// Whether some plane may cut off the part of a box that parallel rays along
    /// `direction` meet first.
    pub(crate) fn cuts_front(&self, direction: DVec3, b: &Block) -> bool {
        let reach = b.min.abs().max(b.max.abs()).max_element();
        self.planes.iter().filter(|p| p.normal.dot(direction) > ALONG_RAYS).any(|p| {
            let nearest = DVec3::select(p.normal.cmpge(DVec3::ZERO), b.min, b.max);
            p.distance(nearest) < 2.0 * self.widened + p.margin(reach)
        })
    }

    /// The parts of the view that each cutting plane cuts away: convex regions with their
    /// bounding box, as far as they lie in the box from `min` to `max`.
    pub(crate) fn cut_regions(&self, min: DVec3, max: DVec3) -> impl Iterator<Item = (Self, Block)> {
        let regions = self.marked(self.cutting).map(|cut| {
            let mut planes: SmallVec<[HalfSpace; 6]> = self.marked(!self.cutting).copied().collect();
            planes.push(HalfSpace { normal: -cut.normal, offset: 2.0 * self.widened - cut.offset });
            self.region(planes)
        });
        regions.chain(self.before_turned()).filter_map(move |region| {
            let corners = region.corners(min, max);
            (!corners.is_empty()).then(|| (region, Block::around(corners)))
        })
    }

    /// A part of space where rays may start.
    pub(super) fn region(&self, planes: SmallVec<[HalfSpace; 6]>) -> Self {
        Self { layers: self.layers, ..Self::bounded(self.origin, planes) }
    }

    /// Where an eye may lie that is not known exactly, or that may go elsewhere, as a region with
    /// its box.
    pub(crate) fn eye_region(&self) -> Option<(Self, Block)> {
        let Origin::Eye { at, .. } = self.origin else { return None };
        let room = self.eye_box();
        let region = self.region(cuboid(at, room).collect());
        (room.max_element() > 0.0).then_some((region, Block { min: at - room, max: at + room }))
    }
}

/// The half-spaces of the box of all points up to `room` from a point along each axis.
pub(super) fn cuboid(at: DVec3, room: DVec3) -> impl Iterator<Item = HalfSpace> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|n| [n, -n]);
    axes.map(move |n| HalfSpace { normal: n, offset: room.dot(n.abs()) - n.dot(at) })
}

/// Whether rays of a view may start inside an occluder, so that one sees through it: at the eye,
/// which may be anywhere in `unsure`, or where the near plane cuts into it, for which `cut` has the
/// regions between eye and near plane.
pub(crate) fn may_start_in(
    view: &View,
    cut: &[(View, Block)],
    unsure: Option<&(View, Block)>,
    occluder: &Occluder,
) -> bool {
    let meets = |(region, around): &(View, Block)| may_meet(occluder, region, around);
    cut.iter().any(meets)
        || match view.origin {
            Origin::Direction(d) => view.cuts_front(d, &occluder.block()),
            Origin::Eye { at, .. } => occluder.kind().contains_point(at) || unsure.is_some_and(meets),
        }
}

/// Whether an occluder may intersect a convex region that lies in `around`; in doubt, yes.
pub(crate) fn may_meet(occluder: &Occluder, region: &View, around: &Block) -> bool {
    let by = REGION * (1.0 + around.min.abs().max(around.max.abs()).max_element());
    let around = Block { min: around.min - by, max: around.max + by };
    occluder.kind().may_meet(&region.planes, &around)
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;
    use crate::geometry::{Obb, Sphere};

    #[test]
    fn a_large_solid_beside_a_splinter_does_not_meet_it() {
        let region = View::omnidirectional(Vec3::ZERO).unwrap();
        let around = Block { min: DVec3::splat(-0.01), max: DVec3::splat(0.01) };
        let meets = |o: Occluder| may_meet(&o, &region, &around);
        let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_4);
        // Its corner box contains the splinter; its nearest side is this far off.
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

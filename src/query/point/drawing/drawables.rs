//! Patches made ready to be drawn: placed, and turned to the eye.

use casca_slots::Slot;
use glam::{DVec3, Vec3};

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::mesh::surface::seams::Place;
use crate::mesh::surface::{Patch, PatchIndex, PatchSide, Surface};
use crate::numeric::occlusion::REACH_CLEARANCE;
use crate::numeric::query::{CUT_REGION, FRONT_SINE, SLAB};
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::projector::Viewpoint;
use crate::query::start::Starts;
use crate::scene::Scene;
use crate::view::View;

/// The surface of an object.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) slot: Slot,
    pub(super) surface: &'a Surface,
    /// Where the surface stands, if it is an instance.
    pub(super) placement: Option<&'a Placement>,
    pub(super) place: &'a Place,
}

/// The slab of a patch in world units.
struct PlacedSlab {
    normal: DVec3,
    lo: f64,
    hi: f64,
    /// Points may be off by this much, for the eye and for the placement.
    error: f64,
    /// How far the triangles may be from the outline.
    slack: f64,
}

impl<'a> Source<'a> {
    /// The surface of an object, if it has one.
    pub(super) fn of(scene: &'a Scene, slot: Slot) -> Option<Self> {
        let occluder = scene.object(slot).occluder()?;
        let (surface, placement) = (occluder.surface()?, occluder.placement());
        Some(Source { slot, surface, placement, place: scene.seams().place(slot) })
    }

    /// A box around a patch as it is placed, in world units.
    pub(super) fn block(&self, patch: PatchIndex) -> Block {
        let &Patch { min, max, .. } = self.surface.patch(patch);
        placed_block(&Block { min: min.as_dvec3(), max: max.as_dvec3() }, self.placement)
    }

    /// A patch in a box in world units ready to be drawn, if it can be.
    pub(super) fn drawable(
        &self,
        patch: PatchIndex,
        world: &Block,
        (view, starts): (&View, &Starts),
        buffers: &OcclusionBuffers,
    ) -> Option<Drawable<'a>> {
        let &Source { surface, placement, place, .. } = self;
        let (eye, direction) = (buffers.origin(), buffers.direction());
        let block = buffers.relative(world);
        let PlacedSlab { normal, lo, hi, error, slack } =
            placed_slab(surface.patch(patch), placement, buffers.uncertainty())?;
        let base = normal.dot(eye);
        let room = error + SLAB * (base.abs() + eye.abs().max_element() + lo.abs().max(hi.abs()));
        let slab = (lo.min(hi) - base - room, lo.max(hi) - base + room);
        if direction.is_none() {
            let clear = buffers.clearance(error + slack);
            let outside = slab.0 > clear || slab.1 < -clear;
            let nearby = !outside && block.min.max(-block.max).max_element() <= clear;
            if nearby && !self.is_beside_room(buffers.viewpoint(), patch, (normal, slab), clear) {
                return None;
            }
        }
        // Unequal scales change the angles in a patch.
        let sine = || f64::from(surface.patch(patch).sine);
        let keeps_angles = placement.is_none_or(|p| p.keeps_angles);
        if surface.front {
            // The first is nearer for patches that are far, the second for wide ones.
            let is_front = || {
                is_front(direction, normal, &block, sine())
                    || direction.is_none() && is_below_eye(normal, slab, &block, sine())
            };
            if !(keeps_angles && is_front()) {
                return None;
            }
        }
        // The far side of a closed surface lies behind its near side.
        if surface.outward != 0.0
            && keeps_angles
            && is_front(direction, -surface.outward * normal, &block, sine())
        {
            return None;
        }
        if near_plane_cuts_slab(starts, eye, world, normal, slab, room)
            || direction.is_some_and(|d| view.cuts_front(d, world))
        {
            return None;
        }
        // How far above the middle of its slab rays start.
        let height = match direction {
            Some(d) => -normal.dot(d),
            None => -(slab.0 + slab.1) * 0.5,
        };
        let faces_eye =
            buffers.reach() == 0.0 || keeps_angles && is_turned_to_eye(normal, slab, &block, sine());
        Some(Drawable {
            surface,
            placement,
            patch,
            id: 0,
            number: place.base.of(patch),
            links: &place.links,
            block,
            normal,
            slab,
            turned: height < 0.0,
            faces_eye,
            error,
        })
    }

    /// Whether all eyes lie on one side of a patch that is near, and its outline is far: then
    /// nothing of it is drawn that is near ([`REACH_CLEARANCE`]).
    fn is_beside_room(
        &self,
        Viewpoint { origin, room, .. }: Viewpoint,
        patch: PatchIndex,
        (normal, slab): (DVec3, (f64, f64)),
        clear: f64,
    ) -> bool {
        if room.radius() == 0.0 {
            return false;
        }
        let beside = room.along(normal) + clear - REACH_CLEARANCE * room.radius();
        let end = |p: Vec3| match self.placement {
            Some(placement) => placement.affine.transform_point3(p.as_dvec3()) - origin,
            None => p.as_dvec3() - origin,
        };
        let is_far = |side: PatchSide| {
            let [a, b] = self.surface.ends(&side).map(end);
            let way = b - a;
            let share = (-a.dot(way) / way.length_squared()).clamp(0.0, 1.0);
            // Nor if it is NaN.
            (a + way * share).length() > clear
        };
        (slab.0 > beside || slab.1 < -beside) && self.surface.outline(patch).all(|(_, side)| is_far(side))
    }
}

/// Whether every triangle of a patch is turned to every ray: the directions from its points to
/// the eye differ from its normal by less than a right angle less the greatest angle of its
/// triangles, whose sine is given.
fn is_front(direction: Option<DVec3>, normal: DVec3, block: &Block, sine: f64) -> bool {
    let sine = sine + FRONT_SINE;
    match direction {
        Some(d) => -normal.dot(d) > sine,
        None => {
            let d = -(block.min + block.max) * 0.5;
            let radius = (block.max - block.min).length() * 0.5;
            normal.dot(d) - radius > sine * (d.length() + radius)
        }
    }
}

/// Whether the near plane may cut into a patch: then one sees through it.
fn near_plane_cuts_slab(
    starts: &Starts,
    eye: DVec3,
    world: &Block,
    normal: DVec3,
    slab: (f64, f64),
    room: f64,
) -> bool {
    starts.cut().iter().any(|(region, around)| {
        let middle = normal.dot((around.min + around.max) * 0.5 - eye);
        let radius = normal.abs().dot((around.max - around.min) * 0.5) * (1.0 + CUT_REGION) + room;
        around.min.cmple(world.max).all()
            && world.min.cmple(around.max).all()
            && middle + radius >= slab.0
            && middle - radius <= slab.1
            && region.may_see_block(world)
    })
}

/// Whether every triangle of a patch is turned to the eye, which is the origin, with the same side:
/// the directions from its points to the eye differ from its normal, or from the opposite one, by
/// less than a right angle less the greatest angle of its triangles, whose sine is given.
fn is_turned_to_eye(normal: DVec3, slab: (f64, f64), block: &Block, sine: f64) -> bool {
    is_below_eye(normal, slab, block, sine) || is_below_eye(-normal, (-slab.1, -slab.0), block, sine)
}

/// The same of the side that the normal points to.
fn is_below_eye(normal: DVec3, slab: (f64, f64), block: &Block, sine: f64) -> bool {
    let (middle, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    // How far the eye lies above all of the patch.
    let height = -(normal.dot(middle) + normal.abs().dot(half)).min(slab.1);
    let farthest = block.min.abs().max(block.max.abs()).length();
    height > (sine + FRONT_SINE) * farthest
}

/// The slab of a patch as it is placed; `None` if the placement has no normals or leaves the range
/// of numbers.
fn placed_slab(patch: &Patch, placement: Option<&Placement>, unsure: f64) -> Option<PlacedSlab> {
    let (mut error, mut slack) = (unsure, f64::from(patch.slack));
    let Some(p) = placement else {
        return Some(PlacedSlab { normal: patch.normal, lo: patch.lo, hi: patch.hi, error, slack });
    };
    let turned = p.normals? * patch.normal;
    let length = turned.length();
    // The two planes of the slab, by a point of each.
    let at = |h: f64| turned.dot(p.affine.transform_point3(patch.normal * h)) / length;
    let (lo, hi) = (at(patch.lo), at(patch.hi));
    let normal = turned / length;
    if !(normal.is_finite() && lo.is_finite() && hi.is_finite()) {
        return None;
    }
    error += p.error;
    slack *= p.growth;
    Some(PlacedSlab { normal, lo, hi, error, slack })
}

/// A box around a box as it is placed.
fn placed_block(block: &Block, placement: Option<&Placement>) -> Block {
    let Some(p) = placement else { return *block };
    let (center, half) = ((block.min + block.max) * 0.5, (block.max - block.min) * 0.5);
    let m = p.affine.matrix3;
    let radius = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z + p.error;
    let center = p.affine.transform_point3(center);
    Block { min: center - radius, max: center + radius }
}

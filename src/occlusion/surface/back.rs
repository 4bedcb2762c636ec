//! The depth of the far side of a patch.

use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::plane::HalfSpace;
use crate::numeric::occlusion::{PLANE_NEAR_EYE, SLAB_EDGE_ON};
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::surface::drawable::Drawable;

/// The far side of a patch: where rays leave the intersection of half-spaces that contain the patch
/// and the origin.
#[derive(Debug, Clone)]
pub(super) struct Back {
    planes: SmallVec<[Linear; 7]>,
    floor: f64,
}

impl Back {
    pub(super) fn new(face: &Face, d: &Drawable) -> Self {
        let mut planes = SmallVec::new();
        let (lo, hi) = d.slab;
        if face.parallel {
            let half = (d.block.max - d.block.min) * 0.5;
            let depth = face.local((d.block.min + d.block.max) * 0.5).z + half.dot(face.forward.abs());
            let along = d.normal.dot(face.forward);
            let plane = if along < 0.0 {
                HalfSpace { normal: d.normal, offset: -lo }
            } else {
                HalfSpace { normal: -d.normal, offset: hi }
            };
            planes.extend(face.nearness(&plane).filter(|_| along.abs() > SLAB_EDGE_ON));
            return Self { planes, floor: -depth };
        }
        // Planes too close to the origin are not known well enough.
        let reach = d.block.min.abs().max(d.block.max.abs()).max_element();
        let mut add = |normal: DVec3, offset: f64| {
            if offset > PLANE_NEAR_EYE * reach {
                planes.extend(face.nearness(&HalfSpace { normal, offset }));
            }
        };
        add(d.normal, -lo);
        add(-d.normal, hi);
        for axis in [face.right, face.up] {
            let (p, q) = (axis.dot(d.block.min), axis.dot(d.block.max));
            add(axis, -p.min(q));
            add(-axis, p.max(q));
        }
        let (p, q) = (face.local(d.block.min), face.local(d.block.max));
        let floor = p.z.max(q.z);
        Self { planes, floor: if floor > 0.0 { 1.0 / floor } else { f64::NEG_INFINITY } }
    }

    /// Points of a rectangle less near than this are behind the patch. With the plane that bounds
    /// it, if one does.
    #[inline(always)]
    pub(super) fn behind(&self, rect: &Rect) -> (f64, Option<Linear>) {
        let (mut near, mut plane) = (self.floor, None);
        for p in &self.planes {
            let own = p.least(rect);
            if own > near {
                (near, plane) = (own, Some(*p));
            }
        }
        (near, plane)
    }
}

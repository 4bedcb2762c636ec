//! The depth of the far side of a patch.

use fearless_simd::f64x8;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::geometry::plane::HalfSpace;
use crate::numeric::occlusion::{PLANE_NEAR_EYE, SLAB_EDGE_ON};
use crate::occlusion::face::{Face, Linear};
use crate::occlusion::surface::drawable::Drawable;

/// Planes that bound the far side at most, and its floor.
const PLANES: usize = 8;

/// The far side of a patch: where rays leave the intersection of half-spaces that contain the patch
/// and the origin.
#[derive(Debug, Clone)]
pub(super) struct Back {
    /// The nearness of planes, `a u + b v + c`; the last one is the floor. Missing planes are
    /// infinitely far.
    a: [f64; PLANES],
    b: [f64; PLANES],
    c: [f64; PLANES],
}

impl Back {
    pub(super) fn new(face: &Face, d: &Drawable) -> Self {
        let mut back = Self { a: [0.0; PLANES], b: [0.0; PLANES], c: [f64::NEG_INFINITY; PLANES] };
        let mut count = 0;
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
            let plane = face.nearness(&plane).filter(|_| along.abs() > SLAB_EDGE_ON);
            plane.iter().for_each(|plane| back.set(0, plane));
            back.c[PLANES - 1] = -depth;
            return back;
        }
        // Planes too close to the origin are not known well enough.
        let reach = d.block.min.abs().max(d.block.max.abs()).max_element();
        let mut add = |normal: DVec3, offset: f64| {
            if offset > PLANE_NEAR_EYE * reach
                && let Some(plane) = face.nearness(&HalfSpace { normal, offset })
            {
                back.set(count, &plane);
                count += 1;
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
        back.c[PLANES - 1] = if floor > 0.0 { 1.0 / floor } else { f64::NEG_INFINITY };
        back
    }

    /// Sets one of the planes before the last.
    fn set(&mut self, at: usize, plane: &Linear) {
        if at < PLANES - 1 && (plane.a + plane.b + plane.c).is_finite() {
            (self.a[at], self.b[at], self.c[at]) = (plane.a, plane.b, plane.c);
        }
    }

    /// [`Back::behind`] is no more than this for any square of a rectangle, given by its lower left
    /// corner and its size.
    #[inline(always)]
    pub(super) fn behind_at_most<S: Simd>(&self, simd: S, (u, v): (f64, f64), size: (f64, f64)) -> f64 {
        let load = |of: &[f64; PLANES]| f64x8::from_slice(simd, of);
        let (a, b, c) = (load(&self.a), load(&self.b), load(&self.c));
        let zero = f64x8::splat(simd, 0.0);
        ((a * u + b * v) + (a.max(zero) * size.0 + b.max(zero) * size.1) + c).reduce_max()
    }

    /// Points of a square, given by its lower left corner and its size, that are less near than
    /// this are behind the patch. With the plane that bounds it, if one does.
    #[inline(always)]
    pub(super) fn behind<S: Simd>(&self, simd: S, (u, v): (f64, f64), size: f64) -> (f64, Option<Linear>) {
        let load = |of: &[f64; PLANES]| f64x8::from_slice(simd, of);
        let (a, b, c) = (load(&self.a), load(&self.b), load(&self.c));
        let zero = f64x8::splat(simd, 0.0);
        // Each plane is least at one corner.
        let least = (a * u + b * v) + (a.min(zero) + b.min(zero)) * size + c;
        let near = least.reduce_max();
        let at = least.simd_eq(near).to_bitmask().trailing_zeros() as usize;
        let plane = (at < PLANES - 1).then(|| Linear { a: self.a[at], b: self.b[at], c: self.c[at] });
        (near, plane)
    }
}

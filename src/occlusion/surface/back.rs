//! The depth of the far side of a patch.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::geometry::plane::HalfSpace;
use crate::numeric::lesser;
use crate::numeric::occlusion::{PLANE_NEAR_EYE, SLAB_EDGE_ON};
use crate::occlusion::face::{Face, Linear};
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::raster::TILES;

/// Planes that bound the far side at most: two of the slab, and four of the box.
const PLANES: usize = 6;

/// The far side of a patch: where rays leave the intersection of half-spaces that contain the patch
/// and the origin.
#[derive(Debug, Clone)]
pub(super) struct Back {
    /// The nearness of the planes.
    planes: [Linear; PLANES],
    count: usize,
    /// It is no less near than this.
    floor: f64,
}

/// The far side of a patch in the tiles of a block: points that are less near are behind it.
pub(super) struct Behind {
    pub(super) near: [f64; TILES],
    /// The number of the plane that says so.
    pub(super) plane: [f64; TILES],
}

impl Back {
    pub(super) fn new(face: &Face, d: &Drawable) -> Self {
        let none = Linear { a: 0.0, b: 0.0, c: 0.0 };
        let mut back = Self { planes: [none; PLANES], count: 0, floor: f64::NEG_INFINITY };
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
            plane.into_iter().for_each(|plane| back.push(plane));
            back.floor = -depth;
            return back;
        }
        // Planes too close to the origin are not known well enough.
        let reach = d.block.min.abs().max(d.block.max.abs()).max_element();
        let mut add = |normal: DVec3, offset: f64| {
            if offset > PLANE_NEAR_EYE * reach
                && let Some(plane) = face.nearness(&HalfSpace { normal, offset })
            {
                back.push(plane);
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
        back.floor = if floor > 0.0 { 1.0 / floor } else { f64::NEG_INFINITY };
        back
    }

    fn push(&mut self, plane: Linear) {
        if (plane.a + plane.b + plane.c).is_finite()
            && let Some(place) = self.planes.get_mut(self.count)
        {
            *place = plane;
            self.count += 1;
        }
    }

    /// A plane by the number that was told; none for the floor.
    #[inline(always)]
    pub(super) fn plane(&self, number: f64) -> Option<Linear> {
        self.planes.get(number as usize).copied()
    }

    /// How near the planes are in a row of tiles, whose lower border and width are given, where the
    /// face has its middle: each is least at one corner of a tile.
    #[inline(always)]
    pub(super) fn row(&self, v: f64, size: f64) -> [f64; PLANES] {
        self.planes.map(|p| p.b * v + ((lesser(p.a, 0.0) + lesser(p.b, 0.0)) * size + p.c))
    }

    /// The far side in the tiles of a block, of which the first column and the width are given.
    #[inline(always)]
    pub(super) fn behind<S: Simd>(&self, simd: S, row: &[f64; PLANES], first: f64, size: f64) -> Behind {
        let u = (f64x4::from_slice(simd, &[0.0, 1.0, 2.0, 3.0]) + first) * size - 1.0;
        let mut near = f64x4::splat(simd, self.floor);
        let mut number = f64x4::splat(simd, PLANES as f64);
        for (i, (plane, &row)) in self.planes.iter().zip(row).enumerate().take(self.count) {
            let at = u * plane.a + row;
            let is_nearer = at.simd_gt(near);
            near = is_nearer.select(at, near);
            number = is_nearer.select(f64x4::splat(simd, i as f64), number);
        }
        Behind { near: near.into(), plane: number.into() }
    }
}

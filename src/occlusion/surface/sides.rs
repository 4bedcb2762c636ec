//! Sides of patches as one face sees them.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

use crate::mesh::surface::PatchNumber;
use crate::occlusion::surface::raster::{EdgeVectors, Edges, LANES, Lanes};

/// Eight points of outlines and the one after them, as one face sees them. Each begins the side to
/// the next one, but for the last one of a path.
#[derive(Debug, Clone)]
pub(super) struct Sides {
    /// Pixels.
    pub(super) x: [f32; LANES + 1],
    pub(super) y: [f32; LANES + 1],
    /// As those of [`Edges`](crate::occlusion::surface::raster::Edges).
    pub(super) wide: Lanes,
    pub(super) unsure: Lanes,
    pub(super) plain: u8,
    pub(super) seams: u8,
    /// The points that begin a side, one bit each.
    pub(super) begins: u8,
    /// Sides with a patch beyond them, and those of them along which it runs in the opposite
    /// direction.
    pub(super) shared: u8,
    pub(super) opposite: u8,
    /// The numbers of these patches.
    pub(super) twins: [PatchNumber; LANES],
}

impl Sides {
    /// The sides that are drawn as single edges, in pixels that are finer by a factor.
    #[inline(always)]
    pub(super) fn edges<S: Simd>(&self, simd: S, by: f32) -> EdgeVectors<S> {
        let load = |lanes: &[f32]| f32x8::from_slice(simd, lanes) * by;
        let Self { x, y, wide, unsure, plain, seams, .. } = self;
        let (x0, y0, x1, y1) = (load(&x[..LANES]), load(&y[..LANES]), load(&x[1..]), load(&y[1..]));
        let (wide, unsure) = (load(wide), load(unsure));
        EdgeVectors { x0, y0, x1, y1, wide, unsure, plain: *plain, seams: *seams }
    }

    /// Puts one of them among others; `seam` tells whether it is shared.
    #[inline(always)]
    pub(super) fn put(&self, lane: usize, to: &mut Edges, at: usize, seam: bool) {
        (to.x0[at], to.y0[at]) = (self.x[lane], self.y[lane]);
        (to.x1[at], to.y1[at]) = (self.x[lane + 1], self.y[lane + 1]);
        (to.wide[at], to.unsure[at]) = (self.wide[lane], self.unsure[lane]);
        to.plain |= 1 << at;
        to.seams |= u8::from(seam) << at;
    }
}

/// A side that is drawn in pieces.
#[derive(Debug, Clone)]
pub(super) struct WholeSide {
    /// Its place among the sides.
    pub(super) group: u32,
    pub(super) lane: u32,
    /// Its ends in coordinates of the face, and in pixels where they are deep enough.
    pub(super) ends: [DVec3; 2],
    pub(super) pixels: [(f64, f64); 2],
    pub(super) slack: f64,
}

/// Eight points of outlines and the one after them, as they are stored, then in coordinates of the
/// face.
#[derive(Debug, Default, Clone)]
pub(super) struct PlacedPoints {
    pub(super) at: [[f32; LANES + 1]; 3],
    /// One over their depth.
    pub(super) inverse: [f32; LANES + 1],
    /// Of the sides that they begin.
    pub(super) slack: Lanes,
}

/// The sides of the patches seen.
#[derive(Debug, Clone, Default)]
pub(super) struct SeenSides {
    pub(super) groups: Vec<Sides>,
    /// The points of the patch that is projected.
    pub(super) placed: Vec<PlacedPoints>,
    /// Those that reach over a large range of depths, or behind the near limit.
    pub(super) deep: Vec<WholeSide>,
    /// All of them, if the eye may go some way: each may be a part of a rim.
    pub(super) rims: Vec<WholeSide>,
}

impl SeenSides {
    /// Appends a point that begins no side yet, as it is stored, number `at` of a patch.
    #[inline(always)]
    pub(super) fn push(&mut self, at: usize, p: Vec3) {
        if at.is_multiple_of(LANES) {
            self.placed.push(PlacedPoints::default());
            self.groups.push(Sides {
                x: [0.0; LANES + 1],
                y: [0.0; LANES + 1],
                wide: [0.0; LANES],
                unsure: [0.0; LANES],
                plain: 0,
                seams: 0,
                begins: 0,
                shared: 0,
                opposite: 0,
                twins: [PatchNumber::NONE; LANES],
            });
        }
        if let Some(points) = self.placed.last_mut() {
            let [x, y, z] = &mut points.at;
            (x[at % LANES], y[at % LANES], z[at % LANES]) = (p.x, p.y, p.z);
        }
    }

    /// Lets the last point begin a side, with the patch beyond it.
    #[inline(always)]
    pub(super) fn begin(&mut self, at: usize, slack: f32, beyond: Option<(PatchNumber, bool)>) {
        let (lane, bit) = (at % LANES, 1 << (at % LANES));
        if let (Some(sides), Some(points)) = (self.groups.last_mut(), self.placed.last_mut()) {
            points.slack[lane] = slack;
            sides.begins |= bit;
            if let Some((twin, opposite)) = beyond {
                sides.twins[lane] = twin;
                sides.shared |= bit;
                sides.opposite |= if opposite { bit } else { 0 };
            }
        }
    }

    /// How many groups, deep sides and sides of rims there are.
    pub(super) fn reached(&self) -> [usize; 3] {
        [self.groups.len(), self.deep.len(), self.rims.len()]
    }

    /// Drops those from some places on.
    pub(super) fn truncate(&mut self, [groups, deep, rims]: [usize; 3]) {
        self.groups.truncate(groups);
        self.deep.truncate(deep);
        self.rims.truncate(rims);
    }
}

//! The points of patches, drawn into images of their planes.

use std::collections::HashMap;

use casca::Obb;
use glam::{DMat3, DQuat, DVec3, IVec2, Vec3};
use rayon::prelude::*;

use super::patches::Patch;
use super::rectangles::{Mask, Rectangle};
use super::voxels::Voxels;
use crate::bricks::{BrickError, Bricks};

/// Half the thickness of boxes, in cells: casca draws solids, and a sheet has none of its own.
pub(super) const HALF_THICKNESS: f32 = 0.25;
/// The greatest distance of points of a patch from its plane, in cells.
pub(super) const NEAR: f32 = 2.0;
/// The greatest distance of points beside a patch that tell where other surface goes on, in cells.
const BESIDE: f64 = 4.0;
/// Pixels along the side of a block, of which there is a bit each.
const BLOCK: i32 = 8;
/// Blocks along the side of a tile. Rectangles are no longer, and an image takes memory in
/// proportion to its points, whatever its extents are.
const TILE: i32 = 64;
/// Blocks of other tiles around a tile, so that rectangles overlap: more than what growing and
/// shrinking reach.
const RIM: i32 = 1;

/// Around each pixel, a square that reaches so far must be full to this share before single empty
/// pixels are closed: points at random fill four fifths, a fence less.
const AROUND: usize = 3;
const FULL: f64 = 0.6;

/// Bits of a block: where points of the patch are, and points beside it.
type Block = [u64; 2];

/// The images of all patches, in blocks that hold something.
pub(super) struct Images(HashMap<(u32, IVec2), Block>);

impl Images {
    pub fn draw(bricks: &Bricks, voxels: &Voxels, patches: &[Patch]) -> Result<Self, BrickError> {
        let near = near(voxels, patches);
        let mut blocks: HashMap<(u32, IVec2), Block> = HashMap::new();
        let mut draw = |p: Vec3| {
            let Some(voxel) = voxels.at(p) else { return };
            let from = near.partition_point(|&(v, _)| v < voxel);
            for &(_, patch) in near[from..].iter().take_while(|&&(v, _)| v == voxel) {
                let [x, y, z] = patches[patch as usize].place(p, voxels.cell);
                if z.abs() > BESIDE {
                    continue;
                }
                let pixel = IVec2::new(x.floor() as i32, y.floor() as i32);
                let (block, at) =
                    (pixel.div_euclid(IVec2::splat(BLOCK)), pixel.rem_euclid(IVec2::splat(BLOCK)));
                let bits =
                    &mut blocks.entry((patch, block)).or_default()[usize::from(z.abs() > f64::from(NEAR))];
                *bits |= 1 << (at.y * BLOCK + at.x);
            }
        };
        for brick in 0..bricks.len() as u32 {
            bricks.positions(brick)?.for_each(&mut draw);
        }
        Ok(Self(blocks))
    }

    /// Boxes along the rectangles of all images, in the order of patches.
    pub fn boxes(&self, patches: &[Patch], cell: f32, least: usize) -> Vec<Obb> {
        let tile = |&(patch, block): &(u32, IVec2)| (patch, block.div_euclid(IVec2::splat(TILE)));
        let mut tiles: Vec<(u32, IVec2)> = self.0.keys().map(tile).collect();
        tiles.sort_unstable_by_key(|&(patch, at)| (patch, at.to_array()));
        tiles.dedup();
        let boxes = |&(patch, tile): &(u32, IVec2)| {
            let Some((corner, mask)) = self.mask(patch, tile) else { return Vec::new() };
            let found = mask.rectangles(least).into_iter();
            found.map(|r| patches[patch as usize].along(&r, corner, f64::from(cell))).collect()
        };
        tiles.par_iter().flat_map_iter(boxes).collect()
    }

    /// What is covered in a tile, and the pixel of its corner.
    fn mask(&self, patch: u32, tile: IVec2) -> Option<(IVec2, Mask)> {
        let from = tile * TILE - RIM;
        let all = (0..TILE + 2 * RIM).flat_map(|y| (0..TILE + 2 * RIM).map(move |x| from + IVec2::new(x, y)));
        let blocks: Vec<(IVec2, Block)> =
            all.filter_map(|at| Some((at, *self.0.get(&(patch, at))?))).collect();
        let low = blocks.iter().map(|b| b.0).reduce(IVec2::min)? - RIM;
        let high = blocks.iter().map(|b| b.0).reduce(IVec2::max)? + RIM;
        let size = ((high - low + 1) * BLOCK).as_usizevec2();
        let mut masks = [Mask::new(size.x, size.y), Mask::new(size.x, size.y)];
        for (at, block) in blocks {
            let corner = ((at - low) * BLOCK).as_usizevec2();
            for (mask, bits) in masks.iter_mut().zip(block) {
                for i in (0..64).filter(|i| bits >> i & 1 == 1) {
                    mask.pixels[(corner.y + i / BLOCK as usize) * size.x + corner.x + i % BLOCK as usize] =
                        true;
                }
            }
        }
        let [on, beside] = masks;
        let mut closed = on.grown().shrunk();
        let (full, whole) = (on.counts(AROUND), closed.counts(AROUND));
        for ((pixel, full), whole) in closed.pixels.iter_mut().zip(full).zip(whole) {
            *pixel &= f64::from(full) >= FULL * f64::from(whole);
        }
        // A rim where other surface goes on is none.
        let inner = closed.or(&beside.grown()).shrunk();
        Some((low * BLOCK, closed.and(&inner)))
    }
}

/// Voxels, and the patches that have a facet in them or beside them, in their order.
fn near(voxels: &Voxels, patches: &[Patch]) -> Vec<(u32, u32)> {
    let each = patches.iter().zip(0..).flat_map(|(patch, i)| patch.facets.iter().map(move |&f| (f, i)));
    let mut near: Vec<(u32, u32)> =
        each.flat_map(|(facet, i)| voxels.around(facet).map(move |voxel| (voxel, i))).collect();
    near.sort_unstable();
    near.dedup();
    near
}

impl Patch {
    /// A point in the frame of the patch, in cells.
    fn place(&self, p: Vec3, cell: f64) -> [f64; 3] {
        let p = (p.as_dvec3() - self.middle) / cell;
        self.axes.map(|axis| axis.dot(p))
    }

    /// The box along a rectangle of an image whose corner is a pixel.
    fn along(&self, r: &Rectangle, corner: IVec2, cell: f64) -> Obb {
        let span = |range: &std::ops::Range<usize>, from: i32| {
            let ends = [range.start, range.end].map(|i| (i as f64 + f64::from(from)) * cell);
            (ends[0].midpoint(ends[1]), (ends[1] - ends[0]) / 2.0)
        };
        let ((x, wide), (y, high)) = (span(&r.x, corner.x), span(&r.y, corner.y));
        let [u, v, n] = self.axes;
        let half = DVec3::new(wide, high, f64::from(HALF_THICKNESS) * cell);
        let rotation = DQuat::from_mat3(&DMat3::from_cols(u, v, n));
        Obb::new((self.middle + u * x + v * y).as_vec3(), half.as_vec3(), rotation.as_quat())
    }
}

//! Covering the pixels of one component of patches.

use std::ops::Range;

use crate::numeric::occlusion::below;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::back::Back;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::{Area, Raster};
use crate::occlusion::surface::scratch::{Joint, Seen, SurfaceScratch};
use crate::occlusion::surface::sides::WholeSide;
use crate::occlusion::surface::viewpoint::Viewpoint;
use crate::occlusion::tiles::TILE;

/// Draws the patches of one component, a range of the order of drawing, and notes which hide more
/// than before.
pub(super) fn draw_component(
    buffer: &mut FaceBuffer,
    range: Range<usize>,
    viewpoint: Viewpoint,
    kept: &KeptPatches,
    scratch: &mut SurfaceScratch,
) {
    let SurfaceScratch { seen, order, raster, rims, joint, useful, .. } = scratch;
    let members = || order[range.clone()].iter().map(|&(_, _, i)| &seen[i as usize]);
    let area = Area::around(&members().fold(PixelRect::EMPTY, |around, s| around.join(&s.pixels)));
    let mut joint = (range.len() > 1).then(|| {
        joint.clear(area);
        joint
    });
    let projector = Projector::new(buffer, viewpoint);
    let (first, deep) = (projector.first(), projector.deep_sides());
    let is_seam = |side: &WholeSide| kept.group(side.group).edges.seams >> side.lane & 1 == 1;
    // Nothing is covered before all rims of the component are known.
    let rims = projector.rims().map(|widened| {
        rims.begin(area, first);
        for s in members() {
            let own = kept.rims(s.kept).iter();
            own.filter(|side| !is_seam(side)).for_each(|side| widened.draw(rims, side));
        }
        &*rims
    });
    for s in members() {
        let patch = kept.patch(s.kept);
        raster.begin(Area::around(&s.pixels), first);
        kept.groups(s.kept).iter().for_each(|sides| raster.edges(&sides.edges, patch.turned));
        deep.draw(raster, kept.deep(s.kept), patch.turned, is_seam);
        raster.finish();
        if cover_patch(buffer, raster, s, &patch.back, rims, joint.as_deref_mut()) {
            useful.push(s.drawable);
        }
    }
    if let Some(joint) = joint
        && cover_seams(buffer, rims, joint)
    {
        useful.extend(members().map(|s| s.drawable));
    }
}

/// Covers the pixels of one patch, and adds its marks to those of its component.
#[inline]
fn cover_patch(
    buffer: &mut FaceBuffer,
    raster: &Raster,
    seen: &Seen,
    back: &Back,
    rims: Option<&Raster>,
    mut joint: Option<&mut Joint>,
) -> bool {
    let area = raster.area();
    let mut changed = false;
    for ty in 0..area.ny {
        let row = buffer.window().tile_index(area.x / TILE, area.y / TILE + ty);
        let joint_row = joint.as_ref().map_or(0, |joint| joint.area.tile(&area, ty, 0));
        for tx in 0..area.nx as usize {
            let marks = raster.marks(ty as usize * area.nx as usize + tx);
            if marks.is_empty() {
                continue;
            }
            let tile = row + tx;
            let closed = buffer.coverage().closed(tile);
            if closed >= seen.near {
                if let Some(joint) = &mut joint {
                    // Its marks are not added here, so seams with it are not known to be closed.
                    joint.nears[joint_row + tx] = f32::NEG_INFINITY;
                }
                continue;
            }
            let mask = marks.covered() & !open_rims(rims, &area, (tx as i64, ty));
            if mask == 0 && joint.is_none() {
                continue;
            }
            let rect = buffer.window().square(area.x + tx as i64 * TILE, area.y + ty * TILE, TILE);
            let (near, plane) = back.behind(&rect);
            let near = below(near);
            if mask != 0 && closed < near {
                changed |= buffer.coverage_mut().cover_plane(tile, mask, near, plane);
            }
            if let Some(joint) = &mut joint {
                joint.tiles[joint_row + tx].add(&marks);
                joint.nears[joint_row + tx] = joint.nears[joint_row + tx].min(near);
            }
        }
    }
    changed
}

/// The pixels that rims touch in a tile, given by its column and row in an area.
#[inline]
fn open_rims(rims: Option<&Raster>, area: &Area, (column, row): (i64, i64)) -> u64 {
    rims.map_or(0, |rims| rims.marks(rims.area().tile(area, row, column)).open())
}

/// Covers the pixels that only seams between the patches of a component touch.
fn cover_seams(buffer: &mut FaceBuffer, rims: Option<&Raster>, joint: &Joint) -> bool {
    let area = joint.area;
    let mut changed = false;
    for ty in 0..area.ny {
        let row = buffer.window().tile_index(area.x / TILE, area.y / TILE + ty);
        for tx in 0..area.nx as usize {
            let at = ty as usize * area.nx as usize + tx;
            let (mask, near) = (joint.tiles[at].covered_seams(), joint.nears[at]);
            let mask = mask & !open_rims(rims, &area, (tx as i64, ty));
            if mask != 0 && buffer.coverage().closed(row + tx) < near {
                changed |= buffer.coverage_mut().cover(row + tx, mask, near);
            }
        }
    }
    changed
}

//! Covering the pixels of one component of patches.

use std::ops::Range;

use fearless_simd::Simd;

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::{Area, FEW};
use crate::occlusion::surface::scratch::FaceScratch;
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::surface::sides::WholeSide;

/// Patches around many blocks of pixels go through all blocks of the window this many times in a
/// query, at most. A smaller number leaves gaps between thousands of narrow patches.
const WIDE_FACES: u64 = 128;

/// Draws the patches of one component, a range of the order of drawing, and notes which hide more
/// than before. Patches around many blocks are left out once that much of the face was drawn in a
/// query: they hide nothing then, and neither do the seams of their component.
#[inline(always)]
pub(super) fn draw_component<S: Simd>(
    simd: S,
    sheet: &mut Sheet,
    range: Range<usize>,
    projector: &Projector,
    kept: &KeptPatches,
    scratch: &mut FaceScratch,
) {
    let FaceScratch { seen, order, raster, rims, joint, useful, blocks, wide_blocks, .. } = scratch;
    let most_wide = WIDE_FACES * sheet.block_count();
    let members = || order[range.clone()].iter().map(|&(_, _, i)| &seen[i as usize]);
    let area = Area::around(&members().fold(PixelRect::EMPTY, |around, s| around.join(&s.pixels)));
    let mut joint = (range.len() > 1).then(|| {
        joint.clear(area);
        joint
    });
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
    let mut all = true;
    for s in members() {
        let (patch, around) = (kept.patch(s.kept), Area::around(&s.pixels));
        let is_wide = around.block_count() > FEW;
        if is_wide && *wide_blocks >= most_wide {
            all = false;
            continue;
        }
        raster.begin(around, first);
        for sides in kept.groups(s.kept) {
            raster.edges(simd, &sides.edges, patch.turned);
        }
        deep.draw(simd, raster, (kept.deep(s.kept), patch.turned), is_seam);
        raster.finish();
        let used = raster.spans().count() as u64;
        *blocks += used;
        if is_wide {
            *wide_blocks += used;
        }
        if sheet.cover_patch(simd, raster, (s.near, &patch.back), rims, joint.as_deref_mut()) {
            useful.push(s.drawable);
        }
    }
    if let Some(joint) = joint
        && all
        && sheet.cover_seams(rims, joint)
    {
        useful.extend(members().map(|s| s.drawable));
    }
}

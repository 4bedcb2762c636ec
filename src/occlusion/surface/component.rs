//! Covering the pixels of one component of patches.

use std::ops::Range;

use fearless_simd::Simd;

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::raster::Area;
use crate::occlusion::surface::scratch::FaceScratch;
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::surface::sides::WholeSide;

/// Draws the patches of one component, a range of the order of drawing, and notes which hide more
/// than before.
#[inline(always)]
pub(super) fn draw_component<S: Simd>(
    simd: S,
    sheet: &mut Sheet,
    range: Range<usize>,
    projector: &Projector,
    kept: &KeptPatches,
    scratch: &mut FaceScratch,
) {
    let FaceScratch { seen, order, raster, rims, joint, useful, .. } = scratch;
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
    for s in members() {
        let patch = kept.patch(s.kept);
        raster.begin(Area::around(&s.pixels), first);
        for sides in kept.groups(s.kept) {
            raster.edges(simd, &sides.edges, patch.turned);
        }
        deep.draw(simd, raster, (kept.deep(s.kept), patch.turned), is_seam);
        raster.finish();
        if sheet.cover_patch(simd, raster, (s.near, &patch.back), rims, joint.as_deref_mut()) {
            useful.push(s.drawable);
        }
    }
    if let Some(joint) = joint
        && sheet.cover_seams(rims, joint)
    {
        useful.extend(members().map(|s| s.drawable));
    }
}

//! The patches of a batch that a face sees, joined to components, put in order and drawn.

use fearless_simd::Simd;

use crate::mesh::surface::PatchNumber;
use crate::occlusion::bins::WideBins;
use crate::occlusion::face_buffer::{FaceBuffer, ListedPatch};
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::batch::Sighting;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::joined::DrawPlace;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::projector::{Projector, Viewpoint};
use crate::occlusion::surface::raster::{Area, LANES};
use crate::occlusion::surface::scratch::{FaceScratch, Ids, SeenPatch};
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::surface::sides::WholeSide;
use crate::occlusion::tiles::TILE;

/// Patches that touch fewer columns or rows of pixels are drawn in finer pixels only: their outlines
/// touch nearly all of these, so that they cover none alone, and hardly any with their neighbours.
const NARROW: i64 = 3;

/// Patches around more blocks of pixels than this count as wide.
const FEW: usize = 8;

/// Patches around many blocks of pixels go through all blocks of the window this many times in a
/// query, at most. A smaller number leaves gaps between thousands of narrow patches.
const WIDE_FACES: u64 = 128;

/// Draws patches together on one face, those that it sees, and notes which hide more than before.
#[inline(always)]
pub(super) fn draw_surfaces<S: Simd>(
    simd: S,
    buffer: &mut FaceBuffer,
    batch: &[Drawable],
    sights: impl Iterator<Item = Sighting>,
    viewpoint: Viewpoint,
    listed: bool,
    (ids, scratch): (&Ids, &mut FaceScratch),
) {
    scratch.begin();
    let (projector, reach) = (Projector::new(buffer, viewpoint), viewpoint.room.radius());
    let listed = listed.then(|| buffer.patches_mut());
    see(simd, &projector, reach, batch, sights, listed, scratch);
    join(batch, reach, ids, scratch);
    scratch.joined.sort();
    let kept = std::mem::take(&mut scratch.kept);
    let order = std::mem::take(&mut scratch.joined.order);
    // Components may cover all tiles of the window.
    let window = buffer.window();
    let (first, count, step) = (window.first_tile(), window.tile_count(), window.step() * TILE as f64);
    for component in order.chunk_by(|a, b| a.1 == b.1) {
        let mut sheet = Sheet { coverage: buffer.coverage_mut(), base: 0, first, count, step };
        draw_component(simd, &mut sheet, component, &projector, &kept, scratch);
    }
    scratch.joined.order = order;
    scratch.kept = kept;
}

/// Whether a patch touches so few columns or rows of pixels that it is not drawn.
fn is_narrow(pixels: &PixelRect) -> bool {
    pixels.x.1 - pixels.x.0 < NARROW || pixels.y.1 - pixels.y.0 < NARROW
}

/// Collects the patches that the face sees. Narrow ones are only listed, to be drawn in finer
/// pixels.
#[inline(always)]
fn see<S: Simd>(
    simd: S,
    projector: &Projector,
    reach: f64,
    batch: &[Drawable],
    sights: impl Iterator<Item = Sighting>,
    mut listed: Option<&mut WideBins<ListedPatch>>,
    scratch: &mut FaceScratch,
) {
    let FaceScratch { kept, joined, seen, .. } = scratch;
    // The rims around a hole are wide if the eye may go far, however narrow the hole is.
    let is_narrow = |pixels: &PixelRect| reach == 0.0 && is_narrow(pixels);
    for Sighting { patch: drawable, near, pixels, .. } in sights {
        if is_narrow(&pixels) && listed.is_none() {
            continue;
        }
        let id = batch[drawable as usize].id;
        let place = kept.keep(simd, projector, &batch[drawable as usize], pixels);
        let Some(pixels) = kept.patch(place).pixels else { continue };
        if let Some(listed) = &mut listed {
            listed.push(&pixels, ListedPatch { id, near, pixels });
        }
        if is_narrow(&pixels) {
            continue;
        }
        joined.push(id, near);
        seen.push(SeenPatch { drawable, kept: place, pixels, near });
    }
}

/// Joins patches that share sides, and marks those sides as seams.
///
/// If the eye may go some way, only patches that are wholly turned to it are joined.
#[inline(always)]
fn join(batch: &[Drawable], reach: f64, ids: &Ids, scratch: &mut FaceScratch) {
    let FaceScratch { kept, joined, seen: all, .. } = scratch;
    for i in 0..all.len() as u32 {
        let seen = &all[i as usize];
        let d = &batch[seen.drawable as usize];
        // Sides with the same neighbour follow each other.
        let (mut last, mut beyond) = (PatchNumber::NONE, None);
        for group in kept.groups_mut(seen.kept) {
            let (mut lanes, mut seams) = (group.shared, 0);
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize % LANES;
                lanes &= lanes - 1;
                if group.twins[lane] != last {
                    last = group.twins[lane];
                    beyond = ids.get(last).and_then(|id| joined.find(id)).filter(|&place| place != i);
                }
                let Some(place) = beyond else { continue };
                let other = &batch[all[place as usize].drawable as usize];
                if (group.opposite >> lane & 1 == 1) != (d.turned == other.turned) {
                    continue;
                }
                if reach > 0.0 && !(d.faces_eye && other.faces_eye) {
                    continue;
                }
                joined.unite(i, place);
                seams |= 1 << lane;
            }
            group.seams = seams;
        }
    }
}

/// Draws the patches of one component, and notes which hide more than before. Patches around many
/// blocks are left out once that much of the face was drawn in a query: they hide nothing then, and
/// neither do the seams of their component.
#[inline(always)]
fn draw_component<S: Simd>(
    simd: S,
    sheet: &mut Sheet,
    component: &[DrawPlace],
    projector: &Projector,
    kept: &KeptPatches,
    scratch: &mut FaceScratch,
) {
    let FaceScratch { seen, raster, rims, joint, useful, blocks, wide_blocks, .. } = scratch;
    let most_wide = WIDE_FACES * sheet.block_count();
    let members = || component.iter().map(|&(_, _, i)| &seen[i as usize]);
    let area = Area::around(&members().fold(PixelRect::EMPTY, |around, s| around.join(&s.pixels)));
    let mut joint = (component.len() > 1).then(|| {
        joint.clear(area);
        joint
    });
    let (first, deep) = (projector.first(), projector.deep_sides());
    let is_seam = |side: &WholeSide| kept.group(side.group).seams >> side.lane & 1 == 1;
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
            raster.edges(simd, &sides.edges(simd, 1.0), patch.turned);
        }
        deep.draw(simd, raster, (kept.deep(s.kept), patch.turned), is_seam);
        let (changed, used) =
            sheet.cover_patch(simd, raster, (s.near, &patch.back), rims, joint.as_deref_mut());
        *blocks += used;
        if is_wide {
            *wide_blocks += used;
        }
        if changed {
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

//! The patches of a batch that a face sees, joined to components, put in order and drawn.

use fearless_simd::Simd;

use crate::mesh::surface::PatchNumber;
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

/// Patches that touch fewer columns or rows of pixels are not drawn: their outlines touch nearly
/// all of those pixels, so that they cover none alone, and hardly any with their neighbours.
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
    (ids, scratch): (&Ids, &mut FaceScratch),
) {
    scratch.begin();
    let mut kept = std::mem::take(&mut scratch.kept);
    let projector = Projector::new(buffer, viewpoint);
    see(simd, &projector, viewpoint.room.radius(), batch, sights, &mut kept, scratch);
    join(batch, viewpoint.room.radius(), &mut kept, (ids, scratch));
    scratch.joined.sort();
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

/// Lists the patches that the last drawing saw for the first time, drawn or too narrow for its
/// pixels.
pub(super) fn list(buffer: &mut FaceBuffer, batch: &[Drawable], scratch: &FaceScratch) {
    let drawn = scratch.seen.iter().map(|s| (s.drawable, s.near, s.pixels));
    let all = drawn.chain(scratch.narrow.iter().copied());
    for (drawable, near, pixels) in all {
        let patch = ListedPatch { id: batch[drawable as usize].id, near, pixels };
        buffer.patches_mut().push(&pixels, patch);
    }
}

/// Whether a patch touches so few columns or rows of pixels that it is not drawn.
fn is_narrow(pixels: &PixelRect) -> bool {
    pixels.x.1 - pixels.x.0 < NARROW || pixels.y.1 - pixels.y.0 < NARROW
}

/// Collects the patches that the face sees.
#[inline(always)]
fn see<S: Simd>(
    simd: S,
    projector: &Projector,
    reach: f64,
    batch: &[Drawable],
    sights: impl Iterator<Item = Sighting>,
    kept: &mut KeptPatches,
    scratch: &mut FaceScratch,
) {
    // The rims around a hole are wide if the eye may go far, however narrow the hole is.
    let is_narrow = |pixels: &PixelRect| reach == 0.0 && is_narrow(pixels);
    for Sighting { patch: drawable, near, pixels, .. } in sights {
        if is_narrow(&pixels) {
            scratch.narrow.push((drawable, near, pixels));
            continue;
        }
        let place = kept.keep(simd, projector, &batch[drawable as usize], pixels);
        let Some(pixels) = kept.patch(place).pixels else { continue };
        if is_narrow(&pixels) {
            scratch.narrow.push((drawable, near, pixels));
            continue;
        }
        scratch.joined.push(batch[drawable as usize].id, near);
        scratch.seen.push(SeenPatch { drawable, kept: place, pixels, near });
    }
}

/// Joins patches that share sides, and marks those sides as seams.
///
/// If the eye may go some way, only patches that are wholly turned to it are joined.
#[inline(always)]
fn join(batch: &[Drawable], reach: f64, kept: &mut KeptPatches, (ids, scratch): (&Ids, &mut FaceScratch)) {
    for i in 0..scratch.seen.len() as u32 {
        let seen = &scratch.seen[i as usize];
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
                    beyond = ids.get(last).and_then(|id| scratch.joined.find(id)).filter(|&place| place != i);
                }
                let Some(place) = beyond else { continue };
                let other = &batch[scratch.seen[place as usize].drawable as usize];
                if (group.opposite >> lane & 1 == 1) != (d.turned == other.turned) {
                    continue;
                }
                if reach > 0.0 && !(d.faces_eye && other.faces_eye) {
                    continue;
                }
                scratch.joined.unite(i, place);
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

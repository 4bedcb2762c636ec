//! The patches of a batch that a face sees, joined to components and put in order of drawing.

use fearless_simd::Simd;

use crate::occlusion::face_buffer::{FaceBuffer, ListedPatch};
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::batch::Sighting;
use crate::occlusion::surface::component::draw_component;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::scratch::{FaceScratch, Ids, SeenPatch};
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::surface::sides::NO_TWIN;
use crate::occlusion::surface::viewpoint::Viewpoint;
use crate::occlusion::tiles::TILE;

/// Patches that touch fewer columns or rows of pixels are not drawn: their outlines touch nearly
/// all of those pixels, so that they cover none alone, and hardly any with their neighbours.
const NARROW: i64 = 3;

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
    order(scratch);
    let mut first = 0;
    while first < scratch.order.len() {
        let root = scratch.order[first].1;
        let last = first + scratch.order[first..].iter().take_while(|o| o.1 == root).count();
        let hidden = |&(_, _, i): &(u32, u32, u32)| {
            let s = &scratch.seen[i as usize];
            buffer.hides_pixels(&s.pixels, s.near)
        };
        if !scratch.order[first..last].iter().all(hidden) {
            draw_component(simd, &mut buffer.sheet(), first..last, &projector, &kept, scratch);
        }
        first = last;
    }
    scratch.kept = kept;
}

impl FaceBuffer {
    /// All tiles of its window.
    fn sheet(&mut self) -> Sheet<'_> {
        let window = *self.window();
        let step = window.step() * TILE as f64;
        let (first, count) = (window.first_tile(), window.tile_count());
        Sheet { coverage: self.coverage_mut(), base: 0, first, count, step }
    }
}

/// Lists the patches that the last drawing saw for the first time, drawn or too narrow for its
/// pixels.
pub(super) fn list(buffer: &mut FaceBuffer, batch: &[Drawable], scratch: &FaceScratch) {
    let drawn = scratch.seen.iter().map(|s| (s.drawable, s.near, s.pixels));
    let all = drawn.chain(scratch.narrow.iter().copied());
    for (drawable, near, pixels) in all.filter(|s| !batch[s.0 as usize].again) {
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
        let seen = SeenPatch {
            drawable,
            kept: place,
            parent: scratch.seen.len() as u32,
            pixels,
            near,
            nearest: near,
            around: PixelRect::EMPTY,
        };
        scratch.push(batch[drawable as usize].id, seen);
    }
}

/// Joins patches that share sides, and marks those sides as seams.
///
/// If the eye may go some way, only patches that are wholly turned to it are joined, and those that
/// were drawn before take part as all others: the rims of a component must be known wherever it
/// covers pixels.
#[inline(always)]
fn join(batch: &[Drawable], reach: f64, kept: &mut KeptPatches, (ids, scratch): (&Ids, &mut FaceScratch)) {
    let in_part = reach == 0.0;
    for i in 0..scratch.seen.len() as u32 {
        let seen = &scratch.seen[i as usize];
        let d = &batch[seen.drawable as usize];
        for group in kept.groups_mut(seen.kept) {
            let mut seams = 0;
            for (lane, &number) in group.twins.iter().enumerate() {
                if number == NO_TWIN {
                    continue;
                }
                let place = ids.get(number).and_then(|id| scratch.find(id));
                let Some(place) = place.filter(|&place| place != i) else { continue };
                let other = &batch[scratch.seen[place as usize].drawable as usize];
                if (group.opposite >> lane & 1 == 1) != (d.turned == other.turned) {
                    continue;
                }
                let joins = if in_part {
                    // Patches that were drawn before are drawn again in part only: the sum of two
                    // of them is not known.
                    !(d.again && other.again)
                } else {
                    d.faces_eye && other.faces_eye
                };
                if !joins {
                    continue;
                }
                if scratch.seen[i as usize].parent != scratch.seen[place as usize].parent {
                    scratch.unite(i, place);
                }
                seams |= 1 << lane;
                if in_part && !d.again && other.again {
                    let pixels = scratch.seen[i as usize].pixels;
                    let around = &mut scratch.seen[place as usize].around;
                    *around = around.join(&pixels);
                }
            }
            group.edges.seams = seams;
        }
    }
    if !in_part {
        return;
    }
    // A patch that was drawn before is new only around its seams with patches that were not.
    for s in scratch.seen.iter_mut().filter(|s| batch[s.drawable as usize].again) {
        s.pixels = s.pixels.intersect(&s.around);
    }
}

/// Puts the patches in order: nearest components first, since they may hide the rest.
#[inline(always)]
fn order(scratch: &mut FaceScratch) {
    for i in 0..scratch.seen.len() as u32 {
        let root = scratch.root(i);
        let near = scratch.seen[i as usize].near;
        let nearest = &mut scratch.seen[root as usize].nearest;
        *nearest = nearest.max(near);
        scratch.seen[i as usize].parent = root;
    }
    scratch.order.clear();
    for (s, i) in scratch.seen.iter().zip(0..).filter(|(s, _)| !s.pixels.is_empty()) {
        let nearest = scratch.seen[s.parent as usize].nearest;
        scratch.order.push((farness(nearest), s.parent, i));
    }
    scratch.order.sort_unstable();
}

/// An integer that falls as nearness grows.
pub(super) fn farness(near: f32) -> u32 {
    let bits = near.to_bits();
    if bits >> 31 == 0 { !bits & 0x7fff_ffff } else { bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn farness_falls_as_nearness_grows() {
        let nears = [f32::NEG_INFINITY, -3.0, -1e-9, 0.0, 1e-9, 0.5, 2.0, f32::INFINITY];
        assert!(nears.windows(2).all(|w| farness(w[0]) > farness(w[1])));
    }
}

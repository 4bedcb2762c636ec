//! Patches as one face sees them: projected once in a query, and drawn by both passes.
//!
//! The first pass draws a patch in the pixels of the face, the second one in groups of finer pixels
//! ([`local`](crate::occlusion::surface::local)), where its edges are the same but for a factor.

use fearless_simd::Simd;

use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::back::Back;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::sides::{SeenSides, Sides, WholeSide};

/// No place.
const NONE: u32 = u32::MAX;

/// A patch as one face sees it.
#[derive(Debug, Clone)]
pub(crate) struct Kept {
    /// Its range in the lists of sides.
    sides: ([usize; 3], [usize; 3]),
    /// The pixels that it may touch; `None` if it cannot be drawn, or touches none.
    pub(super) pixels: Option<PixelRect>,
    /// How many sides it has.
    pub(super) side_count: u32,
    /// As in [`Drawable`].
    pub(super) turned: bool,
    pub(super) faces_eye: bool,
    /// The depth of its far side.
    pub(super) back: Back,
}

/// The patches of a query that one face saw so far.
#[derive(Debug, Clone, Default)]
pub(crate) struct KeptPatches {
    /// By the number in the order of first drawing, the place among the patches.
    places: Vec<u32>,
    patches: Vec<Kept>,
    sides: SeenSides,
}

impl KeptPatches {
    /// Forgets all patches.
    pub(crate) fn clear(&mut self) {
        self.places.clear();
        self.patches.clear();
        self.sides.truncate([0; 3]);
    }

    /// The place of a patch, by its number in the order of first drawing.
    #[inline(always)]
    pub(super) fn find(&self, id: u32) -> Option<u32> {
        self.places.get(id as usize).copied().filter(|&place| place != NONE)
    }

    /// How many sides a patch has that is kept, by its number in the order of first drawing.
    pub(crate) fn side_count(&self, id: u32) -> Option<u32> {
        self.find(id).map(|place| self.patch(place).side_count)
    }

    /// A patch by its place.
    #[inline(always)]
    pub(super) fn patch(&self, place: u32) -> &Kept {
        &self.patches[place as usize]
    }

    /// Projects a patch that touches some pixels, unless that is done. Returns its place.
    #[inline(always)]
    pub(crate) fn keep<S: Simd>(
        &mut self,
        simd: S,
        projector: &Projector,
        d: &Drawable,
        within: PixelRect,
    ) -> u32 {
        if let Some(place) = self.find(d.id) {
            return place;
        }
        let (place, first) = (self.patches.len() as u32, self.sides.reached());
        let pixels = projector.project(simd, d, within, &mut self.sides);
        if pixels.is_none() {
            self.sides.truncate(first);
        }
        self.patches.push(Kept {
            sides: (first, self.sides.reached()),
            pixels,
            side_count: d.outline().len() as u32,
            turned: d.turned,
            faces_eye: d.faces_eye,
            back: Back::new(projector.face(), d),
        });
        let id = d.id as usize;
        if self.places.len() <= id {
            self.places.resize(id + 1, NONE);
        }
        self.places[id] = place;
        place
    }

    /// The sides of a patch, eight at a time.
    #[inline(always)]
    pub(super) fn groups(&self, place: u32) -> &[Sides] {
        let (first, last) = self.patch(place).sides;
        &self.sides.groups[first[0]..last[0]]
    }

    /// The place of the first of them among those of all patches.
    #[inline(always)]
    pub(super) fn first_group(&self, place: u32) -> u32 {
        self.patch(place).sides.0[0] as u32
    }

    /// As [`KeptPatches::groups`], to mark seams.
    #[inline(always)]
    pub(super) fn groups_mut(&mut self, place: u32) -> &mut [Sides] {
        let (first, last) = self.patches[place as usize].sides;
        &mut self.sides.groups[first[0]..last[0]]
    }

    /// Eight sides of any patch.
    #[inline(always)]
    pub(super) fn group(&self, group: u32) -> &Sides {
        &self.sides.groups[group as usize]
    }

    /// The sides of a patch that are drawn in pieces.
    #[inline(always)]
    pub(super) fn deep(&self, place: u32) -> &[WholeSide] {
        let (first, last) = self.patch(place).sides;
        &self.sides.deep[first[1]..last[1]]
    }

    /// The sides of a patch, if the eye may go some way: each may be a part of a rim.
    pub(super) fn rims(&self, place: u32) -> &[WholeSide] {
        let (first, last) = self.patch(place).sides;
        &self.sides.rims[first[2]..last[2]]
    }
}

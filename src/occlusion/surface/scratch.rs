//! Patches as one face sees them, and the memory for drawing them, reused from batch to batch.

use std::ops::Range;

use crate::mesh::surface::PatchNumber;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::by_patch::ByPatch;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::sheet::Joint;

/// A patch as one face sees it.
#[derive(Debug, Clone)]
pub(super) struct SeenPatch {
    /// Index in the batch.
    pub(super) drawable: u32,
    /// Its place among the kept patches of the face.
    pub(super) kept: u32,
    /// The index of another patch of its component, or its own.
    pub(super) parent: u32,
    /// The pixels that it may touch.
    pub(super) pixels: PixelRect,
    /// No point of it is nearer.
    pub(super) near: f32,
    /// For the root of a component, no point of the component is nearer.
    pub(super) nearest: f32,
    /// A rectangle around its neighbours that are drawn for the first time.
    pub(super) around: PixelRect,
}

/// A patch in the order of drawing, nearest components first: farness of the component, its root,
/// index of the patch.
pub(super) type DrawPlace = (u32, u32, u32);

/// The memory for drawing surfaces.
#[derive(Debug, Clone, Default)]
pub(crate) struct SurfaceScratch {
    pub(super) ids: Ids,
    /// One for each face that the view looks through. Several threads may draw on several faces.
    pub(super) faces: Vec<FaceScratch>,
    /// Indices of patches of the last batch that hid more than before; some of them repeat.
    pub(crate) useful: Vec<u32>,
}

/// The memory for drawing surfaces on one face.
#[derive(Debug, Clone, Default)]
pub(super) struct FaceScratch {
    pub(super) seen: Vec<SeenPatch>,
    /// Patches too narrow to be drawn: index in the batch, nearness of the nearest point, pixels.
    pub(super) narrow: Vec<(u32, f32, PixelRect)>,
    pub(super) kept: KeptPatches,
    /// For each patch by its number in the order of first drawing, the last drawing that saw it,
    /// and its index in `seen`.
    places: Vec<(u32, u32)>,
    /// Counts drawings.
    drawing: u32,
    pub(super) order: Vec<DrawPlace>,
    pub(super) raster: Raster,
    /// The pixels that rims touch, widened by the distance that the eye may go.
    pub(super) rims: Raster,
    pub(super) joint: Joint,
    /// As in [`SurfaceScratch`], on this face.
    pub(super) useful: Vec<u32>,
    /// The blocks of pixels that the last drawing went through.
    pub(super) blocks: u64,
    /// Those that patches around many of them went through in the query.
    pub(super) wide_blocks: u64,
}

/// The numbers of the patches of a query in the order of first drawing, by their numbers in the
/// scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ids {
    query: u32,
    /// Query and number.
    by_patch: ByPatch<(u32, u32)>,
}

impl Ids {
    /// Forgets all numbers, for another query.
    fn begin(&mut self) {
        self.query += 1;
        if self.query == u32::MAX {
            self.by_patch.clear();
            self.query = 1;
        }
    }

    /// Numbers a patch of a surface, and its parts, which are not drawn beside it. `patches` is
    /// greater than all numbers in the scene.
    pub(super) fn set(&mut self, numbers: Range<PatchNumber>, id: u32, patches: usize) {
        self.by_patch.grow(patches);
        self.by_patch.fill(numbers, (self.query, id));
    }

    /// The number of a patch that was drawn, alone or as a part.
    #[inline]
    pub(super) fn get(&self, number: PatchNumber) -> Option<u32> {
        let (query, id) = self.by_patch.get(number);
        (query == self.query).then_some(id)
    }
}

impl SurfaceScratch {
    /// Forgets the patches of the last query: the numbers of first drawing begin anew.
    pub(crate) fn begin_query(&mut self) {
        self.ids.begin();
        for face in &mut self.faces {
            face.kept.clear();
            face.places.clear();
            face.wide_blocks = 0;
        }
    }

    /// The numbers of the patches of the query, and those that a face saw; `None` if nothing was
    /// drawn there.
    pub(crate) fn kept(&self, face: usize) -> Option<(&Ids, &KeptPatches)> {
        Some((&self.ids, &self.faces.get(face)?.kept))
    }
}

impl FaceScratch {
    /// Forgets the patches seen, for another drawing.
    pub(super) fn begin(&mut self) {
        self.drawing = self.drawing.wrapping_add(1);
        if self.drawing == 0 {
            self.places.clear();
            self.drawing = 1;
        }
        self.seen.clear();
        self.narrow.clear();
        self.useful.clear();
        self.blocks = 0;
    }

    /// Appends a patch by its number in the order of first drawing.
    pub(super) fn push(&mut self, id: u32, seen: SeenPatch) {
        debug_assert!(self.find(id).is_none(), "patches of a batch share triangles");
        if self.places.len() <= id as usize {
            self.places.resize(id as usize + 1, (0, 0));
        }
        self.places[id as usize] = (self.drawing, self.seen.len() as u32);
        self.seen.push(seen);
    }

    /// The index of a patch by its number in the order of first drawing, if the face sees it.
    #[inline]
    pub(super) fn find(&self, id: u32) -> Option<u32> {
        let &(drawing, place) = self.places.get(id as usize)?;
        (drawing == self.drawing).then_some(place)
    }

    /// The root of the component of a patch. Shortens the way for the next call.
    pub(super) fn root(&mut self, mut i: u32) -> u32 {
        while self.seen[i as usize].parent != i {
            let up = self.seen[self.seen[i as usize].parent as usize].parent;
            self.seen[i as usize].parent = up;
            i = up;
        }
        i
    }

    /// Makes one component of those of two patches.
    pub(super) fn unite(&mut self, i: u32, k: u32) {
        let (a, b) = (self.root(i), self.root(k));
        self.seen[a.max(b) as usize].parent = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_have_one_root() {
        let mut scratch = FaceScratch::default();
        scratch.begin();
        for i in 0..10 {
            let (pixels, around) = (PixelRect::EMPTY, PixelRect::EMPTY);
            let seen = SeenPatch { drawable: i, kept: i, parent: i, pixels, near: 1.0, nearest: 1.0, around };
            scratch.push(i * 2, seen);
        }
        assert_eq!((scratch.find(6), scratch.find(7)), (Some(3), None));
        for (a, b) in [(9, 7), (7, 5), (2, 4), (5, 3), (4, 8)] {
            scratch.unite(a, b);
        }
        let roots: Vec<u32> = (0..10).map(|i| scratch.root(i)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 6, 3, 2, 3]);
        scratch.begin();
        assert_eq!(scratch.find(6), None);
    }
}

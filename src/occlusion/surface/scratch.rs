//! Patches as one face sees them, and the memory for drawing them, reused from batch to batch.

use std::ops::Range;

use crate::mesh::surface::PatchNumber;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::by_patch::ByPatch;
use crate::occlusion::surface::joined::Joined;
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
    /// The pixels that it may touch.
    pub(super) pixels: PixelRect,
    /// No point of it is nearer.
    pub(super) near: f32,
}

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
    pub(super) kept: KeptPatches,
    /// Those seen.
    pub(super) joined: Joined,
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
            face.joined.forget_numbers();
            face.wide_blocks = 0;
        }
    }

    /// Whether a patch was drawn in the query, alone or as a part.
    pub(crate) fn has_drawn(&self, number: PatchNumber) -> bool {
        self.ids.get(number).is_some()
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
        self.joined.begin();
        self.seen.clear();
        self.useful.clear();
        self.blocks = 0;
    }
}

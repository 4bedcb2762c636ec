//! Patches as one face sees them, and the memory for drawing them, reused from batch to batch.

use std::ops::Range;

use glam::DVec3;

use crate::mesh::surface::PatchNumber;
use crate::occlusion::pixels::PixelRect;
use crate::occlusion::surface::by_patch::ByPatch;
use crate::occlusion::surface::raster::{Area, Edges, LANES, Marks, Raster};

/// A patch as one face sees it.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    /// Index in the batch.
    pub(super) drawable: u32,
    /// The index of another patch of its component, or its own.
    pub(super) parent: u32,
    /// The pixels that it may touch.
    pub(super) pixels: PixelRect,
    /// No point of it is nearer.
    pub(super) near: f32,
    /// For the root of a component, no point of the component is nearer.
    pub(super) nearest: f32,
    /// Its range in the list of sides.
    pub(super) sides: (Reached, Reached),
    /// A rectangle around its neighbours that are drawn for the first time.
    pub(super) around: PixelRect,
}

/// The place of a side that no other patch shares.
pub(super) const NO_TWIN: PatchNumber = PatchNumber::NONE;

/// Eight sides of a patch as one face sees them.
#[derive(Debug, Clone)]
pub(super) struct Sides {
    pub(super) edges: Edges,
    /// The numbers of the patches beyond, or [`NO_TWIN`].
    pub(super) twins: [PatchNumber; LANES],
    /// Those that run along the side in the opposite direction, one bit each.
    pub(super) opposite: u8,
}

/// A side that is drawn in pieces.
#[derive(Debug, Clone)]
pub(super) struct WholeSide {
    /// Its place among the sides.
    pub(super) group: u32,
    pub(super) lane: u32,
    /// Its ends in coordinates of the face, and in pixels where they are deep enough.
    pub(super) ends: [DVec3; 2],
    pub(super) pixels: [(f64, f64); 2],
    pub(super) slack: f64,
}

/// The sides of the patches seen.
#[derive(Debug, Clone, Default)]
pub(super) struct SeenSides {
    pub(super) groups: Vec<Sides>,
    /// Those that reach over a large range of depths, or behind the near limit.
    pub(super) deep: Vec<WholeSide>,
    /// All of them, if the eye may go some way: each may be a part of a rim.
    pub(super) rims: Vec<WholeSide>,
}

impl SeenSides {
    /// How many there are.
    pub(super) fn reached(&self) -> Reached {
        Reached {
            groups: self.groups.len() as u32,
            deep: self.deep.len() as u32,
            rims: self.rims.len() as u32,
        }
    }

    /// Drops those from a place on.
    pub(super) fn truncate(&mut self, reached: Reached) {
        self.groups.truncate(reached.groups as usize);
        self.deep.truncate(reached.deep as usize);
        self.rims.truncate(reached.rims as usize);
    }
}

/// A place in the list of sides.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Reached {
    pub(super) groups: u32,
    pub(super) deep: u32,
    pub(super) rims: u32,
}

/// The pixels around the patches of one component.
#[derive(Debug, Clone, Default)]
pub(super) struct Joint {
    pub(super) area: Area,
    pub(super) tiles: Vec<Marks>,
    /// The least nearness of the patches in each tile.
    pub(super) nears: Vec<f32>,
}

impl Joint {
    pub(super) fn clear(&mut self, area: Area) {
        self.area = area;
        self.tiles.clear();
        self.tiles.resize(area.tile_count(), Marks::default());
        self.nears.clear();
        self.nears.resize(area.tile_count(), f32::INFINITY);
    }
}

/// A patch in the order of drawing, nearest components first: farness of the component, its root,
/// index of the patch.
pub(super) type Place = (u32, u32, u32);

/// The memory for drawing surfaces.
#[derive(Debug, Clone, Default)]
pub(crate) struct SurfaceScratch {
    pub(super) seen: Vec<Seen>,
    /// Patches too narrow to be drawn: index in the batch, nearness of the nearest point, pixels.
    pub(super) narrow: Vec<(u32, f32, PixelRect)>,
    /// For each patch of the scene, the last drawing of a face that saw it, and its index in
    /// `seen`.
    places: ByPatch<(u32, u32)>,
    /// Counts drawings of faces.
    drawing: u32,
    pub(super) sides: SeenSides,
    pub(super) order: Vec<Place>,
    pub(super) raster: Raster,
    /// The pixels that rims touch, widened by the distance that the eye may go.
    pub(super) rims: Raster,
    pub(super) joint: Joint,
    /// Indices of patches of the last batch that hid more than before; some of them repeat.
    pub(crate) useful: Vec<u32>,
}

impl SurfaceScratch {
    /// Forgets the patches seen. `patches` is greater than all their numbers in the scene.
    pub(super) fn begin(&mut self, patches: usize) {
        self.places.grow(patches);
        self.drawing += 1;
        if self.drawing == u32::MAX {
            self.places.clear();
            self.drawing = 1;
        }
        self.seen.clear();
        self.narrow.clear();
        self.sides.truncate(Reached::default());
    }

    /// Appends a patch, by its number in the scene and those of its parts.
    pub(super) fn push(&mut self, numbers: Range<PatchNumber>, seen: Seen) {
        debug_assert!(self.sees_none(&numbers), "patches of a batch share triangles");
        let place = (self.drawing, self.seen.len() as u32);
        self.places.fill(numbers, place);
        self.seen.push(seen);
    }

    /// Whether the face sees none of some patches whose numbers follow each other.
    fn sees_none(&self, numbers: &Range<PatchNumber>) -> bool {
        let numbers = numbers.start.get()..numbers.end.get();
        numbers.map(PatchNumber::new).all(|number| self.find(number).is_none())
    }

    /// The index of a patch, if the face sees it.
    #[inline]
    pub(super) fn find(&self, number: PatchNumber) -> Option<u32> {
        let (drawing, place) = self.places.get(number);
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
        let mut scratch = SurfaceScratch::default();
        scratch.begin(20);
        for i in 0..10 {
            let (pixels, around, sides) = (PixelRect::EMPTY, PixelRect::EMPTY, Default::default());
            let seen = Seen { drawable: i, parent: i, pixels, near: 1.0, nearest: 1.0, sides, around };
            let number = PatchNumber::new(i * 2);
            scratch.push(number..number.after(), seen);
        }
        assert_eq!((scratch.find(PatchNumber::new(6)), scratch.find(PatchNumber::new(7))), (Some(3), None));
        for (a, b) in [(9, 7), (7, 5), (2, 4), (5, 3), (4, 8)] {
            scratch.unite(a, b);
        }
        let roots: Vec<u32> = (0..10).map(|i| scratch.root(i)).collect();
        assert_eq!(roots, [0, 1, 2, 3, 2, 3, 6, 3, 2, 3]);
        scratch.begin(20);
        assert_eq!(scratch.find(PatchNumber::new(6)), None);
    }
}

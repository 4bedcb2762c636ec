//! Static solids that share cells, found by the bricks and the lists that they are in.

use casca_slots::{Slot, Slots};
use glam::{DVec3, IVec3};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::grid::Grid;
use crate::object::Occluder;
use crate::scene::object::Object;
use crate::scene::opacity::OpacityPart;
use crate::scene::spatial_index::SpatialIndex;

/// How many of the objects that share a cell or a brick with a solid are looked at, to find others
/// that fill a cell together with it. If there are more, the cell stays transparent.
pub(super) const MOST_ASKED: usize = 256;

/// How many of the objects in a brick are looked at.
const MOST_MEMBERS: usize = 1024;

/// Solids with the boxes around them.
pub(super) type NearSolids<'a> = SmallVec<[(&'a Occluder, Block); 16]>;

/// Static solids that are in no lists of cells, because they are too large for these.
pub(super) type Large = SmallVec<[Slot; 8]>;

/// The static solids whose cells are in one part of the opacity: a solid whose cells are added is
/// not among them yet, and one whose cells are taken away not any more.
#[derive(Clone, Copy)]
pub(super) struct StaticSolids<'a> {
    pub(super) grid: &'a Grid,
    pub(super) objects: &'a Slots<Object>,
    pub(super) index: &'a SpatialIndex,
    pub(super) part: OpacityPart,
}

impl<'a> StaticSolids<'a> {
    /// The occluder of an object, if that is one of the solids.
    fn solid(&self, slot: Slot) -> Option<&'a Occluder> {
        let object = &self.objects[slot];
        object.occluder().filter(|_| object.is_static() && object.opacity == Some(self.part))
    }

    /// Those that are in no lists of cells and may touch another solid.
    pub(super) fn large_near(&self, occluder: &Occluder) -> Large {
        let around = occluder.block();
        let meets = |&s: &Slot| {
            let solid = self.solid(s).filter(|_| !self.objects[s].in_cells);
            solid.is_some_and(|o| o.block().meets(&around))
        };
        self.index.always.as_slice().iter().copied().take(MOST_ASKED).filter(meets).collect()
    }

    /// Those that may touch the part of a brick that lies in a box.
    pub(super) fn in_brick(&self, brick: IVec3, around: &Block, large: &Large) -> NearSolids<'a> {
        let part =
            Block::new(self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7)).intersection(around);
        let members = self.index.ids.in_brick(brick).take(MOST_MEMBERS).chain(large.iter().copied());
        let solids = members.filter_map(|s| self.solid(s)).map(|o| (o, o.block()));
        solids.filter(|(_, block)| block.meets(&part)).collect()
    }

    /// Whether some may touch a brick.
    pub(super) fn touch_brick(&self, brick: IVec3, large: &Large) -> bool {
        let mut members = self.index.ids.in_brick(brick);
        if members.len() > MOST_ASKED || members.any(|s| self.solid(s).is_some()) {
            return true;
        }
        let (min, max) = self.grid.range_bounds(brick << 3i32, (brick << 3i32) + 7);
        self.large_touch(min, max, large)
    }

    /// Whether some of the large ones may touch a box.
    pub(super) fn large_touch(&self, min: DVec3, max: DVec3, large: &Large) -> bool {
        large.iter().any(|&s| self.solid(s).is_some_and(|o| !o.kind().misses(min, max)))
    }
}

//! Where queries find the objects of a scene: by the bricks that they touch, in lists of those that
//! no cell tells all of, in zones, and in volumes.

use casca_slots::{Id, Slot, SlotSet};
use glam::{IVec3, Vec3A};

use crate::geometry::{Aabb, Block};
use crate::grid::cell_box::{CellBox, volume};
use crate::grid::mask::{BRICK, NONE};
use crate::grid::{Grid, reaches};
use crate::matrix::ids::IdMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::object::{Bounds, Occluder};
use crate::scene::boxes::Boxes;
use crate::scene::movers::Movers;
use crate::scene::object::Object;
use crate::scene::rooms::Rooms;
use crate::shape::pieces::{Moved, touched};

/// An object whose bounds span more cells than this is not written into I, which would take a
/// brick for every 512 of them: it is tested against the frustum in every query.
const MOST_SPANNED: u64 = 1 << 22;

/// How the cells of a box stand for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    /// Whether all have coordinates.
    inside: bool,
    /// Whether they are few enough to be written into I.
    few: bool,
}

impl Span {
    pub(super) fn of(grid: &Grid, block: &Block) -> Self {
        let (lo, hi) = grid.cover(block.min, block.max);
        Self { inside: reaches(lo) && reaches(hi), few: volume(lo, hi) <= MOST_SPANNED }
    }

    /// Whether the object is in cells, so that the walk over these finds it.
    pub(super) fn suffices(self) -> bool {
        self.inside && self.few
    }
}

/// Whether two shapes surely touch the same bricks, none of them wholly.
fn touch_same_bricks(grid: &Grid, old: &Bounds, new: &Bounds) -> bool {
    // A mesh may be in several pieces, none of them in a brick between two others.
    if [old, new].iter().any(|bounds| matches!(bounds, Bounds::Mesh(_))) {
        return false;
    }
    let cover = |shape: &Bounds| {
        let block = shape.block();
        grid.cover(block.min, block.max)
    };
    let ((lo, hi), (old_lo, old_hi)) = (cover(new), cover(old));
    let same = lo >> 3i32 == old_lo >> 3i32 && hi >> 3i32 == old_hi >> 3i32;
    // A connected shape touches all bricks of its box if those are a row.
    let rows = (hi >> 3i32).cmpgt(lo >> 3i32).bitmask().count_ones() <= 1;
    let whole = |lo: IVec3, hi: IVec3| (hi - lo).min_element() >= BRICK - 1;
    let inside = [lo, hi, old_lo, old_hi].into_iter().all(reaches);
    same && rows && inside && !whole(lo, hi) && !whole(old_lo, old_hi)
}

/// The zone to list an object in instead of cells, with some bounds, if it may be: it moves, is
/// small and hides nothing.
pub(super) fn zone_for(grid: &Grid, object: &Object, bounds: &Bounds) -> Option<IVec3> {
    let may = !object.is_static() && object.given_occluder().is_none();
    if may { Movers::zone_of(grid, &bounds.block()) } else { None }
}

/// Where queries find objects. It owns the matrix I and the lists beside it, the zones of small
/// movers, the volumes, the rooms that belong to both, and the boxes that queries read first. In an
/// object, it sets whether that is in cells or in a zone.
#[derive(Clone, Default)]
pub(super) struct SpatialIndex {
    /// I: the objects that touch each brick.
    pub(super) ids: IdMatrix,
    /// What queries ask of most objects.
    pub(super) boxes: Boxes,
    /// Listed dynamic objects.
    pub(super) movers: SlotSet,
    /// Those of them that are reported on expiry and are in no zone.
    pub(super) on_expiry: SlotSet,
    /// Objects tested in every query: beyond the reach of coordinates, too large, overdue or
    /// unlocated.
    pub(super) always: SlotSet,
    /// Small moving objects, by zones.
    pub(super) zones: Movers,
    /// Where objects may go without a change of the matrices.
    pub(super) rooms: Rooms,
    /// Txy, Txz, Tyz: the surfaces of the volumes.
    pub(super) volumes: TbvMatrix,
    /// Memory used again: the cells of an object that moves.
    moved: Moved,
}

impl SpatialIndex {
    /// Writes an object that is nowhere into I or a zone, and into lists.
    pub(super) fn list(&mut self, grid: &Grid, id: Id, object: &mut Object) {
        let slot = id.slot();
        self.boxes.put(slot, object);
        if !object.is_static() {
            self.movers.insert(slot);
        }
        if let Some(zone) = zone_for(grid, object, &object.bounds) {
            (object.in_cells, object.in_zone) = (true, true);
            self.enter_zone(grid, (id, zone), object.is_plain(), corners(&object.bounds));
            return;
        }
        let span = Span::of(grid, &object.bounds.block());
        object.in_cells = span.suffices();
        if object.in_cells {
            touched(&object.bounds, grid, &mut |p| p.bricks(|b, m| self.ids.change(b, &NONE, m, slot)));
        }
        if !object.in_cells {
            self.always.insert(slot);
        }
        if object.on_expiry() {
            self.on_expiry.insert(slot);
        }
    }

    /// Takes a listed object out of I or its zone, and out of the lists.
    pub(super) fn unlist(&mut self, grid: &Grid, slot: Slot, object: &mut Object) {
        if std::mem::take(&mut object.in_zone) {
            self.rooms.close(slot);
            self.zones.remove(slot);
            object.in_cells = false;
        }
        if std::mem::take(&mut object.in_cells) {
            touched(&object.bounds, grid, &mut |p| p.bricks(|b, m| self.ids.change(b, m, &NONE, slot)));
        }
        self.always.remove(slot);
        self.movers.remove(slot);
        self.on_expiry.remove(slot);
    }

    /// Moves the cells of a small dynamic object in I; false, without a change, for others.
    pub(super) fn move_cells(
        &mut self,
        grid: &Grid,
        (slot, object): (Slot, &Object),
        bounds: &Bounds,
        occluder: Option<&Occluder>,
    ) -> bool {
        let in_cells = object.in_cells && !self.always.contains(slot);
        let hides = object.occluder().is_some() || occluder.is_some();
        // From now on it is listed in other ways.
        if object.in_zone || !hides && zone_for(grid, object, bounds).is_some() {
            return false;
        }
        if in_cells && !hides && touch_same_bricks(grid, &object.bounds, bounds) {
            return true;
        }
        let after = Span::of(grid, &bounds.block());
        // An occluder that comes or goes joins or leaves its part of the opacity.
        let same_part = object.occluder().is_some() == occluder.is_some();
        let simple = !object.is_static() && in_cells && same_part && after.suffices();
        if !simple || !self.moved.touched(&object.bounds, bounds, grid) {
            return false;
        }
        self.moved.iter().for_each(|(brick, old, new)| self.ids.change(brick, old, new, slot));
        true
    }

    /// Writes an object with a box into the list of a zone, out of any other.
    pub(super) fn enter_zone(
        &mut self,
        grid: &Grid,
        (id, zone): (Id, IVec3),
        plain: bool,
        (min, max): (Vec3A, Vec3A),
    ) {
        let room = self.zones.insert(grid, (id, zone), plain);
        self.boxes.put_mover(id.slot(), min, max);
        self.rooms.open(id, &room);
    }

    /// Brings the entry of an object in the list of its zone, if it is in one, up to date with it;
    /// false, without a change, if no zone may list it any more.
    pub(super) fn refresh_mover(&mut self, grid: &Grid, id: Id, object: &Object) -> bool {
        if !object.in_zone {
            return true;
        }
        // Its bounds may have become those of a larger object, in the same room.
        let Some(zone) = Movers::zone_of(grid, &object.bounds.block()) else { return false };
        self.enter_zone(grid, (id, zone), object.is_plain(), corners(&object.bounds));
        true
    }

    /// A block of bricks around all objects and volumes that are somewhere.
    pub(super) fn extent(&self) -> Option<CellBox> {
        let all = [self.ids.pages().extent(), self.volumes.pages().extent(), self.zones.extent()];
        all.into_iter().flatten().reduce(CellBox::join)
    }

    /// Empties all but the volumes and the boxes.
    pub(super) fn clear_lists(&mut self) {
        (self.ids, self.movers, self.on_expiry, self.always) = Default::default();
        self.rooms.clear();
        self.zones.clear();
    }

    /// Bytes of all but I and the volumes.
    pub(super) fn bytes_of_lists(&self) -> usize {
        self.boxes.bytes()
            + self.movers.bytes()
            + self.on_expiry.bytes()
            + self.always.bytes()
            + self.zones.bytes()
            + self.rooms.bytes()
            + self.moved.bytes()
    }
}

fn corners(bounds: &Bounds) -> (Vec3A, Vec3A) {
    let Aabb { min, max } = bounds.aabb();
    (min.into(), max.into())
}

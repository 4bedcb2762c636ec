//! Where queries find the objects of a scene: by the bricks that they touch, in lists of those that
//! no cell tells all of, in zones, and in volumes.

use casca_slots::{Id, Slot, SlotSet};
use glam::{IVec3, Vec3A};

use crate::geometry::{Aabb, Block};
use crate::grid::cell_box::{CellBox, volume};
use crate::grid::{Grid, reaches};
use crate::matrix::ids::IdMatrix;
use crate::matrix::tbv::TbvMatrix;
use crate::object::Bounds;
use crate::scene::boxes::Boxes;
use crate::scene::movers::Movers;
use crate::scene::object::Object;
use crate::scene::rooms::Rooms;
use crate::shape::pieces::touched;

/// An object whose bounds span more cells than this is not written into I, which would take a
/// brick for every 512 of them: it is tested against the frustum in every query.
const MOST_SPANNED: u64 = 1 << 22;

/// Whether the cells of a box all have coordinates and are few enough for I.
fn suits_cells(grid: &Grid, block: &Block) -> bool {
    let (lo, hi) = grid.cover(block.min, block.max);
    reaches(lo) && reaches(hi) && volume(lo, hi) <= MOST_SPANNED
}

/// The bricks of the box of some bounds.
fn bricks_of(grid: &Grid, bounds: &Bounds) -> CellBox {
    let block = bounds.block();
    let (lo, hi) = grid.cover(block.min, block.max);
    CellBox { lo, hi }.bricks()
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
    /// Objects tested in every query: beyond the reach of coordinates, too large, or in a
    /// volume whose time is over.
    pub(super) always: SlotSet,
    /// Small moving objects, by zones.
    pub(super) zones: Movers,
    /// Where objects may go without a change of the matrices.
    pub(super) rooms: Rooms,
    /// Txy, Txz, Tyz: the surfaces of the volumes.
    pub(super) volumes: TbvMatrix,
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
        object.in_cells = suits_cells(grid, &object.bounds.block());
        if !object.in_cells {
            self.always.insert(slot);
        } else if object.is_static() {
            touched(object.bounds.kind(), grid, &mut |piece| {
                piece.bricks(|brick, _| self.ids.insert(brick, slot))
            });
        } else {
            self.enter_bricks(grid, id, object);
        }
    }

    /// Takes a listed object out of I or its zone, and out of the lists.
    pub(super) fn unlist(&mut self, grid: &Grid, slot: Slot, object: &mut Object) {
        self.rooms.close(slot);
        if std::mem::take(&mut object.in_zone) {
            self.zones.remove(slot);
        } else if object.in_cells && object.is_static() {
            touched(object.bounds.kind(), grid, &mut |piece| {
                piece.bricks(|brick, _| self.ids.remove(brick, slot))
            });
        } else if object.in_cells {
            object.bricks().cells().for_each(|brick| self.ids.remove(brick, slot));
        }
        object.in_cells = false;
        self.always.remove(slot);
        self.movers.remove(slot);
    }

    /// Writes a mover into all bricks of its box. One that hides nothing may go where it likes in these.
    fn enter_bricks(&mut self, grid: &Grid, id: Id, object: &mut Object) {
        let bricks = bricks_of(grid, &object.bounds);
        bricks.cells().for_each(|brick| self.ids.insert(brick, id.slot()));
        object.set_bricks(bricks);
        if object.given_occluder().is_none() {
            self.rooms.open(id, &Block::new(grid.bricks().range_bounds(bricks.lo, bricks.hi)));
        }
    }

    /// Whether a mover that goes to other bounds, with or without an occluder as before, stays in the
    /// bricks that list it.
    pub(super) fn stays_in_bricks(&self, grid: &Grid, object: &Object, bounds: &Bounds, hides: bool) -> bool {
        let as_before = object.in_cells && !object.in_zone && object.occluder().is_some() == hides;
        as_before
            && !object.is_static()
            && suits_cells(grid, &bounds.block())
            && bricks_of(grid, bounds) == object.bricks()
            && (hides || zone_for(grid, object, bounds).is_none())
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
        (self.ids, self.movers, self.always) = Default::default();
        self.rooms.clear();
        self.zones.clear();
    }

    /// Bytes of all but I and the volumes.
    pub(super) fn bytes_of_lists(&self) -> usize {
        self.boxes.bytes()
            + self.movers.bytes()
            + self.always.bytes()
            + self.zones.bytes()
            + self.rooms.bytes()
    }
}

fn corners(bounds: &Bounds) -> (Vec3A, Vec3A) {
    let Aabb { min, max } = bounds.aabb();
    (min.into(), max.into())
}

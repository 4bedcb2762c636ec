//! Small moving objects that hide nothing, by zones of the grid.
//!
//! There may be very many of them, and all may move in each frame. None is drawn, so that nothing
//! is gained by finding them brick by brick from front to back: they are decided once all occluders
//! are drawn. So they are in no brick, but in the list of the *zone* that their middle lies in, a
//! cube of 32x32x32 cells. One test decides for most zones, and for all that they list. A mover may
//! go where it likes in the *room* of its zone, which is the zone with a margin around it, before
//! its report changes a list.
//!
//! Only queries of [`crate::Method::Point`] look at zones. Those of [`crate::Method::Cell`] list
//! all objects by cell, these included, for themselves.

use casca_slots::{Id, Slot};
use glam::{DVec3, IVec3};
use hashbrown::HashMap;

use crate::geometry::Block;
use crate::grid::cell_box::CellBox;
use crate::grid::extent::Extent;
use crate::grid::mask::BRICK;
use crate::grid::{Grid, reaches};

/// The edge of a zone in cells, as a power of two.
const ZONE_BITS: i32 = 5;

/// The edge of a zone in bricks.
const ZONE_BRICKS: i32 = (1 << ZONE_BITS) / BRICK;

/// How far a mover may reach out of its zone, in cells.
const MARGIN: i32 = 4;

/// Movers are smaller than this, in cells, so that each fits in the room of the zone of its middle.
const SMALL: f64 = 7.0;

const _: () = assert!(MARGIN < BRICK && 2.0 * MARGIN as f64 > SMALL + 0.5);

/// The movers of one zone.
#[derive(Debug, Clone)]
pub(crate) struct Zone {
    at: IVec3,
    room: Block,
    plain: Vec<Id>,
    others: Vec<Slot>,
}

impl Zone {
    /// A box that contains all of them.
    #[inline]
    pub(crate) fn room(&self) -> &Block {
        &self.room
    }

    /// Those that are on all layers, and whose bounds contain the middle of their box: a query
    /// needs nothing but their boxes.
    #[inline]
    pub(crate) fn plain(&self) -> &[Id] {
        &self.plain
    }

    /// The others.
    #[inline]
    pub(crate) fn others(&self) -> &[Slot] {
        &self.others
    }

    fn is_empty(&self) -> bool {
        self.plain.is_empty() && self.others.is_empty()
    }
}

/// Where a mover is listed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ListPlace {
    /// The index of its zone.
    zone: u32,
    /// Its place in the list, twice, and one more in the list of the others.
    at: u32,
}

impl ListPlace {
    const NONE: Self = Self { zone: u32::MAX, at: 0 };
}

/// The movers of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Movers {
    zones: Vec<Zone>,
    /// Zones that list nobody, to be used again.
    free: Vec<u32>,
    by_place: HashMap<IVec3, u32>,
    extent: Extent,
    /// By slot.
    places: Vec<ListPlace>,
}

impl Movers {
    /// The zone of an object with these bounds; none if it is too large, or beyond the reach of
    /// coordinates.
    #[inline]
    pub(super) fn zone_of(grid: &Grid, bounds: &Block) -> Option<IVec3> {
        let Block { min, max } = *bounds;
        let small = (max - min).cmplt(DVec3::splat(SMALL * grid.cell_size())).all();
        let zone = || grid.cell_of((min + max) * 0.5) >> ZONE_BITS;
        small.then(zone).filter(|&zone| reaches((zone - 1) << ZONE_BITS) && reaches((zone + 2) << ZONE_BITS))
    }

    /// Lists a mover, and returns its room. It was not listed.
    pub(super) fn insert(&mut self, grid: &Grid, (id, zone): (Id, IVec3), plain: bool) -> Block {
        let slot = id.slot();
        if self.places.len() <= slot.index() {
            self.places.resize(slot.index() + 1, ListPlace::NONE);
        }
        self.remove(slot);
        let index = self.zone_at(grid, zone);
        let zone = &mut self.zones[index as usize];
        let at = if plain {
            zone.plain.push(id);
            zone.plain.len() as u32 * 2 - 2
        } else {
            zone.others.push(slot);
            zone.others.len() as u32 * 2 - 1
        };
        self.places[slot.index()] = ListPlace { zone: index, at };
        zone.room
    }

    /// The index of the zone at a place, which may list nobody yet.
    fn zone_at(&mut self, grid: &Grid, at: IVec3) -> u32 {
        if let Some(&index) = self.by_place.get(&at) {
            return index;
        }
        let lo = at << ZONE_BITS;
        let room = Block::new(grid.range_bounds(lo - MARGIN, lo + ((1 << ZONE_BITS) - 1 + MARGIN)));
        let index = self.free.pop().unwrap_or(self.zones.len() as u32);
        match self.zones.get_mut(index as usize) {
            Some(zone) => (zone.at, zone.room) = (at, room),
            None => self.zones.push(Zone { at, room, plain: Vec::new(), others: Vec::new() }),
        }
        self.by_place.insert(at, index);
        self.extent.change(at, true);
        index
    }

    /// Takes a mover out of its list; nothing changes for others.
    pub(super) fn remove(&mut self, slot: Slot) {
        let Some(place) = self.places.get_mut(slot.index()) else { return };
        let ListPlace { zone: index, at } = std::mem::replace(place, ListPlace::NONE);
        let Some(zone) = self.zones.get_mut(index as usize) else { return };
        let here = at as usize / 2;
        let moved = if at % 2 == 0 {
            zone.plain.swap_remove(here);
            zone.plain.get(here).map(|id| id.slot())
        } else {
            zone.others.swap_remove(here);
            zone.others.get(here).copied()
        };
        if let Some(moved) = moved {
            self.places[moved.index()].at = at;
        }
        if zone.is_empty() {
            self.by_place.remove(&zone.at);
            self.extent.change(zone.at, false);
            self.free.push(index);
        }
    }

    /// Takes all out.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// A block of bricks around all of them.
    pub(super) fn extent(&self) -> Option<CellBox> {
        // They reach out of their zones by less than a brick.
        let bricks = |CellBox { lo, hi }| CellBox { lo: lo * ZONE_BRICKS - 1, hi: (hi + 1) * ZONE_BRICKS };
        self.extent.around().map(bricks)
    }

    /// The zones; some list nobody.
    #[inline]
    pub(crate) fn zones(&self) -> &[Zone] {
        &self.zones
    }

    pub(super) fn bytes(&self) -> usize {
        let lists = |zone: &Zone| {
            zone.plain.capacity() * size_of::<Id>() + zone.others.capacity() * size_of::<Slot>()
        };
        self.zones.capacity() * size_of::<Zone>()
            + self.zones.iter().map(lists).sum::<usize>()
            + self.by_place.capacity() * size_of::<(IVec3, u32)>()
            + self.free.capacity() * size_of::<u32>()
            + self.extent.bytes()
            + self.places.capacity() * size_of::<ListPlace>()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use casca_slots::Slots;

    use super::*;
    use crate::random::Random;

    fn grid() -> Grid {
        Grid::new(1.0).unwrap()
    }

    fn block(at: DVec3, half: f64) -> Block {
        Block { min: at - half, max: at + half }
    }

    #[test]
    fn movers_are_listed_once_and_their_rooms_contain_them() {
        let (grid, mut random, mut slots) = (grid(), Random::new(3), Slots::new());
        let mut movers = Movers::default();
        let mut listed = BTreeMap::new();
        for step in 0..4000 {
            let slot = Slot::new((random.next().abs() * 99.0) as u32);
            while slots.count() <= slot.index() {
                slots.insert(()).unwrap();
            }
            if step % 3 == 0 {
                movers.remove(slot);
                listed.remove(&slot);
                continue;
            }
            let bounds = block(random.point(100.0), 1.0 + random.next().abs() * 2.4);
            let Some(zone) = Movers::zone_of(&grid, &bounds) else { panic!("{bounds:?} is small") };
            let room = movers.insert(&grid, (slots.id(slot), zone), step % 2 == 0);
            assert!(room.contains(&bounds), "{room:?} {bounds:?}");
            listed.insert(slot, (step % 2 == 0, zone));
            let CellBox { lo, hi } = movers.extent().unwrap();
            let extent = Block::new(grid.bricks().range_bounds(lo, hi));
            assert!(extent.contains(&bounds), "{extent:?} {bounds:?}");
        }
        let mut found = BTreeMap::new();
        for zone in movers.zones() {
            let plain = zone.plain().iter().map(|id| (id.slot(), true));
            for (slot, plain) in plain.chain(zone.others().iter().map(|&slot| (slot, false))) {
                assert!(found.insert(slot, (plain, zone.at)).is_none(), "{slot} twice");
            }
        }
        assert_eq!(found, listed);
        let full = movers.zones.len();
        listed.keys().for_each(|&slot| movers.remove(slot));
        assert!(movers.by_place.is_empty() && movers.free.len() == full && full > 40);
    }

    #[test]
    fn large_objects_and_those_far_away_are_in_no_zone() {
        let grid = grid();
        let of = |x: f64, half: f64| Movers::zone_of(&grid, &block(DVec3::new(x, 50.0, 35.0), half));
        assert_eq!(of(40.0, 3.4), Some(IVec3::new(1, 1, 1)));
        assert!(of(40.0, 3.6).is_none() && of(f64::NAN, 1.0).is_none());
        assert!(of(1.04e6, 1.0).is_some() && of(1.05e6, 1.0).is_none() && of(-1.05e6, 1.0).is_none());
    }
}

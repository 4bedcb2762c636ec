//! Rooms: where a moving object may go without a change of the matrices.
//!
//! A small moving object that hides nothing is listed in all bricks that its box reaches, instead
//! of cell by cell; one that no view saw is in a temporal bounding volume. While its box stays
//! inside of these bricks or of this volume, a report changes nothing but its bounds. The table of
//! rooms has all that such a report is compared with, in 32 bytes an object: most moves look at
//! nothing else but the record that they write.
//!
//! The bricks that an object left stay in its list until it leaves their common box. So an object
//! that swings across a face changes no list, and [`crate::Method::Point`], which asks for bricks
//! alone, looks at it in a brick too many at most.

use casca_slots::{Id, Slot};
use glam::{IVec3, Vec3A};

use crate::geometry::Block;
use crate::geometry::block::{above, below};
use crate::grid::Grid;
use crate::grid::bricks::BRICK;
use crate::grid::cell_box::CellBox;
use crate::object::Bounds;

/// A block of bricks, both corners included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BrickBox {
    lo: [u16; 3],
    hi: [u16; 3],
}

impl BrickBox {
    /// The bricks that bounds reach, if an object with them may be listed by bricks: they lie in
    /// the grid, fill no brick, and a mesh in several pieces would be listed where it is not.
    pub(super) fn of(grid: &Grid, bounds: &Bounds) -> Option<Self> {
        if matches!(bounds, Bounds::Mesh(_)) {
            return None;
        }
        Self::around(grid, &bounds.block())
    }

    /// As [`BrickBox::of`], for bounds that touch all bricks of a box or may be listed in all of
    /// them.
    pub(super) fn around(grid: &Grid, block: &Block) -> Option<Self> {
        let Block { min, max } = *block;
        let inside = min.cmpge(grid.min()).all() && max.cmplt(grid.max()).all();
        let small = (max - min).max_element() < f64::from(BRICK - 1) * grid.cell_size();
        if !(inside && small) {
            return None;
        }
        let (lo, hi) = grid.bricks().cover(min, max);
        let corner = |brick: IVec3| brick.to_array().map(|at| at as u16);
        Some(Self { lo: corner(lo), hi: corner(hi) })
    }

    fn corners(&self) -> CellBox {
        let corner = |at: [u16; 3]| IVec3::from_array(at.map(i32::from));
        CellBox { lo: corner(self.lo), hi: corner(self.hi) }
    }

    /// Calls `found` with all of them.
    #[inline]
    pub(super) fn for_each(&self, mut found: impl FnMut(IVec3)) {
        let CellBox { lo, hi } = self.corners();
        for z in lo.z..=hi.z {
            for y in lo.y..=hi.y {
                (lo.x..=hi.x).for_each(|x| found(IVec3::new(x, y, z)));
            }
        }
    }

    /// Calls `found` with those that are not among others.
    #[inline]
    pub(super) fn for_each_but(&self, others: &Self, mut found: impl FnMut(IVec3)) {
        self.for_each(|brick| {
            if !others.contains(brick) {
                found(brick);
            }
        });
    }

    fn contains(&self, brick: IVec3) -> bool {
        self.corners().contains(brick)
    }

    /// Whether others are among them.
    pub(super) fn contains_all(&self, others: &Self) -> bool {
        let CellBox { lo, hi } = others.corners();
        self.contains(lo) && self.contains(hi)
    }

    /// Their part of the grid as a box in world units.
    pub(super) fn block(&self, grid: &Grid) -> Block {
        let CellBox { lo, hi } = self.corners();
        let last = (hi * BRICK + (BRICK - 1)).min(grid.dims() - 1);
        Block::new(grid.range_bounds(lo * BRICK, last))
    }
}

/// Where one object may go. Closed rooms contain nothing.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
struct Room {
    /// The least corner; not a number if the room is closed.
    min: [f32; 3],
    /// The rest of the id of the object that it is for.
    generation: u32,
    /// The greatest corner, which is not inside.
    max: [f32; 3],
    store: u32,
}

impl Room {
    const CLOSED: Self = Self { min: [f32::NAN; 3], generation: 0, max: [f32::NAN; 3], store: 0 };
}

/// The rooms of a scene, by slot.
#[derive(Debug, Clone, Default)]
pub(super) struct Rooms(Vec<Room>);

impl Rooms {
    /// An object may go anywhere in a box from now on, but to its upper sides: a cell begins there.
    pub(super) fn open(&mut self, id: Id, block: &Block) {
        let at = id.slot().index();
        if self.0.len() <= at {
            self.0.resize(at + 1, Room::CLOSED);
        }
        let (min, max) = (block.min.to_array().map(above), block.max.to_array().map(below));
        self.0[at] = Room { min, generation: id.generation(), max, store: id.store() };
    }

    /// The next report of the object in a slot may change the matrices.
    pub(super) fn close(&mut self, slot: Slot) {
        if let Some(room) = self.0.get_mut(slot.index()) {
            *room = Room::CLOSED;
        }
    }

    /// Closes all.
    pub(super) fn clear(&mut self) {
        self.0.fill(Room::CLOSED);
    }

    /// Whether an id names an object whose room is open and contains a box. No box contains
    /// numbers that are not finite, and none is inverted.
    #[inline]
    pub(super) fn hold(&self, id: Id, min: Vec3A, max: Vec3A) -> bool {
        let Some(room) = self.0.get(id.slot().index()) else { return false };
        let inside = Vec3A::from_array(room.min).cmple(min) & max.cmplt(Vec3A::from_array(room.max));
        room.generation == id.generation() && room.store == id.store() && (inside & min.cmple(max)).all()
    }

    pub(super) fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<Room>()
    }
}

#[cfg(test)]
mod tests {
    use casca_slots::Slots;
    use glam::{DVec3, UVec3, Vec3, Vec3A};

    use super::*;
    use crate::geometry::Sphere;
    use crate::grid::GridSpec;

    #[test]
    fn rooms_contain_their_boxes_but_for_the_upper_sides() {
        let mut slots = Slots::new();
        let slot = slots.insert(()).unwrap();
        let (mut rooms, id) = (Rooms::default(), slots.id(slot));
        let hold =
            |rooms: &Rooms, id, min: f32, max: f32| rooms.hold(id, Vec3A::splat(min), Vec3A::splat(max));
        assert!(!hold(&rooms, id, 1.0, 2.0), "there is none yet");
        rooms.open(id, &Block { min: DVec3::splat(1.0 - 1e-12), max: DVec3::splat(3.0 + 1e-12) });
        assert!(hold(&rooms, id, 1.0, 2.9) && hold(&rooms, id, 2.0, 2.0));
        for (min, max) in [(0.99, 2.0), (1.5, 3.0), (2.0, 1.5), (f32::NAN, 2.0), (1.5, f32::NAN)] {
            assert!(!hold(&rooms, id, min, max), "{min} {max}");
        }
        slots.remove(slot);
        let other = slots.insert(()).unwrap();
        assert!(other == slot && !hold(&rooms, slots.id(other), 1.0, 2.0), "it is another's");
        let mut theirs = Slots::new();
        theirs.insert(()).unwrap();
        assert!(!hold(&rooms, theirs.id(slot), 1.0, 2.0), "another scene's");
        assert!(hold(&rooms, id, 1.0, 2.0));
        rooms.close(slot);
        assert!(!hold(&rooms, id, 1.0, 2.0));
    }

    #[test]
    fn objects_that_are_large_or_leave_the_grid_are_not_listed_by_bricks() {
        let grid = Grid::new(&GridSpec { min: Vec3::ZERO, cell: 1.0, dims: UVec3::splat(30) }).unwrap();
        let of = |x: f32, r: f32| BrickBox::of(&grid, &Sphere::new(Vec3::new(x, 15.5, 15.5), r).into());
        let across = of(8.0, 1.0).unwrap();
        let count = |of: BrickBox, others: BrickBox| {
            let mut count = 0;
            of.for_each_but(&others, |_| count += 1);
            count
        };
        let (lower, aside) = (of(4.0, 1.0).unwrap(), of(28.0, 0.5).unwrap());
        assert_eq!((count(across, aside), count(across, lower), count(across, across)), (8, 4, 0));
        assert!(of(1.0, 1.1).is_none() && of(29.5, 0.6).is_none() && of(15.5, 3.6).is_none());
        // The last brick ends with the grid.
        assert_eq!(of(28.0, 0.5).unwrap().block(&grid).max.x, 30.0);
        assert!(across.block(&grid).min.x == 0.0 && across.block(&grid).max.x == 16.0);
    }
}

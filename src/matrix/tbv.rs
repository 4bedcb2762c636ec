//! Txy, Txz, Tyz: temporal bounding volumes as hollow squares in three
//! projections (thesis, section 3.4.1).
//!
//! A box whose projections are drawn hollow costs O(n) cells instead of
//! O(n^3). A cell (x, y, z) is on the surface of the box iff at least two of
//! (x, y) in Txy, (x, z) in Txz and (y, z) in Tyz are set: on the face x = x0 both
//! projections that contain x do; strictly inside none does; outside at most
//! the one without the axis that it misses.
//!
//! The projections are kept brick by brick, so that a volume is found only from
//! the part of space where it is, however many others share its rows. Bricks
//! inside of a volume list it too: an eye there is in it.

use casca_slots::Slot;
use glam::IVec3;

use crate::grid::bricks::{Bricks, Pages};
use crate::grid::cell_box::CellBox;
use crate::grid::mask::{BRICK, span8};
use crate::grid::side::SideAxes;

/// The part of a block of cells in a brick along one axis: a bit for each coordinate.
#[derive(Clone, Copy)]
struct Extent {
    /// Inside the block.
    all: u64,
    /// Strictly inside.
    inner: u64,
}

impl Extent {
    fn new(volume: &CellBox, brick: IVec3, axis: usize) -> Self {
        let corner = brick[axis] * BRICK;
        let (first, last) = (volume.lo[axis] - corner, volume.hi[axis] - corner);
        Self { all: span8(first, last), inner: span8(first + 1, last - 1) }
    }

    /// The hollow rectangle with this extent along the first axis and `up` along the second: bit
    /// 8b+a for the coordinates a and b.
    fn hollow(self, up: TileRows) -> u64 {
        (self.all * up.all) & !(self.inner * up.inner)
    }

    fn rows(self) -> TileRows {
        TileRows { all: spread(self.all), inner: spread(self.inner) }
    }
}

/// An [`Extent`] along the second axis of a tile: bit 8b for coordinate b.
#[derive(Clone, Copy)]
struct TileRows {
    all: u64,
    inner: u64,
}

/// The walls of a block of cells, brick by brick.
trait Hollow {
    /// The hollow projections of the block in a brick that it reaches into.
    fn projections(&self, brick: IVec3) -> Projections;
}

impl Hollow for CellBox {
    fn projections(&self, brick: IVec3) -> Projections {
        let [x, y, z] = [0, 1, 2].map(|axis| Extent::new(self, brick, axis));
        let (y_rows, z_rows) = (y.rows(), z.rows());
        Projections { xy: x.hollow(y_rows), xz: x.hollow(z_rows), yz: y.hollow(z_rows) }
    }
}

/// Puts bit i of a byte at bit 8i.
fn spread(byte: u64) -> u64 {
    // Byte i keeps bit i, which the sum carries into bit 7 wherever it was.
    let own = byte.wrapping_mul(0x0101_0101_0101_0101) & 0x8040_2010_0804_0201;
    (own + 0x7f7f_7f7f_7f7f_7f7f) >> 7 & 0x0101_0101_0101_0101
}

/// The three projections inside one brick; bit 8 * second + first axis.
#[derive(Clone, Copy, Default)]
struct Projections {
    xy: u64,
    xz: u64,
    yz: u64,
}

impl Projections {
    fn union(self, o: Self) -> Self {
        Self { xy: self.xy | o.xy, xz: self.xz | o.xz, yz: self.yz | o.yz }
    }

    /// The cells of a tile that are in at least two of the three projections.
    fn tile(&self, axes: &SideAxes, at: i32) -> u64 {
        let at = (at & 7) as u32;
        let row = |tile: u64| (tile >> (8 * at) & 0xff).wrapping_mul(0x0101_0101_0101_0101);
        let row_up = |tile: u64| spread(tile >> (8 * at) & 0xff) * 0xff;
        let column = |tile: u64| (tile >> at & 0x0101_0101_0101_0101) * 0xff;
        let column_across = |tile: u64| {
            let byte = (tile >> at & 0x0101_0101_0101_0101).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            byte.wrapping_mul(0x0101_0101_0101_0101)
        };
        let (a, b, c) = match axes.normal {
            // Rows z, columns y.
            0 => (self.yz, column_across(self.xy), column(self.xz)),
            // Rows z, columns x.
            1 => (self.xz, row(self.xy), column(self.yz)),
            // Rows y, columns x.
            _ => (self.xy, row(self.xz), row_up(self.yz)),
        };
        (a & b) | (b & c) | (a & c)
    }
}

#[derive(Clone, Default)]
struct TbvBrick {
    /// Union of the projections of the volumes. After removals it may contain more.
    all: Projections,
    held: Vec<Held>,
}

/// A volume in the list of a brick.
#[derive(Clone, Copy)]
struct Held {
    slot: Slot,
    /// The brick's place among those that the volume reaches into.
    brick: u32,
}

/// Txy, Txz and Tyz: the projections of hollow temporal bounding volumes.
#[derive(Clone, Default)]
pub struct TbvMatrix {
    bricks: Bricks<TbvBrick>,
    /// By slot: its places in the lists of its bricks, so that it leaves them at once.
    places: Vec<Vec<u32>>,
    volumes: usize,
}

impl TbvMatrix {
    /// Draws the volume of an object.
    pub(crate) fn insert(&mut self, volume: &CellBox, slot: Slot) {
        self.volumes += 1;
        if self.places.len() <= slot.index() {
            self.places.resize_with(slot.index() + 1, Vec::new);
        }
        let Self { bricks, places, .. } = self;
        let places = &mut places[slot.index()];
        for b in volume.bricks().cells() {
            let brick = bricks.get_mut(b);
            brick.all = brick.all.union(volume.projections(b));
            brick.held.push(Held { slot, brick: places.len() as u32 });
            places.push(brick.held.len() as u32 - 1);
        }
    }

    /// Erases a volume drawn before. The cost grows with its bricks, not with the other volumes in
    /// them.
    pub(crate) fn remove(&mut self, volume: &CellBox, slot: Slot) {
        self.volumes -= 1;
        let mut places = std::mem::take(&mut self.places[slot.index()]);
        let mut next = places.iter();
        for b in volume.bricks().cells() {
            let (Some(&place), Some(brick)) = (next.next(), self.bricks.get_existing_mut(b)) else { break };
            brick.held.swap_remove(place as usize);
            if let Some(moved) = brick.held.get(place as usize) {
                self.places[moved.slot.index()][moved.brick as usize] = place;
            }
            if brick.held.is_empty() {
                self.bricks.release(b);
            }
        }
        places.clear();
        self.places[slot.index()] = places;
    }

    /// The cells of a tile on the surface of some volume (a superset).
    #[inline]
    pub(crate) fn tile(&self, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        let b = self.bricks.get(brick);
        if b.held.is_empty() { 0 } else { b.all.tile(axes, at) }
    }

    /// A block around the cells of a brick on the surface of some volume; `None` if there are none.
    pub(crate) fn extent(&self, brick: IVec3) -> Option<CellBox> {
        let TbvBrick { all, held } = self.bricks.get(brick);
        // Inside of all that it lists there is no surface.
        if held.is_empty() || all.xy | all.xz | all.yz == 0 {
            return None;
        }
        let columns = |tile: u64| (0..8).fold(0, |sum, row| sum | (tile >> (8 * row) & 0xff));
        let rows = |tile: u64| (0..8).map(|row| u64::from(tile >> (8 * row) & 0xff != 0) << row).sum::<u64>();
        let used =
            [columns(all.xy) | columns(all.xz), rows(all.xy) | columns(all.yz), rows(all.xz) | rows(all.yz)];
        let lo = IVec3::from_array(used.map(|u| u.trailing_zeros().min(7) as i32));
        let hi = IVec3::from_array(used.map(|u| 63 - (u | 1).leading_zeros() as i32));
        let corner = brick * BRICK;
        Some(CellBox { lo: corner + lo, hi: corner + hi })
    }

    /// The objects whose volumes reach into a brick.
    pub(crate) fn ids(&self, brick: IVec3) -> impl ExactSizeIterator<Item = Slot> {
        self.bricks.get(brick).held.iter().map(|h| h.slot)
    }

    /// The bricks that volumes reach into.
    pub(crate) fn bricks(&self) -> impl Iterator<Item = IVec3> {
        self.bricks.iter().filter(|(_, brick)| !brick.held.is_empty()).map(|(at, _)| at)
    }

    /// The pages that volumes reach into.
    pub(crate) fn pages(&self) -> &Pages {
        self.bricks.pages()
    }

    /// The cells of a tile on the surface of one volume.
    pub(crate) fn surface_tile(volume: &CellBox, brick: IVec3, axes: &SideAxes, at: i32) -> u64 {
        volume.projections(brick).tile(axes, at)
    }

    /// Number of volumes drawn.
    pub fn volumes(&self) -> usize {
        self.volumes
    }

    /// Bytes of memory that the matrix uses.
    pub fn bytes(&self) -> usize {
        let lists = self.bricks.iter().map(|(_, b)| b.held.capacity() * size_of::<Held>());
        let places = self.places.iter().map(|p| p.capacity() * 4);
        let own = self.places.capacity() * size_of::<Vec<u32>>();
        self.bricks.bytes() + lists.sum::<usize>() + own + places.sum::<usize>()
    }
}

impl std::fmt::Debug for TbvMatrix {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "TbvMatrix({} volumes)", self.volumes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_of_three_projections_make_the_surface() {
        let boxes = [
            CellBox { lo: IVec3::new(3, 5, 6), hi: IVec3::new(20, 17, 9) },
            CellBox { lo: IVec3::new(0, 0, 0), hi: IVec3::new(23, 23, 23) },
            CellBox { lo: IVec3::new(9, 8, 7), hi: IVec3::new(9, 8, 7) },
            CellBox { lo: IVec3::new(1, 2, 3), hi: IVec3::new(2, 3, 4) },
        ];
        for volume in &boxes {
            let mut m = TbvMatrix::default();
            m.insert(volume, Slot::new(5));
            for axes in &SideAxes::ALL {
                for i in 0..24 * 24 * 24 {
                    let c = IVec3::new(i % 24, i / 24 % 24, i / 576);
                    let inner = c.cmpgt(volume.lo).all() && c.cmplt(volume.hi).all();
                    let surface = volume.contains(c) && !inner;
                    let bit = 8 * (c[axes.row] & 7) + (c[axes.col] & 7);
                    let tile = TbvMatrix::surface_tile(volume, c >> 3i32, axes, c[axes.normal]);
                    assert_eq!(tile >> bit & 1 != 0, surface, "{volume:?} {axes:?} {c}");
                    let tile = m.tile(c >> 3i32, axes, c[axes.normal]);
                    assert_eq!(tile >> bit & 1 != 0, surface, "{volume:?} {axes:?} {c}");
                }
            }
            m.remove(volume, Slot::new(5));
            assert_eq!((m.volumes(), m.bricks.iter().count()), (0, 0));
        }
    }

    #[test]
    fn volumes_leave_in_any_order() {
        let mut m = TbvMatrix::default();
        let volume = |slot: Slot| {
            let i = slot.get() as i32;
            let lo = IVec3::new(i * 7 % 23, i * 5 % 19, i * 3 % 17);
            CellBox { lo, hi: lo + IVec3::new(9 + i % 5, 12, 3 + i % 30) }
        };
        let holds = |m: &TbvMatrix, slot: Slot| {
            let (mut held, mut all) = (0, 0);
            for b in volume(slot).bricks().cells() {
                held += usize::from(m.ids(b).any(|s| s == slot));
                all += 1;
            }
            (held, all)
        };
        let mut inside: Vec<Slot> = Slot::below(60).collect();
        inside.iter().for_each(|&s| m.insert(&volume(s), s));
        for step in 0..200usize {
            if step % 3 == 2 && inside.len() < 60 {
                let new = Slot::below(60).find(|s| !inside.contains(s)).unwrap();
                m.insert(&volume(new), new);
                inside.push(new);
            } else if !inside.is_empty() {
                let gone = inside.swap_remove(step * 31 % inside.len());
                m.remove(&volume(gone), gone);
                assert_eq!(holds(&m, gone).0, 0);
            }
            assert_eq!(m.volumes(), inside.len());
            for &s in &inside {
                let (held, all) = holds(&m, s);
                assert_eq!(held, all);
            }
        }
        inside.iter().for_each(|&s| m.remove(&volume(s), s));
        assert_eq!(m.bricks.iter().count(), 0);
    }
}

//! Finds the volumes that contain a cell.

use casca_slots::Slot;
use glam::IVec3;
use hashbrown::HashMap;

use crate::grid::cell_box::CellBox;
use crate::heap::in_table;

/// The volumes of one level by the place of their centre.
type Level = HashMap<[i32; 3], Vec<Slot>>;

/// Finds the volumes that contain a cell, to keep the rule that a hollow volume
/// must not contain the viewer: a volume of up to 2^level cells is filed by its
/// centre in a hash grid of that pitch, so that 8 places a level are looked up.
#[derive(Clone, Default)]
pub(super) struct Containing {
    levels: Vec<Level>,
    /// By slot: its place in its list, so that it leaves it at once.
    places: Vec<u32>,
}

fn level_and_key(volume: &CellBox) -> (usize, [i32; 3]) {
    let size = (volume.hi - volume.lo).max_element() as u32 + 1;
    let level = size.next_power_of_two().trailing_zeros() as usize;
    (level, (((volume.lo + volume.hi) >> 1i32) >> level as i32).to_array())
}

impl Containing {
    pub(super) fn insert(&mut self, volume: &CellBox, slot: Slot) {
        let (level, key) = level_and_key(volume);
        if self.levels.len() <= level {
            self.levels.resize_with(level + 1, Level::new);
        }
        if self.places.len() <= slot.index() {
            self.places.resize(slot.index() + 1, 0);
        }
        let list = self.levels[level].entry(key).or_default();
        self.places[slot.index()] = list.len() as u32;
        list.push(slot);
    }

    pub(super) fn remove(&mut self, volume: &CellBox, slot: Slot) {
        let (level, key) = level_and_key(volume);
        let Some(map) = self.levels.get_mut(level) else { return };
        let Some(list) = map.get_mut(&key) else { return };
        let place = self.places[slot.index()];
        list.swap_remove(place as usize);
        if let Some(&moved) = list.get(place as usize) {
            self.places[moved.index()] = place;
        }
        if list.is_empty() {
            map.remove(&key);
        }
    }

    /// Calls `found` for a superset of the volumes that contain a cell.
    pub(super) fn find(&self, cell: IVec3, mut found: impl FnMut(Slot)) {
        for (level, map) in self.levels.iter().enumerate() {
            if map.is_empty() {
                continue;
            }
            // A volume reaches at most 2^(level-1) cells from its centre, rounded up.
            let half = (1 << level >> 1i32) + 1;
            let (a, b) = ((cell - half) >> level as i32, (cell + half) >> level as i32);
            for z in a.z..=b.z {
                for y in a.y..=b.y {
                    for x in a.x..=b.x {
                        if let Some(list) = map.get(&[x, y, z]) {
                            list.iter().for_each(|&s| found(s));
                        }
                    }
                }
            }
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let table = |m: &Level| in_table::<([i32; 3], Vec<Slot>)>(m.capacity());
        let lists = self.levels.iter().flat_map(Level::values).map(|list| list.capacity() * 4);
        self.levels.capacity() * size_of::<Level>()
            + self.levels.iter().map(table).sum::<usize>()
            + lists.sum::<usize>()
            + self.places.capacity() * 4
    }
}

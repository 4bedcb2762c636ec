//! Finds the volumes that contain a cell, to keep the rule that a hollow volume must not contain
//! the viewer.

use std::collections::HashMap;

use casca_slots::Slot;
use glam::IVec2;

use crate::volume::tbv::Tbv;

/// The volumes of one level by the place of their centre. Never iterated.
type Level = HashMap<IVec2, Vec<(Slot, Tbv)>>;

/// A volume of up to 2^level cells along an axis is filed by its centre in squares of that size, so
/// that four squares a level are looked up. Volumes of one square are looked through one by one.
#[derive(Debug, Clone, Default)]
pub(super) struct Containing {
    levels: Vec<Level>,
}

fn level_and_key(tbv: &Tbv) -> (usize, IVec2) {
    let (center, size) = tbv.place();
    let level = size.next_power_of_two().trailing_zeros();
    (level as usize, center >> level as i32)
}

impl Containing {
    pub(super) fn insert(&mut self, tbv: &Tbv, slot: Slot) {
        let (level, key) = level_and_key(tbv);
        if self.levels.len() <= level {
            self.levels.resize_with(level + 1, Level::new);
        }
        self.levels[level].entry(key).or_default().push((slot, *tbv));
    }

    pub(super) fn remove(&mut self, tbv: &Tbv, slot: Slot) {
        let (level, key) = level_and_key(tbv);
        let Some(map) = self.levels.get_mut(level) else { return };
        let Some(list) = map.get_mut(&key) else { return };
        if let Some(at) = list.iter().rposition(|(other, _)| *other == slot) {
            list.swap_remove(at);
        }
        if list.is_empty() {
            map.remove(&key);
        }
    }

    /// Calls `found` with each volume that may contain a cell.
    pub(super) fn find(&self, cell: IVec2, mut found: impl FnMut(Slot)) {
        for (level, map) in self.levels.iter().enumerate().filter(|(_, map)| !map.is_empty()) {
            // The centre is less than half the size away.
            let half = (1 << level) / 2;
            let (lo, hi) = ((cell - half) >> level as i32, (cell + half) >> level as i32);
            for key in (lo.x..=hi.x).flat_map(|x| (lo.y..=hi.y).map(move |y| IVec2::new(x, y))) {
                let list = map.get(&key).into_iter().flatten();
                list.filter(|(_, tbv)| tbv.may_contain(cell)).for_each(|&(slot, _)| found(slot));
            }
        }
    }
}

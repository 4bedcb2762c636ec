//! Opaque cells that several occluders may fill at once.

use std::collections::HashMap;

use glam::UVec2;

use crate::matrix::CrossBits;

/// The cells that occluders fill, O or Os: a cell is opaque while any of them fills it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Opacity {
    bits: CrossBits,
    /// For cells that more than one occluder fills, how many more. Never iterated.
    more: HashMap<(u32, u32), u32>,
}

impl Opacity {
    pub(crate) fn new(dims: UVec2) -> Self {
        Self { bits: CrossBits::new(dims), more: HashMap::new() }
    }

    pub(crate) fn bits(&self) -> &CrossBits {
        &self.bits
    }

    /// One more occluder fills a cell of the grid.
    pub(crate) fn add(&mut self, x: u32, y: u32) {
        if self.bits.get(x, y) {
            *self.more.entry((x, y)).or_default() += 1;
        } else {
            self.bits.set(x, y, true);
        }
    }

    /// One occluder less fills a cell of the grid.
    pub(crate) fn remove(&mut self, x: u32, y: u32) {
        match self.more.get_mut(&(x, y)) {
            None => self.bits.set(x, y, false),
            Some(1) => {
                self.more.remove(&(x, y));
            }
            Some(count) => *count -= 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_stays_opaque_until_the_last_occluder_leaves_it() {
        let mut opacity = Opacity::new(UVec2::new(70, 3));
        for round in 0..3 {
            assert_eq!(opacity.bits().get(65, 2), round > 0);
            opacity.add(65, 2);
        }
        opacity.add(2, 1);
        assert_eq!(opacity.bits().line(0, 65), [1 << 2]);
        assert_eq!(opacity.bits().line(1, 2), [0, 1 << 1]);
        for left in (0..3).rev() {
            opacity.remove(65, 2);
            assert_eq!(opacity.bits().get(65, 2), left > 0);
        }
        assert_eq!(opacity.bits().cells().collect::<Vec<_>>(), [(2, 1)]);
        assert!(opacity.more.is_empty());
    }
}

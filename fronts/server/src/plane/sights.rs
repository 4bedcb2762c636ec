//! What eyes in a tile see, kept from tick to tick.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use casca_plane::{FieldOfView, FovOptions, OpaqueTiles};
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::ServerError;
use crate::plane::ground::Tile;

/// Eyes: a tile, and the bits of the radius.
pub type Key = (Tile, u32);

/// Tiles in a part of a map, a bit for each.
#[derive(Debug, Clone, Default)]
pub struct Window {
    /// Words of a row.
    words: Range<usize>,
    rows: Range<usize>,
    bits: Vec<u64>,
}

impl Window {
    /// What eyes see.
    fn of(fov: &mut FieldOfView, map: &OpaqueTiles, ((x, y), radius): Key) -> Result<Self, ServerError> {
        let options = FovOptions::default().in_circle(f32::from_bits(radius))?;
        fov.run_from_tile(map, x, y, &options)?;
        let (seen, (columns, rows)) = (fov.seen(), fov.bounds());
        let words = columns.start as usize / 64..(columns.end as usize).div_ceil(64);
        let bits = rows.clone().flat_map(|y| seen.row(y)[words.clone()].iter().copied()).collect();
        Ok(Self { words, rows: rows.start as usize..rows.end as usize, bits })
    }

    /// All tiles of some windows.
    pub(crate) fn union(windows: &[&Self]) -> Self {
        let around = |part: fn(&Self) -> &Range<usize>| {
            let all = windows.iter().map(|window| part(window));
            all.cloned().reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or_default()
        };
        let (words, rows) = (around(|window| &window.words), around(|window| &window.rows));
        let mut bits = vec![0; words.len() * rows.len()];
        for window in windows.iter().filter(|window| !window.words.is_empty()) {
            let parts = window.bits.chunks_exact(window.words.len());
            for (y, part) in window.rows.clone().zip(parts) {
                let at = (y - rows.start) * words.len() + window.words.start - words.start;
                bits[at..].iter_mut().zip(part).for_each(|(to, from)| *to |= from);
            }
        }
        Self { words, rows, bits }
    }

    pub(crate) fn has(&self, (x, y): Tile) -> bool {
        let (word, row) = (x as usize / 64, y as usize);
        if !self.words.contains(&word) || !self.rows.contains(&row) {
            return false;
        }
        let at = (row - self.rows.start) * self.words.len() + word - self.words.start;
        self.bits[at] >> (x % 64) & 1 == 1
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + self.bits.len() * 8
    }
}

/// What eyes see, by their tile and radius.
#[derive(Debug, Default)]
pub(crate) struct Sights {
    /// With the tick that last asked for it.
    kept: BTreeMap<Key, (u64, Window)>,
    bytes: usize,
}

impl Sights {
    /// Finds what is not known of some eyes. Forgets what was not asked for the longest, if all
    /// takes more than `memory` bytes.
    pub(crate) fn find(
        &mut self,
        map: &OpaqueTiles,
        eyes: &BTreeSet<Key>,
        tick: u64,
        memory: usize,
    ) -> Result<(), ServerError> {
        let mut unknown: Vec<Key> = Vec::new();
        for key in eyes {
            match self.kept.get_mut(key) {
                Some((last, _)) => *last = tick,
                None => unknown.push(*key),
            }
        }
        let run = |fov: &mut FieldOfView, key: Key| Ok((key, Window::of(fov, map, key)?));
        #[cfg(feature = "rayon")]
        let found = unknown.into_par_iter().map_init(FieldOfView::new, run);
        #[cfg(not(feature = "rayon"))]
        let found = {
            let mut fov = FieldOfView::new();
            unknown.into_iter().map(move |key| run(&mut fov, key))
        };
        for (key, window) in found.collect::<Result<Vec<_>, ServerError>>()? {
            self.bytes += window.bytes();
            self.kept.insert(key, (tick, window));
        }
        if self.bytes > memory {
            let mut old: Vec<(u64, Key)> = self.kept.iter().map(|(key, (last, _))| (*last, *key)).collect();
            old.sort_unstable();
            for (_, key) in old.into_iter().take_while(|(last, _)| *last < tick) {
                if self.bytes <= memory {
                    break;
                }
                self.bytes -= self.kept.remove(&key).map_or(0, |(_, window)| window.bytes());
            }
        }
        Ok(())
    }

    /// What some eyes see, if it was found.
    pub(crate) fn get(&self, key: &Key) -> Option<&Window> {
        self.kept.get(key).map(|(_, window)| window)
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use casca_plane::BitGrid;

    use super::*;

    #[test]
    fn a_union_has_what_any_window_has_and_no_more() {
        // Two walls, so that windows begin at different words and rows.
        let mut walls = BitGrid::new(300, 12);
        (0..12).for_each(|y| [70, 140].into_iter().for_each(|x| walls.set(x, y, true)));
        walls.fill(5, 0..300);
        let map = OpaqueTiles::new(walls);
        let mut fov = FieldOfView::new();
        let mut window = |x, y| Window::of(&mut fov, &map, ((x, y), f32::INFINITY.to_bits())).unwrap();
        let all = [window(200, 8), window(100, 2), window(290, 9)];
        let starts = [0, 1, 2].map(|i| (all[i].words.start, all[i].rows.start));
        assert_ne!((starts[0].0, starts[0].1), (0, 0), "{starts:?}");
        assert!(starts[0].0 != starts[1].0, "{starts:?}");
        for some in [&all[..], &all[..1], &all[1..2], &[]] {
            let union = Window::union(&some.iter().collect::<Vec<_>>());
            let tiles = (0..12).flat_map(|y| (0..300).map(move |x| (x, y)));
            let right = |tile| union.has(tile) == some.iter().any(|window| window.has(tile));
            assert!(tiles.into_iter().all(right));
        }
        assert!(all[0].has((200, 8)) && all[1].has((100, 2)) && !all[0].has((100, 2)));
    }
}

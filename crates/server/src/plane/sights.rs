//! What eyes in a tile see, kept from tick to tick.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use casca_plane::{FieldOfView, FovOptions, OpaqueTiles};
#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::error::ServerError;
use crate::plane::ground::Tile;

/// Eyes: a tile, and the bits of the radius.
pub(crate) type Key = (Tile, u32);

/// Tiles in a part of a map, a bit for each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Window {
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

    /// Bytes that all takes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

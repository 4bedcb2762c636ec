//! The pixels of a tile.

use std::sync::atomic::{AtomicU32, Ordering};

use casca_scenes::world::Shape;
use glam::DVec3;

use super::super::geometry::safe_inverse;
use super::frame::{AREA, Entry, Frame, NONE, TILE};
use super::trace::{Area, trace};

/// The pixels being drawn.
pub(super) struct Tile {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) depth: [f64; AREA],
    pub(super) index: [u32; AREA],
    /// Pixels without an occluder.
    pub(super) bare: usize,
    /// No pixel is farther than this.
    pub(super) farthest: f64,
    /// Draws since `farthest` was found.
    pub(super) age: u32,
    /// One over the steps of the rays, once `inverted`.
    pub(super) inverse: Box<[DVec3; AREA]>,
    pub(super) inverted: bool,
}

impl Tile {
    pub(super) fn new() -> Self {
        Self {
            x: 0,
            y: 0,
            columns: 0,
            rows: 0,
            depth: [f64::INFINITY; AREA],
            index: [NONE; AREA],
            bare: 0,
            farthest: f64::INFINITY,
            age: 0,
            inverse: Box::new([DVec3::ZERO; AREA]),
            inverted: false,
        }
    }

    pub(super) fn reset(&mut self, x: usize, y: usize, width: usize, height: usize) {
        self.x = x;
        self.y = y;
        self.columns = TILE.min(width - x);
        self.rows = TILE.min(height - y);
        self.depth.fill(f64::INFINITY);
        self.index.fill(NONE);
        self.bare = self.columns * self.rows;
        self.farthest = f64::INFINITY;
        self.age = 7;
        self.inverted = false;
    }

    /// Draws an occluder.
    pub(super) fn draw(&mut self, frame: &Frame, entry: &Entry) {
        self.prepare(frame, entry);
        let object = entry.object;
        let Self { depth, index, bare, inverse, .. } = self;
        let area = Area { x: self.x, y: self.y, columns: self.columns, rows: self.rows };
        trace(&area, inverse, frame, entry, |pixel, t| {
            let old = depth[pixel];
            if t < old || (t == old && object < index[pixel]) {
                *bare -= usize::from(index[pixel] == NONE);
                depth[pixel] = t;
                index[pixel] = object;
            }
        });
        if self.bare == 0 {
            self.age += 1;
            if self.age >= 8 {
                self.age = 0;
                self.farthest = (0..self.rows)
                    .flat_map(|y| &self.depth[y * TILE..y * TILE + self.columns])
                    .fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a });
            }
        }
    }

    /// Computes what boxes need.
    pub(super) fn prepare(&mut self, frame: &Frame, entry: &Entry) {
        if self.inverted || !matches!(frame.objects[entry.object as usize].shape, Shape::Box { .. }) {
            return;
        }
        self.inverted = true;
        for y in 0..self.rows {
            for x in 0..self.columns {
                self.inverse[y * TILE + x] = safe_inverse(frame.rays.step(self.x + x, self.y + y));
            }
        }
    }

    /// Counts the pixels of the occluders.
    pub(super) fn count(&self, counts: &[AtomicU32]) {
        for y in 0..self.rows {
            for run in self.index[y * TILE..y * TILE + self.columns].chunk_by(|a, b| a == b) {
                if run[0] != NONE {
                    counts[run[0] as usize].fetch_add(run.len() as u32, Ordering::Relaxed);
                }
            }
        }
    }

    /// Counts the pixels of what does not hide, once the occluders are drawn.
    pub(super) fn show(&mut self, frame: &Frame, entries: &[Entry], list: &[u32], counts: &[AtomicU32]) {
        let area = Area { x: self.x, y: self.y, columns: self.columns, rows: self.rows };
        for group in list.chunk_by(|&a, &b| entries[a as usize].object == entries[b as usize].object) {
            let mut seen = [false; AREA];
            for &i in group {
                let entry = &entries[i as usize];
                self.prepare(frame, entry);
                let (depth, inverse) = (&self.depth, &self.inverse);
                trace(&area, inverse, frame, entry, |pixel, t| seen[pixel] |= t <= depth[pixel]);
            }
            let count = seen.iter().filter(|&&seen| seen).count() as u32;
            if count > 0 {
                counts[entries[group[0] as usize].object as usize].fetch_add(count, Ordering::Relaxed);
            }
        }
    }
}

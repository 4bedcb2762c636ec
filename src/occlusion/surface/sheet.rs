//! Tiles that patches cover, by the marks of their outlines.

use std::ops::Range;

use fearless_simd::f32x4;
use fearless_simd::prelude::*;

use crate::numeric::occlusion::below;
use crate::occlusion::coverage::Coverage;
use crate::occlusion::surface::back::Back;
use crate::occlusion::surface::raster::{Area, COLUMNS, Head, PixelMarks, Raster, TILES, tiles};
use crate::occlusion::tiles::{TILE, bits};

/// A rectangle of tiles of a face, and what covers them.
pub(crate) struct Sheet<'a> {
    pub(crate) coverage: &'a mut Coverage,
    /// The place of its first tile there. Rows of tiles follow each other.
    pub(crate) base: usize,
    /// Its first tile and the number of tiles, in both directions.
    pub(crate) first: (i64, i64),
    pub(crate) count: (i64, i64),
    /// The width of a tile on the face.
    pub(crate) step: f64,
}

/// The marks of the patches of one component.
#[derive(Debug, Clone, Default)]
pub(super) struct Joint {
    area: Area,
    /// The blocks in use, and for each block whether it is. Others hold anything.
    used: Vec<u32>,
    is_used: Vec<bool>,
    blocks: Vec<PixelMarks>,
    /// The least nearness of the patches in each tile.
    nears: Vec<[f32; TILES]>,
}

impl Joint {
    #[inline(always)]
    pub(super) fn clear(&mut self, area: Area) {
        self.used.drain(..).for_each(|at| self.is_used[at as usize] = false);
        self.area = area;
        let count = area.block_count();
        if self.blocks.len() < count {
            self.is_used.resize(count, false);
            self.blocks.resize(count, PixelMarks::NONE);
            self.nears.resize(count, [f32::INFINITY; TILES]);
        }
    }

    /// Adds the marks of a patch in a block of an area inside. Returns the nearness of its tiles.
    #[inline(always)]
    fn add(&mut self, inside: &Area, (row, column): (i64, i64), marks: &PixelMarks) -> &mut [f32; TILES] {
        let at = self.area.block(inside, row, column);
        if std::mem::replace(&mut self.is_used[at], true) {
            self.blocks[at].add(marks);
        } else {
            self.used.push(at as u32);
            self.blocks[at] = *marks;
            self.nears[at] = [f32::INFINITY; TILES];
        }
        &mut self.nears[at]
    }
}

impl Sheet<'_> {
    /// The place of the first tile of a block, and which of its tiles the sheet has, one bit each.
    #[inline(always)]
    fn place(&self, area: &Area, row: i64, column: i64) -> (usize, u32) {
        let left = area.x / TILE + column * TILES as i64 - self.first.0;
        let low = area.y / TILE + row - self.first.1;
        let (from, to) = ((-left).clamp(0, TILES as i64), (self.count.0 - left).clamp(0, TILES as i64));
        let is_beside = low < 0 || low >= self.count.1;
        // Where the block begins left of the sheet, the sum is right all the same.
        let tile = self.base.wrapping_add_signed((low * self.count.0 + left) as isize);
        (tile, if is_beside { 0 } else { 0xf << from & 0xf >> (TILES as i64 - to) })
    }

    /// Which of some tiles of a block are not covered nearer than a nearness.
    #[inline(always)]
    fn open<S: Simd>(&self, simd: S, (tile, own): (usize, u32), near: f32) -> u32 {
        match self.coverage.closed_four(tile) {
            Some(closed) => own & f32x4::from_slice(simd, closed).simd_lt(near).to_bitmask() as u32,
            None => each_bit(own)
                .filter(|i| self.coverage.closed(tile.wrapping_add(*i)) < near)
                .fold(0, |all, i| all | 1 << i),
        }
    }

    /// How many blocks of pixels its tiles fill.
    pub(super) fn block_count(&self) -> u64 {
        (self.count.0 * self.count.1) as u64 / TILES as u64
    }

    /// The left or lower border of a tile on the face.
    #[inline(always)]
    fn border(&self, at: i64) -> f64 {
        at as f64 * self.step - 1.0
    }

    /// Covers the pixels of one patch, of which no point is nearer than `near`, and adds its marks
    /// to those of its component. Pixels that rims touch stay open. Returns whether any hides more
    /// than before, and how many blocks of pixels it went through.
    #[inline(always)]
    pub(super) fn cover_patch<S: Simd>(
        &mut self,
        simd: S,
        raster: &Raster,
        (near, back): (f32, &Back),
        rims: Option<&Raster>,
        mut joint: Option<&mut Joint>,
    ) -> (bool, u64) {
        let area = raster.area();
        let (mut changed, mut blocks) = (false, 0);
        for row in 0..area.ny {
            let Range { start, mut end } = raster.columns(row as usize);
            let (mut before, mut column) = (Head::default(), start);
            let planes = back.row(self.border(area.y / TILE + row), self.step);
            while column < end {
                let (block, here) = (row as usize * area.nx as usize + column, column as i64);
                column += 1;
                blocks += 1;
                let head = raster.head(block);
                before.add(head);
                if !head.is_marked() && before.is_zero() {
                    continue;
                }
                if column == end {
                    // An outline may go around the rest of the row: no edge is there.
                    end = if before.is_zero() { end } else { area.nx as usize };
                }
                let (tile, own) = self.place(area, row, here);
                let mut open = self.open(simd, (tile, own), near);
                if joint.is_none() && open == 0 {
                    continue;
                }
                let (mut words, mut nears) = ([u64::MAX; TILES], None);
                if head.is_marked() || !before.is_full() || rims.is_some() || joint.is_some() {
                    let marks = raster.marks(block).passed(before);
                    words = tiles(&closed_to_rims(marks.covered(), rims, area, (row, here)));
                    let mut marked = with_bits(&words);
                    if let Some(joint) = &mut joint {
                        marked = with_bits(&marks.marked_columns().to_le_bytes().map(u64::from));
                        let of = joint.add(area, (row, here), &marks);
                        // Seams with those that are covered nearer need not be closed.
                        each_bit(own & marked & !open).for_each(|i| of[i] = f32::NEG_INFINITY);
                        nears = Some(of);
                    }
                    open &= marked;
                }
                if open == 0 {
                    continue;
                }
                let first = (area.x / TILE + here * TILES as i64) as f64;
                let behind = back.behind(simd, &planes, first, self.step);
                for i in each_bit(open) {
                    let near = below(behind.near[i]);
                    if words[i] != 0 {
                        let plane = back.plane(behind.plane[i]);
                        changed |= self.coverage.cover_behind(tile.wrapping_add(i), words[i], near, plane);
                    }
                    if let Some(nears) = &mut nears {
                        nears[i] = nears[i].min(near);
                    }
                }
            }
        }
        (changed, blocks)
    }

    /// Covers the pixels that only seams between the patches of a component touch.
    #[inline(always)]
    pub(super) fn cover_seams(&mut self, rims: Option<&Raster>, joint: &Joint) -> bool {
        let area = &joint.area;
        let mut changed = false;
        for at in joint.used.iter().map(|&at| at as usize) {
            let (row, column) = (at as i64 / area.nx, at as i64 % area.nx);
            let words = tiles(&closed_to_rims(joint.blocks[at].covered_seams(), rims, area, (row, column)));
            let (tile, own) = self.place(area, row, column);
            for i in each_bit(own & with_bits(&words)) {
                let near = joint.nears[at][i];
                changed |= self.coverage.cover_behind(tile.wrapping_add(i), words[i], near, None);
            }
        }
        changed
    }
}

/// The numbers of the set bits of a word.
#[inline(always)]
fn each_bit(word: u32) -> impl Iterator<Item = usize> {
    bits(word.into()).map(|bit| bit as usize % TILES)
}

/// Which of four words have bits, one bit each.
#[inline(always)]
fn with_bits(words: &[u64; TILES]) -> u32 {
    words.iter().rev().fold(0, |all, &word| all << 1 | u32::from(word != 0))
}

/// Covered pixels without those that rims touch, in a block of an area inside that of the rims.
#[inline(always)]
fn closed_to_rims(
    mut covered: [u32; 8],
    rims: Option<&Raster>,
    area: &Area,
    (row, column): (i64, i64),
) -> [u32; 8] {
    if let Some(rims) = rims {
        let open = rims.marks(rims.area().block(area, row, column)).open();
        covered.iter_mut().zip(open).for_each(|(covered, open)| *covered &= !open);
    }
    covered
}

const _: () = assert!(COLUMNS == TILES as i64 * TILE, "blocks have whole tiles");

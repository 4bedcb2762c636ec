//! Tiles that patches cover, by the marks of their outlines.

use std::ops::Range;

use fearless_simd::Simd;

use crate::numeric::occlusion::{above, below};
use crate::occlusion::coverage::Coverage;
use crate::occlusion::surface::back::Back;
use crate::occlusion::surface::raster::{Area, COLUMNS, FEW, PixelMarks, Raster, Spans, TILES, tiles};
use crate::occlusion::tiles::TILE;

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
    /// The blocks in use. Others have no marks, whatever they hold.
    spans: Spans,
    blocks: Vec<PixelMarks>,
    /// The least nearness of the patches in each tile.
    nears: Vec<[f32; TILES]>,
}

impl Joint {
    #[inline(always)]
    pub(super) fn clear(&mut self, area: Area) {
        self.area = area;
        let count = area.block_count();
        if self.blocks.len() < count {
            self.blocks.resize(count, PixelMarks::default());
            self.nears.resize(count, [f32::INFINITY; TILES]);
        }
        let all = self.spans.begin(&area);
        self.clear_blocks(all);
    }

    #[inline(always)]
    fn clear_blocks(&mut self, blocks: Range<usize>) {
        self.blocks[blocks.clone()].fill(PixelMarks::default());
        self.nears[blocks].fill([f32::INFINITY; TILES]);
    }

    /// Takes a block of an area inside into use. Returns its place.
    #[inline(always)]
    fn take(&mut self, inside: &Area, row: i64, column: i64) -> usize {
        let (row, column) = self.area.place(inside, row, column);
        for fresh in self.spans.take(row as usize, column as usize, column as usize + 1) {
            if !fresh.is_empty() {
                self.clear_blocks(fresh);
            }
        }
        (row * self.area.nx + column) as usize
    }
}

/// A block of pixels on a sheet: the place of its first tile, that tile's column and row, and the
/// range of its tiles that belong to the sheet.
struct BlockPlace {
    tile: usize,
    column: i64,
    row: i64,
    from: usize,
    to: usize,
}

impl Sheet<'_> {
    /// A block of an area; `None` if the sheet has none of its tiles.
    #[inline(always)]
    fn place(&self, area: &Area, row: i64, column: i64) -> Option<BlockPlace> {
        let (x, y) = (area.x / TILE + column * TILES as i64, area.y / TILE + row);
        let (left, low) = (x - self.first.0, y - self.first.1);
        let from = (-left).max(0);
        let to = (self.count.0 - left).min(TILES as i64);
        if from >= to || low < 0 || low >= self.count.1 {
            return None;
        }
        // Where the block begins left of the sheet, the sum is right all the same.
        let tile = self.base.wrapping_add_signed((low * self.count.0 + left) as isize);
        Some(BlockPlace { tile, column: x, row: y, from: from as usize, to: to as usize })
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
    /// than before.
    #[inline(always)]
    pub(super) fn cover_patch<S: Simd>(
        &mut self,
        simd: S,
        raster: &Raster,
        (near, back): (f32, &Back),
        rims: Option<&Raster>,
        mut joint: Option<&mut Joint>,
    ) -> bool {
        let area = raster.area();
        let mut changed = false;
        // To ask for whole blocks is worth it where patches lie over each other in many.
        let is_wide = area.block_count() > FEW;
        for (row, column) in raster.spans().blocks() {
            let marks = raster.marks_in_use(row, column);
            let (row, column) = (row as i64, column as i64);
            let Some(place) = self.place(area, row, column) else { continue };
            let mut near = near;
            if is_wide {
                let at = (self.border(place.column), self.border(place.row));
                let size = (self.step * TILES as f64, self.step);
                near = near.min(above(back.behind_at_most(simd, at, size)));
                let (first, last) =
                    (place.tile.wrapping_add(place.from), place.tile.wrapping_add(place.to - 1));
                if joint.is_none() && self.coverage.all_closed(first, last, near) {
                    continue;
                }
            }
            let covered = closed_to_rims(marks.covered(), rims, area, (row, column));
            let columns = covered.iter().fold(0, |all, row| all | row);
            let marked = if joint.is_some() { marks.marked_columns() } else { columns };
            if marked == 0 {
                continue;
            }
            let words = if columns == 0 { [0; TILES] } else { tiles(&covered) };
            let mut joint = joint.as_deref_mut().map(|joint| {
                let at = joint.take(area, row, column);
                joint.blocks[at].add(marks);
                &mut joint.nears[at]
            });
            for i in place.from..place.to {
                if marked >> (TILE as usize * i) & 0xff == 0 {
                    continue;
                }
                let tile = place.tile.wrapping_add(i);
                let closed = self.coverage.closed(tile);
                if closed >= near {
                    if let Some(nears) = &mut joint {
                        // Seams with it need not be closed.
                        nears[i] = f32::NEG_INFINITY;
                    }
                    continue;
                }
                let at = (self.border(place.column + i as i64), self.border(place.row));
                let (near, plane) = back.behind(simd, at, self.step);
                let near = below(near);
                if words[i] != 0 && closed < near {
                    changed |= self.coverage.cover_plane(tile, words[i], near, plane);
                }
                if let Some(nears) = &mut joint {
                    nears[i] = nears[i].min(near);
                }
            }
        }
        changed
    }

    /// Covers the pixels that only seams between the patches of a component touch.
    #[inline(always)]
    pub(super) fn cover_seams(&mut self, rims: Option<&Raster>, joint: &Joint) -> bool {
        let area = &joint.area;
        let mut changed = false;
        for (row, column) in joint.spans.blocks() {
            let (row, column) = (row as i64, column as i64);
            let at = (row * area.nx + column) as usize;
            let covered = closed_to_rims(joint.blocks[at].covered_seams(), rims, area, (row, column));
            if covered.iter().fold(0, |all, row| all | row) == 0 {
                continue;
            }
            let Some(place) = self.place(area, row, column) else { continue };
            let words = tiles(&covered);
            for (i, &word) in words.iter().enumerate().take(place.to).skip(place.from) {
                let (tile, near) = (place.tile.wrapping_add(i), joint.nears[at][i]);
                if word != 0 && self.coverage.closed(tile) < near {
                    changed |= self.coverage.cover(tile, word, near);
                }
            }
        }
        changed
    }
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

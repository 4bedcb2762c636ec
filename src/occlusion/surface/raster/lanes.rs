//! Eight edges at a time, in single precision; each in eight rows at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, i32x8, mask32x8, u32x8};

use crate::numeric::occlusion::{ACROSS_AREA, FAR_PIXEL, FLAT, NEAREST_INTEGER_SINGLE};
use crate::numeric::{greater, lesser};
use crate::occlusion::surface::raster::edges::{Edges, LANES, Lanes};
use crate::occlusion::surface::raster::marks::{PixelMarks, Windings, from_column};
use crate::occlusion::surface::raster::{COLUMNS, Raster};

/// Edges ready to be drawn, from their lower to their upper ends. Columns and rows in whole numbers
/// are counted from the corner of the area.
struct EdgeLanes {
    /// Column and row of the lower end; of edges nearly parallel to the rows, the first column.
    x: Lanes,
    y: Lanes,
    /// Columns for each row; 0 for those.
    slope: Lanes,
    /// How far left of the column where it passes the middle of a row the columns begin that it
    /// touches there, and how far right they end: half a column more and less than the same.
    before: Lanes,
    after: Lanes,
    /// Half a column left of the columns between which it stays.
    left: Lanes,
    right: Lanes,
    /// How far the column may be off where it passes a row.
    unsure: Lanes,
    /// Where it is farther than this from the middle between two columns, it is known on which side
    /// of the middle of a pixel it passes a row.
    sure: Lanes,
    /// The first and last row of the area that it touches.
    first: [i32; LANES],
    last: [i32; LANES],
    /// It passes the middles of the rows from one up to before the other.
    from: [i32; LANES],
    to: [i32; LANES],
    /// The first and last column that it touches.
    low: [i32; LANES],
    high: [i32; LANES],
    /// Those that touch the area or pass left of it, one bit each.
    drawn: u8,
    /// Those of them that stay in one block of the area, and pass rows only there.
    inside: u8,
    /// Those that make winding numbers to their right fall.
    falls: u8,
    /// Seams that two patches agree about, and those of them of which it must be known where they
    /// pass rows.
    seams: u8,
    doubted: u8,
}

impl EdgeLanes {
    #[inline(always)]
    fn new<S: Simd>(simd: S, e: &Edges, raster: &Raster, fall: bool) -> Self {
        let load = |lanes: &Lanes| f32x8::from_slice(simd, lanes);
        let splat = |v: f32| f32x8::splat(simd, v);
        let (x0, y0, x1, y1) = (load(&e.x0), load(&e.y0), load(&e.x1), load(&e.y1));
        let (wide, unsure) = (load(&e.wide), load(&e.unsure));
        let up = y0.simd_le(y1);
        let (x, to_x) = (up.select(x0, x1), up.select(x1, x0));
        let (y, to_y) = (up.select(y0, y1), up.select(y1, y0));
        let slope = (to_x - x) / (to_y - y);
        let steep = slope.abs();
        // Not if it is NaN.
        let is_slanted = steep.simd_lt(FLAT);
        let half = is_slanted.select(steep * 0.5 + (wide * steep + wide), splat(ACROSS_AREA));
        let unsure = is_slanted.select(unsure * steep + unsure, splat(ACROSS_AREA));
        let left = x.min(to_x) - wide - 0.5;
        let right = x.max(to_x) + wide - 0.5;
        let (width, height) = (raster.area.width(), raster.area.height());
        let row = |y: f32x8<S>| nearest_lanes(y) - raster.corner.1;
        let column = |x: f32x8<S>| nearest_lanes(x) - raster.corner.0;
        let (first, last) = (row(y - wide - 0.5), row(to_y + wide - 0.5));
        let (from, to) = (row(y), row(to_y));
        let (low, high) = (column(left), column(right));
        let is_near = last.simd_ge(0) & first.simd_lt(height) & low.simd_lt(width);
        // Two patches may not agree where a flat edge passes a row.
        let is_agreed = is_slanted | from.simd_ge(to);
        // One column more: it may pass rows there.
        let is_inside = first.simd_ge(0)
            & last.simd_lt(height)
            & low.simd_ge(0)
            & high.simd_lt(width - 1)
            & ((first ^ last) & !(LANES as i32 - 1)).simd_eq(0)
            & ((low ^ (high + 1)) & !(COLUMNS as i32 - 1)).simd_eq(0);
        let [up, slanted, near, inside, agreed] =
            [up, is_slanted, is_near, is_inside, is_agreed].map(|m| m.to_bitmask() as u8);
        let store = |v: f32x8<S>| -> Lanes { v.into() };
        let whole = |v: i32x8<S>| -> [i32; LANES] { v.into() };
        Self {
            x: store(is_slanted.select(x, left + 0.5)),
            y: store(y),
            slope: store(is_slanted.select(slope, splat(0.0))),
            before: store(half + 0.5),
            after: store(half - 0.5),
            left: store(left),
            right: store(right),
            unsure: store(unsure),
            sure: store(-unsure + 0.5),
            first: whole(first.max(i32x8::splat(simd, 0))),
            last: whole(last.min(i32x8::splat(simd, height - 1))),
            from: whole(from),
            to: whole(to),
            low: whole(low),
            high: whole(high),
            drawn: near & e.plain,
            inside: near & inside & e.plain,
            falls: if fall { up } else { !up },
            seams: e.seams & agreed,
            doubted: e.seams & slanted,
        }
    }

    /// The column where an edge passes the middle of a row, which is given in rows of the face.
    #[inline(always)]
    fn at(&self, i: usize, middle: f32) -> f32 {
        self.x[i] + (middle - self.y[i]) * self.slope[i]
    }
}

impl Raster {
    /// Draws edges of an outline. Going up, they make the winding numbers to their right grow by
    /// one, or fall.
    #[inline(always)]
    pub(crate) fn edges<S: Simd>(&mut self, simd: S, edges: &Edges, fall: bool) {
        let lines = EdgeLanes::new(simd, edges, self, fall);
        let mut lanes = lines.inside;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            self.line_inside(simd, &lines, i);
        }
        let mut lanes = lines.drawn & !lines.inside;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            for block in lines.first[i] as usize / LANES..=lines.last[i] as usize / LANES {
                self.line(simd, &lines, i, block);
            }
        }
    }

    /// Draws one edge that stays in one block: as [`Raster::line`], with less to ask.
    #[inline(always)]
    fn line_inside<S: Simd>(&mut self, simd: S, l: &EdgeLanes, i: usize) {
        let (top, column) = (l.first[i] & !(LANES as i32 - 1), l.low[i] & !(COLUMNS as i32 - 1));
        let (row, from) = ((top / LANES as i32) as usize, (column / COLUMNS as i32) as usize);
        self.take(row, from, (from + 2).min(self.across));
        let block = row * self.across + from;
        let Some(marks) = self.blocks.get_mut(block) else { return };
        let left = self.corner.0 + column;
        let rows = i32x8::from_slice(simd, &ROWS) + top;
        let middles = f32x8::from_slice(simd, &MIDDLES) + (top + self.corner.1) as f32;
        let at = (middles - l.y[i]) * l.slope[i] + l.x[i];
        // The first and the last column that it touches, and where it passes the row: in the rows
        // that count they are columns of the block.
        let begin = nearest_lanes((at - l.before[i]).max(f32x8::splat(simd, l.left[i]))) - left;
        let end = nearest_lanes((at + l.after[i]).min(f32x8::splat(simd, l.right[i]))) - left;
        let passes = nearest_lanes(at) - left;
        let is_touched = rows.simd_ge(l.first[i]) & rows.simd_le(l.last[i]);
        let is_passed = rows.simd_ge(l.from[i]) & rows.simd_lt(l.to[i]);
        let (none, all) = (u32x8::splat(simd, 0), u32x8::splat(simd, u32::MAX));
        let within = |column: i32x8<S>| (column & (COLUMNS as i32 - 1)).bitcast::<u32x8<S>>();
        let touched = (all << within(begin)) & (all >> within(-end - 1));
        let (falls, layer) = (l.falls >> i & 1 == 1, usize::from(l.seams >> i & 1));
        marks.mark(layer, is_touched.select(touched, none));
        marks.wind(is_passed.select(all << within(passes), none), falls);
        if column + (COLUMNS as i32) < self.area.width() && l.from[i] < l.to[i] {
            let rows = (1u32 << (l.to[i] - top)) - (1 << (l.from[i] - top));
            self.carried[block + 1].step(rows, falls);
        }
        if l.doubted >> i & 1 == 1 {
            self.doubt_where(l, i, (at, is_passed), top);
        }
    }

    /// Marks the pixels of a seam of which it is not known on which side of it their middles lie,
    /// in those of eight rows that it passes. It passes them at the columns given.
    #[inline(always)]
    fn doubt_where<S: Simd>(
        &mut self,
        l: &EdgeLanes,
        i: usize,
        (at, is_passed): (f32x8<S>, mask32x8<S>),
        top: i32,
    ) {
        let rounded = (at + NEAREST_INTEGER_SINGLE) - NEAREST_INTEGER_SINGLE;
        let is_sure = (at - rounded).abs().simd_le(l.sure[i]);
        let doubted = (is_passed & !is_sure).to_bitmask();
        if doubted != 0 {
            self.doubt(l, i, doubted, top);
        }
    }

    /// Draws one edge in those rows of a row of blocks that it touches.
    #[inline(always)]
    fn line<S: Simd>(&mut self, simd: S, l: &EdgeLanes, i: usize, block: usize) {
        let (top, left) = ((block * LANES) as i32, self.corner.0);
        let rows = i32x8::from_slice(simd, &ROWS) + top;
        let middles = f32x8::from_slice(simd, &MIDDLES) + (top + self.corner.1) as f32;
        let at = (middles - l.y[i]) * l.slope[i] + l.x[i];
        // The first column that it touches, the one beyond the last, and where it passes the row.
        let begin = nearest_lanes((at - l.before[i]).max(f32x8::splat(simd, l.left[i]))) - left;
        let end = nearest_lanes((at + l.after[i]).min(f32x8::splat(simd, l.right[i]))) + (1 - left);
        let column = nearest_lanes(at) - left;
        let is_touched = rows.simd_ge(l.first[i]) & rows.simd_le(l.last[i]);
        let is_passed = rows.simd_ge(l.from[i]) & rows.simd_lt(l.to[i]);
        let (low, high) = (l.low[i], l.high[i]);
        let (low, high) = if (low ^ high) >> 5 == 0 { (low, high) } else { self.columns(l, i, top) };
        // One column more: it may pass rows there.
        let (low, high) = (low.max(0) >> 5, (high + 1).clamp(-1, self.area.width() - 1) >> 5);
        // From the leftmost to the one beyond the last, into which numbers are carried.
        let (from, beyond) = (low.min(high + 1), (high + 2).min(self.across as i32));
        if from < beyond {
            self.take(block, from as usize, beyond as usize);
        }
        let start = block * self.across;
        let (none, falls) = (u32x8::splat(simd, 0), l.falls >> i & 1 == 1);
        let layer = if l.seams >> i & 1 == 1 { PixelMarks::SEAM } else { PixelMarks::OPEN };
        for x in low..=high {
            let Some(marks) = self.blocks.get_mut(start + x as usize) else { break };
            let touched = from_columns(simd, begin - (x << 5)) & !from_columns(simd, end - (x << 5));
            marks.mark(layer, is_touched.select(touched, none));
            marks.wind(is_passed.select(from_columns(simd, column - (x << 5)), none), falls);
        }
        if high + 1 < self.across as i32 && l.from[i] < top + LANES as i32 && l.to[i] > top {
            let (from, to) = ((l.from[i] - top).max(0), (l.to[i] - top).min(LANES as i32));
            self.carried[start + (high + 1) as usize].step((1u32 << to) - (1 << from), falls);
        }
        if l.doubted >> i & 1 == 1 {
            self.doubt_where(l, i, (at, is_passed), top);
        }
    }

    /// The first and last column that an edge touches in eight rows from one on.
    #[inline(always)]
    fn columns(&self, l: &EdgeLanes, i: usize, top: i32) -> (i32, i32) {
        let at = |row: usize| l.at(i, MIDDLES[row] + (top + self.corner.1) as f32);
        let (a, b) = (at(0), at(LANES - 1));
        let (low, high) = (lesser(a, b) - l.before[i], greater(a, b) + l.after[i]);
        let (low, high) = (greater(low, l.left[i]), lesser(high, l.right[i]));
        (nearest(low) - self.corner.0, nearest(high) - self.corner.0)
    }

    /// Marks the pixels of which it is not known on which side of their middles a seam passes: its
    /// two patches may both count them, or neither. The rows are bits, from the row `top` on.
    #[cold]
    fn doubt(&mut self, l: &EdgeLanes, i: usize, rows: u64, top: i32) {
        for k in (0..LANES).filter(|&k| rows >> k & 1 == 1) {
            let at = l.at(i, MIDDLES[k] + (top + self.corner.1) as f32);
            let lo = (nearest(at - l.unsure[i] - 0.5) - self.corner.0).max(0);
            let hi = (nearest(at + l.unsure[i] - 0.5) - self.corner.0).min(self.area.width() - 1);
            if lo <= hi {
                self.mark(top + k as i32, lo, hi, PixelMarks::OPEN);
            }
        }
    }
}

/// The numbers of eight rows, and their middles.
const ROWS: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];
const MIDDLES: Lanes = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];

/// As [`nearest`], of eight numbers.
#[inline(always)]
fn nearest_lanes<S: Simd>(v: f32x8<S>) -> i32x8<S> {
    (v + NEAREST_INTEGER_SINGLE).bitcast::<i32x8<S>>() - NEAREST_INTEGER_SINGLE.to_bits() as i32
}

/// As [`from_column`], of eight columns, which may be less than zero or beyond the last.
#[inline(always)]
fn from_columns<S: Simd>(simd: S, columns: i32x8<S>) -> u32x8<S> {
    let within = columns.max(i32x8::splat(simd, 0)).min(i32x8::splat(simd, 31));
    let pixels = u32x8::splat(simd, u32::MAX) << within.bitcast::<u32x8<S>>();
    columns.simd_lt(32).select(pixels, u32x8::splat(simd, 0))
}

/// The rows whose middles some edges pass, up or down, with signs: bits from the row `first` on, of
/// which there are `count`.
#[inline(always)]
pub(crate) fn rows_passed(edges: &Edges, mut lanes: u8, (first, count): (i32, i32), fall: bool) -> Windings {
    let mut passed = Windings::default();
    let row = |y: f32| (nearest(y) - first).clamp(0, count);
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let (a, b) = (row(edges.y0[i]), row(edges.y1[i]));
        let rows = from_column(a.min(b)) & !from_column(a.max(b));
        passed.step(rows, (edges.y0[i] > edges.y1[i]) != fall);
    }
    passed
}

/// The integer nearest to a number below 2^22, halves to even: as its twin in double precision.
/// Other numbers, which lanes hold that are not drawn, give any integer.
#[inline(always)]
fn nearest(v: f32) -> i32 {
    ((v + NEAREST_INTEGER_SINGLE).to_bits() as i32).wrapping_sub(NEAREST_INTEGER_SINGLE.to_bits() as i32)
}

const _: () = assert!(FAR_PIXEL + ACROSS_AREA < 4_194_304.0, "all columns and rows fit `nearest`");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::surface::raster::Area;
    use crate::simd::vectorized;

    #[test]
    fn lanes_that_are_not_drawn_may_hold_anything() {
        let mut raster = Raster::default();
        raster.begin(Area { x: 0, y: 0, nx: 1, ny: 1 }, (0, 0));
        let any = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -3e9, 3e9, -0.0, 1e-45];
        for turn in 0..LANES {
            let lanes = |by: usize| std::array::from_fn(|i| any[(i * (by + turn) + by) % LANES]);
            let (wide, unsure) = (lanes(4), lanes(6));
            let edges = Edges {
                x0: lanes(1),
                y0: lanes(3),
                x1: lanes(5),
                y1: lanes(7),
                wide,
                unsure,
                plain: 0,
                seams: 255,
            };
            vectorized!(simd => raster.edges(simd, &edges, false));
        }
        raster.finish();
        assert_eq!(raster.marks(0), &PixelMarks::default());
    }

    #[test]
    fn nearest_integers() {
        for v in [-7.6, -0.5, -0.2, 0.0, 0.49, 0.5, 1.5, 2.5, 1e6 + 0.25] {
            let lanes = vectorized!(simd => nearest_lanes(f32x8::splat(simd, v)).as_slice()[3]);
            assert_eq!((nearest(v), lanes), (v.round_ties_even() as i32, v.round_ties_even() as i32));
        }
    }
}

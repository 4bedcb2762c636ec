//! Eight edges at a time, in single precision; each in eight rows at a time.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, i32x8, mask32x8, u32x8};

use crate::numeric::occlusion::{ACROSS_AREA, FAR_PIXEL, FLAT, NEAREST_INTEGER_SINGLE};
use crate::occlusion::surface::raster::edges::{EdgeVectors, LANES, Lanes};
use crate::occlusion::surface::raster::marks::{Head, PixelMarks, Windings, from_column};
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
    /// The rows of the area that it touches: those after one and before the other.
    first: [i32; LANES],
    last: [i32; LANES],
    /// It passes the middles of the rows after one and before the other.
    from: [i32; LANES],
    to: [i32; LANES],
    /// The first and last row of blocks that it touches.
    begins: [i32; LANES],
    ends: [i32; LANES],
    /// The first column that it touches.
    low: [i32; LANES],
    /// All bits of those that make winding numbers to their right fall.
    falls: [u32; LANES],
    /// Those that touch the area or pass left of it, one bit each.
    drawn: u8,
    /// Those that stay in one column of blocks of the area, and pass rows only there; those of them
    /// that touch one row of one block, or two.
    narrow: u8,
    tiny: u8,
    /// Seams that two patches agree about, and those of them of which it must be known where they
    /// pass rows.
    seams: u8,
    doubted: u8,
}

impl EdgeLanes {
    #[inline(always)]
    fn new<S: Simd>(simd: S, e: &EdgeVectors<S>, raster: &Raster, fall: bool) -> Self {
        let splat = |v: f32| f32x8::splat(simd, v);
        let &EdgeVectors { x0, y0, x1, y1, wide, unsure, .. } = e;
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
        let is_narrow = low.simd_ge(0)
            & high.simd_lt(width - 1)
            & ((low ^ (high + 1)) & !(COLUMNS as i32 - 1)).simd_eq(0);
        let is_tiny =
            is_narrow & (last - first).simd_le(1) & ((first ^ last) & !(LANES as i32 - 1)).simd_eq(0);
        let [slanted, near, narrow, tiny, agreed] =
            [is_slanted, is_near, is_narrow, is_tiny, is_agreed].map(|m| m.to_bitmask() as u8);
        let store = |v: f32x8<S>| -> Lanes { v.into() };
        let whole = |v: i32x8<S>| -> [i32; LANES] { v.into() };
        let (first, last) = (first.max(i32x8::splat(simd, 0)), last.min(i32x8::splat(simd, height - 1)));
        let (none, all) = (u32x8::splat(simd, 0), u32x8::splat(simd, u32::MAX));
        let falls = if fall { up.select(all, none) } else { up.select(none, all) };
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
            first: whole(first - 1),
            last: whole(last + 1),
            from: whole(from - 1),
            to: whole(to),
            begins: whole(first >> 3),
            ends: whole(last >> 3),
            low: whole(low),
            falls: falls.into(),
            drawn: near & e.plain,
            narrow,
            tiny: near & tiny & e.plain,
            seams: e.seams & agreed,
            doubted: e.seams & slanted,
        }
    }

    /// In a row for each edge, which is one of a block: the pixels that it touches; those right of
    /// where it passes the middle of the row, if it does; whether it does, and whether it is not
    /// known where.
    #[inline(always)]
    fn row<S: Simd>(
        &self,
        row: i32x8<S>,
        corner: (i32, i32),
    ) -> (u32x8<S>, u32x8<S>, mask32x8<S>, mask32x8<S>) {
        let simd = row.simd;
        let load = |of: &Lanes| f32x8::from_slice(simd, of);
        let integers = |of: &[i32; LANES]| i32x8::from_slice(simd, of);
        let (none, all) = (u32x8::splat(simd, 0), u32x8::splat(simd, u32::MAX));
        let middle = simd.cvt_f32_i32x8(row + corner.1) + 0.5;
        let at = (middle - load(&self.y)) * load(&self.slope) + load(&self.x);
        let begin = within_block((at - load(&self.before)).max(load(&self.left)), corner.0);
        let end = within_block((at + load(&self.after)).min(load(&self.right)), corner.0);
        let touched = (all << begin) & (all >> (end ^ (COLUMNS as u32 - 1)));
        let is_touched = row.simd_lt(integers(&self.last));
        let is_passed = row.simd_gt(integers(&self.from)) & row.simd_lt(integers(&self.to));
        let passed = is_passed.select(all << within_block(at, corner.0), none);
        let rounded = (at + NEAREST_INTEGER_SINGLE) - NEAREST_INTEGER_SINGLE;
        let is_sure = (at - rounded).abs().simd_le(load(&self.sure));
        (is_touched.select(touched, none), passed, is_passed, is_passed & !is_sure)
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
    pub(crate) fn edges<S: Simd>(&mut self, simd: S, edges: &EdgeVectors<S>, fall: bool) {
        let lines = EdgeLanes::new(simd, edges, self, fall);
        if lines.tiny != 0 {
            self.tiny_lines(simd, &lines);
        }
        let mut lanes = lines.drawn & !lines.tiny;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            self.line(simd, &lines, i);
        }
    }

    /// Draws those edges that touch one row of one block, or two: most of them. The words of all of
    /// them are found at once.
    #[inline(always)]
    fn tiny_lines<S: Simd>(&mut self, simd: S, l: &EdgeLanes) {
        let row = i32x8::from_slice(simd, &l.first) + 1;
        let (touched, passed, passes, doubts) = l.row(row, self.corner);
        let (touched_next, passed_next, passes_next, doubts_next) = l.row(row + 1, self.corner);
        let whole = |v: u32x8<S>| -> [u32; LANES] { v.into() };
        let words = [touched, touched_next, passed, passed_next].map(whole);
        let (none, one) = (u32x8::splat(simd, 0), u32x8::splat(simd, 1));
        let bits = passes.select(one, none) | passes_next.select(one + one, none);
        let in_block = (row & (LANES as i32 - 1)).bitcast::<u32x8<S>>();
        let (passed_rows, rows) = (whole(bits << in_block), whole(in_block));
        let mut lanes = l.tiny;
        while lanes != 0 {
            let i = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let (above, column) = ((l.first[i] + 1) as usize / LANES, l.low[i] as usize / COLUMNS as usize);
            let (layer, row) = (usize::from(l.seams >> i & 1), rows[i] as usize);
            let Some(marks) = self.block(above, column) else { return };
            marks.mark_row(layer, row, words[0][i]);
            // Behind the last row of the block comes the first one, with no pixels.
            marks.mark_row(layer, row + 1, words[1][i]);
            if passed_rows[i] != 0 {
                marks.wind_row(row, words[2][i], l.falls[i]);
                marks.wind_row(row + 1, words[3][i], l.falls[i]);
                self.carry(above, column + 1, Head::step(passed_rows[i], l.falls[i]));
            }
        }
        let (doubts, next) = (doubts.to_bitmask(), doubts_next.to_bitmask());
        let doubted = (doubts | next) as u8 & l.tiny & l.doubted;
        if doubted != 0 {
            for i in (0..LANES).filter(|i| doubted >> i & 1 == 1) {
                let bits = doubts >> i & 1 | (next >> i & 1) << 1;
                self.doubt(l, i, bits << rows[i], l.first[i] + 1 - rows[i] as i32);
            }
        }
    }

    /// Draws one edge, in each row of blocks that it touches.
    #[inline(always)]
    fn line<S: Simd>(&mut self, simd: S, l: &EdgeLanes, i: usize) {
        let number = |of: &Lanes| f32x8::splat(simd, of[i]);
        let integer = |of: &[i32; LANES]| i32x8::splat(simd, of[i]);
        let (x, y, slope) = (number(&l.x), number(&l.y), number(&l.slope));
        let (before, after) = (number(&l.before), number(&l.after));
        let (left, right) = (number(&l.left), number(&l.right));
        let (first, last) = (integer(&l.first), integer(&l.last));
        let (from, to) = (integer(&l.from), integer(&l.to));
        let (falls, layer) = (u32x8::splat(simd, l.falls[i]), usize::from(l.seams >> i & 1));
        let (none, all) = (u32x8::splat(simd, 0), u32x8::splat(simd, u32::MAX));
        for row in l.begins[i]..=l.ends[i] {
            let (top, above) = (row * LANES as i32, row as usize);
            let rows = i32x8::from_slice(simd, &ROWS) + top;
            let middles = f32x8::from_slice(simd, &MIDDLES) + (top + self.corner.1) as f32;
            let at = (middles - y) * slope + x;
            // The first and the last column that it touches, and where it passes the row.
            let begin = nearest_lanes((at - before).max(left)) - self.corner.0;
            let end = nearest_lanes((at + after).min(right)) - self.corner.0;
            let passes = nearest_lanes(at) - self.corner.0;
            let is_touched = rows.simd_gt(first) & rows.simd_lt(last);
            let is_passed = rows.simd_gt(from) & rows.simd_lt(to);
            let (mut low, mut high) = (l.low[i], l.low[i]);
            if l.narrow >> i & 1 == 0 {
                // It leans to one side. One column more: it may pass rows there.
                (low, high) = (begin[0].min(begin[LANES - 1]), end[0].max(end[LANES - 1]).wrapping_add(1));
            }
            let is_inside = low >= 0 && high < self.area.width() && (low ^ high) >> 5 == 0;
            let (low, high) = (low.max(0) >> 5, high.clamp(-1, self.area.width() - 1) >> 5);
            if is_inside {
                // In the rows that count, all are columns of the block.
                let within = |column: i32x8<S>| (column & (COLUMNS as i32 - 1)).bitcast::<u32x8<S>>();
                let touched = (all << within(begin)) & (all >> within(!end));
                let Some(marks) = self.block(above, low as usize) else { return };
                marks.mark(layer, is_touched.select(touched, none));
                marks.wind(is_passed.select(all << within(passes), none), falls);
            } else {
                for column in low..=high {
                    let Some(marks) = self.block(above, column as usize) else { break };
                    let own = |columns: i32x8<S>| from_columns(simd, columns - (column << 5));
                    marks.mark(layer, is_touched.select(own(begin) & !own(end + 1), none));
                    marks.wind(is_passed.select(own(passes), none), falls);
                }
            }
            let passed = Head::step(is_passed.to_bitmask() as u32, l.falls[i]);
            if high < 0 {
                self.pass_beside(above, passed);
            } else {
                self.carry(above, high as usize + 1, passed);
            }
            if l.doubted >> i & 1 == 1 {
                self.doubt_where(l, i, (at, is_passed), top);
            }
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

    /// Marks the pixels of which it is not known on which side of their middles a seam passes: its
    /// two patches may both count them, or neither. The rows are bits, from the row `top` on.
    #[cold]
    fn doubt(&mut self, l: &EdgeLanes, i: usize, rows: u64, top: i32) {
        for k in (0..LANES).filter(|&k| rows >> k & 1 == 1) {
            let at = l.at(i, MIDDLES[k] + (top + self.corner.1) as f32);
            // Within the area, or just beside it: steep seams are in doubt for millions of columns.
            let (left, right) = ((self.corner.0 - 1) as f32, (self.corner.0 + self.area.width()) as f32);
            let lo = (nearest((at - l.unsure[i] - 0.5).max(left)) - self.corner.0).max(0);
            let hi =
                (nearest((at + l.unsure[i] - 0.5).min(right)) - self.corner.0).min(self.area.width() - 1);
            if lo <= hi {
                self.mark(top + k as i32, lo, hi, PixelMarks::OPEN);
            }
        }
    }
}

/// The numbers of eight rows, and their middles.
const ROWS: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];
const MIDDLES: Lanes = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5];

/// The columns nearest to numbers, counted from the first one of the block that each is in.
#[inline(always)]
fn within_block<S: Simd>(v: f32x8<S>, corner: i32) -> u32x8<S> {
    ((nearest_lanes(v) - corner) & (COLUMNS as i32 - 1)).bitcast()
}

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
pub(crate) fn rows_passed<S: Simd>(
    edges: &EdgeVectors<S>,
    mut lanes: u8,
    (first, count): (i32, i32),
    fall: bool,
) -> Windings {
    let mut passed = Windings::default();
    let up = edges.y0.simd_le(edges.y1).to_bitmask() as u8;
    let row = |y: f32x8<S>| -> [i32; LANES] { (nearest_lanes(y) - first).into() };
    let (low, high) = (row(edges.y0.min(edges.y1)), row(edges.y0.max(edges.y1)));
    while lanes != 0 {
        let i = lanes.trailing_zeros() as usize % LANES;
        lanes &= lanes - 1;
        let rows = from_column(low[i].clamp(0, count)) & !from_column(high[i].clamp(0, count));
        passed.step(rows, (up >> i & 1 == 0) != fall);
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
    use crate::occlusion::surface::raster::{Area, Edges};
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
            vectorized!(simd => raster.edges(simd, &edges.vectors(simd, 1.0), false));
        }
        assert_eq!(raster.whole(0), PixelMarks::NONE);
    }

    #[test]
    fn a_seam_in_doubt_for_millions_of_columns_is_open_in_all_of_the_area() {
        let mut raster = Raster::default();
        raster.begin(Area { x: 0, y: 0, nx: 2, ny: 1 }, (0, 0));
        let edges = Edges {
            x0: [16.0; LANES],
            y0: [1.2; LANES],
            x1: [5616.0; LANES],
            y1: [6.8; LANES],
            wide: [4e4; LANES],
            unsure: [2e4; LANES],
            plain: 1,
            seams: 1,
        };
        vectorized!(simd => raster.edges(simd, &edges.vectors(simd, 1.0), false));
        for block in 0..2 {
            // The rows whose middles it passes.
            let open = std::array::from_fn(|row| if (1..7).contains(&row) { u32::MAX } else { 0 });
            assert_eq!(raster.marks(block).open(), &open);
        }
    }

    #[test]
    fn nearest_integers() {
        for v in [-7.6, -0.5, -0.2, 0.0, 0.49, 0.5, 1.5, 2.5, 1e6 + 0.25] {
            let lanes = vectorized!(simd => nearest_lanes(f32x8::splat(simd, v)).as_slice()[3]);
            assert_eq!((nearest(v), lanes), (v.round_ties_even() as i32, v.round_ties_even() as i32));
        }
    }
}

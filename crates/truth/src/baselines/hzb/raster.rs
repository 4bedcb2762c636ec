//! Triangles into pixels, eight at a time for their setup and eight pixels at a time for drawing.
//!
//! A pixel belongs to a triangle if its centre does. Neighbours compute the same numbers for the
//! edge that they share, so that no pixel falls between them.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};

use crate::baselines::DepthPyramid;
use crate::baselines::depth::{LANES, TILE};
use crate::numeric::baselines::{BEYOND, EDGE_ON};

/// Eight triangles by corner: columns and rows in pixels, and nearness. Not positive where a corner
/// cannot be projected; such triangles are passed over.
#[derive(Clone, Copy, Default)]
pub(super) struct Corners {
    pub(super) x: [[f32; 8]; 3],
    pub(super) y: [[f32; 8]; 3],
    pub(super) near: [[f32; 8]; 3],
}

/// Which side of triangles is drawn.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Sides {
    /// Clockwise ones on the screen, where y goes down.
    Clockwise,
    CounterClockwise,
    Both,
}

/// An edge of each of eight triangles: a point of it, less half a pixel, and columns by row.
#[derive(Clone, Copy)]
struct Edge {
    x: [f32; 8],
    y: [f32; 8],
    slope: [f32; 8],
}

impl Edge {
    /// The columns where the edge of one of the triangles crosses the middles of rows.
    #[inline(always)]
    fn at<S: Simd>(&self, i: usize, rows: f32x8<S>) -> f32x8<S> {
        (rows - self.y[i]) * self.slope[i] + self.x[i]
    }
}

/// What drawing needs to know, for eight triangles.
struct Setup {
    long: Edge,
    upper: Edge,
    lower: Edge,
    /// Positive where the corner in the middle lies to the right of the long edge.
    side: [f32; 8],
    columns: [[f32; 8]; 2],
    rows: [[f32; 8]; 2],
    /// Nearness at the first pixel, and its steps.
    start: [f32; 8],
    step: [[f32; 8]; 2],
    nearest: [f32; 8],
}

/// Columns and rows of points.
type Point<S> = (f32x8<S>, f32x8<S>);

#[inline(always)]
fn lanes<S: Simd>(v: f32x8<S>) -> [f32; 8] {
    *v
}

#[inline(always)]
fn loaded<S: Simd>(simd: S, v: &[[f32; 8]; 3]) -> [f32x8<S>; 3] {
    [f32x8::from_slice(simd, &v[0]), f32x8::from_slice(simd, &v[1]), f32x8::from_slice(simd, &v[2])]
}

/// Two points from top to bottom; at the same height from left to right.
#[inline(always)]
fn sorted<S: Simd>(p: Point<S>, q: Point<S>) -> (Point<S>, Point<S>) {
    let keep = p.1.simd_lt(q.1) | (p.1.simd_eq(q.1) & p.0.simd_le(q.0));
    ((keep.select(p.0, q.0), keep.select(p.1, q.1)), (keep.select(q.0, p.0), keep.select(q.1, p.1)))
}

/// The edge between two points, from top to bottom. A level one bounds no row: it lies at `beyond`.
#[inline(always)]
fn edge<S: Simd>(simd: S, p: Point<S>, q: Point<S>, beyond: f32x8<S>) -> Edge {
    let runs = p.1.simd_lt(q.1);
    let slope = runs.select((q.0 - p.0) / (q.1 - p.1), f32x8::splat(simd, 0.0));
    Edge { x: lanes(runs.select(p.0 - 0.5, beyond)), y: lanes(p.1 - 0.5), slope: lanes(slope) }
}

/// Draws those of eight triangles that cover the centre of a pixel.
#[inline(always)]
pub(super) fn draw<S: Simd>(simd: S, depth: &mut DepthPyramid, corners: &Corners, sides: Sides) {
    let [ax, bx, cx] = loaded(simd, &corners.x);
    let [ay, by, cy] = loaded(simd, &corners.y);
    let [an, bn, cn] = loaded(simd, &corners.near);
    let zero = f32x8::splat(simd, 0.0);
    let (width, height) =
        (f32x8::splat(simd, depth.width() as f32), f32x8::splat(simd, depth.height() as f32));

    let (ux, uy, vx, vy) = (bx - ax, by - ay, cx - ax, cy - ay);
    let area = ux * vy - uy * vx;
    // From the first pixel whose centre is not left of the corner to the last whose centre is left
    // of it.
    let left = (ax.min(bx).min(cx) - 0.5).ceil().max(zero);
    let right = (ax.max(bx).max(cx) - 0.5).ceil().min(width);
    let top = (ay.min(by).min(cy) - 0.5).ceil().max(zero);
    let bottom = (ay.max(by).max(cy) - 0.5).ceil().min(height);
    let least = an.min(bn).min(cn);
    let facing = match sides {
        Sides::Clockwise => area.simd_lt(-EDGE_ON),
        Sides::CounterClockwise => area.simd_gt(EDGE_ON),
        Sides::Both => area.abs().simd_gt(EDGE_ON),
    };
    let drawn = facing & left.simd_lt(right) & top.simd_lt(bottom) & least.simd_gt(zero);
    let drawn = drawn.to_bitmask();
    if drawn == 0 {
        return;
    }

    let scale = 1.0 / area;
    let (un, vn) = (bn - an, cn - an);
    let (dx, dy) = ((un * vy - vn * uy) * scale, (vn * ux - un * vx) * scale);
    // Counted from the farthest corner, where rounding matters most.
    let (a_far, b_far) = (an.simd_le(least), bn.simd_le(least));
    let far_x = a_far.select(ax, b_far.select(bx, cx));
    let far_y = a_far.select(ay, b_far.select(by, cy));
    let start = least + (0.5 - far_x) * dx + (0.5 - far_y) * dy;

    let ((ax, ay), (bx, by)) = sorted((ax, ay), (bx, by));
    let ((bx, by), (cx, cy)) = sorted((bx, by), (cx, cy));
    let ((ax, ay), (bx, by)) = sorted((ax, ay), (bx, by));
    let long = (cx - ax) / (cy - ay);
    let side = bx - (ax + long * (by - ay));
    let beyond = side.simd_gt(zero).select(f32x8::splat(simd, BEYOND), f32x8::splat(simd, -BEYOND));
    let setup = Setup {
        long: Edge { x: lanes(ax - 0.5), y: lanes(ay - 0.5), slope: lanes(long) },
        upper: edge(simd, (ax, ay), (bx, by), beyond),
        lower: edge(simd, (bx, by), (cx, cy), beyond),
        side: lanes(side),
        columns: [lanes(left), lanes(right)],
        rows: [lanes(top), lanes(bottom)],
        start: lanes(start),
        step: [lanes(dx), lanes(dy)],
        nearest: lanes(an.max(bn).max(cn)),
    };
    let mut left_over = drawn;
    while left_over != 0 {
        fill(simd, depth, &setup, left_over.trailing_zeros() as usize & 7);
        left_over &= left_over - 1;
    }
}

/// Draws one of eight triangles, tile by tile.
#[inline(always)]
fn fill<S: Simd>(simd: S, depth: &mut DepthPyramid, setup: &Setup, i: usize) {
    let lane = f32x8::from_slice(simd, &LANES);
    let [x0, x1] = [setup.columns[0][i], setup.columns[1][i]];
    let [y0, y1] = [setup.rows[0][i], setup.rows[1][i]];
    let (nearest, most) = (setup.nearest[i], f32x8::splat(simd, setup.nearest[i]));
    let middle_is_right = f32x8::splat(simd, setup.side[i]).simd_gt(f32x8::splat(simd, 0.0));
    let (dx, dy) = (f32x8::splat(simd, setup.step[0][i]), setup.step[1][i]);
    let (first, last) = (y0 as usize / TILE, (y1 as usize - 1) / TILE);
    let (from, to) = (x0 as usize / TILE, (x1 as usize - 1) / TILE);
    for tile_row in first..=last {
        let row = (tile_row * TILE) as f32;
        let rows = lane + row;
        let (long, upper, lower) = (setup.long.at(i, rows), setup.upper.at(i, rows), setup.lower.at(i, rows));
        let lo = middle_is_right.select(long, upper.max(lower));
        let hi = middle_is_right.select(upper.min(lower), long);
        let lo = lanes(lo.ceil().max(f32x8::splat(simd, x0)));
        let hi = lanes(hi.ceil().min(f32x8::splat(simd, x1)));
        let begin = (y0 - row).max(0.0) as usize;
        let end = ((y1 - row) as usize).min(TILE);
        for column in from..=to {
            let tile = depth.tile(column, tile_row);
            if depth.least(tile) >= nearest {
                continue;
            }
            let columns = lane + (column * TILE) as f32;
            let level = columns * dx + setup.start[i];
            let pixels = depth.rows(tile);
            for r in begin..end {
                let inside = columns.simd_ge(lo[r & 7]) & columns.simd_lt(hi[r & 7]);
                let near = (level + (row + r as f32) * dy).min(most);
                let old = f32x8::from_slice(simd, &pixels[r & 7]);
                inside.select(old.max(near), old).store_slice(&mut pixels[r & 7]);
            }
        }
    }
}

//! The columns that a segment crosses, and the part of it in each.
//!
//! Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing", in homogeneous
//! pixel coordinates, so that the same steps serve both lenses. The thesis' rasteriser visits one
//! column for each step along the longer axis; here each column that a segment crosses is visited,
//! so that the parts of a segment are contiguous and their lengths add up.

use std::ops::Range;

use glam::DVec3;

use crate::view::View;

/// The part of a segment from `from` to `to`, as shares of the way from its first end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// The part of a segment of eye space in the view's depths and in some rows of its picture (Liang
/// and Barsky 1984). A segment on the border of two rows is in the lower one only, but at the
/// bottom of the picture.
pub(crate) fn clip(view: &View, [a, b]: [DVec3; 2], rows: &Range<u32>) -> Option<Part> {
    let [near, far] = view.depths();
    let (pa, pb) = (view.project(a), view.project(b));
    let (width, top, bottom) = (f64::from(view.size()[0]), f64::from(rows.start), f64::from(rows.end));
    let sides = [
        (-a.z - near, -b.z - near),
        (far + a.z, far + b.z),
        (pa.x, pb.x),
        (width * pa.z - pa.x, width * pb.z - pb.x),
        (pa.y - top * pa.z, pb.y - top * pb.z),
        (bottom * pa.z - pa.y, bottom * pb.z - pb.y),
    ];
    let below = |(at_a, at_b): (f64, f64)| at_a <= 0.0 && at_b <= 0.0;
    if rows.end < view.size()[1] && below(sides[5]) {
        return None;
    }
    let mut part = Part { from: 0.0, to: 1.0 };
    for (at_a, at_b) in sides {
        if at_a < 0.0 && at_b < 0.0 {
            return None;
        }
        if at_a < 0.0 {
            part.from = part.from.max(at_a / (at_a - at_b));
        } else if at_b < 0.0 {
            part.to = part.to.min(at_a / (at_a - at_b));
        }
    }
    (part.from <= part.to).then_some(part)
}

/// Calls `visit` with column, row and part for each column that a segment of eye space crosses, in
/// order; only `rows`.
pub(crate) fn walk(view: &View, ends: [DVec3; 2], rows: &Range<u32>, mut visit: impl FnMut(u32, u32, Part)) {
    let Some(part) = clip(view, ends, rows) else { return };
    let [pa, pb] = ends.map(|e| view.project(e));
    let at = |t: f64| pa + (pb - pa) * t;
    let (first, last) = (at(part.from), at(part.to));
    let pixel = |value: f64, w: f64, range: &Range<u32>| {
        ((value / w) as i64).clamp(i64::from(range.start), i64::from(range.end) - 1)
    };
    let columns = 0..view.size()[0];
    let (mut x, mut y) = (pixel(first.x, first.z, &columns), pixel(first.y, first.z, rows));
    let (end_x, end_y) = (pixel(last.x, last.z, &columns), pixel(last.y, last.z, rows));
    let (step_x, step_y) = ((end_x - x).signum(), (end_y - y).signum());
    // Where the segment crosses the border x / w = c.
    let crossing = |c: i64, step: i64, at: i64, end: i64, from: [f64; 2], to: [f64; 2]| {
        if at == end {
            return f64::INFINITY;
        }
        let border = (c + i64::from(step > 0)) as f64;
        let (start, stop) = (from[0] - border * from[1], to[0] - border * to[1]);
        start / (start - stop)
    };
    let mut t = part.from;
    loop {
        let over_x = crossing(x, step_x, x, end_x, [pa.x, pa.z], [pb.x, pb.z]);
        let over_y = crossing(y, step_y, y, end_y, [pa.y, pa.z], [pb.y, pb.z]);
        let done = x == end_x && y == end_y;
        // Rounding must not let a part run backwards.
        let next = if done { part.to } else { over_x.min(over_y).clamp(t, part.to) };
        visit(x as u32, y as u32, Part { from: t, to: next });
        if done {
            return;
        }
        t = next;
        // Towards the last column in any case: a crossing may be no number if coordinates are
        // absurd.
        if y == end_y || (x != end_x && over_x <= over_y) {
            x += step_x;
        } else {
            y += step_y;
        }
    }
}

//! The columns that a segment crosses, and the part of it in each.
//!
//! Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing", in homogeneous
//! pixel coordinates, so that the same steps serve both lenses. The thesis' rasteriser visits one
//! column for each step along the longer axis; here each column that a segment crosses is visited,
//! so that the parts of a segment are contiguous and their lengths add up.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::sets::{LineSet, Segment};
use crate::view::View;

/// Rows of pixels that are worked on as one.
const BAND: u32 = 8;

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

/// A set of lines in a view: its vertices in eye space, and its segments by the bands of rows that
/// they cross. Work that goes band by band over them gives the same result for any number of
/// threads.
pub(crate) struct Placed {
    points: Vec<DVec3>,
    segments: Vec<Segment>,
    bands: Vec<Vec<u32>>,
}

impl Placed {
    pub(crate) fn new(lines: &LineSet, view: &View) -> Self {
        let points: Vec<DVec3> = lines.points().par_iter().map(|&p| view.to_eye(p)).collect();
        let segments: Vec<Segment> = lines.segments().collect();
        let height = view.size()[1];
        let rows = |s: &Segment| {
            let [a, b] = [points[s.a as usize], points[s.b as usize]];
            let part = clip(view, [a, b], &(0..height))?;
            let row = |t: f64| {
                let p = view.project(a + (b - a) * t);
                ((p.y / p.z) as i64).clamp(0, i64::from(height) - 1) as u32
            };
            let (from, to) = (row(part.from), row(part.to));
            // A row more on both sides: rounding may put the ends of the parts of a segment there.
            Some(from.min(to).saturating_sub(1)..(from.max(to) + 2).min(height))
        };
        let rows: Vec<Option<Range<u32>>> = segments.par_iter().map(rows).collect();
        let mut bands = vec![Vec::new(); height.div_ceil(BAND) as usize];
        for (i, rows) in rows.iter().enumerate() {
            let Some(rows) = rows else { continue };
            let touched = (rows.start / BAND) as usize..=((rows.end - 1) / BAND) as usize;
            bands[touched].iter_mut().for_each(|b| b.push(i as u32));
        }
        Self { points, segments, bands }
    }

    pub(crate) fn ends(&self, segment: &Segment) -> [DVec3; 2] {
        [self.points[segment.a as usize], self.points[segment.b as usize]]
    }

    /// For each band, in order and in parallel: its rows of pixels and the segments in them.
    pub(crate) fn bands<T: Send>(
        &self,
        view: &View,
        work: impl Fn(Range<u32>, &mut dyn Iterator<Item = Segment>) -> T + Sync,
    ) -> Vec<T> {
        let height = view.size()[1];
        let band = |(i, segments): (usize, &Vec<u32>)| {
            let top = i as u32 * BAND;
            let mut segments = segments.iter().map(|&s| self.segments[s as usize]);
            work(top..(top + BAND).min(height), &mut segments)
        };
        self.bands.par_iter().enumerate().map(band).collect()
    }
}

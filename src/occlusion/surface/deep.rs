//! Sides that reach over a large range of depths, or behind the near limit: drawn in pieces.

use fearless_simd::Simd;
use glam::DVec3;

use crate::numeric::occlusion::{
    EDGE, EDGE_ROUNDING, FAR_ASIDE, FAR_PIXEL, FAR_WIDTHS, PIECE_ROUNDING, PROJECTED, WIDTH_ROUNDINGS,
};
use crate::occlusion::surface::raster::{Edges, LANES, Raster};
use crate::occlusion::surface::sides::WholeSide;

/// As a number in double precision.
const FAR: f64 = FAR_PIXEL as f64;

/// Where an edge passes the near limit.
pub(super) struct Cut {
    pub(super) at: DVec3,
    /// Whether the edge goes to lesser depths there.
    pub(super) leaves: bool,
}

/// The magnitudes of the coordinates of two points, added.
#[inline(always)]
fn magnitude(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0.abs() + a.1.abs() + b.0.abs() + b.1.abs()
}

/// Between which shares of the way from `p` to `q` numbers lie between two others; the second is
/// less if none do.
fn shares((p, q): (f64, f64), (low, high): (f64, f64)) -> (f64, f64) {
    if p == q {
        return if low <= p && p <= high { (0.0, 1.0) } else { (1.0, 0.0) };
    }
    let (a, b) = ((low - p) / (q - p), (high - p) / (q - p));
    (a.min(b).max(0.0), a.max(b).min(1.0))
}

/// Draws the sides of one patch that are not drawn as single edges.
pub(super) struct DeepSides {
    pub(super) per_unit: f64,
    /// The pixel of the middle of the face.
    pub(super) middle: (f64, f64),
    /// Edges are cut off where they are less deep.
    pub(super) limit: f64,
    /// Pixels for one of those in which sides have their ends.
    pub(super) finer: f64,
}

/// Pieces of the sides of one patch: those within the range of single precision are drawn eight at
/// a time.
struct Pieces<'a, S> {
    simd: S,
    raster: &'a mut Raster,
    /// Whether winding numbers fall to the right of those of the eight that go up.
    falls: bool,
    edges: Edges,
    count: usize,
    /// The magnitudes of the coordinates of the middle of the face, added.
    shift: f64,
}

impl<S: Simd> Pieces<'_, S> {
    /// Draws a piece, at once or later. Its ends are in single precision.
    #[inline(always)]
    fn add(&mut self, from: (f64, f64), to: (f64, f64), falls: bool, (wide, unsure): (f64, f64), seam: bool) {
        // Also if one is NaN.
        if magnitude(from, to) < FAR && wide + unsure < FAR {
            self.put(from, to, falls, (wide, unsure), seam);
        } else {
            self.add_far(from, to, falls, (wide, unsure), seam);
        }
    }

    /// Draws a piece that reaches far beyond the area: the part that may touch the area, and rows
    /// that others pass left of it.
    #[cold]
    fn add_far(&mut self, a: (f64, f64), b: (f64, f64), falls: bool, (wide, unsure): (f64, f64), seam: bool) {
        let rounding = EDGE_ROUNDING * magnitude(a, b);
        let (wide, unsure) = (wide + rounding, unsure + rounding);
        let aside = FAR_ASIDE + WIDTH_ROUNDINGS * self.shift * f64::from(PROJECTED);
        let room = FAR_WIDTHS * (wide + unsure) + aside;
        let ((left, right), (low, high)) = self.raster.borders();
        let rows = shares((a.1, b.1), (low - room, high + room));
        let columns = shares((a.0, b.0), (left - room, right + room));
        let (begin, end) = (rows.0.max(columns.0), rows.1.min(columns.1));
        let is_near = begin <= end;
        if !room.is_finite() || is_near && room >= FAR {
            self.raster.open_all();
            return;
        }
        let at = |share: f64| match share {
            0.0 => a,
            1.0 => b,
            _ => (a.0 + (b.0 - a.0) * share, a.1 + (b.1 - a.1) * share),
        };
        let near = is_near.then(|| (at(begin), at(end), (wide, unsure), seam));
        let (begin, end) = if is_near { (begin, end) } else { (rows.1, rows.1) };
        let beside = |(from, to): (f64, f64)| {
            let (from, to) = (at(from), at(to));
            let place = |y: f64| (left - aside, y.clamp(low - 1.0, high + 1.0));
            let is_left = rows.0 < rows.1 && from.0 + to.0 < 2.0 * left;
            is_left.then(|| (place(from.1), place(to.1), (EDGE, EDGE), false))
        };
        for (from, to, widths, seam) in
            near.into_iter().chain([(rows.0, begin), (end, rows.1)].into_iter().filter_map(beside))
        {
            self.put(from, to, falls, widths, seam);
        }
    }

    /// Draws a piece within the range of single precision, at once or later.
    #[inline(always)]
    fn put(&mut self, from: (f64, f64), to: (f64, f64), falls: bool, (wide, unsure): (f64, f64), seam: bool) {
        let rounding = (magnitude(from, to) + self.shift) * f64::from(PROJECTED);
        let (wide, unsure) = (wide + unsure + WIDTH_ROUNDINGS * rounding, unsure + rounding);
        let (from, to) = if falls == self.falls { (from, to) } else { (to, from) };
        let (at, e) = (self.count % LANES, &mut self.edges);
        (e.x0[at], e.y0[at]) = (from.0 as f32, from.1 as f32);
        (e.x1[at], e.y1[at]) = (to.0 as f32, to.1 as f32);
        (e.wide[at], e.unsure[at]) = (wide as f32, unsure as f32);
        e.plain |= 1 << at;
        e.seams |= u8::from(seam) << at;
        self.count += 1;
        if self.count == LANES {
            self.flush();
        }
    }

    /// Draws those that wait.
    #[inline(always)]
    fn flush(&mut self) {
        if self.count > 0 {
            self.raster.edges(self.simd, &self.edges.vectors(self.simd, 1.0), self.falls);
            (self.edges, self.count) = (Edges::default(), 0);
        }
    }
}

impl DeepSides {
    /// The same in pixels that are finer by a factor.
    pub(super) fn finer(&self, by: f64) -> Self {
        Self {
            per_unit: self.per_unit * by,
            middle: (self.middle.0 * by, self.middle.1 * by),
            limit: self.limit,
            finer: self.finer * by,
        }
    }

    /// Draws sides; `falls` tells whether winding numbers fall to the right of those that go up,
    /// and `is_seam` which of them two patches share.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &self,
        simd: S,
        raster: &mut Raster,
        (sides, falls): (&[WholeSide], bool),
        is_seam: impl Fn(&WholeSide) -> bool,
    ) {
        if sides.is_empty() {
            return;
        }
        let shift = self.middle.0.abs() + self.middle.1.abs();
        let mut pieces = Pieces { simd, raster, falls, edges: Edges::default(), count: 0, shift };
        let mut base = None;
        for side in sides {
            let cut = self.cut(side.ends);
            self.draw_side(&mut pieces, side, cut.as_ref(), is_seam(side));
            // An outline that the near limit cuts is closed along it, far outside the face.
            if let Some(Cut { at, leaves }) = cut {
                let base = *base.get_or_insert(at);
                // From where the outline leaves to where it comes back.
                let (from, to) = if leaves { (at, base) } else { (base, at) };
                let (from, to) = (self.single(from), self.single(to));
                pieces.add_far(from, to, falls, (EDGE, EDGE), false);
            }
        }
        pieces.flush();
    }

    /// Draws a side in pieces whose depth doubles at most, from the near limit on.
    #[inline(always)]
    fn draw_side<S: Simd>(&self, pieces: &mut Pieces<S>, side: &WholeSide, cut: Option<&Cut>, seam: bool) {
        let ([mut p, mut q], slack, mut falls) = (side.ends, side.slack, pieces.falls);
        if p.z < self.limit && q.z < self.limit {
            return;
        }
        // Ends as their other sides have them, so that these agree about the rows.
        let mut ends = side.pixels.map(|(x, y)| (x * self.finer, y * self.finer));
        if let Some(&Cut { at, leaves }) = cut {
            if leaves {
                (q, ends[1]) = (at, self.single(at));
            } else {
                (p, ends[0]) = (at, self.single(at));
            }
        }
        if p.z > q.z {
            ((p, q), ends, falls) = ((q, p), [ends[1], ends[0]], !falls);
        }
        let (near, far) = (p, q);
        let (mut start, mut from) = (near.z, ends[0]);
        loop {
            let end = 2.0 * start.max(slack);
            let is_last = end.is_nan() || end >= far.z;
            let (stop, to) = if is_last {
                (far.z, ends[1])
            } else {
                let at = near + (far - near) * ((end - near.z) / (far.z - near.z));
                (at.z, self.single(at))
            };
            let slack = if stop <= 2.0 * slack { 0.0 } else { slack };
            pieces.add(from, to, falls, self.widths(near, far, start, slack), seam);
            if is_last {
                break;
            }
            (start, from) = (stop, to);
        }
    }

    /// The width of a piece of the edge from `p` to `q` whose least depth is `near`, and the part
    /// of it that rounding alone takes.
    ///
    /// At depth z, points of the face move by at most slack (1 + |u|) / z, with |u| <= 1.
    fn widths(&self, p: DVec3, q: DVec3, near: f64, slack: f64) -> (f64, f64) {
        let rounding = PIECE_ROUNDING * (p.abs().max_element() + q.abs().max_element());
        let unsure = EDGE + rounding / near * self.per_unit;
        (unsure + 2.0 * slack / near * self.per_unit, unsure)
    }

    /// The pixel of a point of the face.
    pub(super) fn pixel(&self, p: DVec3) -> (f64, f64) {
        let scale = self.per_unit / p.z;
        (p.x * scale + self.middle.0, p.y * scale + self.middle.1)
    }

    /// As [`DeepSides::pixel`], in single precision: all that have a point in common draw the same
    /// one.
    fn single(&self, p: DVec3) -> (f64, f64) {
        let (x, y) = self.pixel(p);
        (f64::from(x as f32), f64::from(y as f32))
    }

    /// Where an edge passes the near limit.
    pub(super) fn cut(&self, [p, q]: [DVec3; 2]) -> Option<Cut> {
        if (p.z < self.limit) == (q.z < self.limit) {
            return None;
        }
        let leaves = q.z < self.limit;
        // Always from the lesser to the greater depth: two patches that share the edge get the same
        // point.
        let (p, q) = if leaves { (q, p) } else { (p, q) };
        let mut at = p + (q - p) * ((self.limit - p.z) / (q.z - p.z));
        at.z = self.limit;
        Some(Cut { at, leaves })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::occlusion::pixels::PixelRect;
    use crate::occlusion::surface::raster::{Area, PixelMarks};
    use crate::random::Random;
    use crate::simd::vectorized;

    fn sides(limit: f64) -> DeepSides {
        DeepSides { per_unit: 512.0, middle: (512.0, 512.0), limit, finer: 1.0 }
    }

    #[test]
    fn edges_are_cut_at_the_near_limit() {
        let sides = sides(0.5);
        let (near, far) = (DVec3::new(1.0, 0.0, -0.5), DVec3::new(3.0, 2.0, 1.5));
        let expected = DVec3::new(2.0, 1.0, 0.5);
        let cut = |ends| sides.cut(ends).map(|cut| (cut.at, cut.leaves));
        assert_eq!(cut([near, far]), Some((expected, false)));
        assert_eq!(cut([far, near]), Some((expected, true)));
        assert_eq!(cut([far, far + DVec3::Z]), None);
    }

    #[test]
    fn widths_hold_every_point_that_is_off_by_the_slack() {
        let sides = sides(0.1);
        let slack = 0.02;
        let (p, q) = (DVec3::new(-1.5, 0.3, 2.0), DVec3::new(2.5, -1.0, 3.0));
        let (wide, unsure) = sides.widths(p, q, 2.0, slack);
        assert!(unsure < 0.01);
        for end in [p, q] {
            let at = sides.pixel(end);
            for offset in
                [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.0, -0.6, -0.8)]
            {
                let moved = sides.pixel(end + offset * slack);
                assert!((moved.0 - at.0).abs() <= wide && (moved.1 - at.1).abs() <= wide, "{end} {offset}");
            }
        }
    }

    #[test]
    fn pieces_leave_the_winding_numbers_of_whole_sides() {
        let sides = DeepSides { per_unit: 32.0, middle: (32.0, 32.0), limit: 0.1, finer: 1.0 };
        let area = Area::around(&PixelRect { x: (0, 64), y: (0, 64) });
        let (mut random, mut raster) = (Random::new(41), Raster::default());
        let (mut covered, mut marked) = (0, 0);
        for round in 0..400 {
            // Some corners are far beside the face.
            let spread = [1.2, 3.0, 4000.0][round % 3];
            let corners: [DVec3; 3] = std::array::from_fn(|_| {
                let z = random.within(0.2, 3.0).exp();
                DVec3::new(random.within(-spread, spread), random.within(-spread, spread), 1.0) * z
            });
            let slack = if round % 2 == 0 { 0.0 } else { 0.003 };
            let whole: Vec<WholeSide> = (0..3)
                .map(|i| {
                    let ends = [corners[i], corners[(i + 1) % 3]];
                    WholeSide { group: 0, lane: i as u32, ends, pixels: ends.map(|p| sides.single(p)), slack }
                })
                .collect();
            let turned = round % 4 > 1;
            raster.begin(area, (0, 0));
            vectorized!(simd => sides.draw(simd, &mut raster, (&whole, turned), |_| round % 5 == 0));
            let pixels = corners.map(|p| sides.pixel(p));
            for (x, y) in (0..64usize).flat_map(|y| (0..64).map(move |x| (x, y))) {
                let marks = raster.whole(y / 8 * area.nx as usize + x / 32);
                let layers =
                    [PixelMarks::OPEN, PixelMarks::SEAM].map(|layer| marks.pixel(layer, y % 8, x % 32));
                if layers[0].0 || layers[1].0 {
                    marked += 1;
                    continue;
                }
                let p = (x as f64 + 0.5, y as f64 + 0.5);
                let across = |i: usize| {
                    let (a, b) = (pixels[i], pixels[(i + 1) % 3]);
                    (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0)
                };
                let signs = [across(0), across(1), across(2)];
                let inside = signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0);
                assert_eq!(layers[0].1 != 0, inside, "{round}: {x} {y}");
                covered += u32::from(inside);
            }
        }
        assert!(covered > 100_000 && marked > 10_000, "{covered} {marked}");
    }
}

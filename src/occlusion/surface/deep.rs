//! Sides that reach over a large range of depths, or behind the near limit: drawn in pieces.

use glam::DVec3;

use crate::numeric::occlusion::{EDGE, PIECE_ROUNDING};
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::sides::WholeSide;

/// Where an edge passes the near limit.
pub(super) struct Cut {
    pub(super) at: DVec3,
    /// Whether the edge goes to lesser depths there.
    pub(super) leaves: bool,
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

impl DeepSides {
    /// The same in pixels that are so many times as fine.
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
    pub(super) fn draw(
        &self,
        raster: &mut Raster,
        sides: &[WholeSide],
        falls: bool,
        is_seam: impl Fn(&WholeSide) -> bool,
    ) {
        let mut base = None;
        for side in sides {
            let cut = self.cut(side.ends);
            self.draw_side(raster, side, cut.as_ref(), falls, is_seam(side));
            // An outline that the near limit cuts is closed along it, far outside the face.
            if let Some(Cut { at, leaves }) = cut {
                let base = *base.get_or_insert(at);
                // From where the outline leaves to where it comes back.
                let (from, to) = if leaves { (at, base) } else { (base, at) };
                raster.edge(self.pixel(from), self.pixel(to), falls, (EDGE, EDGE), false);
            }
        }
    }

    /// Draws a side in pieces whose depth doubles at most, from the near limit on.
    fn draw_side(
        &self,
        raster: &mut Raster,
        side: &WholeSide,
        cut: Option<&Cut>,
        mut falls: bool,
        seam: bool,
    ) {
        let ([mut p, mut q], slack) = (side.ends, side.slack);
        if p.z < self.limit && q.z < self.limit {
            return;
        }
        // Ends as their other sides have them, so that these agree about the rows.
        let mut ends = side.pixels.map(|(x, y)| (x * self.finer, y * self.finer));
        if let Some(&Cut { at, leaves }) = cut {
            if leaves {
                (q, ends[1]) = (at, self.pixel(at));
            } else {
                (p, ends[0]) = (at, self.pixel(at));
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
                (at.z, self.pixel(at))
            };
            let slack = if stop <= 2.0 * slack { 0.0 } else { slack };
            raster.edge(from, to, falls, self.widths(near, far, start, slack), seam);
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
}

//! Sides of patches projected to the pixels of a face.

use glam::{DVec3, Vec3};

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::numeric::occlusion::{EDGE, EDGE_ROUNDING};
use crate::occlusion::face::Face;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::{PixelRect, floor};
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::raster::Raster;
use crate::occlusion::surface::scratch::{DeepSide, SeenSide, SeenSides, SideKind};

/// Projects points of a face to its pixels.
pub(super) struct Projector<'a> {
    face: &'a Face,
    per_unit: f64,
    /// Edges are cut off where they are less deep.
    limit: f64,
}

/// A point in coordinates of the face, and its pixel.
#[derive(Debug, Default, Clone, Copy)]
struct Projected {
    at: DVec3,
    pixel: (f64, f64),
}

/// A rectangle around points, and their least depth.
struct Extent {
    least: (f64, f64),
    most: (f64, f64),
    near: f64,
    slack: f64,
}

impl Extent {
    const EMPTY: Self = Self {
        least: (f64::INFINITY, f64::INFINITY),
        most: (f64::NEG_INFINITY, f64::NEG_INFINITY),
        near: f64::INFINITY,
        slack: 0.0,
    };

    #[inline(always)]
    fn add(&mut self, p: Projected) {
        self.least = (smaller(p.pixel.0, self.least.0), smaller(p.pixel.1, self.least.1));
        self.most = (larger(p.pixel.0, self.most.0), larger(p.pixel.1, self.most.1));
        self.near = smaller(p.at.z, self.near);
    }
}

/// The smaller number. Quicker than `f64::min`, which treats NaN in another way.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl<'a> Projector<'a> {
    pub(super) fn new(buffer: &'a FaceBuffer, limit: f64) -> Self {
        Self { face: buffer.face(), per_unit: buffer.window().per_unit(), limit }
    }

    /// Appends the sides of a patch as the face sees them. Returns the pixels of `within` that the patch may
    /// touch; `None` if there are none.
    #[inline(always)]
    pub(super) fn project(
        &self,
        d: &Drawable,
        origin: DVec3,
        within: PixelRect,
        sides: &mut SeenSides,
    ) -> Option<PixelRect> {
        let growth = d.placement.map_or(1.0, |p| p.growth);
        // A side often starts where the last one ended.
        let mut known = (Vec3::NAN, Projected::default());
        let mut extent = Extent::EMPTY;
        for (_, side) in d.outline() {
            let from = if known.0 == side.from {
                known.1
            } else {
                self.project_point(side.from, d.placement, origin)
            };
            let to = self.project_point(side.to, d.placement, origin);
            known = (side.to, to);
            extent.add(from);
            extent.add(to);
            let slack = f64::from(side.slack) * growth + d.error;
            extent.slack = larger(slack, extent.slack);
            let kind = match self.plain_width(from.at, to.at, slack) {
                Some(wide) => SideKind::Plain(wide),
                None => {
                    sides.deep.push(DeepSide { ends: [from.at, to.at], slack });
                    SideKind::Deep(sides.deep.len() as u32 - 1)
                }
            };
            sides.all.push(SeenSide { from: from.pixel, to: to.pixel, kind, seam: false });
        }
        self.tighter(extent, within)
    }

    /// The pixels of a rectangle within the extent of a patch, if that is known: where the patch is deep enough.
    #[inline(always)]
    fn tighter(&self, extent: Extent, within: PixelRect) -> Option<PixelRect> {
        let Extent { least, most, near, slack } = extent;
        if !self.face.parallel && (near.is_nan() || near < 2.0 * self.limit + 2.0 * slack) {
            return Some(within);
        }
        let wide = if self.face.parallel { slack * self.face.right.length() } else { 2.0 * slack / near };
        let wide = EDGE + wide * self.per_unit;
        let narrow = |(lo, hi): (i64, i64), least: f64, most: f64| {
            let lo = lo.max(floor((least - wide).clamp(-1.0, hi as f64)));
            (lo, hi.min(floor((most + wide).clamp(-1.0, hi as f64)) + 1))
        };
        let pixels = PixelRect { x: narrow(within.x, least.0, most.0), y: narrow(within.y, least.1, most.1) };
        (!pixels.is_empty()).then_some(pixels)
    }

    /// A point of a surface that stands at a placement.
    #[inline(always)]
    fn project_point(&self, v: Vec3, placement: Option<&Placement>, origin: DVec3) -> Projected {
        let v = v.as_dvec3();
        let at = self.face.local(placement.map_or(v, |p| p.affine.transform_point3(v)) - origin);
        Projected { at, pixel: self.pixel(at) }
    }

    /// The pixel of a point of the face.
    #[inline]
    fn pixel(&self, p: DVec3) -> (f64, f64) {
        let scale = if self.face.parallel { 1.0 } else { 1.0 / p.z };
        let (u, v) = (p.x * scale, p.y * scale);
        ((u + 1.0) * self.per_unit, (v + 1.0) * self.per_unit)
    }

    /// The width of an edge whose points may be off by `slack`, if it has one width along all of its length.
    #[inline]
    fn plain_width(&self, p: DVec3, q: DVec3, slack: f64) -> Option<f64> {
        if self.face.parallel {
            return Some(self.parallel_width(slack));
        }
        let (near, far) = if p.z <= q.z { (p.z, q.z) } else { (q.z, p.z) };
        if near < self.limit || near.is_nan() {
            return None;
        }
        if slack == 0.0 {
            return Some(EDGE);
        }
        (far <= 2.0 * near && far > 2.0 * slack).then(|| self.width(p, q, near, slack))
    }

    #[inline]
    fn parallel_width(&self, slack: f64) -> f64 {
        EDGE + slack * self.face.right.length() * self.per_unit
    }

    /// The width of a piece of the edge from `p` to `q` whose least depth is `near`.
    ///
    /// At depth z, points of the face move by at most slack (1 + |u|) / z, with |u| <= 1. The ends of a piece are
    /// rounded where it was cut.
    #[inline]
    fn width(&self, p: DVec3, q: DVec3, near: f64, slack: f64) -> f64 {
        let rounding = EDGE_ROUNDING * (p.abs().max_element() + q.abs().max_element());
        EDGE + (2.0 * slack + rounding) / near * self.per_unit
    }

    /// Draws the outline of a patch, whose sides are these.
    #[inline(always)]
    pub(super) fn draw(&self, raster: &mut Raster, d: &Drawable, sides: &[SeenSide], deep: &[DeepSide]) {
        let by = d.sign();
        let cut = !self.face.parallel && self.cuts(&d.block);
        let mut base = None;
        for side in sides {
            let deep = match side.kind {
                SideKind::Plain(wide) => {
                    raster.edge(side.from, side.to, by, wide, side.seam);
                    continue;
                }
                SideKind::Deep(place) => &deep[place as usize],
            };
            self.draw_deep(raster, deep, by, side.seam);
            // An outline that the near limit cuts is closed along it, far outside the face.
            if cut && let Some((at, leaves)) = self.cut(deep.ends) {
                let base = *base.get_or_insert(at);
                // From where the outline leaves to where it comes back.
                let (a, b) = if leaves { (at, base) } else { (base, at) };
                let (from, to) = (self.pixel(a), self.pixel(b));
                raster.edge(from, to, by, EDGE, false);
            }
        }
    }

    /// Draws a side in pieces whose depth doubles at most, from the near limit on.
    fn draw_deep(&self, raster: &mut Raster, side: &DeepSide, by: i16, seam: bool) {
        let ([mut p, mut q], slack) = (side.ends, side.slack);
        if self.face.parallel {
            let (from, to, wide) = (self.pixel(p), self.pixel(q), self.parallel_width(slack));
            return raster.edge(from, to, by, wide, seam);
        }
        if p.z < self.limit && q.z < self.limit {
            return;
        }
        if let Some((cut, leaves)) = self.cut(side.ends) {
            if leaves { q = cut } else { p = cut }
        }
        let (near, far, by) = if p.z <= q.z { (p, q, by) } else { (q, p, -by) };
        let mut start = near;
        loop {
            let end = 2.0 * start.z.max(slack);
            let stop =
                if end < far.z { near + (far - near) * ((end - near.z) / (far.z - near.z)) } else { far };
            let slack = if stop.z <= 2.0 * slack { 0.0 } else { slack };
            let wide = self.width(p, q, start.z, slack);
            let (from, to) = (self.pixel(start), self.pixel(stop));
            raster.edge(from, to, by, wide, seam);
            if end >= far.z {
                break;
            }
            start = stop;
        }
    }

    /// Where an edge passes the near limit, and whether it goes to lesser depths there.
    fn cut(&self, [p, q]: [DVec3; 2]) -> Option<(DVec3, bool)> {
        if (p.z < self.limit) == (q.z < self.limit) {
            return None;
        }
        let leaves = q.z < self.limit;
        // Always from the lesser to the greater depth: two patches that share the edge get the same point.
        let (p, q) = if leaves { (q, p) } else { (p, q) };
        let mut at = p + (q - p) * ((self.limit - p.z) / (q.z - p.z));
        at.z = self.limit;
        Some((at, leaves))
    }

    /// Whether the near limit passes through a box.
    fn cuts(&self, block: &Block) -> bool {
        let (p, q) = (self.face.local(block.min), self.face.local(block.max));
        p.z.min(q.z) < self.limit && p.z.max(q.z) >= self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face() -> Face {
        Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false }
    }

    #[test]
    fn edges_are_cut_at_the_near_limit() {
        let face = face();
        let projector = Projector { face: &face, per_unit: 32.0, limit: 0.5 };
        let (near, far) = (DVec3::new(1.0, 0.0, -0.5), DVec3::new(3.0, 2.0, 1.5));
        let expected = DVec3::new(2.0, 1.0, 0.5);
        assert_eq!(projector.cut([near, far]), Some((expected, false)));
        assert_eq!(projector.cut([far, near]), Some((expected, true)));
        assert_eq!(projector.cut([far, far + DVec3::Z]), None);
        assert!(projector.cuts(&Block { min: near, max: far }));
        assert!(!projector.cuts(&Block { min: far, max: far + 1.0 }));
    }

    #[test]
    fn widths_hold_every_point_that_is_off_by_the_slack() {
        let face = face();
        let projector = Projector { face: &face, per_unit: 512.0, limit: 0.1 };
        let slack = 0.02;
        let (p, q) = (DVec3::new(-1.5, 0.3, 2.0), DVec3::new(2.5, -1.0, 3.0));
        let wide = projector.plain_width(p, q, slack).unwrap();
        for (end, at) in [(p, projector.pixel(p)), (q, projector.pixel(q))] {
            for offset in
                [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.0, -0.8), DVec3::new(0.0, -0.6, -0.8)]
            {
                let moved = projector.pixel(end + offset * slack);
                assert!((moved.0 - at.0).abs() <= wide && (moved.1 - at.1).abs() <= wide, "{end} {offset}");
            }
        }
        // Over a large range of depths there is no one width.
        assert_eq!(projector.plain_width(p, q * 10.0, slack), None);
        assert_eq!(projector.plain_width(p, q * 10.0, 0.0), Some(EDGE));
        assert_eq!(projector.plain_width(p, DVec3::new(0.0, 0.0, 0.05), 0.0), None);
    }
}

//! Rectangles of pixels, and the window of a face that is divided into them.

use crate::numeric::occlusion::{NEAREST_INTEGER, PIXEL};
use crate::occlusion::face::Rect;
use crate::occlusion::tiles::TILE;

/// A rectangle of pixels of a face, upper ends excluded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PixelRect {
    pub(crate) x: (i64, i64),
    pub(crate) y: (i64, i64),
}

impl PixelRect {
    /// No pixels; joined with a rectangle it gives that.
    pub(crate) const EMPTY: Self = Self { x: (i64::MAX, i64::MIN), y: (i64::MAX, i64::MIN) };

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.x.0 >= self.x.1 || self.y.0 >= self.y.1
    }

    /// Number of pixels of a rectangle that is not empty.
    #[inline]
    pub(crate) fn count(&self) -> u64 {
        ((self.x.1 - self.x.0) * (self.y.1 - self.y.0)) as u64
    }

    /// The smallest rectangle around both.
    #[inline]
    pub(crate) fn join(&self, o: &Self) -> Self {
        let join = |a: (i64, i64), b: (i64, i64)| (a.0.min(b.0), a.1.max(b.1));
        Self { x: join(self.x, o.x), y: join(self.y, o.y) }
    }

    /// The pixels of both.
    #[inline]
    pub(crate) fn intersect(&self, o: &Self) -> Self {
        let both = |a: (i64, i64), b: (i64, i64)| (a.0.max(b.0), a.1.min(b.1));
        Self { x: both(self.x, o.x), y: both(self.y, o.y) }
    }

    /// Whether two rectangles share a pixel.
    #[inline]
    pub(crate) fn overlaps(&self, o: &Self) -> bool {
        self.x.0 < o.x.1 && o.x.0 < self.x.1 && self.y.0 < o.y.1 && o.y.0 < self.y.1
    }

    /// Its first and last tile along x. The rectangle is not empty.
    #[inline]
    pub(crate) fn tiles_x(&self) -> (i64, i64) {
        (self.x.0 / TILE, (self.x.1 - 1) / TILE)
    }

    /// Its first and last tile along y. The rectangle is not empty.
    #[inline]
    pub(crate) fn tiles_y(&self) -> (i64, i64) {
        (self.y.0 / TILE, (self.y.1 - 1) / TILE)
    }
}

/// How a face is divided into pixels, and the rectangle of them that is kept.
///
/// Pixels are counted from the lower left corner of the whole face.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    /// Width of a pixel on the face, and its inverse.
    step: f64,
    per_unit: f64,
    /// First tile, and number of tiles.
    first: (i64, i64),
    count: (i64, i64),
    pixels: PixelRect,
}

impl Window {
    /// A window without pixels, of a face that has `pixels` along each side.
    pub(crate) fn empty(pixels: i64) -> Self {
        Self {
            step: 2.0 / pixels as f64,
            per_unit: pixels as f64 / 2.0,
            first: (0, 0),
            count: (0, 0),
            pixels: PixelRect { x: (0, 0), y: (0, 0) },
        }
    }

    /// The pixels that a rectangle touches, of a face that has `pixels` along each side.
    pub(crate) fn around(rect: &Rect, pixels: i64) -> Self {
        let mut window = Self::empty(pixels);
        let (x, y) =
            (window.touched(rect.u0, rect.u1, (0, pixels)), window.touched(rect.v0, rect.v1, (0, pixels)));
        window.pixels = PixelRect { x, y };
        window.first = (x.0 / TILE, y.0 / TILE);
        window.count = ((x.1 - 1) / TILE + 1 - window.first.0, (y.1 - 1) / TILE + 1 - window.first.1);
        window
    }

    /// The pixels of the window.
    #[inline]
    pub(crate) fn pixels(&self) -> &PixelRect {
        &self.pixels
    }

    /// Pixels for one unit of the face, whose width is two.
    #[inline]
    pub(crate) fn per_unit(&self) -> f64 {
        self.per_unit
    }

    /// Pixels along each side of the whole face.
    pub(crate) fn face_pixels(&self) -> i64 {
        (self.per_unit * 2.0).round() as i64
    }

    /// Its first tile.
    #[inline]
    pub(crate) fn first_tile(&self) -> (i64, i64) {
        self.first
    }

    /// Number of its tiles along x and y.
    #[inline]
    pub(crate) fn tile_count(&self) -> (i64, i64) {
        self.count
    }

    /// The place of a tile in lists of all tiles of the window, row by row.
    #[inline]
    pub(crate) fn tile_index(&self, tx: i64, ty: i64) -> usize {
        ((ty - self.first.1) * self.count.0 + tx - self.first.0) as usize
    }

    /// Left or lower border of a pixel.
    #[inline]
    pub(crate) fn border(&self, p: i64) -> f64 {
        p as f64 * self.step - 1.0
    }

    /// Width of a pixel.
    #[inline]
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// A square of pixels as directions.
    #[inline]
    pub(crate) fn square(&self, x: i64, y: i64, size: i64) -> Rect {
        Rect { u0: self.border(x), v0: self.border(y), u1: self.border(x + size), v1: self.border(y + size) }
    }

    /// A rectangle of pixels as directions.
    pub(crate) fn rect(&self, pixels: &PixelRect) -> Rect {
        let (x, y) = (pixels.x, pixels.y);
        Rect { u0: self.border(x.0), v0: self.border(y.0), u1: self.border(x.1), v1: self.border(y.1) }
    }

    /// The pixels of `range` that the part of the face between two coordinates touches.
    #[inline]
    fn touched(&self, lo: f64, hi: f64, range: (i64, i64)) -> (i64, i64) {
        // Also if both are infinite.
        if (lo + hi).is_nan() {
            return range;
        }
        let within = |p: f64| nearest_integer(p.clamp(range.0 as f64, range.1 as f64));
        // Half a pixel more than the margin makes a floor of the nearest integer, and a ceiling.
        let first = within((lo + 1.0) * self.per_unit - (PIXEL + 0.5));
        let end = within((hi + 1.0) * self.per_unit + (PIXEL + 0.5));
        (first.into(), end.into())
    }

    /// The pixels of the window that a rectangle touches.
    #[inline]
    pub(crate) fn touched_by(&self, rect: &Rect) -> PixelRect {
        PixelRect {
            x: self.touched(rect.u0, rect.u1, self.pixels.x),
            y: self.touched(rect.v0, rect.v1, self.pixels.y),
        }
    }

    /// The pixel of the window with a point in it; `None` beside the window.
    pub(crate) fn pixel_at(&self, u: f64, v: f64) -> Option<(i64, i64)> {
        let at = |c: f64, (lo, hi): (i64, i64)| {
            let pixel = floor(((c + 1.0) * self.per_unit).clamp(-1.0, hi as f64));
            (lo <= pixel && pixel < hi).then_some(pixel)
        };
        Some((at(u, self.pixels.x)?, at(v, self.pixels.y)?))
    }
}

/// The integer nearest to a number whose magnitude is below 2^31, halves to even, by the digits
/// that are left of a sum: unlike a conversion, this vectorises on all processors. That of `v -
/// 0.5` is the floor of `v`, except that odd integers go down by one.
#[inline(always)]
pub(crate) fn nearest_integer(v: f64) -> i32 {
    (v + NEAREST_INTEGER).to_bits() as i32
}

/// The floor of a number within the range of `i64`.
///
/// `f64::floor` calls a library function on processors without SSE4.1, for which this is compiled.
#[inline]
pub(crate) fn floor(v: f64) -> i64 {
    let whole = v as i64;
    whole - i64::from(whole as f64 > v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_touches_its_pixels_and_no_others() {
        // Pixels of width 0.125.
        let window = Window::around(&Rect { u0: -0.5, v0: -1.0, u1: 0.49, v1: 1.0 }, 16);
        // An end on a border touches the pixels on both of its sides.
        assert_eq!(*window.pixels(), PixelRect { x: (3, 12), y: (0, 16) });
        assert_eq!((window.first_tile(), window.tile_count()), ((0, 0), (2, 2)));
        let inside = Rect { u0: 0.01, v0: 0.01, u1: 0.02, v1: 0.26 };
        assert_eq!(window.touched_by(&inside), PixelRect { x: (8, 9), y: (8, 11) });
        assert_eq!(window.pixel_at(0.01, 0.26), Some((8, 10)));
        assert_eq!(window.pixel_at(-0.9, 0.0), None);
        assert_eq!(window.rect(&PixelRect { x: (8, 16), y: (8, 16) }), window.square(8, 8, 8));
        let square = window.square(8, 8, 8);
        assert_eq!((square.u0, square.v0, square.u1, square.v1), (0.0, 0.0, 1.0, 1.0));
        // A bound that is not a number touches everything.
        assert_eq!(window.touched_by(&Rect { u0: f64::NAN, ..inside }).x, (3, 12));
    }

    #[test]
    fn rectangles_join_and_intersect() {
        let (a, b) = (PixelRect { x: (0, 4), y: (2, 6) }, PixelRect { x: (3, 9), y: (5, 7) });
        assert_eq!(a.join(&b), PixelRect { x: (0, 9), y: (2, 7) });
        assert_eq!(a.intersect(&b), PixelRect { x: (3, 4), y: (5, 6) });
        assert!(a.overlaps(&b) && !a.overlaps(&PixelRect { x: (4, 9), y: (2, 6) }));
        assert_eq!(PixelRect::EMPTY.join(&a), a);
        assert!(PixelRect::EMPTY.is_empty() && a.intersect(&PixelRect::EMPTY).is_empty());
        assert_eq!((b.tiles_x(), b.tiles_y()), ((0, 1), (0, 0)));
    }

    #[test]
    fn floors() {
        for v in [-2.0, -1.5, -0.1, 0.0, 0.9, 1.0, 1e9 + 0.5] {
            assert_eq!(floor(v), v.floor() as i64);
        }
        for v in [-1000.4, -7.6, -0.6, -0.5, 0.0, 0.4, 0.5, 1.5, 2.5, 7.6, 16_777_216.3] {
            assert_eq!(f64::from(nearest_integer(v)), v.round_ties_even());
        }
        let floors = [3.999, 4.0, 5.0].map(|v| nearest_integer(v - 0.5));
        assert_eq!(floors, [3, 4, 4], "odd integers go down by one");
    }
}

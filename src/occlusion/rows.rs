//! Rows of pixels inside a silhouette, eight at a time.
//!
//! A silhouette is prepared once for a face: each edge of a polygon becomes a line that gives a
//! column for each row, and a conic two roots for each border between rows. A silhouette is convex,
//! so a row of pixels is inside as far as both of its borders are. Everything is kept in pixels,
//! and the loops over the eight rows of a tile have no branches, so that compilers vectorise them,
//! for the best vectors of the processor where the caller is compiled for them
//! ([`simd`](crate::simd)).

use fearless_simd::prelude::*;
use fearless_simd::{i32x8, u32x8};
use smallvec::SmallVec;

use crate::numeric::occlusion::{
    CHORD_ROUNDING, CONIC, CONIC_PARABOLA, HALF_PLANE_OUTSIDE, HALF_PLANE_SLOPE, PIXEL,
};
use crate::numeric::shape::CONE_MARGIN;
use crate::numeric::{greater, lesser};
use crate::occlusion::face::Linear;
use crate::occlusion::pixels::{PixelRect, Window, floor, nearest_integer};
use crate::occlusion::silhouette::{Silhouette, SilhouetteKind};
use crate::occlusion::tiles::TILE;
use crate::simd::vectorized;

/// Rows of a tile.
const ROWS: usize = TILE as usize;

/// A column that no window has, so that a row from here to minus here is empty in each tile.
const BEYOND: i32 = 1 << 28;

/// A bound on the columns of each row, in pixels: `at + slope * row`.
#[derive(Debug, Clone, Copy)]
struct Bound {
    at: f64,
    slope: f64,
}

/// A conic whose roots are `middle +- root` on the border at height `v`, for `rest = b v + c`:
/// `middle = rest * shift + origin` and `root = sqrt(k (rest^2 - width ((v - v0)^2 + e))) * scale`.
#[derive(Debug, Clone, Copy)]
struct Conic {
    s: Linear,
    k: f64,
    v0: f64,
    e: f64,
    width: f64,
    shift: f64,
    origin: f64,
    scale: f64,
    /// How far the roots may be off, in pixels.
    error: f64,
}

/// Which pixels are asked for: those inside for sure, or all that may be touched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rounding {
    Inwards,
    Outwards,
}

#[derive(Debug, Clone, Copy, Default)]
enum RowShape {
    /// A polygon is covered between its bounds.
    #[default]
    Polygon,
    /// An ellipse is covered between its roots.
    Ellipse(Conic),
    /// A hyperbola is covered beyond one root, on the side of greater columns if `right`.
    Hyperbola { conic: Conic, right: bool },
}

/// A shape on a face that is ready to be asked for rows of pixels. It is filled again for each
/// shape; methods that do so return whether there may be covered pixels.
#[derive(Debug, Clone, Default)]
pub(crate) struct ShapeRows {
    shape: RowShape,
    /// Columns of a polygon are not less than these.
    lower: SmallVec<[Bound; 6]>,
    /// They are not greater than these.
    upper: SmallVec<[Bound; 6]>,
    /// The pixels outside of which nothing is covered.
    pixels: PixelRect,
    /// Height of the lower border of row 0, and of a row.
    base: f64,
    step: f64,
    /// Number of columns of the whole face.
    columns: f64,
    /// Half a pixel more than the margin by which columns are moved inwards; less than zero if
    /// outwards.
    inset: f64,
}

/// The pixels of a shape in one row of tiles.
#[derive(Debug)]
pub(crate) struct TileRow {
    /// For each row of pixels, the first covered column and the one after the last.
    first: [i32; ROWS],
    end: [i32; ROWS],
    /// Columns that some row covers, and that all rows cover.
    some: (i32, i32),
    all: (i32, i32),
}

impl TileRow {
    /// The columns that some row covers, upper end excluded.
    #[inline(always)]
    pub(crate) fn columns(&self) -> (i64, i64) {
        (self.some.0.into(), self.some.1.into())
    }

    /// Whether the tile that begins at column `x` is covered as a whole.
    #[inline(always)]
    pub(crate) fn covers_tile(&self, x: i64) -> bool {
        i64::from(self.all.0) <= x && x + TILE <= self.all.1.into()
    }

    /// The covered pixels of any tile of the window.
    pub(crate) fn mask_of_tile(&self, x: i64) -> u64 {
        if self.covers_tile(x) {
            u64::MAX
        } else if x + TILE <= self.some.0.into() || i64::from(self.some.1) <= x {
            0
        } else {
            vectorized!(simd => self.mask(simd, x))
        }
    }

    /// The covered pixels of the tile that begins at column `x`.
    #[inline(always)]
    pub(crate) fn mask<S: Simd>(&self, simd: S, x: i64) -> u64 {
        let x = x as i32;
        let from = |columns: &[i32; ROWS]| {
            let column = (i32x8::from_slice(simd, columns) - x).max(0).min(TILE as i32);
            u32x8::splat(simd, 0xff) << column.bitcast::<u32x8<S>>()
        };
        let rows: [u32; ROWS] = (from(&self.first) & !from(&self.end)).into();
        u64::from_le_bytes(rows.map(|row| row as u8))
    }
}

impl ShapeRows {
    /// Fills it with the whole pixels inside a silhouette that lies in a rectangle of them.
    pub(crate) fn set_inside(
        &mut self,
        silhouette: &Silhouette,
        window: &Window,
        pixels: &PixelRect,
    ) -> bool {
        self.pixels = *pixels;
        let mut error = 0.0;
        match *silhouette.kind() {
            SilhouetteKind::Polygon => {
                if !self.set_polygon(silhouette.halves(), window, Rounding::Inwards) {
                    return false;
                }
            }
            SilhouetteKind::Conic { s, k, u0, v0, e, .. } => {
                let Some(shape) = conic(&s, k, (u0, v0), e, window) else { return false };
                self.shape = shape;
                if let RowShape::Ellipse(conic) | RowShape::Hyperbola { conic, .. } = shape {
                    error = conic.error;
                }
            }
            SilhouetteKind::Everything => return false,
        }
        self.set_scale(window, PIXEL + error + 0.5)
    }

    /// Fills it with the pixels of a window that may reach into all half-planes.
    pub(crate) fn set_touching(&mut self, halves: &[Linear], window: &Window) -> bool {
        self.pixels = *window.pixels();
        self.set_polygon(halves, window, Rounding::Outwards) && self.set_scale(window, -PIXEL - 0.5)
    }

    fn set_scale(&mut self, window: &Window, inset: f64) -> bool {
        (self.base, self.step, self.columns) = (window.border(0), window.step(), window.per_unit() * 2.0);
        self.inset = inset;
        !self.pixels.is_empty()
    }

    /// Prepares the half-planes of a polygon. Those that bound rows narrow the rectangle of pixels
    /// instead.
    fn set_polygon(&mut self, halves: &[Linear], window: &Window, rounding: Rounding) -> bool {
        self.shape = RowShape::Polygon;
        let (step, per_unit, base) = (window.step(), window.per_unit(), window.border(0));
        let Self { lower, upper, pixels, .. } = self;
        lower.clear();
        upper.clear();
        let inwards = rounding == Rounding::Inwards;
        let margin = if inwards { CONE_MARGIN } else { 0.0 };
        for half in halves {
            if !(half.a + half.b + half.c).is_finite() {
                if inwards {
                    return false;
                }
                continue;
            }
            let c = half.c - margin;
            if half.a.abs() > HALF_PLANE_SLOPE {
                // The border of a row that lies farther outside, or farther inside.
                let v = if (half.b < 0.0) == inwards { base + step } else { base };
                let inverse = -1.0 / half.a;
                let at = ((half.b * v + c) * inverse + 1.0) * per_unit;
                let bound = Bound { at, slope: half.b * inverse };
                if half.a > 0.0 {
                    lower.push(bound)
                } else {
                    upper.push(bound)
                }
                continue;
            }
            // All columns of the face are as far inside but for this.
            let c = if inwards { c - HALF_PLANE_SLOPE } else { c + HALF_PLANE_OUTSIDE };
            if half.b.abs() <= HALF_PLANE_SLOPE {
                let slack = if inwards { HALF_PLANE_SLOPE } else { -HALF_PLANE_SLOPE };
                if c < slack {
                    return false;
                }
                continue;
            }
            let row = ((1.0 - c / half.b) * per_unit).clamp(pixels.y.0 as f64 - 2.0, pixels.y.1 as f64 + 2.0);
            match (half.b > 0.0, inwards) {
                (true, true) => pixels.y.0 = pixels.y.0.max(-floor(-(row + PIXEL))),
                (true, false) => pixels.y.0 = pixels.y.0.max(floor(row - PIXEL)),
                (false, true) => pixels.y.1 = pixels.y.1.min(floor(row - PIXEL)),
                (false, false) => pixels.y.1 = pixels.y.1.min(floor(row + PIXEL) + 1),
            }
        }
        true
    }

    /// The pixels outside of which nothing is covered.
    pub(crate) fn pixels(&self) -> &PixelRect {
        &self.pixels
    }

    /// The covered pixels of the row of tiles `ty`.
    #[inline(always)]
    pub(crate) fn tile_row(&self, ty: i64) -> TileRow {
        let y = ty * TILE;
        let v = self.base + self.step * y as f64;
        let columns = match &self.shape {
            RowShape::Polygon => {
                let rows = ((self.pixels.y.0 - y) as f64, (self.pixels.y.1 - y) as f64);
                between(&self.lower, &self.upper, y as f64, rows)
            }
            RowShape::Ellipse(conic) => conic.inside(v, self.step),
            RowShape::Hyperbola { conic, right } => conic.beside(*right, v, self.step),
        };
        self.pixels_between(columns, self.inset)
    }

    /// The pixels between two columns in each row from `y` on, at least `inset` from both after
    /// rounding to the nearest borders of pixels.
    #[inline(always)]
    fn pixels_between(&self, (lo, hi): ([f64; ROWS], [f64; ROWS]), inset: f64) -> TileRow {
        let (x0, x1) = (self.pixels.x.0 as f64, self.pixels.x.1 as f64);
        let (mut first, mut end) = ([0; ROWS], [0; ROWS]);
        for i in 0..ROWS {
            // The borders of the face itself are exact.
            let a = if lo[i] <= 0.0 { 0.0 } else { lo[i] + inset };
            let b = if hi[i] >= self.columns { self.columns } else { hi[i] - inset };
            let (a, b) =
                (nearest_integer(lesser(greater(a, x0), x1)), nearest_integer(lesser(greater(b, x0), x1)));
            first[i] = if a < b { a } else { BEYOND };
            end[i] = if a < b { b } else { -BEYOND };
        }
        let (mut some, mut all) = ((BEYOND, -BEYOND), (-BEYOND, BEYOND));
        for i in 0..ROWS {
            some = (some.0.min(first[i]), some.1.max(end[i]));
            all = (all.0.max(first[i]), all.1.min(end[i]));
        }
        TileRow { first, end, some, all }
    }
}

/// Prepares a conic; `None` for one that is hardly an ellipse or a hyperbola, or whose numbers
/// overflowed.
fn conic(s: &Linear, k: f64, (u0, v0): (f64, f64), e: f64, window: &Window) -> Option<RowShape> {
    let (width, per_unit) = (k - s.a * s.a, window.per_unit());
    let finite = (s.a + s.b + s.c + k + u0 + v0 + e).is_finite() && width.is_finite();
    if !finite || width.abs() <= CONIC_PARABOLA {
        return None;
    }
    let conic = Conic {
        s: *s,
        k,
        v0,
        e,
        width,
        shift: s.a / width * per_unit,
        origin: (u0 + 1.0) * per_unit,
        scale: per_unit / width.abs(),
        error: CHORD_ROUNDING * per_unit / width.abs(),
    };
    Some(if width > 0.0 { RowShape::Ellipse(conic) } else { RowShape::Hyperbola { conic, right: s.a > 0.0 } })
}

/// The columns between all bounds, for the rows from `y` on; none in rows outside of `rows`, which
/// are counted from `y`.
#[inline(always)]
fn between(lower: &[Bound], upper: &[Bound], y: f64, rows: (f64, f64)) -> ([f64; ROWS], [f64; ROWS]) {
    let (mut lo, mut hi) = ([f64::MIN; ROWS], [f64::MAX; ROWS]);
    for (i, lo) in lo.iter_mut().enumerate() {
        let i = i as f64;
        *lo = if (i >= rows.0) & (i < rows.1) { f64::MIN } else { f64::MAX };
    }
    for bound in lower {
        let at = bound.at + bound.slope * y;
        for (i, lo) in lo.iter_mut().enumerate() {
            *lo = greater(*lo, at + bound.slope * i as f64);
        }
    }
    for bound in upper {
        let at = bound.at + bound.slope * y;
        for (i, hi) in hi.iter_mut().enumerate() {
            *hi = lesser(*hi, at + bound.slope * i as f64);
        }
    }
    (lo, hi)
}

impl Conic {
    /// The middle between its roots on the border at height `v`, the square under the root, and
    /// whether `rest` is positive: the line then meets the cone in front of the eye.
    #[inline(always)]
    fn line(&self, v: f64) -> (f64, f64, bool) {
        let (dv, rest) = (v - self.v0, self.s.b * v + self.s.c);
        let square = self.k * (rest * rest - self.width * (dv * dv + self.e));
        (rest * self.shift + self.origin, square, rest > 0.0)
    }

    /// The columns inside an ellipse, for rows from the border at height `v` on.
    #[inline(always)]
    fn inside(&self, v: f64, step: f64) -> ([f64; ROWS], [f64; ROWS]) {
        let (mut lo, mut hi) = ([f64::MAX; ROWS + 1], [f64::MIN; ROWS + 1]);
        for i in 0..=ROWS {
            let (middle, square, front) = self.line(v + step * i as f64);
            let root = greater(square - CONIC, 0.0).sqrt() * self.scale;
            let meets = front & (square > CONIC);
            lo[i] = if meets { middle - root } else { f64::MAX };
            hi[i] = if meets { middle + root } else { f64::MIN };
        }
        (
            std::array::from_fn(|i| greater(lo[i], lo[i + 1])),
            std::array::from_fn(|i| lesser(hi[i], hi[i + 1])),
        )
    }

    /// The columns inside the branch of a hyperbola that opens to greater columns if `right`.
    #[inline(always)]
    fn beside(&self, right: bool, v: f64, step: f64) -> ([f64; ROWS], [f64; ROWS]) {
        let root = |i: usize| {
            let (middle, square, _) = self.line(v + step * i as f64);
            let root = greater(square + CONIC, 0.0).sqrt() * self.scale;
            if right { middle + root } else { middle - root }
        };
        if right {
            (std::array::from_fn(|i| greater(root(i), root(i + 1))), [f64::MAX; ROWS])
        } else {
            ([f64::MIN; ROWS], std::array::from_fn(|i| lesser(root(i), root(i + 1))))
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::Room;
    use crate::geometry::aspect::Aspect;
    use crate::geometry::body::Body;
    use crate::occlusion::face::{Face, Rect};
    use crate::random::Random;

    const PIXELS: i64 = 64;

    /// The pixels of the whole face that a silhouette covers, and those that are well inside of it.
    fn check(body: &Body) -> usize {
        let face = Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false };
        let window = Window::around(&Rect::FACE, PIXELS);
        let (mut aspect, mut silhouette) = (Aspect::default(), Silhouette::default());
        aspect.set_body(body, None, &Room::NONE);
        silhouette.set(&aspect, &face);
        let mut rows = ShapeRows::default();
        let any = rows.set_inside(&silhouette, &window, window.pixels());
        let mut covered = 0;
        for ty in 0..PIXELS / TILE {
            let row = any.then(|| rows.tile_row(ty));
            for (x, y) in (0..PIXELS).flat_map(|x| (ty * TILE..(ty + 1) * TILE).map(move |y| (x, y))) {
                let tile = x / TILE * TILE;
                let bit = 8 * (y - ty * TILE) + x - tile;
                let own = row.as_ref().is_some_and(|row| row.mask_of_tile(tile) >> bit & 1 == 1);
                let square = window.square(x, y, 1);
                assert!(!own || silhouette.covers(&square), "{body:?} {x} {y}");
                let room = 1e-6;
                let (u0, v0) = (square.u0 - room, square.v0 - room);
                let larger = Rect { u0, v0, u1: square.u1 + room, v1: square.v1 + room };
                assert!(own || !silhouette.covers(&larger), "{body:?} {x} {y}");
                covered += usize::from(own);
            }
        }
        covered
    }

    #[test]
    fn numbers_that_overflowed_cover_nothing() {
        let window = Window::around(&Rect::FACE, PIXELS);
        let fine = [0.5, 0.25, 0.75];
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..3 {
                let mut of = fine;
                of[place] = bad;
                let half = Linear { a: of[0], b: of[1], c: of[2] };
                let mut rows = ShapeRows::default();
                assert!(!rows.set_polygon(&[half], &window, Rounding::Inwards));
                assert!(rows.set_touching(&[half], &window) && rows.tile_row(0).covers_tile(0));
                assert!(conic(&half, 0.5, (0.0, 0.0), 1.0, &window).is_none());
            }
            let s = Linear { a: 0.1, b: 0.2, c: 0.9 };
            assert!(conic(&s, bad, (0.0, 0.0), 1.0, &window).is_none());
            assert!(conic(&s, 0.5, (bad, 0.0), 1.0, &window).is_none());
            assert!(conic(&s, 0.5, (0.0, bad), 1.0, &window).is_none());
        }
    }

    #[test]
    fn rows_are_those_that_the_silhouette_covers() {
        let mut random = Random::new(3);
        let mut next = || random.next() - 0.5;
        let (mut spheres, mut boxes, mut beside) = (0, 0, 0);
        for _ in 0..100 {
            // Some centres are so far aside that the conic is a hyperbola.
            let center = DVec3::new(next() * 6.0, next() * 6.0, next() + 1.0);
            let radius = center.length() * (0.1 + 0.8 * (next() + 0.5));
            let found = check(&Body::Sphere { center, radius });
            spheres += found;
            beside += if radius > center.z { found } else { 0 };
            let half = DVec3::new(next(), next(), next()).abs() + 0.1;
            let block = Block { min: center - half, max: center + half };
            boxes += check(&Body::Block(block));
        }
        assert!(spheres > 10_000 && boxes > 5000 && beside > 10_000, "{spheres} {boxes} {beside}");
    }
}

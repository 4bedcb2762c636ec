//! Rows of pixels inside a silhouette, eight at a time.
//!
//! A silhouette is prepared once for a face: each edge of a polygon becomes a line that gives a column for each row, and
//! a conic two roots for each border between rows. A silhouette is convex, so a row of pixels is inside as far as both
//! of its borders are. Everything is kept in pixels, and the loops over the eight rows of a tile have no branches, so
//! that compilers vectorise them.

use smallvec::SmallVec;

use crate::numeric::occlusion::{CHORD_ROUNDING, CONIC, CONIC_PARABOLA, HALF_PLANE_SLOPE, PIXEL};
use crate::numeric::shape::CONE_MARGIN;
use crate::occlusion::face::Linear;
use crate::occlusion::pixels::{PixelRect, Window, floor, nearest_integer};
use crate::occlusion::silhouette::{Kind, Silhouette};
use crate::occlusion::tiles::TILE;

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

#[derive(Debug)]
enum Shape {
    Polygon {
        /// Columns are not less than these.
        lower: SmallVec<[Bound; 6]>,
        /// Columns are not greater than these.
        upper: SmallVec<[Bound; 6]>,
    },
    /// An ellipse is covered between its roots.
    Ellipse(Conic),
    /// A hyperbola is covered beyond one root, on the side of greater columns if `right`.
    Hyperbola { conic: Conic, right: bool },
}

/// A silhouette that is ready to be asked for rows of pixels.
#[derive(Debug)]
pub(crate) struct Rows {
    shape: Shape,
    /// The pixels outside of which nothing is covered.
    pixels: PixelRect,
    /// Height of the lower border of row 0, and of a row.
    base: f64,
    step: f64,
    /// Number of columns of the whole face.
    columns: f64,
}

/// The pixels that a silhouette covers in one row of tiles.
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
    #[inline]
    pub(crate) fn columns(&self) -> (i64, i64) {
        (self.some.0.into(), self.some.1.into())
    }

    /// Whether the tile that begins at column `x` is covered as a whole.
    #[inline]
    pub(crate) fn covers_tile(&self, x: i64) -> bool {
        i64::from(self.all.0) <= x && x + TILE <= self.all.1.into()
    }

    /// The covered pixels of the tile that begins at column `x`.
    #[inline]
    pub(crate) fn mask(&self, x: i64) -> u64 {
        let x = x as i32;
        let within = |columns: &[i32; ROWS]| columns.map(|c| (c - x).clamp(0, TILE as i32));
        let (first, end) = (within(&self.first), within(&self.end));
        let mut mask = 0;
        for i in 0..ROWS {
            let row = 0xffu32 << first[i] & !(0xff << end[i]) & 0xff;
            mask |= u64::from(row) << (8 * i);
        }
        mask
    }
}

/// The greater and the lesser of two numbers, of which none is NaN.
#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

impl Rows {
    /// The rows of a silhouette that lies in a rectangle of pixels; `None` if none of them is covered for sure.
    pub(crate) fn new(silhouette: &Silhouette, window: &Window, pixels: &PixelRect) -> Option<Self> {
        let mut pixels = *pixels;
        let shape = match silhouette.kind() {
            Kind::Polygon(halves) => polygon(halves, window, &mut pixels)?,
            Kind::Conic { s, k, u0, v0, e, .. } => conic(s, *k, (*u0, *v0), *e, window)?,
            Kind::Everything => return None,
        };
        let (base, step, columns) = (window.border(0), window.step(), window.per_unit() * 2.0);
        (!pixels.is_empty()).then_some(Self { shape, pixels, base, step, columns })
    }

    /// The pixels outside of which nothing is covered.
    pub(crate) fn pixels(&self) -> &PixelRect {
        &self.pixels
    }

    /// The covered pixels of the row of tiles `ty`.
    #[inline]
    pub(crate) fn tile_row(&self, ty: i64) -> TileRow {
        let y = ty * TILE;
        let v = self.base + self.step * y as f64;
        match &self.shape {
            Shape::Polygon { lower, upper } => self.whole_pixels(y, between(lower, upper, y as f64), PIXEL),
            Shape::Ellipse(conic) => self.whole_pixels(y, conic.inside(v, self.step), PIXEL + conic.error),
            Shape::Hyperbola { conic, right } => {
                self.whole_pixels(y, conic.beside(*right, v, self.step), PIXEL + conic.error)
            }
        }
    }

    /// The whole pixels between two columns in each row from `y` on, both known to within `margin`.
    #[inline(always)]
    fn whole_pixels(&self, y: i64, (lo, hi): ([f64; ROWS], [f64; ROWS]), margin: f64) -> TileRow {
        let (x0, x1) = (self.pixels.x.0 as f64, self.pixels.x.1 as f64);
        let (y0, y1) = ((self.pixels.y.0 - y) as i32, (self.pixels.y.1 - y) as i32);
        let (mut first, mut end) = ([0; ROWS], [0; ROWS]);
        for i in 0..ROWS {
            // The borders of the face itself are exact.
            let a = if lo[i] <= 0.0 { 0.0 } else { lo[i] + (margin + 0.5) };
            let b = if hi[i] >= self.columns { self.columns } else { hi[i] - (margin + 0.5) };
            let (a, b) =
                (nearest_integer(lesser(greater(a, x0), x1)), nearest_integer(lesser(greater(b, x0), x1)));
            let some = (a < b) & (i as i32 >= y0) & ((i as i32) < y1);
            first[i] = if some { a } else { BEYOND };
            end[i] = if some { b } else { -BEYOND };
        }
        let (mut some, mut all) = ((BEYOND, -BEYOND), (-BEYOND, BEYOND));
        for i in 0..ROWS {
            some = (some.0.min(first[i]), some.1.max(end[i]));
            all = (all.0.max(first[i]), all.1.min(end[i]));
        }
        TileRow { first, end, some, all }
    }
}

/// Prepares the half-planes of a polygon. Those that bound rows narrow `pixels` instead.
fn polygon(halves: &[Linear], window: &Window, pixels: &mut PixelRect) -> Option<Shape> {
    let (step, per_unit, base) = (window.step(), window.per_unit(), window.border(0));
    let (mut lower, mut upper) = (SmallVec::new(), SmallVec::new());
    for half in halves {
        let c = half.c - CONE_MARGIN;
        if half.a.abs() > HALF_PLANE_SLOPE {
            // At the border of the row that is farther outside.
            let v = if half.b < 0.0 { base + step } else { base };
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
        // No column of the face is farther outside than this.
        let c = c - HALF_PLANE_SLOPE;
        let row = (1.0 - c / half.b) * per_unit;
        let row = row.clamp(pixels.y.0 as f64 - 1.0, pixels.y.1 as f64 + 1.0);
        if half.b > HALF_PLANE_SLOPE {
            pixels.y.0 = pixels.y.0.max(-floor(-(row + PIXEL)));
        } else if half.b < -HALF_PLANE_SLOPE {
            pixels.y.1 = pixels.y.1.min(floor(row - PIXEL));
        } else if c < HALF_PLANE_SLOPE {
            return None;
        }
    }
    Some(Shape::Polygon { lower, upper })
}

/// Prepares a conic; `None` for one that is hardly an ellipse or a hyperbola.
fn conic(s: &Linear, k: f64, (u0, v0): (f64, f64), e: f64, window: &Window) -> Option<Shape> {
    let (width, per_unit) = (k - s.a * s.a, window.per_unit());
    if width.abs() <= CONIC_PARABOLA {
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
    Some(if width > 0.0 { Shape::Ellipse(conic) } else { Shape::Hyperbola { conic, right: s.a > 0.0 } })
}

/// The columns between all bounds, for the rows from `y` on.
#[inline(always)]
fn between(lower: &[Bound], upper: &[Bound], y: f64) -> ([f64; ROWS], [f64; ROWS]) {
    let (mut lo, mut hi) = ([f64::MIN; ROWS], [f64::MAX; ROWS]);
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
    /// The middle between its roots on the border at height `v`, the square under the root, and whether `rest` is
    /// positive: the line then meets the cone in front of the eye.
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

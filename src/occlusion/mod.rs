//! Occlusion buffers: pixel-precise visibility from a point, without samples.
//!
//! Six faces around the eye (one plane for parallel rays) hold tiles of coverage bits
//! with far depths. What hides is rounded inwards: a pixel is covered only if all directions in its square
//! are inside the silhouette, at a depth behind which everything is hidden on the whole
//! tile. What is tested is rounded outwards: it is hidden only if every
//! pixel that its silhouette may touch is covered nearer than its nearest point. Where pixels
//! are too coarse to decide, [`refine`] asks the silhouettes themselves.
//!
//! After the thesis' future work (section 5, occluder fusion in image space) and the sources named in
//! [`tiles`].

mod face;
mod outline;
mod refine;
mod silhouette;
mod solid;
mod target;
mod tiles;

use glam::DVec3;
use smallvec::SmallVec;

pub(crate) use outline::{Half, Polytope};
pub(crate) use refine::Effort;
pub(crate) use solid::Solid;
pub(crate) use target::Target;

use crate::mask::Side;
use crate::view::{Origin, View};
use face::{Face, Linear, Rect};
use silhouette::{Depth, Silhouette};
use target::{FaceTarget, below};
use tiles::{TILE, Tile, block, span};

/// Occluders are listed for squares of this many tiles along each side.
const BIN: i64 = 4;

/// The most pixels along a face: of the whole face, of which only the window is kept.
const MAX_PIXELS: i64 = 1 << 20;

/// Directions are compared with the frustum to this, on faces of width 2.
const FRUSTUM_MARGIN: f64 = 1e-9;

/// An occluder as drawn on one face.
#[derive(Debug)]
struct Drawn {
    silhouette: Silhouette,
    depth: Depth,
    /// Index into the list of planes.
    solid: u32,
}

/// One face's window inside the frustum.
#[derive(Debug)]
struct FaceBuffer {
    face: Face,
    active: bool,
    /// Width of a pixel.
    step: f64,
    /// First tile of the window on the face, and their number.
    tx: i64,
    ty: i64,
    nx: i64,
    ny: i64,
    /// Pixels of the window, upper ends excluded.
    px: (i64, i64),
    py: (i64, i64),
    /// Directions inside the frustum.
    halves: SmallVec<[Linear; 8]>,
    tiles: Vec<Tile>,
    /// For each tile, the nearness down to which it is closed.
    closed: Vec<f32>,
    bins: Vec<Vec<u32>>,
    drawn: Vec<Drawn>,
}

/// How finely faces are divided.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pitch {
    /// Pixels along a face that spans 90 degrees.
    pub(crate) pixels: f64,
    /// The longer side of the largest window has at least this many.
    pub(crate) least: f64,
    /// What lies nearer than this is never taken to be hidden.
    pub(crate) nearest: f64,
    /// A distance that reaches everything in sight: the width of the plane of parallel rays.
    pub(crate) reach: f64,
    /// The middle of that plane.
    pub(crate) middle: DVec3,
}

/// What testing found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Hidden,
    Visible,
}

/// The buffers of one view.
#[derive(Debug, Default)]
pub(crate) struct OcclusionBuffers {
    faces: Vec<FaceBuffer>,
    /// For each occluder drawn, the planes behind which it hides.
    fronts: Vec<SmallVec<[Half; 3]>>,
    origin: DVec3,
    error: f64,
    direction: Option<DVec3>,
    nearest: f64,
}

impl OcclusionBuffers {
    /// Clears the windows that a view looks through.
    pub(crate) fn begin(&mut self, view: &View, pitch: &Pitch) {
        self.fronts.clear();
        self.nearest = pitch.nearest;
        let wanted: SmallVec<[Face; 6]> = match view.origin {
            Origin::Eye { at, error } => {
                (self.origin, self.error, self.direction) = (at, error, None);
                Side::ALL.iter().map(Face::side).collect()
            }
            Origin::Direction(d) => {
                (self.origin, self.error, self.direction) = (pitch.middle, 0.0, Some(d));
                // Across the rays, along one of the view's own sides.
                let side = view.planes.iter().map(|p| p.normal).find(|n| n.dot(d).abs() < 1e-3);
                let right = side.map_or_else(|| d.any_orthonormal_vector(), |n| (n - d * n.dot(d)).normalize());
                SmallVec::from_iter([Face::across(d, right, pitch.reach)])
            }
        };
        self.faces.truncate(wanted.len());
        for (i, face) in wanted.into_iter().enumerate() {
            if i == self.faces.len() {
                self.faces.push(FaceBuffer::new(face));
            }
            self.faces[i].face = face;
        }
        let mut windows: SmallVec<[Option<Rect>; 6]> = SmallVec::new();
        let mut widest = 0f64;
        for buffer in &mut self.faces {
            buffer.take_frustum(view, self.origin, pitch);
            let corners = Face::clip(&Rect::FACE, &buffer.halves);
            let mut window: Option<Rect> = None;
            for &(u, v) in &corners {
                let w = window.get_or_insert(Rect { u0: u, v0: v, u1: u, v1: v });
                *w = Rect { u0: w.u0.min(u), v0: w.v0.min(v), u1: w.u1.max(u), v1: w.v1.max(v) };
            }
            if let Some(w) = window {
                widest = widest.max(w.u1 - w.u0).max(w.v1 - w.v0);
            }
            windows.push(window);
        }
        let enough = pitch.least * 2.0 / widest.max(1e-6);
        let pixels = if self.direction.is_some() { pitch.pixels * 2.0 / widest.max(1e-6) } else { pitch.pixels };
        let pixels = (pixels.max(enough).min(MAX_PIXELS as f64) / TILE as f64).ceil() as i64 * TILE;
        for (buffer, window) in self.faces.iter_mut().zip(windows) {
            buffer.clear(window, pixels.max(TILE));
        }
    }

    /// The origin of the rays: the eye, or a point in the middle of what is looked at.
    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction of parallel rays.
    pub(crate) fn direction(&self) -> Option<DVec3> {
        self.direction
    }

    /// How far the eye may lie from where it is taken to be, in any direction.
    pub(crate) fn uncertainty(&self) -> f64 {
        self.error * 3f64.sqrt()
    }

    /// Draws an occluder. Returns whether it hides anything new.
    pub(crate) fn draw(&mut self, solid: &Solid) -> bool {
        let index = self.fronts.len() as u32;
        let mut news = false;
        let mut used = false;
        for buffer in &mut self.faces {
            if buffer.active {
                let (drawn, new) = buffer.draw(solid, index);
                used |= drawn;
                news |= new;
            }
        }
        if used {
            self.fronts.push(solid.fronts.clone());
        }
        news
    }

    /// Whether every pixel that a target may touch is covered nearer than it.
    pub(crate) fn test(&self, target: &Target) -> Verdict {
        if !(target.chessboard_distance() > self.nearest) && self.direction.is_none() {
            return Verdict::Visible;
        }
        for buffer in self.faces.iter().filter(|b| b.active) {
            if let Some(on_face) = target.on_face(&buffer.face)
                && buffer.sees(&on_face)
            {
                return Verdict::Visible;
            }
        }
        Verdict::Hidden
    }

    /// Whether all pixels are closed for what lies farther than `distance` along some axis.
    pub(crate) fn closed(&self, distance: f64) -> bool {
        self.faces.iter().filter(|b| b.active).all(|b| {
            let near = target::above(b.face.nearness_of(distance));
            b.closed.iter().all(|&c| c >= near)
        })
    }

    /// Number of pixels of all windows.
    pub(crate) fn pixels(&self) -> u64 {
        let area = |b: &FaceBuffer| ((b.px.1 - b.px.0) * (b.py.1 - b.py.0)) as u64;
        self.faces.iter().filter(|b| b.active).map(area).sum()
    }
}

impl FaceBuffer {
    fn new(face: Face) -> Self {
        Self {
            face,
            active: false,
            step: 1.0,
            tx: 0,
            ty: 0,
            nx: 0,
            ny: 0,
            px: (0, 0),
            py: (0, 0),
            halves: SmallVec::new(),
            tiles: Vec::new(),
            closed: Vec::new(),
            bins: Vec::new(),
            drawn: Vec::new(),
        }
    }

    /// The frustum on the face. A plane that passes the eye at some distance bounds
    /// directions only as far as points beyond the nearest depth go.
    fn take_frustum(&mut self, view: &View, origin: DVec3, pitch: &Pitch) {
        self.halves.clear();
        for plane in &view.planes {
            let at = plane.distance(origin);
            let error = match view.origin {
                Origin::Eye { error, .. } => error * plane.normal.abs().element_sum(),
                Origin::Direction(_) => 0.0,
            };
            let slack = plane.margin(origin.abs().max_element()) + error;
            if self.face.parallel {
                let along = plane.normal.dot(self.face.forward);
                if along.abs() < 1e-6 {
                    let mut half = self.face.half(plane.normal, at + slack + along.abs() * pitch.reach);
                    half.c += FRUSTUM_MARGIN;
                    self.halves.push(half);
                }
            } else {
                let mut half = self.face.half(plane.normal, 0.0);
                half.c += (at + slack).max(0.0) / pitch.nearest + FRUSTUM_MARGIN;
                self.halves.push(half);
            }
        }
    }

    /// Left or lower border of a pixel.
    #[inline]
    fn border(&self, p: i64) -> f64 {
        p as f64 * self.step - 1.0
    }

    /// The pixels that a range of the face touches, upper end excluded.
    fn pixels(&self, lo: f64, hi: f64, window: (i64, i64)) -> (i64, i64) {
        let margin = 1e-6;
        let first = ((lo + 1.0) / self.step - margin).floor().max(window.0 as f64) as i64;
        let last = ((hi + 1.0) / self.step + margin).floor().min((window.1 - 1) as f64) as i64;
        (first, last + 1)
    }

    fn clear(&mut self, window: Option<Rect>, pixels: i64) {
        self.drawn.clear();
        self.active = false;
        self.step = 2.0 / pixels as f64;
        let Some(w) = window else { return };
        self.active = true;
        self.px = self.pixels(w.u0, w.u1, (0, pixels));
        self.py = self.pixels(w.v0, w.v1, (0, pixels));
        (self.tx, self.ty) = (self.px.0 / TILE, self.py.0 / TILE);
        (self.nx, self.ny) = ((self.px.1 - 1) / TILE + 1 - self.tx, (self.py.1 - 1) / TILE + 1 - self.ty);
        let count = (self.nx * self.ny) as usize;
        self.tiles.clear();
        self.tiles.resize(count, Tile::EMPTY);
        self.closed.clear();
        self.closed.resize(count, f32::NEG_INFINITY);
        let bins = (((self.nx - 1) / BIN + 1) * ((self.ny - 1) / BIN + 1)) as usize;
        self.bins.iter_mut().for_each(Vec::clear);
        if self.bins.len() < bins {
            self.bins.resize_with(bins, Vec::new);
        }
        // Pixels outside the frustum count as covered by something at the eye.
        for ty in 0..self.ny {
            let mut rows = [(0i64, 0i64); TILE as usize];
            for (i, row) in rows.iter_mut().enumerate() {
                *row = self.inside_row((self.ty + ty) * TILE + i as i64);
            }
            let common = rows.iter().fold((i64::MIN, i64::MAX), |c, r| (c.0.max(r.0), c.1.min(r.1)));
            for tx in 0..self.nx {
                let x = (self.tx + tx) * TILE;
                if common.0 <= x && x + TILE <= common.1 {
                    continue;
                }
                let mut inside = 0;
                for (i, row) in rows.iter().enumerate() {
                    inside |= span(row.0 - x, row.1 - x) << (8 * i);
                }
                let t = (ty * self.nx + tx) as usize;
                self.tiles[t].cover(!inside, f32::INFINITY);
                self.closed[t] = self.tiles[t].closed();
            }
        }
    }

    /// The pixels of a row that may be inside the frustum and are in the window.
    fn inside_row(&self, y: i64) -> (i64, i64) {
        if y < self.py.0 || y >= self.py.1 {
            return (0, 0);
        }
        let (v0, v1) = (self.border(y), self.border(y + 1));
        let (mut lo, mut hi) = (-1.0f64, 1.0f64);
        for half in &self.halves {
            let rest = (half.b * v0).max(half.b * v1) + half.c;
            if half.a > 1e-12 {
                lo = lo.max(-rest / half.a);
            } else if half.a < -1e-12 {
                hi = hi.min(-rest / half.a);
            } else if rest < -1e-11 {
                return (0, 0);
            }
        }
        if lo > hi { (0, 0) } else { self.pixels(lo, hi, self.px) }
    }

    fn draw(&mut self, solid: &Solid, index: u32) -> (bool, bool) {
        let Some((rect, silhouette)) = solid.on_face(&self.face) else { return (false, false) };
        let (x0, x1) = self.pixels(rect.u0, rect.u1, self.px);
        let (y0, y1) = self.pixels(rect.v0, rect.v1, self.py);
        if x0 >= x1 || y0 >= y1 {
            return (false, false);
        }
        let depth = Depth::new(&self.face, &solid.fronts, solid.farthest(&self.face));
        let drawn = self.drawn.len() as u32;
        let (bx0, bx1) = ((x0 / TILE - self.tx) / BIN, ((x1 - 1) / TILE - self.tx) / BIN);
        let (by0, by1) = ((y0 / TILE - self.ty) / BIN, ((y1 - 1) / TILE - self.ty) / BIN);
        let bins = (self.nx - 1) / BIN + 1;
        for by in by0..=by1 {
            for bx in bx0..=bx1 {
                self.bins[(by * bins + bx) as usize].push(drawn);
            }
        }
        let mut news = false;
        let conic = silhouette.is_conic();
        let per_pixel = 1.0 / self.step;
        for ty in y0 / TILE..=(y1 - 1) / TILE {
            let mut rows = [(0i64, 0i64); TILE as usize];
            let (first, last) = ((ty * TILE).max(y0), ((ty + 1) * TILE).min(y1));
            let (mut left, mut right) = (i64::MAX, i64::MIN);
            let (mut common_left, mut common_right) = (i64::MIN, i64::MAX);
            let mut whole_rows = 0;
            silhouette.rows(self.border(first), self.step, (last - first) as usize, |i, lo, hi| {
                // Whole pixels between the ends, as borders round; conics are confirmed below.
                let margin = 1e-6;
                let y = first + i as i64;
                let mut a = (((lo + 1.0) * per_pixel + margin).ceil().clamp(x0 as f64, x1 as f64)) as i64;
                let mut b = (((hi + 1.0) * per_pixel - margin).floor().clamp(x0 as f64, x1 as f64)) as i64;
                // The face's own borders are exact.
                if lo <= -1.0 {
                    a = x0;
                }
                if hi >= 1.0 {
                    b = x1;
                }
                if conic && a < b {
                    let (v0, v1) = (y as f64 * self.step - 1.0, (y + 1) as f64 * self.step - 1.0);
                    let border = |p: i64| p as f64 * self.step - 1.0;
                    let sure =
                        |a, b| silhouette.covers(&Rect { u0: border(a), v0, u1: border(b), v1 });
                    if !sure(a, b) {
                        (a, b) = (a + 1, b - 1);
                        if a < b && !sure(a, b) {
                            b = a;
                        }
                    }
                }
                rows[(y - ty * TILE) as usize] = (a, b);
                if a < b {
                    (left, right) = (left.min(a), right.max(b));
                    (common_left, common_right) = (common_left.max(a), common_right.min(b));
                    whole_rows += 1;
                }
            });
            if left >= right {
                continue;
            }
            for tx in left / TILE..=(right - 1) / TILE {
                let x = tx * TILE;
                let t = ((ty - self.ty) * self.nx + tx - self.tx) as usize;
                let rect = Rect {
                    u0: self.border(x),
                    v0: self.border(ty * TILE),
                    u1: self.border(x + TILE),
                    v1: self.border((ty + 1) * TILE),
                };
                let near = below(depth.on(&rect));
                if near <= self.closed[t] {
                    continue;
                }
                let mask = if whole_rows == TILE && common_left <= x && x + TILE <= common_right {
                    u64::MAX
                } else {
                    let mut mask = 0;
                    for (i, row) in rows.iter().enumerate() {
                        mask |= span(row.0 - x, row.1 - x) << (8 * i);
                    }
                    mask
                };
                if mask != 0 && self.tiles[t].cover(mask, near) {
                    self.closed[t] = self.tiles[t].closed();
                    news = true;
                }
            }
        }
        self.drawn.push(Drawn { silhouette, depth, solid: index });
        (true, news)
    }

    /// Calls `found` with each pixel that the target may touch and that is
    /// not covered, until it says stop.
    fn uncovered(&self, target: &FaceTarget, mut found: impl FnMut(i64, i64, &Rect) -> bool) {
        let (x0, x1) = self.pixels(target.rect.u0, target.rect.u1, self.px);
        let (y0, y1) = self.pixels(target.rect.v0, target.rect.v1, self.py);
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        for ty in y0 / TILE..=(y1 - 1) / TILE {
            let row = ((ty - self.ty) * self.nx) as usize;
            for tx in x0 / TILE..=(x1 - 1) / TILE {
                let t = row + (tx - self.tx) as usize;
                if self.closed[t] >= target.near {
                    continue;
                }
                let (x, y) = (tx * TILE, ty * TILE);
                let mut open = block(x0 - x, x1 - x, y0 - y, y1 - y) & !self.tiles[t].hidden(target.near);
                if open == 0 {
                    continue;
                }
                let rect = self.square(x, y, TILE);
                if !target.silhouette.touches(&rect) {
                    continue;
                }
                while open != 0 {
                    let bit = i64::from(open.trailing_zeros());
                    open &= open - 1;
                    let (x, y) = (x + (bit & 7), y + (bit >> 3));
                    let rect = self.square(x, y, 1);
                    if target.silhouette.touches(&rect) && found(x, y, &rect) {
                        return;
                    }
                }
            }
        }
    }

    /// A square of pixels as directions.
    #[inline]
    fn square(&self, x: i64, y: i64, size: i64) -> Rect {
        Rect {
            u0: self.border(x),
            v0: self.border(y),
            u1: self.border(x + size),
            v1: self.border(y + size),
        }
    }

    fn sees(&self, target: &FaceTarget) -> bool {
        let mut seen = false;
        self.uncovered(target, |_, _, _| {
            seen = true;
            true
        });
        seen
    }

    /// The occluders listed for a pixel.
    fn bin(&self, x: i64, y: i64) -> &[u32] {
        let bins = (self.nx - 1) / BIN + 1;
        let (bx, by) = ((x / TILE - self.tx) / BIN, (y / TILE - self.ty) / BIN);
        &self.bins[(by * bins + bx) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Block;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as f64 / (1u64 << 31) as f64
        }

        fn within(&mut self, lo: f64, hi: f64) -> f64 {
            lo + (hi - lo) * self.next()
        }

        fn point(&mut self, reach: f64) -> DVec3 {
            DVec3::new(self.within(-reach, reach), self.within(-reach, reach), self.within(-reach, reach))
        }
    }

    fn pitch(pixels: f64) -> Pitch {
        Pitch { pixels, least: 0.0, nearest: 1e-3, reach: 40.0, middle: DVec3::ZERO }
    }

    /// Where a ray from the origin enters a box, as a share of `d`.
    fn enters(b: &Block, d: DVec3) -> Option<f64> {
        let (mut t0, mut t1) = (0.0f64, f64::INFINITY);
        for i in 0..3 {
            let (x, y) = (b.min[i] / d[i], b.max[i] / d[i]);
            (t0, t1) = (t0.max(x.min(y)), t1.min(x.max(y)));
        }
        (t0 <= t1).then_some(t0)
    }

    #[test]
    fn a_box_hides_only_what_rays_find_behind_it() {
        let mut random = Random(3);
        let view = View::around(glam::Vec3::ZERO).unwrap();
        let mut buffers = OcclusionBuffers::default();
        let mut hidden = 0;
        for _ in 0..400 {
            let boxed = |random: &mut Random, size: f64| {
                let (c, h) = (random.point(20.0), random.point(size).abs() + 0.01);
                Block { min: c - h, max: c + h }
            };
            buffers.begin(&view, &pitch(128.0));
            let occluder = boxed(&mut random, 8.0);
            let Some(solid) = Solid::polytope(Polytope::block(&occluder), None) else { continue };
            buffers.draw(&solid);
            for _ in 0..50 {
                let b = boxed(&mut random, 1.0);
                if buffers.test(&Target::block(b, None)) == Verdict::Visible {
                    continue;
                }
                hidden += 1;
                for _ in 0..20 {
                    let t = DVec3::new(random.next(), random.next(), random.next());
                    let d = b.min + t * (b.max - b.min);
                    assert!(enters(&occluder, d).is_some_and(|t| t < 1.0), "{occluder:?} {b:?} {d}");
                }
            }
        }
        assert!(hidden > 100, "{hidden}");
    }
}

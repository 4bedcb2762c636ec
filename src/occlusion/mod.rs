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

pub(crate) mod face;
pub(crate) mod image;
pub(crate) mod magnify;
pub(crate) mod refine;
pub(crate) mod silhouette;
pub(crate) mod solid;
pub(crate) mod surface;
pub(crate) mod target;
pub(crate) mod tiles;

use crate::geometry::Block;
use crate::grid::side::Side;
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::silhouette::{Front, Silhouette};
use crate::occlusion::solid::{Shadow, Solid};
use crate::occlusion::target::{FaceTarget, Target, above, below};
use crate::occlusion::tiles::{TILE, Tile, bits, block, span};
use crate::view::{Origin, View};
use glam::DVec3;
use smallvec::SmallVec;

/// Occluders are listed for squares of this many tiles along each side.
const BIN: i64 = 4;

/// The most pixels along a face: of the whole face, of which only the window is kept.
const MAX_PIXELS: i64 = 1 << 20;

/// Parallel rays start this many times the reach of the scene before its middle, so that depths
/// are positive and of one size; all of it is nearer than the second number of times.
const MIDDLE_DEPTH: f64 = 4.0;
const MAX_DEPTH: f64 = 6.0;

/// Directions are compared with the frustum to this, on faces of width 2.
const FRUSTUM_MARGIN: f64 = 1e-9;

/// An occluder as drawn on one face.
#[derive(Debug)]
struct Drawn {
    silhouette: Silhouette,
    front: Front,
    /// Index into the list of shadows.
    solid: u32,
    owner: u32,
}

/// An occluder in the list of a square of tiles.
#[derive(Debug, Clone, Copy)]
struct Listed {
    /// Index into the drawn occluders of the face.
    drawn: u32,
    /// No point of it is nearer.
    near: f32,
}

/// A patch in the list of a square of tiles.
#[derive(Debug, Clone, Copy)]
struct ListedPatch {
    /// When it was drawn.
    id: u32,
    /// No point of it is nearer.
    near: f32,
    /// The pixels that it may touch.
    px: (i64, i64),
    py: (i64, i64),
}

/// Planes kept for a tile.
const SHADES: usize = 2;

/// Pixels of a tile in which everything behind a plane is hidden, more exactly than by one depth.
#[derive(Debug, Clone, Copy)]
struct Shade {
    mask: u64,
    near: Linear,
}

impl Shade {
    const NONE: Self = Self { mask: 0, near: Linear { a: 0.0, b: 0.0, c: 0.0 } };
}

/// One face's window inside the frustum.
#[derive(Debug)]
struct FaceBuffer {
    face: Face,
    active: bool,
    /// Width of a pixel, and its inverse.
    step: f64,
    per_unit: f64,
    /// First tile of the window on the face, and their number.
    tx: i64,
    ty: i64,
    nx: i64,
    ny: i64,
    /// A rectangle around the part of the face inside the frustum.
    window: Rect,
    /// Pixels of the window, upper ends excluded.
    px: (i64, i64),
    py: (i64, i64),
    /// Directions inside the frustum.
    halves: SmallVec<[Linear; 8]>,
    tiles: Vec<Tile>,
    /// For each tile, the nearness down to which it is closed.
    closed: Vec<f32>,
    /// For each tile, planes behind which some of its pixels are hidden.
    planes: Vec<[Shade; SHADES]>,
    bins: Vec<Vec<Listed>>,
    /// The patches drawn, by the same squares.
    patches: Vec<Vec<ListedPatch>>,
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
    /// For each occluder drawn, where it hides.
    shadows: Vec<Shadow>,
    surfaces: surface::SurfaceScratch,
    origin: DVec3,
    error: f64,
    direction: Option<DVec3>,
    nearest: f64,
}

impl OcclusionBuffers {
    /// Clears the windows that a view looks through.
    pub(crate) fn begin(&mut self, view: &View, pitch: &Pitch) {
        self.shadows.clear();
        self.nearest = pitch.nearest;
        let wanted: SmallVec<[Face; 6]> = match view.origin {
            Origin::Eye { at, error } => {
                (self.origin, self.error, self.direction) = (at, error, None);
                Side::ALL.iter().map(Face::side).collect()
            }
            Origin::Direction(d) => {
                (self.origin, self.error, self.direction) =
                    (pitch.middle - d * (MIDDLE_DEPTH * pitch.reach), 0.0, Some(d));
                // Across the rays, along one of the view's own sides.
                let side = view.planes.iter().map(|p| p.normal).find(|n| n.dot(d).abs() < 1e-3);
                let right =
                    side.map_or_else(|| d.any_orthonormal_vector(), |n| (n - d * n.dot(d)).normalize());
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
        let pixels =
            if self.direction.is_some() { pitch.pixels * 2.0 / widest.max(1e-6) } else { pitch.pixels };
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
    ///
    /// `owner` tells it from others: a target is not hidden by what is drawn in its name.
    pub(crate) fn draw(&mut self, solid: &Solid, owner: u32) -> bool {
        let index = self.shadows.len() as u32;
        let mut news = false;
        let mut used = false;
        for buffer in &mut self.faces {
            if buffer.active {
                let (drawn, new) = buffer.draw(solid, index, owner);
                used |= drawn;
                news |= new;
            }
        }
        if used {
            self.shadows.push(solid.shadow.clone());
        }
        news
    }

    /// Whether every pixel of the rectangles around a box is covered nearer than it.
    pub(crate) fn hides(&self, block: &Block) -> bool {
        if self.is_close(block) {
            return false;
        }
        self.faces.iter().filter(|b| b.active).all(|buffer| {
            let Some((rect, depth)) = buffer.face.block(block) else { return true };
            buffer.hides(&rect.grown(), above(buffer.face.nearness_of(depth)))
        })
    }

    /// Whether every pixel that a target may touch is covered nearer than it.
    pub(crate) fn test(&self, target: &Target) -> Verdict {
        if self.is_close(target.bounds()) {
            return Verdict::Visible;
        }
        let seen = self.faces.iter().filter(|b| b.active).any(|buffer| {
            let mut seen = false;
            if let Some(on_face) = target.on_face(&buffer.face) {
                buffer.uncovered(&on_face, |_, _, _| {
                    seen = true;
                    true
                });
            }
            seen
        });
        if seen { Verdict::Visible } else { Verdict::Hidden }
    }

    /// Whether a point of a target lies in an open pixel inside the view where no convex occluder is known:
    /// then testing the target finds that pixel.
    pub(crate) fn shows(&self, point: DVec3) -> bool {
        self.faces.iter().filter(|b| b.active).any(|b| b.shows(b.face.local(point)))
    }

    /// Whether a box reaches so close to the eye that directions to it are not told apart.
    fn is_close(&self, block: &Block) -> bool {
        let distance = block.min.max(-block.max).max_element();
        // NaN is close.
        self.direction.is_none() && (distance.is_nan() || distance <= self.nearest)
    }

    /// Whether all pixels are closed for what lies farther than `distance` along some axis.
    pub(crate) fn closed(&self, distance: f64) -> bool {
        let distance = distance - self.uncertainty();
        // What is closer may be in sight beside the windows.
        if distance.is_nan() || distance <= self.nearest {
            return false;
        }
        self.faces.iter().filter(|b| b.active).all(|b| {
            let near = above(b.face.nearness_of(distance));
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
            per_unit: 1.0,
            tx: 0,
            ty: 0,
            nx: 0,
            ny: 0,
            window: Rect::FACE,
            px: (0, 0),
            py: (0, 0),
            halves: SmallVec::new(),
            tiles: Vec::new(),
            closed: Vec::new(),
            planes: Vec::new(),
            bins: Vec::new(),
            patches: Vec::new(),
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
                    let mut half =
                        self.face.half(plane.normal, at + slack + along.abs() * MAX_DEPTH * pitch.reach);
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
        if lo.is_nan() || hi.is_nan() {
            return window;
        }
        let margin = 1e-6;
        let clamp = |p: f64| floor(p.clamp(window.0 as f64 - 1.0, window.1 as f64));
        let first = clamp((lo + 1.0) * self.per_unit - margin).max(window.0);
        let last = clamp((hi + 1.0) * self.per_unit + margin).min(window.1 - 1);
        (first, last + 1)
    }

    fn clear(&mut self, window: Option<Rect>, pixels: i64) {
        self.drawn.clear();
        self.active = false;
        (self.step, self.per_unit) = (2.0 / pixels as f64, pixels as f64 / 2.0);
        let Some(w) = window else { return };
        self.active = true;
        self.window = w;
        self.px = self.pixels(w.u0, w.u1, (0, pixels));
        self.py = self.pixels(w.v0, w.v1, (0, pixels));
        (self.tx, self.ty) = (self.px.0 / TILE, self.py.0 / TILE);
        (self.nx, self.ny) = ((self.px.1 - 1) / TILE + 1 - self.tx, (self.py.1 - 1) / TILE + 1 - self.ty);
        let count = (self.nx * self.ny) as usize;
        self.tiles.clear();
        self.tiles.resize(count, Tile::EMPTY);
        self.closed.clear();
        self.closed.resize(count, f32::NEG_INFINITY);
        self.planes.clear();
        self.planes.resize(count, [Shade::NONE; SHADES]);
        let bins = (((self.nx - 1) / BIN + 1) * ((self.ny - 1) / BIN + 1)) as usize;
        self.bins.iter_mut().for_each(Vec::clear);
        self.patches.iter_mut().for_each(Vec::clear);
        if self.bins.len() < bins {
            self.bins.resize_with(bins, Vec::new);
            self.patches.resize_with(bins, Vec::new);
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

    fn draw(&mut self, solid: &Solid, index: u32, owner: u32) -> (bool, bool) {
        let Some((rect, depth, silhouette)) = solid.on_face(&self.face) else { return (false, false) };
        let (x0, x1) = self.pixels(rect.u0, rect.u1, self.px);
        let (y0, y1) = self.pixels(rect.v0, rect.v1, self.py);
        if x0 >= x1 || y0 >= y1 {
            return (false, false);
        }
        let front = solid.front(&self.face);
        let listed = Listed { drawn: self.drawn.len() as u32, near: above(self.face.nearness_of(depth)) };
        let (bx0, bx1) = ((x0 / TILE - self.tx) / BIN, ((x1 - 1) / TILE - self.tx) / BIN);
        let (by0, by1) = ((y0 / TILE - self.ty) / BIN, ((y1 - 1) / TILE - self.ty) / BIN);
        let bins = (self.nx - 1) / BIN + 1;
        for by in by0..=by1 {
            for bx in bx0..=bx1 {
                self.bins[(by * bins + bx) as usize].push(listed);
            }
        }
        let mut news = false;
        let conic = silhouette.is_conic();
        let step = self.step;
        let per_unit = self.per_unit;
        for ty in y0 / TILE..=(y1 - 1) / TILE {
            let mut rows = [(0i64, 0i64); TILE as usize];
            let (first, last) = ((ty * TILE).max(y0), ((ty + 1) * TILE).min(y1));
            let (mut left, mut right) = (i64::MAX, i64::MIN);
            let (mut common_left, mut common_right) = (i64::MIN, i64::MAX);
            let mut filled = 0;
            silhouette.rows(self.border(first), step, (last - first) as usize, |i, lo, hi| {
                let y = first + i as i64;
                let clamp = |p: f64| p.clamp(x0 as f64, x1 as f64);
                // Whole pixels between the ends, as borders round; the face's own borders are exact.
                let margin = 1e-6;
                let mut a = if lo <= -1.0 { x0 } else { -floor(-clamp((lo + 1.0) * per_unit + margin)) };
                let mut b = if hi >= 1.0 { x1 } else { floor(clamp((hi + 1.0) * per_unit - margin)) };
                if conic && a < b {
                    let border = |p: i64| p as f64 * step - 1.0;
                    let (v0, v1) = (border(y), border(y + 1));
                    let sure = |a, b| silhouette.covers(&Rect { u0: border(a), v0, u1: border(b), v1 });
                    if !sure(a, b) {
                        (a, b) = (a + 1, b - 1);
                        if a < b && !sure(a, b) {
                            b = a;
                        }
                    }
                }
                if a < b {
                    rows[(y - ty * TILE) as usize] = (a, b);
                    (left, right) = (left.min(a), right.max(b));
                    (common_left, common_right) = (common_left.max(a), common_right.min(b));
                    filled += 1;
                }
            });
            if filled < TILE {
                common_right = i64::MIN;
            }
            if left >= right {
                continue;
            }
            for tx in left / TILE..=(right - 1) / TILE {
                let x = tx * TILE;
                let t = ((ty - self.ty) * self.nx + tx - self.tx) as usize;
                if self.closed[t] >= listed.near {
                    continue;
                }
                let rect = self.square(x, ty * TILE, TILE);
                let whole = common_left <= x && x + TILE <= common_right;
                let near = below(if whole { front.behind_inside(&rect) } else { front.behind(&rect) });
                if near <= self.closed[t] {
                    continue;
                }
                let row = |(i, s): (usize, &(i64, i64))| span(s.0 - x, s.1 - x) << (8 * i);
                let mask = if whole {
                    u64::MAX
                } else {
                    rows.iter().enumerate().map(row).fold(0, |all, row| all | row)
                };
                if mask != 0 && self.tiles[t].cover(mask, near) {
                    self.closed[t] = self.tiles[t].closed();
                    news = true;
                }
            }
        }
        self.drawn.push(Drawn { silhouette, front, solid: index, owner });
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
                // In this tile it may be farther than as a whole.
                open &= !self.tiles[t].hidden(target.near(&rect));
                let shades = &self.planes[t];
                for shade in shades {
                    if open & shade.mask != 0 && target.is_behind_plane(&shade.near, &rect) {
                        open &= !shade.mask;
                    }
                }
                let stopped = bits(open).any(|bit| {
                    let (x, y) = (x + (bit & 7), y + (bit >> 3));
                    let rect = self.square(x, y, 1);
                    let shaded = |s: &Shade| s.mask >> bit & 1 == 1 && target.is_behind_plane(&s.near, &rect);
                    target.silhouette.touches(&rect) && !shades.iter().any(shaded) && found(x, y, &rect)
                });
                if stopped {
                    return;
                }
            }
        }
    }

    /// Whether a point, in coordinates of the face, lies in an open pixel with no occluder listed.
    fn shows(&self, p: DVec3) -> bool {
        if !self.face.parallel && p.z <= 0.0 {
            return false;
        }
        let (u, v) = if self.face.parallel { (p.x, p.y) } else { (p.x / p.z, p.y / p.z) };
        let at = |c: f64, (lo, hi): (i64, i64)| {
            let pixel = floor(((c + 1.0) * self.per_unit).clamp(-1.0, hi as f64));
            (lo <= pixel && pixel < hi).then_some(pixel)
        };
        let (Some(x), Some(y)) = (at(u, self.px), at(v, self.py)) else { return false };
        let t = ((y / TILE - self.ty) * self.nx + x / TILE - self.tx) as usize;
        let bit = 1u64 << (y % TILE * TILE + x % TILE);
        let near = self.face.nearness_of(p.z);
        let shaded = |s: &Shade| s.mask & bit != 0 && s.near.at(u, v) >= near;
        self.bins[self.bin(x, y)].is_empty()
            && self.tiles[t].hidden(below(near)) & bit == 0
            && !self.planes[t].iter().any(shaded)
    }

    /// A square of pixels as directions.
    #[inline]
    fn square(&self, x: i64, y: i64, size: i64) -> Rect {
        Rect { u0: self.border(x), v0: self.border(y), u1: self.border(x + size), v1: self.border(y + size) }
    }

    /// Whether every pixel of a rectangle is covered for what is nowhere nearer than `near`.
    fn hides(&self, rect: &Rect, near: f32) -> bool {
        self.covers(self.pixels(rect.u0, rect.u1, self.px), self.pixels(rect.v0, rect.v1, self.py), near)
    }

    /// Whether all pixels of two ranges are covered for what is nowhere nearer than `near`.
    fn covers(&self, (x0, x1): (i64, i64), (y0, y1): (i64, i64), near: f32) -> bool {
        if x0 >= x1 || y0 >= y1 {
            return true;
        }
        let (tx0, tx1) = (x0 / TILE, (x1 - 1) / TILE);
        (y0 / TILE..=(y1 - 1) / TILE).all(|ty| {
            let row = (ty - self.ty) * self.nx - self.tx;
            let (a, b) = ((row + tx0) as usize, (row + tx1) as usize);
            self.closed[a..=b].iter().enumerate().all(|(i, &closed)| {
                if closed >= near {
                    return true;
                }
                let (x, y) = ((tx0 + i as i64) * TILE, ty * TILE);
                block(x0 - x, x1 - x, y0 - y, y1 - y) & !self.tiles[a + i].hidden(near) == 0
            })
        })
    }

    /// The list of occluders for the pixel that holds the corner of a rectangle inside the window.
    fn bin_of(&self, rect: &Rect) -> usize {
        let pixel =
            |at: f64, (lo, hi): (i64, i64)| floor((at + 1.0) * self.per_unit + 1e-6).clamp(lo, hi - 1);
        self.bin(pixel(rect.u0, self.px), pixel(rect.v0, self.py))
    }

    /// The list of occluders for a pixel.
    fn bin(&self, x: i64, y: i64) -> usize {
        let bins = (self.nx - 1) / BIN + 1;
        let (bx, by) = ((x / TILE - self.tx) / BIN, (y / TILE - self.ty) / BIN);
        (by * bins + bx) as usize
    }
}

/// The floor of a number within the range of `i64`, without a call into the
/// mathematics library, which processors of the baseline would need.
#[inline]
fn floor(v: f64) -> i64 {
    let whole = v as i64;
    whole - i64::from(whole as f64 > v)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let Some(solid) = Solid::polytope(crate::geometry::polytope::Polytope::block(&occluder), None)
            else {
                continue;
            };
            buffers.draw(&solid, 0);
            for _ in 0..50 {
                let b = boxed(&mut random, 1.0);
                if buffers.test(&Target::block(b, None)) != Verdict::Hidden {
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

//! Drawing surfaces: winding numbers of outlines, less the pixels that outlines touch.
//!
//! If no edge of a patch's outline touches a pixel, the patch has one winding number there, that of the
//! pixel's middle: if it is not zero, the patch covers all of the pixel, at the depth of the far side of
//! its slab. Patches are drawn in batches: on each face, the edges that two patches of a batch share cancel.
//! Pixels that only such seams touch are covered if the winding numbers of the patches that hang together do not
//! sum to zero at their middles, at the depth of the farthest patch there. Which way a patch counts
//! is free: turning patches to the eye keeps folds from cancelling.
//!
//! Margins: edges are widened by [`TOUCH`] pixels, a hundred times the rounding of projected
//! points, and by their own slack.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use super::face::{Face, Linear, Rect};
use super::target::{above, below};
use super::tiles::{TILE, span};
use super::{FaceBuffer, OcclusionBuffers, SHADES, Shade};
use crate::geometry::Block;
use crate::shape::Placement;
use crate::surface::{NONE, Side, Surface};

/// Pixels by which edges are widened on each side.
const TOUCH: f64 = 1e-5;

/// Edges flatter than this, in pixels of width for one of height, touch all their pixels in each of their rows.
const FLAT: f64 = 1e4;

/// A patch to be drawn.
#[derive(Clone)]
pub(crate) struct Drawable<'a> {
    pub(crate) surface: &'a Surface,
    /// Where the surface is, if that is not where its sides say.
    pub(crate) placement: Option<&'a Placement>,
    pub(crate) patch: u32,
    /// Tells it from all others of the scene, and so its neighbours in the surface.
    pub(crate) number: u32,
    /// Patches of other surfaces at the open sides of its own: (side, number of the patch, whether the
    /// two run along it in opposite directions), in order of sides.
    pub(crate) links: &'a [(u32, u32, bool)],
    /// A box around it, relative to the origin.
    pub(crate) block: Block,
    /// All of it lies where `lo <= normal . x <= hi`, relative to the origin.
    pub(crate) normal: DVec3,
    pub(crate) slab: (f64, f64),
    /// Whether it was drawn before, and only seams with others are new.
    pub(crate) again: bool,
    /// Whether its lower side counts as turned to the eye.
    pub(crate) turned: bool,
    /// Points may lie this far from where the surface says.
    pub(crate) error: f64,
}

impl<'a> Drawable<'a> {
    /// Its sides: where they are, the number of the patch beyond, and whether the two run in opposite
    /// directions.
    pub(crate) fn sides(&self) -> impl Iterator<Item = (&'a Side, Option<(u32, bool)>)> {
        let patch = &self.surface.patches[self.patch as usize];
        let at = self.links.partition_point(|l| l.0 < patch.first);
        let mut links = self.links[at..].iter().peekable();
        let base = self.number - self.patch;
        self.surface.outline(patch).iter().zip(patch.first..).map(move |(side, index)| {
            if side.twin != NONE {
                return (side, Some((base + side.twin, side.opposite)));
            }
            (side, links.next_if(|l| l.0 == index).map(|l| (l.1, l.2)))
        })
    }

    fn sign(&self) -> i32 {
        if self.turned { -1 } else { 1 }
    }
}

/// A patch as one face sees it.
struct Seen {
    /// Index in the batch.
    drawable: u32,
    /// Its component, as the index of another one.
    parent: u32,
    /// The pixels that it may touch, upper ends excluded.
    px: (i64, i64),
    py: (i64, i64),
    /// No point of it is nearer.
    near: f32,
    /// Its edges in the list of the drawing.
    edges: (u32, u32),
    /// The pixels of neighbours that are drawn for the first time.
    around: ((i64, i64), (i64, i64)),
}

/// The common part of two ranges.
fn meet(a: (i64, i64), b: (i64, i64)) -> (i64, i64) {
    (a.0.max(b.0), a.1.min(b.1))
}

/// A range with all pixels of its tiles.
fn in_tiles(a: (i64, i64)) -> (i64, i64) {
    if a.0 < a.1 { (a.0 / TILE * TILE, (a.1 + TILE - 1) / TILE * TILE) } else { a }
}

/// Whether the tiles of `b` hold all of `a`.
fn within_tiles(a: (i64, i64), b: (i64, i64)) -> bool {
    let b = in_tiles(b);
    a.0 >= a.1 || b.0 <= a.0 && a.1 <= b.1
}

/// An empty range.
const NOWHERE: (i64, i64) = (i64::MAX, i64::MIN);

/// Where a winding number changes in a row: for all pixels from a column on.
#[derive(Clone, Copy)]
struct Step {
    column: i16,
    by: i16,
}

/// What drawing keeps to spare allocations.
#[derive(Default)]
pub(super) struct SurfaceScratch {
    seen: Vec<Seen>,
    /// For each patch of the scene, the number of the drawing and its place in `seen`.
    places: Vec<(u32, u32)>,
    drawing: u32,
    /// For each side of the patches seen, whether it is a seam.
    edges: Vec<bool>,
    /// For each patch seen, all pixels that it may touch.
    full: Vec<((i64, i64), (i64, i64))>,
    order: Vec<u32>,
    canvas: Canvas,
    joint: Joint,
}

impl std::fmt::Debug for SurfaceScratch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SurfaceScratch")
    }
}

/// Pixels in tiles.
#[derive(Debug, Default, Clone, Copy)]
struct Area {
    /// First pixel, and number of tiles.
    x: i64,
    y: i64,
    nx: i64,
    ny: i64,
}

impl Area {
    fn new(px: (i64, i64), py: (i64, i64)) -> Self {
        let (x, y) = (px.0 / TILE * TILE, py.0 / TILE * TILE);
        Self { x, y, nx: (px.1 - 1 - x) / TILE + 1, ny: (py.1 - 1 - y) / TILE + 1 }
    }

    fn tiles(&self) -> usize {
        (self.nx * self.ny) as usize
    }
}

/// What is known of the pixels of a tile.
#[derive(Debug, Default, Clone, Copy)]
struct Marks {
    /// Touched by open edges, and by seams.
    touched: [u64; 2],
    /// The winding number of the middle is positive, or negative.
    plus: u64,
    minus: u64,
}

/// Pixels around a patch.
#[derive(Default)]
struct Canvas {
    area: Area,
    tiles: Vec<Marks>,
    rows: Vec<Vec<Step>>,
}

/// Pixels around patches that hang together.
#[derive(Default)]
struct Joint {
    area: Area,
    tiles: Vec<Marks>,
    /// The least nearness of the patches in each tile.
    nears: Vec<f32>,
}

impl Canvas {
    fn clear(&mut self, area: Area) {
        self.area = area;
        self.tiles.clear();
        self.tiles.resize(area.tiles(), Marks::default());
        let rows = (area.ny * TILE) as usize;
        if self.rows.len() < rows {
            self.rows.resize_with(rows, Vec::new);
        }
        self.rows[..rows].iter_mut().for_each(Vec::clear);
    }

    /// Marks pixels of a row, both ends included and inside the canvas.
    #[inline]
    fn touch(&mut self, row: i32, first: i32, last: i32, seam: bool) {
        let at = (row >> 3) * self.area.nx as i32;
        let shift = (row & 7) << 3;
        let (a, b) = (first >> 3, last >> 3);
        let (low, high) = (0xffu64 << (first & 7) & 0xff, 0xffu64 >> (7 - (last & 7)));
        let layer = usize::from(seam);
        if a == b {
            self.tiles[(at + a) as usize].touched[layer] |= (low & high) << shift;
            return;
        }
        self.tiles[(at + a) as usize].touched[layer] |= low << shift;
        for tx in a + 1..b {
            self.tiles[(at + tx) as usize].touched[layer] |= 0xff << shift;
        }
        self.tiles[(at + b) as usize].touched[layer] |= high << shift;
    }

    /// Draws an edge, in pixels from the corner of the canvas; `wide` is what it is widened by.
    #[inline]
    fn edge(&mut self, a: (f64, f64), b: (f64, f64), by: i16, wide: f64, seam: bool) {
        let (width, height) = ((self.area.nx * TILE) as i32, (self.area.ny * TILE) as i32);
        // From top to bottom.
        let (a, b, by) = if a.1 <= b.1 { (a, b, by) } else { (b, a, -by) };
        let (x0, x1) = if a.0 <= b.0 { (a.0, b.0) } else { (b.0, a.0) };
        let (left, x1) = (x0 - wide, x1 + wide);
        let (right, bottom) = (f64::from(width), f64::from(height));
        if b.1 + wide < 0.0 || a.1 - wide >= bottom || left >= right {
            return;
        }
        let first = nearest(within(a.1 - wide, bottom) - 0.5).max(0);
        let last = nearest(within(b.1 + wide, bottom) - 0.5).min(height - 1);
        // Rows whose middles it passes: neighbours share their ends, and so agree.
        let (from, to) = (nearest(within(a.1, bottom)).max(0), nearest(within(b.1, bottom)).min(height));
        if x1 < 0.0 {
            for row in from..to {
                self.rows[row as usize].push(Step { column: 0, by });
            }
            return;
        }
        let slope = (b.0 - a.0) / (b.1 - a.1);
        if first == last || slope.is_nan() || slope.abs() >= FLAT {
            // All of the edge is in one row, or its rows are not told apart. Where it passes
            // the middle does not matter: all of its pixels there are touched.
            let lo = nearest(within(left, right) - 0.5).max(0);
            let hi = nearest(within(x1, right) - 0.5).min(width - 1);
            for row in first..=last {
                if lo <= hi {
                    self.touch(row, lo, hi, seam);
                }
            }
            for row in from..to {
                if lo < width {
                    self.rows[row as usize].push(Step { column: lo as i16, by });
                }
            }
            return;
        }
        let reach = wide * slope.abs() + wide;
        // Where it passes a row's upper border.
        let mut x = a.0 + (f64::from(first) - a.1) * slope;
        for row in first..=last {
            let next = x + slope;
            let (lo, hi) = if x <= next { (x - reach, next + reach) } else { (next - reach, x + reach) };
            let lo = nearest(within(if lo > left { lo } else { left }, right) - 0.5).max(0);
            let hi = nearest(within(if hi < x1 { hi } else { x1 }, right) - 0.5).min(width - 1);
            if lo <= hi {
                self.touch(row, lo, hi, seam);
            }
            if from <= row && row < to {
                let column = nearest(within(x + 0.5 * slope, right)).max(0);
                if column < width {
                    self.rows[row as usize].push(Step { column: column as i16, by });
                }
            }
            x = next;
        }
    }

    /// Turns steps into winding numbers.
    fn fill(&mut self) {
        for row in 0..self.area.ny * TILE {
            let steps = &mut self.rows[row as usize];
            if steps.is_empty() {
                continue;
            }
            if steps.len() > 1 {
                steps.sort_unstable_by_key(|s| s.column);
            }
            let (at, shift) = ((row / TILE) * self.area.nx, 8 * (row % TILE));
            let (mut winding, mut from) = (0i32, 0i64);
            let tiles = &mut self.tiles;
            let mut fill = |winding: i32, from: i64, to: i64| {
                if winding != 0 && from < to {
                    for tx in from / TILE..=(to - 1) / TILE {
                        let x = tx * TILE;
                        let bits = span(from - x, to - x) << shift;
                        let marks = &mut tiles[(at + tx) as usize];
                        if winding > 0 { marks.plus |= bits } else { marks.minus |= bits }
                    }
                }
            };
            for step in steps.iter() {
                let column = i64::from(step.column);
                fill(winding, from, column);
                (winding, from) = (winding + i32::from(step.by), column);
            }
            fill(winding, from, self.area.nx * TILE);
        }
    }
}

/// A number brought between -1 and a greatest one; what is no number becomes -1.
#[inline]
fn within(v: f64, most: f64) -> f64 {
    let v = if v > -1.0 { v } else { -1.0 };
    if v < most { v } else { most }
}

/// The integer nearest to a number of moderate size; less a half, its floor but for integers. By
/// the digits that are left when a large number is added.
#[inline]
fn nearest(v: f64) -> i32 {
    (v + 6_755_399_441_055_744.0).to_bits() as i32
}

/// The root of a component, with shorter ways for the next one who asks.
fn root(seen: &mut [Seen], mut i: u32) -> u32 {
    while seen[i as usize].parent != i {
        let up = seen[seen[i as usize].parent as usize].parent;
        seen[i as usize].parent = up;
        i = up;
    }
    i
}

impl OcclusionBuffers {
    /// Draws patches together: outlines that two of them share leave no seam. Returns
    /// whether they hide anything new.
    pub(crate) fn draw_surfaces(&mut self, batch: &[Drawable], patches: usize) -> bool {
        let mut scratch = std::mem::take(&mut self.surfaces);
        if scratch.places.len() < patches {
            scratch.places.resize(patches, (0, 0));
        }
        let clip = self.nearest * 0.5;
        let mut news = false;
        for buffer in self.faces.iter_mut().filter(|b| b.active) {
            news |= buffer.draw_surfaces(batch, self.origin, clip, &mut scratch);
        }
        self.surfaces = scratch;
        news
    }

    /// How far points must lie from the eye for the near limit, at which patches are cut, and
    /// what is not known of them (`slack`) not to matter: where a straight edge is less deep than twice
    /// the slack, neither it nor its chain then reaches into the face.
    pub(crate) fn clearance(&self, slack: f64) -> f64 {
        8.0 * (self.nearest * 0.5 + slack)
    }
}

impl FaceBuffer {
    fn draw_surfaces(
        &mut self,
        batch: &[Drawable],
        origin: DVec3,
        clip: f64,
        scratch: &mut SurfaceScratch,
    ) -> bool {
        scratch.drawing += 1;
        if scratch.drawing == u32::MAX {
            scratch.places.fill((0, 0));
            scratch.drawing = 1;
        }
        let drawing = scratch.drawing;
        scratch.seen.clear();
        scratch.edges.clear();
        for (i, d) in batch.iter().enumerate() {
            let Some((rect, depth)) = self.face.block(&d.block) else { continue };
            let near = above(self.face.nearness_of(depth));
            let (px, py) = (self.pixels(rect.u0, rect.u1, self.px), self.pixels(rect.v0, rect.v1, self.py));
            if px.0 >= px.1 || py.0 >= py.1 || self.hides(&rect, near) {
                continue;
            }
            let place = scratch.seen.len() as u32;
            scratch.places[d.number as usize] = (drawing, place);
            scratch.seen.push(Seen {
                drawable: i as u32,
                parent: place,
                px,
                py,
                near,
                edges: (0, 0),
                around: (NOWHERE, NOWHERE),
            });
        }
        for i in 0..scratch.seen.len() as u32 {
            let d = &batch[scratch.seen[i as usize].drawable as usize];
            let first = scratch.edges.len() as u32;
            for (_, twin) in d.sides() {
                let mut seam = false;
                if let Some((number, opposite)) = twin
                    && let (drawn, place) = scratch.places[number as usize]
                    && drawn == drawing
                {
                    let other = &batch[scratch.seen[place as usize].drawable as usize];
                    if opposite == (d.sign() == other.sign()) {
                        let (a, b) = (root(&mut scratch.seen, i), root(&mut scratch.seen, place));
                        scratch.seen[a.max(b) as usize].parent = a.min(b);
                        seam = true;
                        if !d.again && other.again {
                            let (px, py) = (scratch.seen[i as usize].px, scratch.seen[i as usize].py);
                            let join = |a: (i64, i64), b: (i64, i64)| (a.0.min(b.0), a.1.max(b.1));
                            let around = &mut scratch.seen[place as usize].around;
                            *around = (join(around.0, px), join(around.1, py));
                        }
                    }
                }
                scratch.edges.push(seam);
            }
            scratch.seen[i as usize].edges = (first, scratch.edges.len() as u32);
        }
        // What was drawn before is new only around its seams with what was not.
        scratch.full.clear();
        scratch.full.extend(scratch.seen.iter().map(|s| (s.px, s.py)));
        for s in scratch.seen.iter_mut().filter(|s| batch[s.drawable as usize].again) {
            (s.px, s.py) = (meet(s.px, s.around.0), meet(s.py, s.around.1));
        }
        // There a seam of two such patches needs both.
        for s in scratch.seen.iter().filter(|s| batch[s.drawable as usize].again) {
            for ((_, twin), at) in batch[s.drawable as usize].sides().zip(s.edges.0 as usize..) {
                let Some((number, _)) = twin.filter(|_| scratch.edges[at]) else { continue };
                let place = scratch.places[number as usize].1 as usize;
                let (other, full) = (&scratch.seen[place], scratch.full[place]);
                scratch.edges[at] = within_tiles(meet(in_tiles(s.px), full.0), other.px)
                    && within_tiles(meet(in_tiles(s.py), full.1), other.py);
            }
        }
        scratch.order.clear();
        scratch.order.extend(0..scratch.seen.len() as u32);
        scratch.order.retain(|&i| {
            let s = &scratch.seen[i as usize];
            s.px.0 < s.px.1 && s.py.0 < s.py.1
        });
        for i in 0..scratch.seen.len() as u32 {
            scratch.seen[i as usize].parent = root(&mut scratch.seen, i);
        }
        scratch.order.sort_by_key(|&i| scratch.seen[i as usize].parent);
        let mut news = false;
        let mut first = 0;
        while first < scratch.order.len() {
            let parent = |at: usize| scratch.seen[scratch.order[at] as usize].parent;
            let last = (first..scratch.order.len()).find(|&at| parent(at) != parent(first));
            let last = last.unwrap_or(scratch.order.len());
            news |= self.draw_component(batch, first..last, origin, clip, scratch);
            first = last;
        }
        news
    }

    /// Draws patches that hang together.
    fn draw_component(
        &mut self,
        batch: &[Drawable],
        range: std::ops::Range<usize>,
        origin: DVec3,
        clip: f64,
        scratch: &mut SurfaceScratch,
    ) -> bool {
        let members = &scratch.order[range];
        let (canvas, joint) = (&mut scratch.canvas, &mut scratch.joint);
        if members.len() > 1 {
            let (mut px, mut py) = ((i64::MAX, i64::MIN), (i64::MAX, i64::MIN));
            for &i in members {
                let s = &scratch.seen[i as usize];
                (px, py) = ((px.0.min(s.px.0), px.1.max(s.px.1)), (py.0.min(s.py.0), py.1.max(s.py.1)));
            }
            joint.area = Area::new(px, py);
            joint.tiles.clear();
            joint.tiles.resize(joint.area.tiles(), Marks::default());
            joint.nears.clear();
            joint.nears.resize(joint.area.tiles(), f32::INFINITY);
        }
        let mut news = false;
        for &i in members {
            let s = &scratch.seen[i as usize];
            let d = &batch[s.drawable as usize];
            canvas.clear(Area::new(s.px, s.py));
            self.outline(canvas, d, &scratch.edges[s.edges.0 as usize..s.edges.1 as usize], origin, clip);
            canvas.fill();
            let back = Back::new(&self.face, d);
            let area = canvas.area;
            for ty in 0..area.ny {
                let row = (area.y / TILE + ty - self.ty) * self.nx + area.x / TILE - self.tx;
                let joint_row =
                    ((area.y - joint.area.y) / TILE + ty) * joint.area.nx + (area.x - joint.area.x) / TILE;
                for tx in 0..area.nx {
                    let marks = canvas.tiles[(ty * area.nx + tx) as usize];
                    let own = (row + tx) as usize;
                    let [open, seam] = marks.touched;
                    if open | seam | marks.plus | marks.minus == 0 {
                        continue;
                    }
                    if self.closed[own] >= s.near {
                        if members.len() > 1 {
                            // Without it, seams with it are not known to be closed.
                            joint.nears[(joint_row + tx) as usize] = f32::NEG_INFINITY;
                        }
                        continue;
                    }
                    let mask = (marks.plus | marks.minus) & !(open | seam);
                    let rect = self.square(area.x + tx * TILE, area.y + ty * TILE, TILE);
                    let (near, plane) = back.behind(&rect);
                    let near = below(near);
                    if mask != 0 && self.closed[own] < near {
                        news |= self.hide(own, mask, near, plane);
                    }
                    if members.len() > 1 {
                        let at = (joint_row + tx) as usize;
                        let all = &mut joint.tiles[at];
                        all.touched[0] |= open;
                        all.touched[1] |= seam;
                        all.plus |= marks.plus;
                        all.minus |= marks.minus;
                        joint.nears[at] = joint.nears[at].min(near);
                    }
                }
            }
        }
        if members.len() > 1 {
            let area = joint.area;
            for ty in 0..area.ny {
                let row = (area.y / TILE + ty - self.ty) * self.nx + area.x / TILE - self.tx;
                for tx in 0..area.nx {
                    let at = (ty * area.nx + tx) as usize;
                    let marks = joint.tiles[at];
                    // Without numbers of both signs the sum is not zero.
                    let mask = marks.touched[1] & (marks.plus ^ marks.minus) & !marks.touched[0];
                    let own = (row + tx) as usize;
                    if mask != 0 && self.closed[own] < joint.nears[at] {
                        news |= self.hide(own, mask, joint.nears[at], None);
                    }
                }
            }
        }
        news
    }

    /// Hides pixels of a tile behind a nearness and a plane.
    fn hide(&mut self, tile: usize, mask: u64, near: f32, plane: Option<Linear>) -> bool {
        if let Some(near) = plane {
            keep(&mut self.planes[tile], Shade { mask, near });
        }
        let news = self.tiles[tile].cover(mask, near);
        if news {
            self.closed[tile] = self.tiles[tile].closed();
        }
        news
    }

    /// Draws the outline of a patch.
    fn outline(&self, canvas: &mut Canvas, d: &Drawable, seams: &[bool], origin: DVec3, clip: f64) {
        let corner = (canvas.area.x as f64, canvas.area.y as f64);
        let pen = Pen { face: &self.face, per_unit: self.per_unit, corner, clip };
        let sign = d.sign() as i16;
        let cut = !self.face.parallel && pen.cuts(&d.block);
        let mut base = None;
        // Outlines run on: an edge often starts where the last one ended.
        let mut known = (Vec3::NAN, Spot::default());
        let patch = &d.surface.patches[d.patch as usize];
        let growth = d.placement.map_or(1.0, |p| p.growth);
        for (side, &seam) in d.surface.outline(patch).iter().zip(seams) {
            let world = |v: DVec3| d.placement.map_or(v, |p| p.affine.transform_point3(v));
            let spot = |v: Vec3| pen.spot(self.face.local(world(v.as_dvec3()) - origin));
            let start = if known.0 == side.from { known.1 } else { spot(side.from) };
            let end = spot(side.to);
            known = (side.to, end);
            let by = sign;
            let ends = [start.at, end.at];
            let slack = f64::from(side.slack) * growth + d.error;
            if slack == 0.0 && (self.face.parallel || start.at.z >= clip && end.at.z >= clip) {
                canvas.edge(start.pixel, end.pixel, by, TOUCH, seam);
                continue;
            }
            pen.edge(canvas, ends, by, slack, seam);
            // Cut by the near limit: the cut runs along it, far outside the face.
            if cut && let Some((at, leaves)) = pen.cut(ends) {
                let base = *base.get_or_insert(at);
                // From where the outline leaves to where it comes back.
                let (a, b) = if leaves { (at, base) } else { (base, at) };
                canvas.edge(pen.place(a), pen.place(b), by, TOUCH, false);
            }
        }
    }
}

/// Keeps a plane of a tile if it covers more than another one does.
fn keep(shades: &mut [Shade; SHADES], new: Shade) {
    let least = shades.iter_mut().min_by_key(|s| s.mask.count_ones());
    if let Some(least) = least.filter(|s| s.mask.count_ones() < new.mask.count_ones()) {
        *least = new;
    }
}

/// How points become pixels of the canvas.
struct Pen<'a> {
    face: &'a Face,
    per_unit: f64,
    corner: (f64, f64),
    /// What is less deep is cut off.
    clip: f64,
}

/// A point as seen by a face, and where it is on the canvas.
#[derive(Debug, Default, Clone, Copy)]
struct Spot {
    at: DVec3,
    pixel: (f64, f64),
}

impl Pen<'_> {
    fn spot(&self, at: DVec3) -> Spot {
        Spot { at, pixel: self.place(at) }
    }

    fn place(&self, p: DVec3) -> (f64, f64) {
        let scale = if self.face.parallel { 1.0 } else { 1.0 / p.z };
        let (u, v) = (p.x * scale, p.y * scale);
        ((u + 1.0) * self.per_unit - self.corner.0, (v + 1.0) * self.per_unit - self.corner.1)
    }

    /// Where an edge passes the near limit, from its lesser to its greater depth, and whether it
    /// leaves the far side in its own direction.
    fn cut(&self, [p, q]: [DVec3; 2]) -> Option<(DVec3, bool)> {
        if (p.z < self.clip) == (q.z < self.clip) {
            return None;
        }
        let leaves = q.z < self.clip;
        let (p, q) = if leaves { (q, p) } else { (p, q) };
        let mut at = p + (q - p) * ((self.clip - p.z) / (q.z - p.z));
        at.z = self.clip;
        Some((at, leaves))
    }

    /// Whether the near limit passes through a box.
    fn cuts(&self, block: &Block) -> bool {
        let (p, q) = (self.face.local(block.min), self.face.local(block.max));
        p.z.min(q.z) < self.clip && p.z.max(q.z) >= self.clip
    }

    fn edge(&self, canvas: &mut Canvas, ends: [DVec3; 2], by: i16, slack: f64, seam: bool) {
        let [mut p, mut q] = ends;
        if !self.face.parallel {
            if p.z < self.clip && q.z < self.clip {
                return;
            }
            if let Some((cut, leaves)) = self.cut(ends) {
                if leaves { q = cut } else { p = cut }
            }
        }
        if slack == 0.0 {
            return canvas.edge(self.place(p), self.place(q), by, TOUCH, seam);
        }
        if self.face.parallel {
            let wide = TOUCH + slack * self.face.right.length() * self.per_unit;
            return canvas.edge(self.place(p), self.place(q), by, wide, seam);
        }
        // In pieces whose depth doubles at most: where the edge is at depth z, points of the
        // face move by at most slack (1 + |u|) / z, with |u| <= 1.
        let (near, far, by) = if p.z <= q.z { (p, q, by) } else { (q, p, -by) };
        let mut from = near;
        loop {
            let end = 2.0 * from.z.max(slack);
            let to =
                if end < far.z { near + (far - near) * ((end - near.z) / (far.z - near.z)) } else { far };
            let wide = if to.z <= 2.0 * slack { TOUCH } else { TOUCH + 2.0 * slack / from.z * self.per_unit };
            canvas.edge(self.place(from), self.place(to), by, wide, seam);
            if end >= far.z {
                break;
            }
            from = to;
        }
    }
}

/// The far side of a patch: where rays leave the common part of half-spaces that hold
/// it and the origin.
struct Back {
    planes: SmallVec<[Linear; 7]>,
    floor: f64,
}

impl Back {
    fn new(face: &Face, d: &Drawable) -> Self {
        let mut planes = SmallVec::new();
        let (lo, hi) = d.slab;
        if face.parallel {
            let half = (d.block.max - d.block.min) * 0.5;
            let depth = face.local((d.block.min + d.block.max) * 0.5).z + half.dot(face.forward.abs());
            let along = d.normal.dot(face.forward);
            let (m, h) = if along < 0.0 { (d.normal, lo) } else { (-d.normal, -hi) };
            planes.extend(face.nearness(m, h).filter(|_| along.abs() > 1e-3));
            return Self { planes, floor: -depth };
        }
        // Planes too close to the origin are not known well enough.
        let reach = d.block.min.abs().max(d.block.max.abs()).max_element();
        let mut add = |m: DVec3, h: f64| {
            if h < -1e-7 * reach {
                planes.extend(face.nearness(m, h));
            }
        };
        add(d.normal, lo);
        add(-d.normal, -hi);
        for axis in [face.right, face.up] {
            let (p, q) = (axis.dot(d.block.min), axis.dot(d.block.max));
            add(axis, p.min(q));
            add(-axis, -p.max(q));
        }
        let (p, q) = (face.local(d.block.min), face.local(d.block.max));
        let floor = p.z.max(q.z);
        Self { planes, floor: if floor > 0.0 { 1.0 / floor } else { f64::NEG_INFINITY } }
    }

    /// What is less near on the whole rectangle is behind; and the plane that says so.
    #[inline]
    fn behind(&self, rect: &Rect) -> (f64, Option<Linear>) {
        let (mut near, mut plane) = (self.floor, None);
        for p in &self.planes {
            let own = p.least(rect);
            if own > near {
                (near, plane) = (own, Some(*p));
            }
        }
        (near, plane)
    }
}

//! Drawing surfaces: winding numbers of outlines, less the pixels that outlines touch.
//!
//! If no edge of a patch's outline touches a pixel, the patch has one winding number there, that of the
//! pixel's middle: if it is not zero, the patch covers all of the pixel, at the depth of the far side of
//! its slab. Patches are drawn in batches: on each face, the edges that two patches of a batch share cancel.
//! Pixels that only such seams touch are covered if the winding numbers of the patches that hang together do not
//! sum to zero at their middles, at the depth of the farthest patch there. Which way a patch counts
//! is free: turning patches to the eye keeps folds from cancelling.
//!
//! Margins: edges are widened by [`TOUCH`] pixels, by [`ROUNDING`] times the coordinates of their ends, and
//! by their own slack.

use glam::{DVec3, Vec3};
use smallvec::SmallVec;

use crate::geometry::Block;
use crate::geometry::placement::Placement;
use crate::geometry::plane::HalfSpace;
use crate::mesh::surface::{NONE, Side, Surface};
use crate::occlusion::face::{Face, Linear, Rect};
use crate::occlusion::target::{above, below};
use crate::occlusion::tiles::TILE;
use crate::occlusion::{BIN, FaceBuffer, ListedPatch, OcclusionBuffers, SHADES, Shade, floor};

/// Pixels by which edges are widened on each side.
const TOUCH: f64 = 1e-5;

/// Coordinates of pixels along an edge err by less than this share of those of its ends.
const ROUNDING: f64 = 4e-15;

/// Edges flatter than this, in pixels of width for one of height, touch all their pixels in each of their rows.
const FLAT: f64 = 1e4;

/// A patch to be drawn.
#[derive(Clone)]
pub(crate) struct Drawable<'a> {
    pub(crate) surface: &'a Surface,
    /// Where the surface is, if that is not where its sides say.
    pub(crate) placement: Option<&'a Placement>,
    pub(crate) patch: u32,
    /// Counts patches when they are drawn first; else of no meaning.
    pub(crate) id: u32,
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
    /// No point of it is nearer; of a component's first one, no point of the component.
    near: f32,
    nearest: f32,
    /// Its sides in the list of the drawing.
    sides: (u32, u32),
    /// The pixels of neighbours that are drawn for the first time.
    around: ((i64, i64), (i64, i64)),
}

/// A side of a patch as one face sees it.
struct SeenSide {
    /// Its ends in pixels of the face.
    from: (f64, f64),
    to: (f64, f64),
    kind: SideKind,
    seam: bool,
}

/// How a side is drawn.
#[derive(Debug, Clone, Copy)]
enum SideKind {
    /// As one edge, widened by so many pixels.
    Plain(f64),
    /// In pieces, or cut by the near limit: the place of its ends in space.
    Deep(u32),
}

/// A side that is drawn in pieces.
struct DeepSide {
    ends: [DVec3; 2],
    slack: f64,
}

/// An empty range.
const NOWHERE: (i64, i64) = (i64::MAX, i64::MIN);

/// Where a winding number changes in a row: for all pixels from a column on.
#[derive(Debug, Default, Clone, Copy)]
struct Step {
    column: i16,
    by: i16,
}

/// Steps of a row that are kept in place.
const STEPS: usize = 7;

/// The steps of a row; what does not fit spills.
#[derive(Debug, Default, Clone, Copy)]
struct Row {
    steps: [Step; STEPS],
    count: u32,
}

/// The sides of patches.
#[derive(Default)]
struct SeenSides {
    all: Vec<SeenSide>,
    deep: Vec<DeepSide>,
}

impl SeenSides {
    fn truncate(&mut self, (all, deep): (usize, usize)) {
        self.all.truncate(all);
        self.deep.truncate(deep);
    }
}

/// What drawing keeps to spare allocations.
#[derive(Default)]
pub(crate) struct SurfaceScratch {
    seen: Vec<Seen>,
    /// For each patch of the scene, the number of the drawing and its place in `seen`.
    places: Vec<(u32, u32)>,
    drawing: u32,
    /// The sides of the patches seen.
    sides: SeenSides,
    /// The patches seen in the order of drawing: how far they are, the farthest last; component; place.
    order: Vec<(u32, u32, u32)>,
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

/// What is known of the pixels of a tile: touched by open sides; touched by seams; the winding number
/// of the middle is positive; it is negative.
type Marks = [u64; 4];
const OPEN: usize = 0;
const SEAM: usize = 1;
const PLUS: usize = 2;
const MINUS: usize = 3;

/// Pixels around a patch.
#[derive(Default)]
struct Canvas {
    area: Area,
    tiles: Vec<Marks>,
    rows: Vec<Row>,
    /// Steps that their rows had no room for.
    spilled: Vec<(i32, Step)>,
    all: Vec<Step>,
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
            self.rows.resize(rows, Row::default());
        }
        self.rows[..rows].iter_mut().for_each(|r| r.count = 0);
        self.spilled.clear();
    }

    /// Marks pixels of a row, both ends included and inside the canvas.
    #[inline]
    fn mark(&mut self, row: i32, first: i32, last: i32, layer: usize) {
        let at = (row >> 3) * self.area.nx as i32;
        let shift = (row & 7) << 3;
        let (a, b) = (first >> 3, last >> 3);
        let (low, high) = (0xffu64 << (first & 7) & 0xff, 0xffu64 >> (7 - (last & 7)));
        if a == b {
            self.tiles[(at + a) as usize][layer] |= (low & high) << shift;
            return;
        }
        self.tiles[(at + a) as usize][layer] |= low << shift;
        for tx in a + 1..b {
            self.tiles[(at + tx) as usize][layer] |= 0xff << shift;
        }
        self.tiles[(at + b) as usize][layer] |= high << shift;
    }

    /// Draws an edge, in pixels from the corner of the canvas; `wide` is what it is widened by.
    #[inline]
    fn edge(&mut self, a: (f64, f64), b: (f64, f64), by: i16, wide: f64, seam: bool) {
        let (width, height) = ((self.area.nx * TILE) as i32, (self.area.ny * TILE) as i32);
        let layer = if seam { SEAM } else { OPEN };
        let wide = wide + ROUNDING * (a.0.abs() + a.1.abs() + b.0.abs() + b.1.abs());
        // From top to bottom.
        let (a, b, by) = if a.1 <= b.1 { (a, b, by) } else { (b, a, -by) };
        let (x0, x1) = if a.0 <= b.0 { (a.0, b.0) } else { (b.0, a.0) };
        let (left, x1) = (x0 - wide, x1 + wide);
        let (right, bottom) = (f64::from(width), f64::from(height));
        if b.1 + wide < 0.0 || a.1 - wide >= bottom || left >= right {
            return;
        }
        let slope = (b.0 - a.0) / (b.1 - a.1);
        // What lies well inside the canvas needs no clipping.
        let inside = left >= 0.0 && x1 < right - 0.01 && a.1 - wide >= 0.0 && b.1 + wide < bottom - 0.01;
        if inside && slope.abs() < FLAT {
            return self.edge_inside(a, b, slope, (left, x1), by, wide, seam);
        }
        let first = nearest(within(a.1 - wide, bottom) - 0.5).max(0);
        let last = nearest(within(b.1 + wide, bottom) - 0.5).min(height - 1);
        // Rows whose middles it passes: neighbours share their ends, and so agree.
        let (from, to) = (nearest(within(a.1, bottom)).max(0), nearest(within(b.1, bottom)).min(height));
        if x1 < 0.0 {
            for row in from..to {
                self.step(row, 0, by);
            }
            return;
        }
        if slope.is_nan() || slope.abs() >= FLAT {
            // Its rows are not told apart, nor where it passes their middles: all of its pixels
            // are touched, and no two patches agree about them.
            let layer = if from < to { OPEN } else { layer };
            let lo = nearest(within(left, right) - 0.5).max(0);
            let hi = nearest(within(x1, right) - 0.5).min(width - 1);
            for row in first..=last {
                if lo <= hi {
                    self.mark(row, lo, hi, layer);
                }
            }
            for row in from..to {
                if lo < width {
                    self.step(row, lo, by);
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
                self.mark(row, lo, hi, layer);
            }
            if from <= row && row < to {
                self.pass(row, within(x + 0.5 * slope, right), by, seam);
            }
            x = next;
        }
    }

    /// Draws an edge from top to bottom that lies inside the canvas with its width, and is not flat.
    #[inline]
    #[allow(clippy::too_many_arguments)]
    fn edge_inside(
        &mut self,
        a: (f64, f64),
        b: (f64, f64),
        slope: f64,
        (left, right): (f64, f64),
        by: i16,
        wide: f64,
        seam: bool,
    ) {
        let layer = if seam { SEAM } else { OPEN };
        let (first, last) = (nearest(a.1 - wide - 0.5), nearest(b.1 + wide - 0.5));
        let (from, to) = (nearest(a.1), nearest(b.1));
        let reach = wide * slope.abs() + wide;
        // Where it passes a row's middle, and how far to both sides it touches the row.
        let mut x = a.0 + (f64::from(first) - a.1) * slope + 0.5 * slope;
        let half = 0.5 * slope.abs() + reach;
        for row in first..=last {
            let (lo, hi) = (x - half, x + half);
            let lo = nearest(if lo > left { lo } else { left } - 0.5);
            let hi = nearest(if hi < right { hi } else { right } - 0.5);
            if lo <= hi {
                self.mark(row, lo, hi, layer);
            }
            if from <= row && row < to {
                self.pass(row, x, by, seam);
            }
            x += slope;
        }
    }

    /// Passes a row's middle at a place from -1 to the canvas's width.
    #[inline]
    fn pass(&mut self, row: i32, at: f64, by: i16, seam: bool) {
        let (width, column) = ((self.area.nx * TILE) as i32, nearest(at));
        // Where a seam passes the very middle of a pixel, its two patches may not agree who has it.
        if seam && (at - f64::from(column)).abs() > 0.5 - TOUCH {
            let (lo, hi) = ((column - 1).max(0), column.min(width - 1));
            if lo <= hi {
                self.mark(row, lo, hi, OPEN);
            }
        }
        if column < width {
            self.step(row, column.max(0), by);
        }
    }

    #[inline]
    fn step(&mut self, row: i32, column: i32, by: i16) {
        let step = Step { column: column as i16, by };
        let own = &mut self.rows[row as usize];
        match own.steps.get_mut(own.count as usize) {
            Some(free) => *free = step,
            None => self.spilled.push((row, step)),
        }
        own.count += 1;
    }

    /// Turns steps into winding numbers.
    fn fill(&mut self) {
        self.spilled.sort_by_key(|s| s.0);
        let width = (self.area.nx * TILE) as i32;
        for row in 0..(self.area.ny * TILE) as i32 {
            let own = self.rows[row as usize];
            let count = own.count as usize;
            if count == 0 {
                continue;
            }
            if count == 2 {
                let [a, b, ..] = own.steps;
                let (a, b) = if a.column <= b.column { (a, b) } else { (b, a) };
                self.wind(row, a.column.into(), b.column.into(), a.by.into());
                self.wind(row, b.column.into(), width, i32::from(a.by) + i32::from(b.by));
                continue;
            }
            let mut all = std::mem::take(&mut self.all);
            all.clear();
            all.extend(&own.steps[..count.min(STEPS)]);
            if count > STEPS {
                let first = self.spilled.partition_point(|s| s.0 < row);
                all.extend(self.spilled[first..].iter().take_while(|s| s.0 == row).map(|s| s.1));
            }
            all.sort_unstable_by_key(|s| s.column);
            let (mut winding, mut from) = (0i32, 0i32);
            for step in &all {
                let column = i32::from(step.column);
                self.wind(row, from, column, winding);
                (winding, from) = (winding + i32::from(step.by), column);
            }
            self.wind(row, from, width, winding);
            self.all = all;
        }
    }

    /// Marks pixels of a row by the sign of their winding number; the upper end is excluded.
    #[inline]
    fn wind(&mut self, row: i32, from: i32, to: i32, winding: i32) {
        if winding != 0 && from < to {
            self.mark(row, from, to - 1, if winding > 0 { PLUS } else { MINUS });
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
        let clip = self.nearest * 0.5;
        let mut news = false;
        for buffer in self.faces.iter_mut().filter(|b| b.active) {
            news |= buffer.draw_surfaces(batch, self.origin, clip, patches, &mut scratch);
            buffer.list(batch, &scratch.seen);
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
    /// Draws patches together; `patches` is greater than all their numbers.
    pub(crate) fn draw_surfaces(
        &mut self,
        batch: &[Drawable],
        origin: DVec3,
        clip: f64,
        patches: usize,
        scratch: &mut SurfaceScratch,
    ) -> bool {
        if scratch.places.len() < patches {
            scratch.places.resize(patches, (0, 0));
        }
        scratch.drawing += 1;
        if scratch.drawing == u32::MAX {
            scratch.places.fill((0, 0));
            scratch.drawing = 1;
        }
        let drawing = scratch.drawing;
        scratch.seen.clear();
        scratch.sides.truncate((0, 0));
        for (i, d) in batch.iter().enumerate() {
            let Some((rect, depth)) = self.face.block(&d.block) else { continue };
            let near = above(self.face.nearness_of(depth));
            let (px, py) = (self.pixels(rect.u0, rect.u1, self.px), self.pixels(rect.v0, rect.v1, self.py));
            if px.0 >= px.1 || py.0 >= py.1 || self.hides(&rect, near) {
                continue;
            }
            let first = (scratch.sides.all.len(), scratch.sides.deep.len());
            let Some((px, py)) = self.project(d, origin, clip, (px, py), &mut scratch.sides) else {
                scratch.sides.truncate(first);
                continue;
            };
            let place = scratch.seen.len() as u32;
            scratch.places[d.number as usize] = (drawing, place);
            scratch.seen.push(Seen {
                drawable: i as u32,
                parent: place,
                px,
                py,
                near,
                nearest: near,
                sides: (first.0 as u32, scratch.sides.all.len() as u32),
                around: (NOWHERE, NOWHERE),
            });
        }
        for i in 0..scratch.seen.len() as u32 {
            let d = &batch[scratch.seen[i as usize].drawable as usize];
            let first = scratch.seen[i as usize].sides.0 as usize;
            for (k, (_, twin)) in d.sides().enumerate() {
                if let Some((number, opposite)) = twin
                    && let (drawn, place) = scratch.places[number as usize]
                    && drawn == drawing
                {
                    let other = &batch[scratch.seen[place as usize].drawable as usize];
                    // Of what was drawn before only a part is drawn again: two such patches are
                    // not known together.
                    if opposite == (d.sign() == other.sign()) && !(d.again && other.again) {
                        let (a, b) = (root(&mut scratch.seen, i), root(&mut scratch.seen, place));
                        scratch.seen[a.max(b) as usize].parent = a.min(b);
                        scratch.sides.all[first + k].seam = true;
                        if !d.again && other.again {
                            let (px, py) = (scratch.seen[i as usize].px, scratch.seen[i as usize].py);
                            let join = |a: (i64, i64), b: (i64, i64)| (a.0.min(b.0), a.1.max(b.1));
                            let around = &mut scratch.seen[place as usize].around;
                            *around = (join(around.0, px), join(around.1, py));
                        }
                    }
                }
            }
        }
        // What was drawn before is new only around its seams with what was not.
        for s in scratch.seen.iter_mut().filter(|s| batch[s.drawable as usize].again) {
            let meet = |a: (i64, i64), b: (i64, i64)| (a.0.max(b.0), a.1.min(b.1));
            (s.px, s.py) = (meet(s.px, s.around.0), meet(s.py, s.around.1));
        }
        for i in 0..scratch.seen.len() as u32 {
            let parent = root(&mut scratch.seen, i);
            let near = scratch.seen[i as usize].near;
            let nearest = &mut scratch.seen[parent as usize].nearest;
            *nearest = nearest.max(near);
            scratch.seen[i as usize].parent = parent;
        }
        // What is nearest is drawn first, and may hide the rest.
        scratch.order.clear();
        for (i, s) in scratch.seen.iter().enumerate().filter(|(_, s)| s.px.0 < s.px.1 && s.py.0 < s.py.1) {
            let nearest = scratch.seen[s.parent as usize].nearest;
            scratch.order.push((farness(nearest), s.parent, i as u32));
        }
        scratch.order.sort_unstable();
        let mut news = false;
        let mut first = 0;
        while first < scratch.order.len() {
            let parent = scratch.order[first].1;
            let last = first + scratch.order[first..].iter().take_while(|o| o.1 == parent).count();
            let hidden = |&(_, _, i): &(u32, u32, u32)| {
                let s = &scratch.seen[i as usize];
                self.covers(s.px, s.py, s.near)
            };
            if !scratch.order[first..last].iter().all(hidden) {
                news |= self.draw_component(batch, first..last, clip, scratch);
            }
            first = last;
        }
        news
    }

    /// Lists patches that were seen for the first time.
    fn list(&mut self, batch: &[Drawable], seen: &[Seen]) {
        let bins = (self.nx - 1) / BIN + 1;
        let bin = |p: i64, first: i64| (p / TILE - first) / BIN;
        for s in seen.iter().filter(|s| !batch[s.drawable as usize].again) {
            let patch = ListedPatch { id: batch[s.drawable as usize].id, near: s.near, px: s.px, py: s.py };
            for by in bin(s.py.0, self.ty)..=bin(s.py.1 - 1, self.ty) {
                for bx in bin(s.px.0, self.tx)..=bin(s.px.1 - 1, self.tx) {
                    self.patches[(by * bins + bx) as usize].push(patch);
                }
            }
        }
    }

    /// Draws patches that hang together.
    fn draw_component(
        &mut self,
        batch: &[Drawable],
        range: std::ops::Range<usize>,
        clip: f64,
        scratch: &mut SurfaceScratch,
    ) -> bool {
        let members = &scratch.order[range];
        let (canvas, joint) = (&mut scratch.canvas, &mut scratch.joint);
        if members.len() > 1 {
            let (mut px, mut py) = ((i64::MAX, i64::MIN), (i64::MAX, i64::MIN));
            for &(_, _, i) in members {
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
        for &(_, _, i) in members {
            let s = &scratch.seen[i as usize];
            let d = &batch[s.drawable as usize];
            canvas.clear(Area::new(s.px, s.py));
            self.outline(canvas, d, &scratch.sides, s.sides.0 as usize..s.sides.1 as usize, clip);
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
                    let [open, seam, plus, minus] = marks;
                    if open | seam | plus | minus == 0 {
                        continue;
                    }
                    if self.closed[own] >= s.near {
                        if members.len() > 1 {
                            // Without it, seams with it are not known to be closed.
                            joint.nears[(joint_row + tx) as usize] = f32::NEG_INFINITY;
                        }
                        continue;
                    }
                    let mask = (plus | minus) & !(open | seam);
                    let rect = self.square(area.x + tx * TILE, area.y + ty * TILE, TILE);
                    let (near, plane) = back.behind(&rect);
                    let near = below(near);
                    if mask != 0 && self.closed[own] < near {
                        news |= self.hide(own, mask, near, plane);
                    }
                    if members.len() > 1 {
                        let at = (joint_row + tx) as usize;
                        let all = &mut joint.tiles[at];
                        for (all, own) in all.iter_mut().zip(marks) {
                            *all |= own;
                        }
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
                    let mask = marks[SEAM] & (marks[PLUS] ^ marks[MINUS]) & !marks[OPEN];
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

    /// Puts the sides of a patch on the face. Returns the pixels that it may touch, of those given.
    fn project(
        &self,
        d: &Drawable,
        origin: DVec3,
        clip: f64,
        within: ((i64, i64), (i64, i64)),
        sides: &mut SeenSides,
    ) -> Option<((i64, i64), (i64, i64))> {
        let pen = Pen { face: &self.face, per_unit: self.per_unit, corner: (0.0, 0.0), clip };
        let growth = d.placement.map_or(1.0, |p| p.growth);
        let world = |v: DVec3| d.placement.map_or(v, |p| p.affine.transform_point3(v));
        let spot = |v: Vec3| pen.spot(self.face.local(world(v.as_dvec3()) - origin));
        // Outlines run on: a side often starts where the last one ended.
        let mut known = (Vec3::NAN, Spot::default());
        let (mut least, mut most) = ((f64::INFINITY, f64::INFINITY), (f64::NEG_INFINITY, f64::NEG_INFINITY));
        let (mut near, mut slack) = (f64::INFINITY, 0.0f64);
        let smaller = |a: f64, b: f64| if a < b { a } else { b };
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        for side in d.surface.outline(&d.surface.patches[d.patch as usize]) {
            let from = if known.0 == side.from { known.1 } else { spot(side.from) };
            let to = spot(side.to);
            known = (side.to, to);
            for s in [from, to] {
                least = (smaller(s.pixel.0, least.0), smaller(s.pixel.1, least.1));
                most = (larger(s.pixel.0, most.0), larger(s.pixel.1, most.1));
                near = smaller(s.at.z, near);
            }
            let own = f64::from(side.slack) * growth + d.error;
            slack = larger(own, slack);
            let kind = match pen.plain(from.at, to.at, own) {
                Some(wide) => SideKind::Plain(wide),
                None => {
                    sides.deep.push(DeepSide { ends: [from.at, to.at], slack: own });
                    SideKind::Deep(sides.deep.len() as u32 - 1)
                }
            };
            sides.all.push(SeenSide { from: from.pixel, to: to.pixel, kind, seam: false });
        }
        let deep = self.face.parallel || near >= 2.0 * clip + 2.0 * slack;
        if !deep {
            return Some(within);
        }
        let wide = if self.face.parallel { slack * self.face.right.length() } else { 2.0 * slack / near };
        let wide = TOUCH + wide * self.per_unit;
        let meet = |(lo, hi): (i64, i64), least: f64, most: f64| {
            let lo = lo.max(floor((least - wide).clamp(-1.0, hi as f64)));
            (lo, hi.min(floor((most + wide).clamp(-1.0, hi as f64)) + 1))
        };
        let (px, py) = (meet(within.0, least.0, most.0), meet(within.1, least.1, most.1));
        (px.0 < px.1 && py.0 < py.1).then_some((px, py))
    }

    /// Draws the outline of a patch, of which these are the sides.
    fn outline(
        &self,
        canvas: &mut Canvas,
        d: &Drawable,
        sides: &SeenSides,
        own: std::ops::Range<usize>,
        clip: f64,
    ) {
        let corner = (canvas.area.x as f64, canvas.area.y as f64);
        let pen = Pen { face: &self.face, per_unit: self.per_unit, corner, clip };
        let by = d.sign() as i16;
        let cut = !self.face.parallel && pen.cuts(&d.block);
        let mut base = None;
        for side in &sides.all[own] {
            let deep = match side.kind {
                SideKind::Plain(wide) => {
                    let own = |p: (f64, f64)| (p.0 - corner.0, p.1 - corner.1);
                    canvas.edge(own(side.from), own(side.to), by, wide, side.seam);
                    continue;
                }
                SideKind::Deep(place) => &sides.deep[place as usize],
            };
            pen.edge(canvas, deep.ends, by, deep.slack, side.seam);
            // Cut by the near limit: the cut runs along it, far outside the face.
            if cut && let Some((at, leaves)) = pen.cut(deep.ends) {
                let base = *base.get_or_insert(at);
                // From where the outline leaves to where it comes back.
                let (a, b) = if leaves { (at, base) } else { (base, at) };
                canvas.edge(pen.place(a), pen.place(b), by, TOUCH, false);
            }
        }
    }
}

/// Orders nearnesses: the greater one, the less.
fn farness(near: f32) -> u32 {
    let bits = near.to_bits();
    if bits >> 31 == 0 { !bits & 0x7fff_ffff } else { bits }
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

    /// How far an edge is widened whose points may lie `slack` away, if that is one width along all of it.
    #[inline]
    fn plain(&self, p: DVec3, q: DVec3, slack: f64) -> Option<f64> {
        if self.face.parallel {
            return Some(TOUCH + slack * self.face.right.length() * self.per_unit);
        }
        let (near, far) = if p.z <= q.z { (p.z, q.z) } else { (q.z, p.z) };
        if near < self.clip || near.is_nan() {
            return None;
        }
        if slack == 0.0 {
            return Some(TOUCH);
        }
        (far <= 2.0 * near && far > 2.0 * slack).then(|| self.wide(p, q, near, slack))
    }

    /// How far a piece of an edge is widened: where it is at depth z, points of the face move by at most
    /// slack (1 + |u|) / z, with |u| <= 1; `ends` round where it was cut.
    #[inline]
    fn wide(&self, p: DVec3, q: DVec3, near: f64, slack: f64) -> f64 {
        let rounding = ROUNDING * (p.abs().max_element() + q.abs().max_element());
        TOUCH + (2.0 * slack + rounding) / near * self.per_unit
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
        if self.face.parallel {
            let wide = TOUCH + slack * self.face.right.length() * self.per_unit;
            return canvas.edge(self.place(p), self.place(q), by, wide, seam);
        }
        // In pieces whose depth doubles at most.
        let (near, far, by) = if p.z <= q.z { (p, q, by) } else { (q, p, -by) };
        let mut from = near;
        loop {
            let end = 2.0 * from.z.max(slack);
            let to =
                if end < far.z { near + (far - near) * ((end - near.z) / (far.z - near.z)) } else { far };
            let slack = if to.z <= 2.0 * slack { 0.0 } else { slack };
            let wide = self.wide(p, q, from.z, slack);
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
            let plane = if along < 0.0 {
                HalfSpace { normal: d.normal, offset: -lo }
            } else {
                HalfSpace { normal: -d.normal, offset: hi }
            };
            planes.extend(face.nearness(&plane).filter(|_| along.abs() > 1e-3));
            return Self { planes, floor: -depth };
        }
        // Planes too close to the origin are not known well enough.
        let reach = d.block.min.abs().max(d.block.max.abs()).max_element();
        let mut add = |normal: DVec3, offset: f64| {
            if offset > 1e-7 * reach {
                planes.extend(face.nearness(&HalfSpace { normal, offset }));
            }
        };
        add(d.normal, -lo);
        add(-d.normal, hi);
        for axis in [face.right, face.up] {
            let (p, q) = (axis.dot(d.block.min), axis.dot(d.block.max));
            add(axis, -p.min(q));
            add(-axis, p.max(q));
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

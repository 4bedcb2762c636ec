//! Magnifying: open pixels are drawn again, eight times as fine.
//!
//! A pixel that leaves a target undecided is divided into a tile of its own. All convex occluders
//! and patches of triangles that reach into it are drawn there together: edges then touch pixels an
//! eighth as wide, occluders of both kinds join, and patches of different batches leave no seams.
//!
//! Patches are drawn into groups of 4x4 pixels ([`local`](crate::occlusion::surface::local)), and
//! convex occluders into single pixels, when the first target asks for them. The tiles are kept for
//! the rest of the query, for all targets. They follow from the occluders drawn alone: which target
//! asks first decides about none of them, unless the budget ends.

use casca_slots::Slot;
use fearless_simd::Simd;

use crate::numeric::occlusion::below;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::coverage::Coverage;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::search::search_tile;
use crate::occlusion::face_buffer::{FaceBuffer, Listed};
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::refine::Pixel;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::kept::KeptPatches;
use crate::occlusion::surface::local::{Listing, Local, Spot, Stores};
use crate::occlusion::surface::near::{FINER, GROUP, GROUP_TILES};
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::target::FaceTarget;
use crate::occlusion::tiles::{TILE, block};
use crate::simd::vectorized;

/// A patch counts once more for this many sides.
const SIDES: u64 = 32;

/// No entry.
const NONE: u32 = u32::MAX;

/// The pixels of a group that lie in the window.
fn pixels_of_group(coarse: &Window, (x, y): (i64, i64)) -> PixelRect {
    let (x, y) = (x / GROUP * GROUP, y / GROUP * GROUP);
    PixelRect { x: (x, x + GROUP), y: (y, y + GROUP) }.intersect(coarse.pixels())
}

/// The place of a pixel in its group.
fn place_in_group(x: i64, y: i64) -> usize {
    (y % GROUP * GROUP + x % GROUP) as usize
}

/// Magnified pixels that lie side by side.
#[derive(Debug, Clone, Copy)]
struct Group {
    /// The first of their tiles of finer pixels.
    tiles: usize,
    /// The range of the list of convex occluders that may reach into them.
    solids: (usize, usize),
    /// The pixels into which these were drawn, by place in the group.
    drawn: u16,
}

/// The magnified pixels of one face.
#[derive(Debug, Clone)]
struct FineFace {
    window: Window,
    /// For each group of the face, its place in `groups`.
    places: Vec<u32>,
    /// Groups in a row.
    across: i64,
    groups: Vec<Group>,
    tiles: Coverage,
    solids: Vec<Listed>,
}

impl FineFace {
    fn new() -> Self {
        Self {
            window: Window::empty(1),
            places: Vec::new(),
            across: 0,
            groups: Vec::new(),
            tiles: Coverage::default(),
            solids: Vec::new(),
        }
    }

    /// Forgets all pixels, for another window of the face.
    fn clear(&mut self, coarse: &Window) {
        let (nx, ny) = coarse.tile_count();
        self.across = nx * (TILE / GROUP);
        self.places.clear();
        self.places.resize((self.across * ny * (TILE / GROUP)) as usize, NONE);
        self.window = Window::around(&Rect::FACE, coarse.face_pixels() * FINER);
        self.groups.clear();
        self.tiles.clear(0);
        self.solids.clear();
    }

    /// The place of the group of a pixel of the coarse window.
    fn place(&self, coarse: &Window, (x, y): (i64, i64)) -> usize {
        let (tx, ty) = coarse.first_tile();
        let (gx, gy) = (x / GROUP - tx * (TILE / GROUP), y / GROUP - ty * (TILE / GROUP));
        (gy * self.across + gx) as usize
    }

    /// The group of a pixel of the coarse window, if it was magnified.
    fn find(&self, coarse: &Window, at: (i64, i64)) -> Option<&Group> {
        self.groups.get(self.places[self.place(coarse, at)] as usize)
    }

    /// The open finer pixels of a tile that a target may touch: all of them, or one if there are
    /// any and one is `enough`.
    fn open(&self, tile: usize, (x, y): (i64, i64), target: &FaceTarget, enough: bool) -> u64 {
        let PixelRect { x: (x0, x1), y: (y0, y1) } = self.window.touched_by(&target.rect);
        let touched = block(x0 - x, x1 - x, y0 - y, y1 - y);
        let mut open = 0;
        search_tile(&self.tiles, tile, &self.window, (x, y), target, touched, &mut |fx, fy, _| {
            open |= 1 << ((fy - y) * TILE + (fx - x));
            enough
        });
        open
    }

    /// Adds the group of a pixel, each pixel of which is as covered as before.
    fn add(&mut self, buffer: &FaceBuffer, at: (i64, i64)) -> Group {
        let pixels = pixels_of_group(buffer.window(), at);
        let tiles = self.tiles.append(GROUP_TILES);
        for y in pixels.y.0..pixels.y.1 {
            for x in pixels.x.0..pixels.x.1 {
                let before = buffer.nearness(x, y);
                if before > f32::NEG_INFINITY {
                    self.tiles.cover(tiles + place_in_group(x, y), u64::MAX, before);
                }
            }
        }
        let solids = (self.solids.len(), list_solids(buffer, &pixels, &mut self.solids));
        let group = Group { tiles, solids, drawn: 0 };
        let place = self.place(buffer.window(), at);
        self.places[place] = self.groups.len() as u32;
        self.groups.push(group);
        group
    }

    /// Draws the convex occluders into a pixel of a group, unless that is done. Appends the objects
    /// of those that hid more than before.
    #[inline(always)]
    fn draw_solids<S: Simd>(
        &mut self,
        simd: S,
        buffer: &FaceBuffer,
        (x, y): (i64, i64),
        used: &mut Vec<Slot>,
    ) {
        let place = self.places[self.place(buffer.window(), (x, y))];
        let Some(group) = self.groups.get_mut(place as usize) else { return };
        let bit = 1 << place_in_group(x, y);
        if group.drawn & bit != 0 {
            return;
        }
        group.drawn |= bit;
        let tile = group.tiles + place_in_group(x, y);
        let rect = buffer.window().square(x, y, 1);
        let border = |c: i64| std::array::from_fn(|i| self.window.border(c * FINER + i as i64));
        let (us, vs) = (border(x), border(y));
        for listed in &self.solids[group.solids.0..group.solids.1] {
            if self.tiles.closed(tile) >= listed.near {
                break;
            }
            let drawn = buffer.drawn(listed);
            let mask = drawn.silhouette.pixels(simd, &us, &vs);
            if mask != 0 {
                let whole = mask == u64::MAX;
                let near = if whole { drawn.front.behind_inside(&rect) } else { drawn.front.behind(&rect) };
                if self.tiles.cover(tile, mask, below(near)) {
                    used.push(drawn.owner);
                }
            }
        }
    }
}

/// Occluders that hid something only in magnified pixels, or compared with a target. Some of them
/// repeat.
#[derive(Debug, Clone, Default)]
pub(crate) struct UsedFinely {
    /// The objects of convex occluders.
    pub(crate) solids: Vec<Slot>,
    /// Numbers of patches in the order of first drawing.
    pub(crate) patches: Vec<u32>,
}

impl UsedFinely {
    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.solids.clear();
        self.patches.clear();
    }
}

/// The magnified pixels of one query.
#[derive(Debug, Clone, Default)]
pub(crate) struct Magnifier {
    /// Occluders that were of use.
    pub(crate) used: UsedFinely,
    faces: Vec<FineFace>,
    /// By face, patches that the first pass did not project, since they are narrow.
    late: Vec<KeptPatches>,
    found: Vec<Listing>,
    local: Local,
}

/// The patches that can be drawn again.
pub(crate) struct Patches<F> {
    /// Gives a patch by its number in the order of first drawing.
    pub(crate) drawable: F,
}

impl Magnifier {
    /// Forgets all pixels, for another query.
    pub(crate) fn begin(&mut self, buffers: &OcclusionBuffers) {
        let count = buffers.faces().count();
        self.faces.resize_with(count.max(self.faces.len()), FineFace::new);
        for (fine, buffer) in self.faces.iter_mut().zip(buffers.faces()) {
            fine.clear(buffer.window());
        }
        self.late.resize_with(count.max(self.late.len()), KeptPatches::default);
        self.late.iter_mut().for_each(KeptPatches::clear);
    }

    /// A pixel that may not be magnified yet: all of it is open.
    pub(crate) fn pixel(&self, face: usize, (x, y): (i64, i64), rect: &Rect) -> Pixel<'_> {
        let fine = &self.faces[face].window;
        Pixel { fine, first: (x * FINER, y * FINER), rect: *rect, open: u64::MAX }
    }

    /// Whether a pixel is magnified, and none of its finer pixels that a target may touch is open.
    pub(crate) fn closes(
        &self,
        (face, buffer): (usize, &FaceBuffer),
        (x, y): (i64, i64),
        target: &FaceTarget,
    ) -> bool {
        let (fine, place) = (&self.faces[face], place_in_group(x, y));
        let drawn = fine.find(buffer.window(), (x, y)).filter(|group| group.drawn >> place & 1 == 1);
        drawn.is_some_and(|group| fine.open(group.tiles + place, (x * FINER, y * FINER), target, true) == 0)
    }

    /// A magnified pixel, with those of its finer pixels open that a target may touch, and the
    /// convex occluders around. Without such occluders, with one of those pixels at most.
    pub(crate) fn search(
        &self,
        (face, buffer): (usize, &FaceBuffer),
        (x, y): (i64, i64),
        rect: &Rect,
        target: &FaceTarget,
    ) -> (Pixel<'_>, &[Listed]) {
        let fine = &self.faces[face];
        let whole = self.pixel(face, (x, y), rect);
        let Some(group) = fine.find(buffer.window(), (x, y)) else { return (whole, &[]) };
        let enough = group.solids.0 == group.solids.1;
        let open = fine.open(group.tiles + place_in_group(x, y), whole.first, target, enough);
        (Pixel { open, ..whole }, &fine.solids[group.solids.0..group.solids.1])
    }

    /// Magnifies a pixel. Patches that reach into its group are drawn unless the budget is less.
    pub(crate) fn magnify<'a, F: Fn(u32) -> Option<Drawable<'a>>>(
        &mut self,
        buffers: &OcclusionBuffers,
        (face, buffer): (usize, &FaceBuffer),
        at: (i64, i64),
        patches: &Patches<F>,
        budget: &mut u32,
    ) {
        if self.faces[face].find(buffer.window(), at).is_none() {
            let group = self.faces[face].add(buffer, at);
            self.draw_patches(buffers, (face, buffer), (at, group), patches, budget);
        }
        let (fine, used) = (&mut self.faces[face], &mut self.used.solids);
        vectorized!(simd => fine.draw_solids(simd, buffer, at, used));
    }

    /// Draws the patches that reach into a group of pixels.
    fn draw_patches<'a, F: Fn(u32) -> Option<Drawable<'a>>>(
        &mut self,
        buffers: &OcclusionBuffers,
        (face, buffer): (usize, &FaceBuffer),
        (at, group): ((i64, i64), Group),
        patches: &Patches<F>,
        budget: &mut u32,
    ) {
        let pixels = pixels_of_group(buffer.window(), at);
        find_patches(buffer, &pixels, &mut self.found);
        if self.found.is_empty() {
            return;
        }
        let projector = Projector::new(buffer, buffers.viewpoint());
        let Some((ids, drawn)) = buffers.surfaces().kept(face) else { return };
        for listed in &self.found {
            if !drawn.has(listed.id)
                && let Some(drawable) = (patches.drawable)(listed.id)
            {
                let drawable = Drawable { id: listed.id, ..drawable };
                let (late, within) = (&mut self.late[face], listed.pixels);
                vectorized!(simd => late.keep(simd, &projector, &drawable, within));
            }
        }
        let stores = Stores { ids, drawn, late: &self.late[face] };
        let sides = self.found.iter().filter_map(|listed| stores.side_count(listed.id));
        let cost = sides.map(|count| 1 + u64::from(count) / SIDES).sum::<u64>();
        if cost == 0 || cost > u64::from(*budget) {
            return;
        }
        *budget -= cost as u32;
        let at = (at.0 / GROUP * GROUP, at.1 / GROUP * GROUP);
        let (coverage, step) = (&mut self.faces[face].tiles, buffer.window().step());
        let sheet = Sheet { coverage, base: group.tiles, first: at, count: (GROUP, GROUP), step };
        let mut spot = Spot { projector, at, pixels, sheet };
        self.local.draw(&mut spot, stores, &self.found, &mut self.used.patches);
    }
}

/// Appends the convex occluders that may reach into a rectangle of pixels of one tile, the nearest
/// first. Returns the length of the list.
fn list_solids(buffer: &FaceBuffer, pixels: &PixelRect, found: &mut Vec<Listed>) -> usize {
    let rect = buffer.window().rect(pixels);
    let first = found.len();
    buffer.occluders().for_around(pixels, |listed| {
        if listed.rect.overlaps(&rect) && buffer.drawn(listed).silhouette.touches(&rect) {
            found.push(*listed);
        }
    });
    found[first..].sort_unstable_by(|a, b| b.near.total_cmp(&a.near).then(a.drawn.cmp(&b.drawn)));
    found.len()
}

/// Finds the drawn patches that may reach into a rectangle of pixels and hide anything there.
fn find_patches(buffer: &FaceBuffer, pixels: &PixelRect, found: &mut Vec<Listing>) {
    found.clear();
    buffer.patches().for_around(pixels, |patch| {
        if patch.pixels.overlaps(pixels) && !buffer.hides_pixels(&patch.pixels.intersect(pixels), patch.near)
        {
            found.push(Listing { id: patch.id, near: patch.near, pixels: patch.pixels });
        }
    });
    found.sort_unstable_by_key(|listed| listed.id);
    found.dedup_by_key(|listed| listed.id);
}

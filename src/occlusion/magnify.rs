//! Magnifying: open pixels are drawn again, eight times as fine.
//!
//! A pixel that leaves a target undecided is divided into a tile of its own. All convex occluders and patches of
//! triangles that reach into it are drawn there together: edges then touch pixels an eighth as wide, occluders of both
//! kinds join, and patches of different batches leave no seams. The tiles are kept for the rest of the query, so that
//! each pixel is magnified once, for all targets.

use smallvec::SmallVec;

use crate::numeric::occlusion::below;
use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::coverage::Coverage;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::search::search_tile;
use crate::occlusion::face_buffer::{FaceBuffer, Listed};
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::surface::batch::Sight;
use crate::occlusion::surface::components::draw_surfaces;
use crate::occlusion::surface::drawable::Drawable;
use crate::occlusion::surface::scratch::SurfaceScratch;
use crate::occlusion::target::FaceTarget;
use crate::occlusion::tiles::{TILE, bits, block};

/// How many times finer.
const FINER: i64 = TILE;

/// A patch counts once more for this many sides.
const SIDES: u64 = 32;

/// No entry.
const NONE: u32 = u32::MAX;

/// A pixel that is covered after all, down to a nearness.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closed {
    face: usize,
    tile: usize,
    bit: i64,
    near: f32,
}

/// A magnified pixel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FinePixel {
    /// Its tile of finer pixels.
    tile: usize,
    /// The range of the list of convex occluders that reach into it or pixels near it.
    solids: (usize, usize),
}

/// The magnified pixels of one face.
#[derive(Debug, Clone)]
struct FineFace {
    window: Window,
    /// For each tile of the face, the place of its list of pixels.
    places: Vec<u32>,
    /// For each pixel of a tile, its place in `pixels`.
    lists: Vec<[u32; (TILE * TILE) as usize]>,
    pixels: Vec<FinePixel>,
    tiles: Coverage,
    solids: Vec<Listed>,
}

impl FineFace {
    fn new() -> Self {
        Self {
            window: Window::empty(1),
            places: Vec::new(),
            lists: Vec::new(),
            pixels: Vec::new(),
            tiles: Coverage::default(),
            solids: Vec::new(),
        }
    }

    /// Forgets all pixels, for another window of the face.
    fn clear(&mut self, coarse: &Window) {
        let (nx, ny) = coarse.tile_count();
        self.places.clear();
        self.places.resize((nx * ny) as usize, NONE);
        self.window = Window::around(&Rect::FACE, coarse.face_pixels() * FINER);
        self.lists.clear();
        self.pixels.clear();
        self.tiles.clear(0);
        self.solids.clear();
    }

    /// A pixel of the coarse window, if it was magnified.
    fn find(&self, coarse: &Window, x: i64, y: i64) -> Option<&FinePixel> {
        let list = self.lists.get(self.places[coarse.tile_index(x / TILE, y / TILE)] as usize)?;
        self.pixels.get(list[(y % TILE * TILE + x % TILE) as usize] as usize)
    }

    /// Calls `found` with the open finer pixels of a magnified pixel that a target may touch, until that returns true.
    /// Returns whether it did.
    fn search(
        &self,
        pixel: &FinePixel,
        (x, y): (i64, i64),
        target: &FaceTarget,
        mut found: impl FnMut(&Rect) -> bool,
    ) -> bool {
        let (x, y) = (x * FINER, y * FINER);
        let PixelRect { x: (x0, x1), y: (y0, y1) } = self.window.touched_by(&target.rect);
        let touched = block(x0 - x, x1 - x, y0 - y, y1 - y);
        let mut found = |_, _, rect: &Rect| found(rect);
        search_tile(&self.tiles, pixel.tile, &self.window, (x, y), target, touched, &mut found)
    }

    /// Adds a pixel of the coarse window, with the convex occluders of the list drawn.
    fn add(&mut self, buffer: &FaceBuffer, (x, y): (i64, i64), solids: (usize, usize)) -> Added {
        let place = &mut self.places[buffer.window().tile_index(x / TILE, y / TILE)];
        if *place == NONE {
            *place = self.lists.len() as u32;
            self.lists.push([NONE; (TILE * TILE) as usize]);
        }
        let tile = self.tiles.append();
        self.lists[*place as usize][(y % TILE * TILE + x % TILE) as usize] = self.pixels.len() as u32;
        self.pixels.push(FinePixel { tile, solids });
        let before = buffer.nearness(x, y);
        if before > f32::NEG_INFINITY {
            self.tiles.cover(tile, u64::MAX, before);
        }
        let rect = buffer.window().square(x, y, 1);
        let border = |c: i64| std::array::from_fn(|i| self.window.border(c * FINER + i as i64));
        let (us, vs) = (border(x), border(y));
        for listed in &self.solids[solids.0..solids.1] {
            let closed = self.tiles.closed(tile);
            if closed >= listed.near {
                break;
            }
            let drawn = buffer.drawn(listed);
            let mask = drawn.silhouette.pixels(&us, &vs);
            if mask != 0 {
                let whole = mask == u64::MAX;
                let near = if whole { drawn.front.behind_inside(&rect) } else { drawn.front.behind(&rect) };
                self.tiles.cover(tile, mask, below(near));
            }
        }
        Added { pixel: (x, y), tile, before }
    }
}

/// A pixel added, and the nearness down to which it was covered before.
#[derive(Debug, Clone, Copy)]
struct Added {
    pixel: (i64, i64),
    tile: usize,
    before: f32,
}

/// The magnified pixels of one query.
#[derive(Debug, Clone, Default)]
pub(crate) struct Magnifier {
    faces: Vec<FineFace>,
    buffer: Option<FaceBuffer>,
    scratch: SurfaceScratch,
    found: Vec<u32>,
    closed: Vec<Closed>,
}

/// The patches that can be drawn again.
pub(crate) struct Patches<F> {
    /// Gives a patch by its number in the order of first drawing.
    pub(crate) drawable: F,
    /// Greater than the numbers of all patches of the scene.
    pub(crate) count: usize,
}

impl Magnifier {
    /// Forgets all pixels, for another query.
    pub(crate) fn begin(&mut self, buffers: &OcclusionBuffers) {
        self.closed.clear();
        let count = buffers.faces().count();
        self.faces.resize_with(count.max(self.faces.len()), FineFace::new);
        for (fine, buffer) in self.faces.iter_mut().zip(buffers.faces()) {
            fine.clear(buffer.window());
        }
    }

    /// Covers the pixels of the buffers that were closed since the last call.
    pub(crate) fn close(&mut self, buffers: &mut OcclusionBuffers) {
        for c in self.closed.drain(..) {
            buffers.cover(c.face, c.tile, 1 << c.bit, c.near);
        }
    }

    /// Calls `found` with the open finer pixels of a pixel that a target may touch, until that returns true.
    /// Returns whether it did, and the convex occluders around; `None` if the pixel is not magnified.
    pub(crate) fn search(
        &self,
        face: usize,
        buffer: &FaceBuffer,
        at: (i64, i64),
        target: &FaceTarget,
        found: impl FnMut(&Rect) -> bool,
    ) -> Option<(bool, &[Listed])> {
        let fine = &self.faces[face];
        let pixel = fine.find(buffer.window(), at.0, at.1)?;
        let solids = &fine.solids[pixel.solids.0..pixel.solids.1];
        Some((fine.search(pixel, at, target, found), solids))
    }

    /// Whether a pixel is magnified.
    pub(crate) fn has(&self, face: usize, buffer: &FaceBuffer, (x, y): (i64, i64)) -> bool {
        self.faces[face].find(buffer.window(), x, y).is_some()
    }

    /// Magnifies the pixels `wanted` of a tile. Patches that reach into them are drawn unless the budget is less.
    pub(crate) fn magnify<'a, F: Fn(u32) -> Option<Drawable<'a>>>(
        &mut self,
        buffers: &OcclusionBuffers,
        (face, buffer): (usize, &FaceBuffer),
        (tx, ty): (i64, i64),
        wanted: u64,
        patches: &Patches<F>,
        budget: &mut u32,
    ) {
        let at = |bit: i64| (tx * TILE + (bit & 7), ty * TILE + (bit >> 3));
        let around = bits(wanted).fold(PixelRect::EMPTY, |all, bit| {
            let (x, y) = at(bit);
            all.join(&PixelRect { x: (x, x + 1), y: (y, y + 1) })
        });
        let own = &mut self.faces[face];
        let solids = (own.solids.len(), list_solids(buffer, &around, &mut own.solids));
        let added: SmallVec<[Added; 16]> = bits(wanted).map(|bit| own.add(buffer, at(bit), solids)).collect();
        let limit = added.iter().map(|a| own.tiles.closed(a.tile)).fold(f32::INFINITY, f32::min);
        find_patches(buffer, &around, limit, &mut self.found);
        let batch: Vec<Drawable<'a>> = self.found.iter().filter_map(|&id| (patches.drawable)(id)).collect();
        let cost = batch.iter().map(|d| 1 + d.outline().len() as u64 / SIDES).sum::<u64>();
        if cost > 0 && cost <= u64::from(*budget) {
            *budget -= cost as u32;
            let fine = self.buffer.get_or_insert_with(|| FaceBuffer::new(*buffer.face()));
            prepare(fine, buffer, &around, &own.tiles, &added);
            let scratch = &mut self.scratch;
            let sights = (0..).zip(&batch).filter_map(|(patch, d)| {
                let (near, pixels) = fine.sight(&d.block)?;
                Some(Sight { face: 0, patch, near, pixels })
            });
            let sights: Vec<Sight> = sights.collect();
            let (origin, limit) = (buffers.origin(), buffers.near_limit());
            draw_surfaces(fine, &batch, sights.into_iter(), origin, limit, patches.count, scratch);
            for a in &added {
                let from = fine.window().tile_index(a.pixel.0, a.pixel.1);
                own.tiles.copy_tile(a.tile, fine.coverage(), from);
            }
        }
        let tile = buffer.window().tile_index(tx, ty);
        for (a, bit) in added.iter().zip(bits(wanted)) {
            let near = own.tiles.closed(a.tile);
            if near > a.before {
                self.closed.push(Closed { face, tile, bit, near });
            }
        }
    }
}

/// Clears a finer buffer for a rectangle of pixels: those added are as covered as their tiles, and the others are
/// closed.
fn prepare(
    fine: &mut FaceBuffer,
    coarse: &FaceBuffer,
    around: &PixelRect,
    tiles: &Coverage,
    added: &[Added],
) {
    fine.clear_finer(coarse, around, FINER);
    for y in around.y.0..around.y.1 {
        for x in around.x.0..around.x.1 {
            let tile = fine.window().tile_index(x, y);
            match added.iter().find(|a| a.pixel == (x, y)) {
                Some(a) => fine.coverage_mut().copy_tile(tile, tiles, a.tile),
                None => {
                    fine.coverage_mut().cover(tile, u64::MAX, f32::INFINITY);
                }
            }
        }
    }
}

/// Appends the convex occluders that may reach into a rectangle of pixels of one tile, the nearest first. Returns the
/// length of the list.
fn list_solids(buffer: &FaceBuffer, pixels: &PixelRect, found: &mut Vec<Listed>) -> usize {
    let rect = buffer.window().rect(pixels);
    let first = found.len();
    buffer.occluders().for_around(pixels, |listed| {
        if buffer.drawn(listed).silhouette.touches(&rect) {
            found.push(*listed);
        }
    });
    found[first..].sort_unstable_by(|a, b| b.near.total_cmp(&a.near).then(a.drawn.cmp(&b.drawn)));
    found.len()
}

/// Finds the drawn patches that may reach into a rectangle of pixels, and may hide anything farther than `limit` there.
fn find_patches(buffer: &FaceBuffer, pixels: &PixelRect, limit: f32, found: &mut Vec<u32>) {
    found.clear();
    buffer.patches().for_around(pixels, |patch| {
        if patch.pixels.overlaps(pixels)
            && patch.near > limit
            && !buffer.hides_pixels(&patch.pixels.intersect(pixels), patch.near)
        {
            found.push(patch.id);
        }
    });
    found.sort_unstable();
    found.dedup();
}

//! Magnifying: open pixels are drawn again, eight times as fine.
//!
//! A pixel that leaves a target undecided is divided into a tile of its own. All convex occluders
//! and patches of triangles that reach into it are drawn there together: edges then touch pixels an
//! eighth as wide, occluders of both kinds join, and patches of different batches leave no seams.
//!
//! Patches are drawn into groups of 4x4 pixels ([`local`](crate::occlusion::surface::local)), and
//! convex occluders into single pixels, when the first target asks for them. The tiles are kept for
//! the rest of the query, for all targets. They follow from the occluders drawn alone: which target
//! asks first decides about none of them, unless the budget ends. So several threads may ask at
//! once, each with a [`Hand`] of its own: the first one fills a group or a pixel, and others that
//! ask for the same wait for it.

pub(crate) mod budget;
mod filled;
mod group;

use casca_slots::Slot;

use crate::occlusion::buffers::OcclusionBuffers;
use crate::occlusion::coverage::Shades;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::search::search_tile;
use crate::occlusion::face_buffer::{FaceBuffer, Listed, ListedPatch};
use crate::occlusion::magnify::budget::Purse;
use crate::occlusion::magnify::filled::Filled;
use crate::occlusion::magnify::group::{Group, Tiles, place_in_group};
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::refine::PixelOccluder;
use crate::occlusion::surface::local::{Local, Spot};
use crate::occlusion::surface::near::{FINER, GROUP};
use crate::occlusion::surface::projector::Projector;
use crate::occlusion::surface::sheet::Sheet;
use crate::occlusion::target::{FaceTarget, Target};
use crate::occlusion::tiles::{TILE, Tile, block};

/// A patch counts once more for this many sides.
const SIDES: u64 = 32;

/// The magnified pixels of one face.
#[derive(Debug)]
struct FineFace {
    window: Window,
    /// For each group of the face.
    groups: Vec<Filled<Box<Group>>>,
    /// Groups in a row.
    across: i64,
}

impl FineFace {
    fn new() -> Self {
        Self { window: Window::empty(1), groups: Vec::new(), across: 0 }
    }

    /// Makes room for another window of the face. There are no groups.
    fn begin(&mut self, coarse: &Window) {
        let (nx, ny) = coarse.tile_count();
        self.across = nx * (TILE / GROUP);
        let count = (self.across * ny * (TILE / GROUP)) as usize;
        if self.groups.len() < count {
            self.groups.resize_with(count, Filled::default);
        }
        self.window = Window::around(&Rect::FACE, coarse.face_pixels() * FINER);
    }

    /// The place of the group of a pixel of the coarse window.
    fn place(&self, coarse: &Window, (x, y): (i64, i64)) -> u32 {
        let (tx, ty) = coarse.first_tile();
        let (gx, gy) = (x / GROUP - tx * (TILE / GROUP), y / GROUP - ty * (TILE / GROUP));
        (gy * self.across + gx) as u32
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

/// A magnified pixel that a target asked for.
#[cfg_attr(not(feature = "rayon"), allow(dead_code, reason = "only threads look ahead"))]
#[derive(Debug, Clone, Copy)]
pub(crate) struct Request {
    face: u32,
    group: u32,
    pixel: u8,
}

impl UsedFinely {
    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.solids.clear();
        self.patches.clear();
    }
}

/// The magnified pixels of one query.
#[derive(Debug, Default)]
pub(crate) struct Magnifier {
    faces: Vec<FineFace>,
}

/// The memory of a thread that magnifies pixels.
#[allow(clippy::vec_box, reason = "boxes move to the faces and back, so that runs allocate nothing")]
#[derive(Debug, Default)]
pub(crate) struct Hand {
    found: Vec<ListedPatch>,
    local: Local,
    /// The groups that it listed, by face and place, and memory for more.
    listed: Vec<(u32, u32)>,
    spare: Vec<Box<Group>>,
    /// Those that it filled with finer pixels.
    filled: Vec<(u32, u32)>,
    spare_tiles: Vec<Box<Tiles>>,
    /// The target that is examined, and its outline on a face.
    pub(crate) target: Target,
    pub(crate) on_face: FaceTarget,
    /// The pixels in which it may be visible, and the occluders that reach into one of those.
    pub(crate) open: Vec<(i64, i64)>,
    pub(crate) candidates: Vec<PixelOccluder>,
    /// The pixels that targets asked for since this was emptied last.
    pub(crate) requests: Vec<Request>,
    /// The objects of convex occluders that targets were compared with, to be hidden by them.
    pub(crate) compared: Vec<Slot>,
}

/// Nothing of it outlasts a run.
impl Clone for Magnifier {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Nothing of it outlasts a run.
impl Clone for Hand {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// A pixel of a face that is magnified.
pub(crate) struct Magnified<'a> {
    fine: &'a Window,
    /// The convex occluders around, the nearest first.
    pub(crate) solids: &'a [Listed],
    tile: &'a Tile,
    shades: &'a Shades,
    first: (i64, i64),
}

impl Magnifier {
    /// Makes room for another query, or for the same with more occluders drawn. The hands must have
    /// been emptied.
    fn begin(&mut self, buffers: &OcclusionBuffers) {
        let count = buffers.faces().count();
        self.faces.resize_with(count.max(self.faces.len()), FineFace::new);
        for (fine, buffer) in self.faces.iter_mut().zip(buffers.faces()) {
            fine.begin(buffer.window());
        }
    }

    /// Forgets all pixels, for another query, or for the same with more occluders drawn.
    pub(crate) fn clear(&mut self, hands: &mut [Hand], buffers: &OcclusionBuffers) {
        self.drop_tiles(hands, |_| false);
        for Hand { listed, spare, .. } in hands {
            // The first one comes first again, with the memory that it has.
            let groups = listed.drain(..).rev().map(|at| self.group_mut(at).take());
            spare.extend(groups.flatten());
        }
        self.begin(buffers);
    }

    /// Forgets the finer pixels that no target asked for.
    #[cfg(feature = "rayon")]
    pub(crate) fn drop_unasked(&mut self, hands: &mut [Hand]) {
        self.drop_tiles(hands, |tiles| tiles.asked.get());
    }

    fn drop_tiles(&mut self, hands: &mut [Hand], stays: impl Fn(&Tiles) -> bool) {
        for Hand { filled, spare_tiles, .. } in hands {
            let before = spare_tiles.len();
            filled.retain(|&at| {
                let Some(group) = self.group_mut(at).get_mut() else { return false };
                let kept = group.tiles.get().is_some_and(|tiles| stays(tiles));
                if !kept {
                    spare_tiles.extend(group.tiles.take());
                }
                kept
            });
            spare_tiles[before..].reverse();
        }
    }

    fn group_mut(&mut self, (face, place): (u32, u32)) -> &mut Filled<Box<Group>> {
        &mut self.faces[face as usize].groups[place as usize]
    }

    /// The finer pixels of a group, and its convex occluders.
    fn tiles(&self, (face, place): (u32, u32)) -> Option<(&Tiles, &[Listed])> {
        let group = self.faces[face as usize].groups[place as usize].get()?;
        Some((group.tiles.get()?, &group.solids))
    }

    /// Whether a pixel that a thread looked at is as the query would find it now, with this many
    /// patches left. Notes that it asks for it, and takes the cost.
    #[cfg(feature = "rayon")]
    pub(crate) fn accept(&self, request: &Request, left: &mut Purse) -> bool {
        let Some((tiles, _)) = self.tiles((request.face, request.group)) else { return false };
        if !tiles.asked.get() && tiles.cost > 0 {
            if left.holds(tiles.cost) == tiles.bare {
                return false;
            }
            left.take(tiles.cost);
        }
        tiles.note(request.pixel.into());
        true
    }

    /// The finer pixels that targets asked for, with the number of the face.
    fn asked<'m>(&'m self, hands: &'m [Hand]) -> impl Iterator<Item = (u32, &'m Tiles, &'m [Listed])> {
        let filled = hands.iter().flat_map(|hand| &hand.filled);
        let tiles = filled.filter_map(|&at| self.tiles(at).map(|(tiles, solids)| (at.0, tiles, solids)));
        tiles.filter(|(_, tiles, _)| tiles.asked.get())
    }

    /// How many patches were drawn in those.
    pub(crate) fn cost(&self, hands: &[Hand]) -> u32 {
        self.asked(hands).filter(|(_, tiles, _)| !tiles.bare).map(|(_, tiles, _)| tiles.cost).sum()
    }

    /// The occluders that hid something in the pixels that were asked for.
    pub(crate) fn used(&self, hands: &[Hand], buffers: &OcclusionBuffers, used: &mut UsedFinely) {
        for (face, tiles, solids) in self.asked(hands) {
            let Some(buffer) = buffers.faces().nth(face as usize) else { continue };
            let own = solids.iter().enumerate().filter(|(place, _)| tiles.uses(*place));
            used.solids.extend(own.map(|(_, listed)| buffer.drawn(listed.drawn).owner));
            used.patches.extend(&tiles.used);
        }
    }

    /// The group of a pixel, and its place.
    fn group(&self, face: usize, buffer: &FaceBuffer, at: (i64, i64), hand: &mut Hand) -> (u32, &Group) {
        let fine = &self.faces[face];
        let place = fine.place(buffer.window(), at);
        let group = fine.groups[place as usize].get_or_fill(|| {
            hand.listed.push((face as u32, place));
            let mut group = hand.spare.pop().unwrap_or_default();
            group.begin(buffer, at);
            group
        });
        (place, group)
    }

    /// Magnifies a pixel. Patches that reach into its group are drawn unless the budget is less.
    pub(crate) fn magnify(
        &self,
        buffers: &OcclusionBuffers,
        (face, buffer): (usize, &FaceBuffer),
        at: (i64, i64),
        (hand, left): (&mut Hand, &mut Purse),
    ) -> Magnified<'_> {
        let (place, group) = self.group(face, buffer, at, hand);
        let (window, solids) = (&self.faces[face].window, &group.solids[..]);
        let tiles = group.tiles.get_or_fill(|| {
            hand.filled.push((face as u32, place));
            let mut tiles = hand.spare_tiles.pop().unwrap_or_default();
            let pixels = tiles.begin(buffer, at);
            hand.draw_patches(buffers, (face, buffer), (at, pixels), &mut tiles, left);
            tiles
        });
        let (tile, shades) = tiles.pixel(buffer, (window, solids), at);
        let pixel = place_in_group(at);
        match left {
            Purse::Own(_) => tiles.note(pixel),
            Purse::Shared(_) => {
                hand.requests.push(Request { face: face as u32, group: place, pixel: pixel as u8 });
            }
        }
        Magnified { fine: window, solids, tile, shades, first: (at.0 * FINER, at.1 * FINER) }
    }
}

impl Magnified<'_> {
    /// A rectangle around those of its finer pixels that are open and that a target may touch, if
    /// there are any. Without convex occluders around, one of them will do.
    pub(crate) fn search(&self, target: &FaceTarget) -> Option<Rect> {
        let (x, y) = self.first;
        let PixelRect { x: (x0, x1), y: (y0, y1) } = self.fine.touched_by(&target.rect);
        let touched = block(x0 - x, x1 - x, y0 - y, y1 - y);
        let (mut open, enough) = (PixelRect::EMPTY, self.solids.is_empty());
        let tile = (self.tile, self.shades);
        search_tile(tile, self.fine, self.first, target, touched, &mut |fx, fy, _| {
            open = open.join(&PixelRect { x: (fx, fx + 1), y: (fy, fy + 1) });
            enough
        });
        (!open.is_empty()).then(|| self.fine.rect(&open))
    }
}

impl Hand {
    /// Draws the patches that reach into a group of pixels.
    fn draw_patches(
        &mut self,
        buffers: &OcclusionBuffers,
        (face, buffer): (usize, &FaceBuffer),
        (at, pixels): ((i64, i64), PixelRect),
        tiles: &mut Tiles,
        left: &mut Purse,
    ) {
        find_patches(buffer, &pixels, &mut self.found);
        if self.found.is_empty() {
            return;
        }
        let Some((ids, kept)) = buffers.surfaces().kept(face) else { return };
        let sides = self.found.iter().filter_map(|listed| kept.side_count(listed.id));
        let cost = sides.map(|count| 1 + u64::from(count) / SIDES).sum::<u64>();
        tiles.cost = u32::try_from(cost).unwrap_or(u32::MAX);
        tiles.bare = cost > 0 && !left.take(tiles.cost);
        if cost == 0 || tiles.bare {
            return;
        }
        let at = (at.0 / GROUP * GROUP, at.1 / GROUP * GROUP);
        let (coverage, step) = (&mut tiles.coverage, buffer.window().step());
        let sheet = Sheet { coverage, base: 0, first: at, count: (GROUP, GROUP), step };
        let mut spot = Spot { projector: Projector::new(buffer, buffers.viewpoint()), at, sheet };
        self.local.draw(&mut spot, (ids, kept), &self.found, &mut tiles.used);
    }
}

/// Finds the drawn patches that may reach into a rectangle of pixels and hide anything there.
fn find_patches(buffer: &FaceBuffer, pixels: &PixelRect, found: &mut Vec<ListedPatch>) {
    found.clear();
    buffer.patches().for_around(pixels, |patch| {
        if patch.pixels.overlaps(pixels) && !buffer.hides_pixels(&patch.pixels.intersect(pixels), patch.near)
        {
            found.push(*patch);
        }
    });
    found.sort_unstable_by_key(|listed| listed.id);
    found.dedup_by_key(|listed| listed.id);
}

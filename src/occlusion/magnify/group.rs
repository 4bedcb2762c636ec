//! Groups of magnified pixels.

use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::Simd;

use crate::numeric::occlusion::below;
use crate::occlusion::coverage::{Coverage, Shades};
use crate::occlusion::face_buffer::{FaceBuffer, Listed};
use crate::occlusion::magnify::filled::Filled;
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::surface::near::{FINER, GROUP, GROUP_TILES};
use crate::occlusion::tiles::Tile;
use crate::simd::vectorized;

/// The last bit of a word.
const LAST_BIT: usize = 63;

/// The pixels of a group that lie in the window.
pub(super) fn pixels_of_group(coarse: &Window, (x, y): (i64, i64)) -> PixelRect {
    let (x, y) = (x / GROUP * GROUP, y / GROUP * GROUP);
    PixelRect { x: (x, x + GROUP), y: (y, y + GROUP) }.intersect(coarse.pixels())
}

/// The place of a pixel in its group.
pub(super) fn place_in_group((x, y): (i64, i64)) -> usize {
    (y % GROUP * GROUP + x % GROUP) as usize
}

/// Something that was found for a target. Threads that look ahead find more than the query asks
/// for in the end.
#[derive(Debug, Default)]
pub(super) struct WasAsked(AtomicBool);

impl WasAsked {
    pub(super) fn note(&self) {
        // Nothing else follows from it while threads run.
        self.0.store(true, Ordering::Relaxed);
    }

    pub(super) fn get(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A pixel with its convex occluders drawn.
#[derive(Debug)]
pub(super) struct FinePixel {
    tile: Tile,
    shades: Shades,
    /// Those of the group's list that hid more than before, one bit each; the last bit is for all
    /// that come later.
    used: u64,
    asked: WasAsked,
}

/// Pixels that lie side by side, some of them magnified.
#[derive(Debug, Default)]
pub(super) struct Group {
    /// The convex occluders that may reach into them, the nearest first.
    pub(super) solids: Vec<Listed>,
    pub(super) tiles: Filled<Box<Tiles>>,
}

/// The finer pixels of a group. They follow from what the query drew, and from whether the patches
/// were left out; pixels are filled when they are asked for.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    /// With the patches, but without the convex occluders.
    pub(super) coverage: Coverage,
    /// The patches that hid more than before, by their numbers in the order of first drawing.
    pub(super) used: Vec<u32>,
    /// What drawing the patches costs, counted in patches with few sides.
    pub(super) cost: u32,
    /// Whether they were left out.
    pub(super) bare: bool,
    pub(super) asked: WasAsked,
    pixels: [Filled<FinePixel>; GROUP_TILES],
}

impl Group {
    /// Makes it the group of a pixel.
    pub(super) fn begin(&mut self, buffer: &FaceBuffer, at: (i64, i64)) {
        list_solids(buffer, &pixels_of_group(buffer.window(), at), &mut self.solids);
    }
}

impl Tiles {
    /// Makes them those of the group of a pixel: each pixel as covered as before, no patch drawn.
    /// Returns the pixels.
    pub(super) fn begin(&mut self, buffer: &FaceBuffer, at: (i64, i64)) -> PixelRect {
        let pixels = pixels_of_group(buffer.window(), at);
        self.coverage.clear(GROUP_TILES);
        for y in pixels.y.0..pixels.y.1 {
            for x in pixels.x.0..pixels.x.1 {
                let before = buffer.nearness(x, y);
                if before > f32::NEG_INFINITY {
                    self.coverage.cover(place_in_group((x, y)), u64::MAX, before);
                }
            }
        }
        self.used.clear();
        (self.cost, self.bare, self.asked) = (0, false, WasAsked::default());
        self.pixels.iter_mut().for_each(|pixel| *pixel = Filled::default());
        pixels
    }

    /// The tile of a pixel, filled now if it was not.
    pub(super) fn pixel(
        &self,
        buffer: &FaceBuffer,
        (fine, solids): (&Window, &[Listed]),
        at: (i64, i64),
    ) -> (&Tile, &Shades) {
        let place = place_in_group(at);
        let (tile, shades) = (self.coverage.tile(place), self.coverage.shades(place));
        if solids.is_empty() {
            return (tile, shades);
        }
        let pixel = self.pixels[place].get_or_fill(|| {
            let asked = WasAsked::default();
            let mut pixel = FinePixel { tile: *tile, shades: *shades, used: 0, asked };
            vectorized!(simd => pixel.draw(simd, buffer, (fine, solids), at));
            pixel
        });
        (&pixel.tile, &pixel.shades)
    }

    /// Notes that a target asked for a pixel.
    pub(super) fn note(&self, place: usize) {
        self.asked.note();
        if let Some(pixel) = self.pixels[place].get() {
            pixel.asked.note();
        }
    }

    /// Whether a convex occluder, by its place in the list of the group, hid something in the pixels
    /// that were asked for.
    pub(super) fn uses(&self, place: usize) -> bool {
        let bit = 1 << place.min(LAST_BIT);
        let pixels = self.pixels.iter().filter_map(Filled::get);
        { pixels }.any(|pixel| pixel.asked.get() && pixel.used & bit != 0)
    }
}

impl FinePixel {
    #[inline(always)]
    fn draw<S: Simd>(
        &mut self,
        simd: S,
        buffer: &FaceBuffer,
        (fine, solids): (&Window, &[Listed]),
        (x, y): (i64, i64),
    ) {
        let rect = buffer.window().square(x, y, 1);
        let border = |c: i64| std::array::from_fn(|i| fine.border(c * FINER + i as i64));
        let (us, vs) = (border(x), border(y));
        let mut closed = self.tile.closed();
        for (place, listed) in solids.iter().enumerate() {
            if closed >= listed.near {
                break;
            }
            let drawn = buffer.drawn(listed.drawn);
            let mask = drawn.silhouette.pixels(simd, &us, &vs);
            if mask != 0 {
                let whole = mask == u64::MAX;
                let near = if whole { drawn.front.behind_inside(&rect) } else { drawn.front.behind(&rect) };
                if self.tile.cover(mask, below(near)) {
                    closed = self.tile.closed();
                    self.used |= 1 << place.min(LAST_BIT);
                }
            }
        }
    }
}

/// Lists the convex occluders that may reach into a rectangle of pixels of one tile, the nearest
/// first.
fn list_solids(buffer: &FaceBuffer, pixels: &PixelRect, found: &mut Vec<Listed>) {
    let rect = buffer.window().rect(pixels);
    found.clear();
    buffer.occluders().for_around(pixels, |listed| {
        if listed.rect.overlaps(&rect) && buffer.drawn(listed.drawn).silhouette.touches(&rect) {
            found.push(*listed);
        }
    });
    found.sort_unstable_by(|a, b| b.near.total_cmp(&a.near).then(a.drawn.cmp(&b.drawn)));
}

//! Searching a face for open pixels.

use casca_slots::Slot;
use glam::DVec3;

use crate::geometry::Block;
use crate::numeric::occlusion::below;
use crate::occlusion::bins::BIN;
use crate::occlusion::coverage::Shades;
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pixels::{PixelRect, Window};
use crate::occlusion::target::FaceTarget;
use crate::occlusion::tiles::{TILE, Tile, bits, block};

/// A pixel that does not hide a point in it.
struct OpenPixel {
    pixel: (i64, i64),
    /// The point's direction and nearness.
    at: (f64, f64),
    near: f64,
}

impl FaceBuffer {
    /// Calls `found` with each open pixel that a target may touch, until that returns true.
    pub(crate) fn uncovered(&self, target: &FaceTarget, mut found: impl FnMut(i64, i64, &Rect) -> bool) {
        let pixels = self.window.touched_by(&target.rect);
        if pixels.is_empty() {
            return;
        }
        let ((x0, x1), (y0, y1)) = (pixels.x, pixels.y);
        let ((tx0, tx1), (ty0, ty1)) = (pixels.tiles_x(), pixels.tiles_y());
        for ty in ty0..=ty1 {
            let row = self.window.tile_index(tx0, ty);
            for tx in tx0..=tx1 {
                let t = row + (tx - tx0) as usize;
                if self.coverage.closed(t) >= target.near {
                    continue;
                }
                let (x, y) = (tx * TILE, ty * TILE);
                let open = block(x0 - x, x1 - x, y0 - y, y1 - y);
                let tile = (self.coverage.tile(t), self.coverage.shades(t));
                if search_tile(tile, &self.window, (x, y), target, open, &mut found) {
                    return;
                }
            }
        }
    }

    /// Whether a target is seen in any open pixel.
    #[inline]
    pub(crate) fn sees(&self, target: &FaceTarget) -> bool {
        let mut seen = false;
        self.uncovered(target, |_, _, _| {
            seen = true;
            true
        });
        seen
    }

    /// Whether a patch of triangles may hide a point at a nearness in a pixel.
    pub(crate) fn patch_may_hide(&self, (x, y): (i64, i64), near: f32) -> bool {
        let holds = |(lo, hi): (i64, i64), at: i64| lo <= at && at < hi;
        self.patches.any_around(x, y, |p| p.near > near && holds(p.pixels.x, x) && holds(p.pixels.y, y))
    }

    /// Whether patches may reach into the bin of a pixel, that of the lists of occluders.
    pub(crate) fn has_patches(&self, (x, y): (i64, i64)) -> bool {
        let ((tx, ty), size) = (self.window.first_tile(), BIN * TILE);
        let first = |at: i64, tile: i64| (at - tile * TILE) / size * size + tile * TILE;
        let (x0, y0) = (first(x, tx), first(y, ty));
        let bin = PixelRect { x: (x0, x0 + size), y: (y0, y0 + size) };
        self.patches.any_around(x, y, |p| p.pixels.overlaps(&bin))
    }

    /// Notes into which tiles nothing was drawn, nor is listed there. Costs the tiles.
    pub(crate) fn note_untouched(&mut self) {
        let ((x0, y0), (nx, ny)) = (self.window.first_tile(), self.window.tile_count());
        let mut untouched = std::mem::take(&mut self.untouched);
        untouched.clear();
        untouched.extend((0..nx * ny).map(|at| {
            let first = ((x0 + at % nx) * TILE, (y0 + at / nx) * TILE);
            self.coverage.tile(at as usize).is_untouched()
                && self.occluders.len(self.occluders.index(first.0, first.1)) == 0
                && !self.has_patches(first)
        }));
        self.untouched = untouched;
    }

    /// Whether nothing was drawn into the tiles of the rectangle around a box when that was noted.
    pub(crate) fn is_untouched(&self, block: &Block) -> bool {
        let Some((rect, _)) = self.face.block(block) else { return true };
        let pixels = self.window.touched_by(&rect);
        pixels.is_empty() || {
            let ((x0, x1), (y0, y1)) = (pixels.tiles_x(), pixels.tiles_y());
            let row = |y: i64| self.window.tile_index(x0, y)..=self.window.tile_index(x1, y);
            (y0..=y1).all(|y| self.untouched[row(y)].iter().all(|&untouched| untouched))
        }
    }

    /// Whether nothing was drawn into the tile of a point, in coordinates of the face, when that was
    /// noted.
    #[inline]
    pub(crate) fn is_untouched_at(&self, p: DVec3) -> bool {
        let pixel = self.window.pixel_at(p.x / p.z, p.y / p.z);
        pixel.is_some_and(|(x, y)| self.untouched[self.window.tile_index(x / TILE, y / TILE)])
    }

    /// Whether a point, in coordinates of the face, lies in an open pixel, inside the frustum, before
    /// all patches that may hide it and all convex occluders but those of its owner.
    pub(crate) fn shows(&self, p: DVec3, owner: Slot) -> bool {
        self.open_pixel(p).is_some_and(|OpenPixel { pixel, at, near }| {
            !self.patch_may_hide(pixel, below(near))
                && self.halves.iter().all(|half| half.at(at.0, at.1) >= 0.0)
                && self.is_before(pixel, at, near, owner)
        })
    }

    /// Whether a point, in coordinates of the face, lies in a pixel that does not hide it.
    pub(crate) fn leaves_open(&self, p: DVec3) -> bool {
        self.open_pixel(p).is_some()
    }

    /// The pixel of a point, in coordinates of the face, if it does not hide the point.
    #[inline]
    fn open_pixel(&self, p: DVec3) -> Option<OpenPixel> {
        if !self.face.parallel && p.z <= 0.0 {
            return None;
        }
        let (u, v) = if self.face.parallel { (p.x, p.y) } else { (p.x / p.z, p.y / p.z) };
        let (x, y) = self.window.pixel_at(u, v)?;
        let near = self.face.nearness_of(p.z);
        let hidden = self.coverage.hides_point(&self.window, (x, y), (u, v), below(near), near);
        (!hidden).then_some(OpenPixel { pixel: (x, y), at: (u, v), near })
    }

    /// Whether a point lies before the convex occluders around its pixel, or beside them; those of
    /// its owner do not count.
    pub(crate) fn is_before(&self, pixel: (i64, i64), (u, v): (f64, f64), near: f64, owner: Slot) -> bool {
        self.occluders.all(self.occluders.index(pixel.0, pixel.1), |listed| {
            if f64::from(listed.near) <= near || !listed.rect.contains(u, v) {
                return true;
            }
            let d = self.drawn(listed.drawn);
            d.owner == owner || !d.silhouette.may_hold(u, v) || d.front.at(u, v) <= near
        })
    }
}

/// Calls `found` with those of the pixels `open` of a tile that are not hidden and that a target
/// may touch, until that returns true. Returns whether it did. `(x, y)` is the tile's first pixel
/// in the window.
#[inline(always)]
pub(crate) fn search_tile(
    (tile, shades): (&Tile, &Shades),
    window: &Window,
    (x, y): (i64, i64),
    target: &FaceTarget,
    mut open: u64,
    found: &mut impl FnMut(i64, i64, &Rect) -> bool,
) -> bool {
    open &= !tile.hidden(target.near);
    if open == 0 {
        return false;
    }
    let rect = window.square(x, y, TILE);
    let Some(silhouette) = target.silhouette.crossing(&rect) else { return false };
    // In this tile the target may be farther than as a whole.
    open &= !tile.hidden(target.near(&rect));
    open = shades.open(open, target, &rect);
    bits(open).any(|bit| {
        let (x, y) = (x + (bit & 7), y + (bit >> 3));
        let rect = window.square(x, y, 1);
        silhouette.touches(&rect) && !shades.hide_pixel(bit, target, &rect) && found(x, y, &rect)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Room;
    use crate::geometry::body::Body;
    use crate::occlusion::face::Face;
    use crate::occlusion::solid::Solid;
    use crate::occlusion::target::Target;

    #[test]
    fn open_pixels_are_those_that_the_target_touches_beside_the_occluder() {
        let face = Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false };
        let mut buffer = FaceBuffer::new(face);
        buffer.clear(Some(Rect::FACE), 64);
        // Covers u < 0 but for a little.
        let wall = Block { min: DVec3::new(-9.0, -9.0, 4.0), max: DVec3::new(-0.01, 9.0, 5.0) };
        let mut solid = Solid::default();
        assert!(solid.set_body(&Body::Block(wall), None, &Room::NONE));
        buffer.draw(&solid, Slot::new(0));
        let target = |x: f64| {
            let (c, h) = (DVec3::new(x, 0.0, 8.0), DVec3::new(1.0, 1.0, 0.5));
            let mut on_face = FaceTarget::default();
            assert!(Target::block(Block { min: c - h, max: c + h }, None).on_face(&face, &mut on_face));
            on_face
        };
        let open = |x: f64| {
            let mut found = Vec::new();
            buffer.uncovered(&target(x), |x, y, _| {
                found.push((x, y));
                false
            });
            found
        };
        assert!(open(-2.0).is_empty() && !buffer.sees(&target(-2.0)));
        let half = open(0.0);
        assert!(buffer.sees(&target(0.0)));
        // The near side reaches from -1/7.5 to 1/7.5: five columns right of the middle, and one for
        // rounding.
        assert!(half.iter().all(|p| (31..37).contains(&p.0)), "{half:?}");
        assert!(half.len() >= 5 * 9, "{half:?}");
        let mut count = 0;
        buffer.uncovered(&target(4.0), |_, _, _| {
            count += 1;
            count == 3
        });
        assert_eq!(count, 3, "the search stops when told");
        let other = Slot::new(1);
        assert!(buffer.shows(DVec3::new(4.0, 0.0, 8.0), other));
        assert!(buffer.shows(DVec3::new(-1.0, 0.0, 3.9), other), "before the wall");
        assert!(!buffer.shows(DVec3::new(-1.0, 0.0, 8.0), other), "behind the wall");
        assert!(!buffer.shows(DVec3::new(4.0, 0.0, -8.0), other), "behind the eye");
    }
}

//! Drawing convex occluders.

use crate::numeric::occlusion::{PIXEL, above, below};
use crate::occlusion::face::Rect;
use crate::occlusion::face_buffer::{Drawn, FaceBuffer, Listed};
use crate::occlusion::front::Front;
use crate::occlusion::pixels::{PixelRect, Window, floor};
use crate::occlusion::silhouette::Silhouette;
use crate::occlusion::solid::Solid;
use crate::occlusion::tiles::{TILE, span};

/// The pixels that an occluder covers in one row of tiles.
struct TileRow {
    /// For each row of pixels, the covered columns.
    spans: [(i64, i64); TILE as usize],
    /// Columns that some row covers, and that all rows cover.
    some: (i64, i64),
    all: (i64, i64),
}

impl TileRow {
    /// The rows of pixels of the row of tiles `ty` that lie inside a rectangle around the silhouette.
    #[inline]
    fn new(silhouette: &Silhouette, window: &Window, pixels: &PixelRect, ty: i64) -> Self {
        let mut row =
            Self { spans: [(0, 0); TILE as usize], some: (i64::MAX, i64::MIN), all: (i64::MIN, i64::MAX) };
        let (first, last) = ((ty * TILE).max(pixels.y.0), ((ty + 1) * TILE).min(pixels.y.1));
        let (step, per_unit) = (window.step(), window.per_unit());
        let (x0, x1) = pixels.x;
        let conic = silhouette.is_conic();
        let mut filled = 0;
        silhouette.rows(window.border(first), step, (last - first) as usize, |i, lo, hi| {
            let y = first + i as i64;
            let clamp = |p: f64| p.clamp(x0 as f64, x1 as f64);
            // Only whole pixels between the ends. The borders of the face itself are exact.
            let mut a = if lo <= -1.0 { x0 } else { -floor(-clamp((lo + 1.0) * per_unit + PIXEL)) };
            let mut b = if hi >= 1.0 { x1 } else { floor(clamp((hi + 1.0) * per_unit - PIXEL)) };
            if conic && a < b {
                let (v0, v1) = (window.border(y), window.border(y + 1));
                let sure =
                    |a, b| silhouette.covers(&Rect { u0: window.border(a), v0, u1: window.border(b), v1 });
                if !sure(a, b) {
                    (a, b) = (a + 1, b - 1);
                    if a < b && !sure(a, b) {
                        b = a;
                    }
                }
            }
            if a < b {
                row.spans[(y - ty * TILE) as usize] = (a, b);
                row.some = (row.some.0.min(a), row.some.1.max(b));
                row.all = (row.all.0.max(a), row.all.1.min(b));
                filled += 1;
            }
        });
        if filled < TILE {
            row.all.1 = i64::MIN;
        }
        row
    }

    /// Whether the tile that begins at column `x` is covered as a whole.
    #[inline]
    fn covers_tile(&self, x: i64) -> bool {
        self.all.0 <= x && x + TILE <= self.all.1
    }

    /// The covered pixels of the tile that begins at column `x`.
    #[inline]
    fn mask(&self, x: i64) -> u64 {
        let row = |(i, s): (usize, &(i64, i64))| span(s.0 - x, s.1 - x) << (8 * i);
        self.spans.iter().enumerate().map(row).fold(0, |all, row| all | row)
    }
}

impl FaceBuffer {
    /// Draws an occluder, `index` in the list of shadows. Returns whether the face sees it, and whether it hides
    /// more than before.
    pub(crate) fn draw(&mut self, solid: &Solid, index: u32, owner: u32) -> (bool, bool) {
        let Some((rect, depth, silhouette)) = solid.on_face(&self.face) else { return (false, false) };
        let pixels = self.window.touched_by(&rect);
        if pixels.is_empty() {
            return (false, false);
        }
        let front = solid.front(&self.face);
        let listed = Listed { drawn: self.drawn.len() as u32, near: above(self.face.nearness_of(depth)) };
        self.occluders.push(&pixels, listed);
        let mut changed = false;
        let (first, last) = pixels.tiles_y();
        for ty in first..=last {
            let row = TileRow::new(&silhouette, &self.window, &pixels, ty);
            changed |= self.cover_row(&row, ty, &front, listed.near);
        }
        self.drawn.push(Drawn { silhouette, front, solid: index, owner });
        (true, changed)
    }

    /// Covers a row of tiles with an occluder of which no point is nearer than `nearest`.
    #[inline]
    fn cover_row(&mut self, row: &TileRow, ty: i64, front: &Front, nearest: f32) -> bool {
        let (left, right) = row.some;
        if left >= right {
            return false;
        }
        let mut changed = false;
        let first = left / TILE;
        let row_start = self.window.tile_index(first, ty);
        for tx in first..=(right - 1) / TILE {
            let x = tx * TILE;
            let t = row_start + (tx - first) as usize;
            let closed = self.coverage.closed(t);
            if closed >= nearest {
                continue;
            }
            let rect = self.window.square(x, ty * TILE, TILE);
            let whole = row.covers_tile(x);
            let near = below(if whole { front.behind_inside(&rect) } else { front.behind(&rect) });
            if near <= closed {
                continue;
            }
            let mask = if whole { u64::MAX } else { row.mask(x) };
            changed |= mask != 0 && self.coverage.cover(t, mask, near);
        }
        changed
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::polytope::Polytope;
    use crate::occlusion::face::Face;

    fn buffer(pixels: i64) -> FaceBuffer {
        let face = Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false };
        let mut buffer = FaceBuffer::new(face);
        buffer.clear(Some(Rect::FACE), pixels);
        buffer
    }

    #[test]
    fn occluders_cover_whole_pixels_inside_their_silhouettes() {
        let block = Block { min: DVec3::new(-1.1, -0.7, 4.0), max: DVec3::new(1.3, 0.9, 5.0) };
        let ball = (DVec3::new(0.3, 0.2, 5.0), 1.5);
        let solids = [
            Solid::polytope(Polytope::block(&block), None).unwrap(),
            Solid::sphere(ball.0, ball.1, None).unwrap(),
        ];
        for (i, solid) in solids.iter().enumerate() {
            let mut buffer = buffer(64);
            assert_eq!(buffer.draw(solid, 0, 0), (true, true));
            assert_eq!(buffer.draw(solid, 1, 0), (true, false), "the second time nothing is new");
            let window = *buffer.window();
            let mut covered = 0;
            for y in 0..64 {
                for x in 0..64 {
                    let near = buffer.coverage().nearness(&window, x, y);
                    if near == f32::NEG_INFINITY {
                        continue;
                    }
                    covered += 1;
                    for (u, v) in window.square(x, y, 1).corners() {
                        let d = DVec3::new(u, v, 1.0);
                        let hit = if i == 0 {
                            (u * 4.0 >= -1.1 && u * 4.0 <= 1.3) && (v * 4.0 >= -0.7 && v * 4.0 <= 0.9)
                        } else {
                            let along = d.normalize().dot(ball.0);
                            (ball.0.length_squared() - along * along).sqrt() <= ball.1
                        };
                        assert!(hit, "{i}: {x} {y}");
                    }
                    // Behind the occluder's front, and not beyond its middle.
                    assert!(near < 1.0 / 3.5 && near > 1.0 / 5.01, "{i}: {near}");
                }
            }
            // Nearly the areas of the silhouettes: 0.6 by 0.4, and a disc of radius 0.31.
            assert!(covered > [200, 270][i], "{i}: {covered}");
        }
    }
}

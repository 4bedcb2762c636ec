//! Drawing convex occluders.

use casca_slots::Slot;
use fearless_simd::Simd;

use crate::numeric::occlusion::{above, below};
use crate::occlusion::coverage::Coverage;
use crate::occlusion::face_buffer::{DrawnSolid, FaceBuffer, Listed};
use crate::occlusion::front::Front;
use crate::occlusion::pixels::Window;
use crate::occlusion::rows::{ShapeRows, TileRow};
use crate::occlusion::silhouette::Silhouette;
use crate::occlusion::solid::Solid;
use crate::occlusion::tiles::TILE;
use crate::simd::vectorized;

impl FaceBuffer {
    /// Draws an occluder. Returns whether it hides more than before.
    pub(crate) fn draw(&mut self, solid: &Solid, owner: Slot) -> bool {
        let Some(seen) = solid.on_face(&self.face) else { return false };
        let pixels = self.window.touched_by(&seen.rect);
        if pixels.is_empty() {
            return false;
        }
        let nearest = above(self.face.nearness_of(seen.near));
        let number = self.drawn_count;
        self.drawn_count += 1;
        self.occluders.push(&pixels, Listed { drawn: number as u32, near: nearest, rect: seen.rect });
        if number == self.drawn.len() {
            let (silhouette, front) = (Silhouette::default(), Front::default());
            self.drawn.push(DrawnSolid { silhouette, front, owner });
        }
        let drawn = &mut self.drawn[number];
        drawn.owner = owner;
        drawn.silhouette.set(solid.aspect(), &self.face);
        drawn.front.set(&self.face, solid.aspect(), seen.far, solid.aspect().largest());
        if !self.rows.set_inside(&drawn.silhouette, &self.window, &pixels) {
            return false;
        }
        let (coverage, window, rows, front) = (&mut self.coverage, &self.window, &self.rows, &drawn.front);
        vectorized!(simd => cover_rows(simd, coverage, window, rows, front, nearest))
    }
}

/// Covers the tiles of an occluder of which no point is nearer than `nearest`. Returns whether that
/// hides more than before.
#[inline(always)]
fn cover_rows<S: Simd>(
    simd: S,
    coverage: &mut Coverage,
    window: &Window,
    rows: &ShapeRows,
    front: &Front,
    nearest: f32,
) -> bool {
    let mut changed = false;
    let (tiles_x, tiles_y) = (rows.pixels().tiles_x(), rows.pixels().tiles_y());
    for ty in tiles_y.0..=tiles_y.1 {
        let start = window.tile_index(tiles_x.0, ty);
        let end = start + (tiles_x.1 - tiles_x.0) as usize;
        if !coverage.all_closed(start, end, nearest) {
            changed |= cover_row(simd, coverage, window, (&rows.tile_row(ty), ty), (front, nearest));
        }
    }
    changed
}

/// Covers a row of tiles.
#[inline(always)]
fn cover_row<S: Simd>(
    simd: S,
    coverage: &mut Coverage,
    window: &Window,
    (row, ty): (&TileRow, i64),
    (front, nearest): (&Front, f32),
) -> bool {
    let (left, right) = row.columns();
    if left >= right {
        return false;
    }
    let mut changed = false;
    let first = left / TILE;
    let row_start = window.tile_index(first, ty);
    for tx in first..=(right - 1) / TILE {
        let x = tx * TILE;
        let t = row_start + (tx - first) as usize;
        let closed = coverage.closed(t);
        if closed >= nearest {
            continue;
        }
        let rect = window.square(x, ty * TILE, TILE);
        let whole = row.covers_tile(x);
        let near = below(if whole { front.behind_inside(&rect) } else { front.behind(&rect) });
        if near <= closed {
            continue;
        }
        let mask = if whole { u64::MAX } else { row.mask(simd, x) };
        changed |= mask != 0 && coverage.cover(t, mask, near);
    }
    changed
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Block;
    use crate::geometry::Room;
    use crate::geometry::body::Body;
    use crate::geometry::polytope::Polytope;
    use crate::occlusion::face::{Face, Rect};

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
        let polytope = Polytope::block(&block);
        let bodies = [
            Body::Part(polytope.part(DVec3::ZERO, DVec3::ZERO)),
            Body::Sphere { center: ball.0, radius: ball.1 },
        ];
        let solid = &mut Solid::default();
        for (i, body) in bodies.iter().enumerate() {
            assert!(solid.set_body(body, None, &Room::NONE));
            let mut buffer = buffer(64);
            assert!(buffer.draw(solid, Slot::new(0)));
            assert!(!buffer.draw(solid, Slot::new(0)), "the second time nothing is new");
            let window = *buffer.window();
            let mut covered = 0;
            for y in 0..64 {
                for x in 0..64 {
                    let near = buffer.nearness(x, y);
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

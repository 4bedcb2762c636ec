//! The frustum on a face: half-planes, and the pixels outside of them.

use glam::DVec3;

use crate::numeric::occlusion::{DIRECTION, HALF_PLANE_OUTSIDE, HALF_PLANE_SLOPE, PLANE_ALONG_RAYS};
use crate::occlusion::face::{Face, Rect};
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pitch::{MAX_DEPTH, Pitch};
use crate::occlusion::tiles::{TILE, span};
use crate::view::{Origin, View};

impl FaceBuffer {
    /// Takes over the frustum of a view. Returns a rectangle around its part on the face.
    ///
    /// A plane that passes the eye at some distance bounds directions only for points beyond the nearest depth.
    pub(crate) fn set_frustum(&mut self, view: &View, origin: DVec3, pitch: &Pitch) -> Option<Rect> {
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
                if along.abs() < PLANE_ALONG_RAYS {
                    let mut half =
                        self.face.half(plane.normal, at + slack + along.abs() * MAX_DEPTH * pitch.reach);
                    half.c += DIRECTION;
                    self.halves.push(half);
                }
            } else {
                let mut half = self.face.half(plane.normal, 0.0);
                half.c += (at + slack).max(0.0) / pitch.nearest + DIRECTION;
                self.halves.push(half);
            }
        }
        let mut bounds: Option<Rect> = None;
        for &(u, v) in &Face::clip(&Rect::FACE, &self.halves) {
            let b = bounds.get_or_insert(Rect { u0: u, v0: v, u1: u, v1: v });
            *b = Rect { u0: b.u0.min(u), v0: b.v0.min(v), u1: b.u1.max(u), v1: b.v1.max(v) };
        }
        bounds
    }

    /// Covers the pixels outside the frustum, as if by something at the eye.
    pub(super) fn cover_outside(&mut self) {
        let (first, count) = (self.window.first_tile(), self.window.tile_count());
        for ty in first.1..first.1 + count.1 {
            let mut rows = [(0i64, 0i64); TILE as usize];
            for (i, row) in rows.iter_mut().enumerate() {
                *row = self.inside_row(ty * TILE + i as i64);
            }
            let common = rows.iter().fold((i64::MIN, i64::MAX), |c, r| (c.0.max(r.0), c.1.min(r.1)));
            for tx in first.0..first.0 + count.0 {
                let x = tx * TILE;
                if common.0 <= x && x + TILE <= common.1 {
                    continue;
                }
                let mut inside = 0;
                for (i, row) in rows.iter().enumerate() {
                    inside |= span(row.0 - x, row.1 - x) << (8 * i);
                }
                self.coverage.cover(self.window.tile_index(tx, ty), !inside, f32::INFINITY);
            }
        }
    }

    /// The pixels of a row that may be inside the frustum and are in the window.
    fn inside_row(&self, y: i64) -> (i64, i64) {
        let rows = self.window.pixels().y;
        if y < rows.0 || y >= rows.1 {
            return (0, 0);
        }
        let (v0, v1) = (self.window.border(y), self.window.border(y + 1));
        let (mut lo, mut hi) = (-1.0f64, 1.0f64);
        for half in &self.halves {
            let rest = (half.b * v0).max(half.b * v1) + half.c;
            if half.a > HALF_PLANE_SLOPE {
                lo = lo.max(-rest / half.a);
            } else if half.a < -HALF_PLANE_SLOPE {
                hi = hi.min(-rest / half.a);
            } else if rest < -HALF_PLANE_OUTSIDE {
                return (0, 0);
            }
        }
        if lo > hi { (0, 0) } else { self.window.columns(lo, hi) }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use glam::camera::rh::{proj::directx, view::look_to_mat4};

    use super::*;
    use crate::grid::side::Side;

    #[test]
    fn pixels_that_the_frustum_touches_stay_open() {
        let matrix = directx::perspective(0.7, 1.5, 0.1, 50.0)
            * look_to_mat4(Vec3::ZERO, Vec3::new(0.9, 0.2, 0.4), Vec3::Y);
        let view = View::perspective(Vec3::ZERO, matrix).unwrap();
        let pitch = Pitch { pixels: 64.0, least: 0.0, nearest: 1e-3, reach: 50.0, middle: DVec3::ZERO };
        let (mut open, mut covered) = (0, 0);
        for side in &Side::ALL {
            let mut buffer = FaceBuffer::new(Face::side(side));
            let bounds = buffer.set_frustum(&view, DVec3::ZERO, &pitch);
            buffer.clear(bounds, 64);
            let window = *buffer.window();
            for i in 0..200 {
                for j in 0..200 {
                    let (u, v) = (f64::from(i) / 100.0 - 0.995, f64::from(j) / 100.0 - 0.995);
                    let inside = buffer.halves().iter().all(|h| h.at(u, v) >= 0.0);
                    match window.pixel_at(u, v) {
                        Some((x, y)) if buffer.is_active() => {
                            let near = buffer.coverage().nearness(&window, x, y);
                            assert!(!inside || near == f32::NEG_INFINITY, "{side:?} {u} {v}");
                            open += u32::from(near == f32::NEG_INFINITY);
                            covered += u32::from(near == f32::INFINITY);
                        }
                        _ => assert!(!inside, "{side:?} {u} {v}"),
                    }
                }
            }
        }
        assert!(open > 1000 && covered > 100, "{open} {covered}");
    }
}

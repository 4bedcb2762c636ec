//! The frustum on a face: half-planes, and the pixels outside of them.

use glam::DVec3;

use crate::numeric::occlusion::{DIRECTION, MAX_DEPTH, PLANE_ALONG_RAYS};
use crate::occlusion::face::{Face, Rect};
use crate::occlusion::face_buffer::FaceBuffer;
use crate::occlusion::pitch::Pitch;
use crate::occlusion::tiles::TILE;
use crate::view::{Origin, View};

impl FaceBuffer {
    /// Takes over the frustum of a view. Returns a rectangle around its part on the face.
    ///
    /// A plane that passes the eye at some distance bounds directions only for points beyond the
    /// nearest depth.
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
                        self.face.half(plane.normal, at + slack + along.abs() * MAX_DEPTH * pitch.radius);
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
    pub(crate) fn cover_outside(&mut self) {
        let (first, count) = (self.window.first_tile(), self.window.tile_count());
        let any = self.rows.set_touching(&self.halves, &self.window);
        for ty in first.1..first.1 + count.1 {
            let start = self.window.tile_index(first.0, ty);
            let row = any.then(|| self.rows.tile_row(ty));
            for (tx, tile) in (first.0..first.0 + count.0).zip(start..) {
                let inside = row.as_ref().map_or(0, |row| row.mask_of_tile(tx * TILE));
                if inside != u64::MAX {
                    self.coverage.cover(tile, !inside, f32::INFINITY);
                }
            }
        }
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
        let pitch = Pitch { pixels: 64.0, least: 0.0, nearest: 1e-3, radius: 50.0, middle: DVec3::ZERO };
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
                            let near = buffer.nearness(x, y);
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

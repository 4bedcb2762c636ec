//! Receivers: what lies before none of them is covered, after Bittner et al. 2011 (shadow caster
//! culling for efficient shadow mapping).

use crate::geometry::Block;
use crate::numeric::occlusion::below;
use crate::occlusion::face_buffer::{FaceBuffer, Received};
use crate::occlusion::tiles::{TILE, block};

impl FaceBuffer {
    /// Covers all pixels that no box touches, and each tile beyond the farthest box in it. Where it
    /// is not known at which end rays start (not `ordered`), nothing is beyond.
    pub(crate) fn keep_before(&mut self, receivers: impl Iterator<Item = Block>, ordered: bool) {
        let mut received = std::mem::take(&mut self.received);
        let (nx, ny) = self.window.tile_count();
        received.clear();
        received.resize((nx * ny) as usize, Received { mask: 0, near: f32::INFINITY });
        receivers.for_each(|block| self.receive(&block, ordered, &mut received));
        for (tile, &Received { mask, near }) in received.iter().enumerate() {
            if mask != u64::MAX {
                self.coverage.cover(tile, !mask, f32::INFINITY);
            }
            if mask != 0 && near > f32::NEG_INFINITY {
                self.coverage.cover(tile, u64::MAX, near);
            }
        }
        self.received = received;
    }

    /// Adds one receiver to the tiles that it may touch.
    fn receive(&self, receiver: &Block, ordered: bool, received: &mut [Received]) {
        let Some((rect, (_, far))) = self.face.block(receiver) else { return };
        let pixels = self.window.touched_by(&rect.grown());
        if pixels.is_empty() {
            return;
        }
        let near = below(self.face.nearness_of(far));
        // A depth that is not a number is any depth.
        let near = if ordered && !near.is_nan() { near } else { f32::NEG_INFINITY };
        let ((tx0, tx1), (ty0, ty1)) = (pixels.tiles_x(), pixels.tiles_y());
        for ty in ty0..=ty1 {
            let row = self.window.tile_index(tx0, ty);
            for tx in tx0..=tx1 {
                let (x, y) = (tx * TILE, ty * TILE);
                let tile = &mut received[row + (tx - tx0) as usize];
                tile.mask |= block(pixels.x.0 - x, pixels.x.1 - x, pixels.y.0 - y, pixels.y.1 - y);
                tile.near = tile.near.min(near);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::occlusion::face::{Face, Rect};

    #[test]
    fn boxes_that_meet_a_ray_before_a_receiver_stay_open() {
        let face = Face { right: DVec3::X, up: DVec3::Y, forward: DVec3::Z, parallel: false };
        let mut buffer = FaceBuffer::new(face);
        let cube = |x: f64, y: f64, z: f64, half: f64| {
            let middle = DVec3::new(x, y, z);
            Block { min: middle - half, max: middle + half }
        };
        let receivers = [cube(1.0, 0.5, 10.0, 0.5), cube(-2.0, 1.0, 6.0, 0.2), cube(1.2, 0.4, 20.0, 0.1)];
        buffer.clear(Some(Rect::FACE), 256);
        buffer.keep_before(receivers.iter().copied(), true);
        for receiver in &receivers {
            for corner in receiver.corners() {
                for share in [0.2, 0.5, 0.9, 1.0] {
                    let p = corner * share;
                    assert!(!buffer.hides_block(&Block { min: p, max: p }), "{p}");
                    assert!(!buffer.hides_block(&Block { min: p - 0.3, max: p + 0.3 }), "{p}");
                }
            }
        }
        assert!(buffer.hides_block(&cube(2.5, 1.25, 25.0, 0.1)), "beyond all");
        assert!(buffer.hides_block(&cube(-2.0, 1.0, 6.5, 0.1)), "beyond the one in its tiles");
        assert!(buffer.hides_block(&cube(3.0, 0.5, 5.0, 0.5)), "beside all");
        buffer.clear(Some(Rect::FACE), 256);
        buffer.keep_before(receivers.iter().copied(), false);
        assert!(
            !buffer.hides_block(&cube(2.5, 1.25, 25.0, 0.1)) && buffer.hides_block(&cube(3.0, 0.5, 5.0, 0.5))
        );
        buffer.clear(Some(Rect::FACE), 256);
        buffer.keep_before(std::iter::empty(), true);
        assert!(buffer.is_closed(1e-3));
    }
}

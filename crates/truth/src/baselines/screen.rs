//! Where points and boxes fall on the pixels.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x8};
use glam::{Affine3A, Vec3, Vec4};

use super::depth::PixelRect;
use crate::numeric::baselines::{BIAS, NEAR};
use casca_scenes::world::Camera;

/// World space to pixels.
#[derive(Clone, Copy)]
pub(super) struct Screen {
    /// With a point and 1 these give x and y in pixels, times the depth, and the depth.
    pub(super) rows: [Vec4; 3],
    pub(super) width: f32,
    pub(super) height: f32,
    /// Depth of the near plane.
    pub(super) near: f32,
    pub(super) eye: Vec3,
    /// Pixels that a metre at a depth of a metre is high.
    pub(super) scale: f32,
}

impl Screen {
    pub(super) fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let p = &camera.projection;
        // Depth 0 for a usual projection, 1 for a reversed one, whichever lies nearer.
        let (a, b) = (p.z_axis.z, p.w_axis.z);
        let near = [b / a, b / (a + 1.0)].into_iter().filter(|z| *z > 0.0).fold(f32::INFINITY, f32::min);
        let near = if near.is_finite() { near } else { NEAR };
        let matrix = camera.view_projection();
        let (width, height) = (width as f32, height as f32);
        let (x, y, w) = (matrix.row(0), matrix.row(1), matrix.row(3));
        let rows = [(w + x) * (0.5 * width), (w - y) * (0.5 * height), w];
        let scale = y.truncate().length() * height * 0.5;
        Self { rows, width, height, near, eye: camera.eye, scale }
    }

    /// The rows for points in the space that a transform leads from.
    pub(super) fn rows_from(&self, transform: &Affine3A) -> [Vec4; 3] {
        let m = transform.matrix3;
        self.rows.map(|row| {
            let r = row.truncate();
            let at = |axis: glam::Vec3A| r.dot(axis.into());
            Vec4::new(at(m.x_axis), at(m.y_axis), at(m.z_axis), at(transform.translation) + row.w)
        })
    }
}

/// Boxes in world space, eight in a block.
#[derive(Default)]
pub(super) struct Boxes {
    /// Coordinates of the least corners and of the greatest ones.
    blocks: Vec<[[f32; 8]; 6]>,
    len: usize,
    /// On the screen, with squared distances from the eye.
    pub(super) rects: Vec<PixelRect>,
    pub(super) distances: Vec<f32>,
}

impl Boxes {
    pub(super) fn fill(&mut self, boxes: impl Iterator<Item = (Vec3, Vec3)>) {
        self.blocks.clear();
        self.len = 0;
        for (min, max) in boxes {
            let lane = self.len % 8;
            if lane == 0 {
                self.blocks.push([[0.0; 8]; 6]);
            }
            if let Some(block) = self.blocks.last_mut() {
                let corners = [min.x, min.y, min.z, max.x, max.y, max.z];
                block.iter_mut().zip(corners).for_each(|(lanes, c)| lanes[lane] = c);
            }
            self.len += 1;
        }
    }

    /// Finds the rectangles. A box across the near plane covers the screen and is nearer than
    /// anything.
    #[inline(always)]
    pub(super) fn project<S: Simd>(&mut self, simd: S, screen: &Screen) {
        self.rects.clear();
        self.distances.clear();
        for block in &self.blocks {
            let [x0, y0, z0, x1, y1, z1] = block.each_ref().map(|c| f32x8::from_slice(simd, c));
            let ends = [[x0, x1], [y0, y1], [z0, z1]];
            // What each end of each axis adds to each of x, y and depth.
            let parts = screen.rows.map(|row| {
                let r = [row.x, row.y, row.z];
                [0, 1, 2].map(|axis: usize| {
                    let base = if axis == 0 { row.w } else { 0.0 };
                    ends[axis].map(|c| c * r[axis] + base)
                })
            });
            let far = f32x8::splat(simd, f32::INFINITY);
            let (mut lo, mut hi) = ([far; 3], [-far; 3]);
            for corner in 0..8usize {
                let [x, y, w] = [0, 1, 2].map(|i: usize| {
                    parts[i][0][corner & 1] + parts[i][1][corner >> 1 & 1] + parts[i][2][corner >> 2]
                });
                let inverse = 1.0 / w;
                for (i, value) in [x * inverse, y * inverse, w].into_iter().enumerate() {
                    lo[i] = lo[i].min(value);
                    hi[i] = hi[i].max(value);
                }
            }
            let none = f32x8::splat(simd, 0.0);
            let (width, height) = (f32x8::splat(simd, screen.width), f32x8::splat(simd, screen.height));
            let crosses = lo[2].simd_lt(screen.near);
            let behind = hi[2].simd_lt(screen.near);
            let near = crosses.select(far, (1.0 + BIAS) / lo[2]);
            let left = crosses.select(none, lo[0].floor().max(none).min(width));
            let right = behind.select(none, crosses.select(width, hi[0].ceil().max(none).min(width)));
            let top = crosses.select(none, lo[1].floor().max(none).min(height));
            let bottom = crosses.select(height, hi[1].ceil().max(none).min(height));
            let away = |axis: usize, eye: f32| (ends[axis][0] - eye).max(eye - ends[axis][1]).max(none);
            let (dx, dy, dz) = (away(0, screen.eye.x), away(1, screen.eye.y), away(2, screen.eye.z));
            let distance = dx * dx + dy * dy + dz * dz;
            let count = (self.len - self.rects.len()).min(8);
            for i in 0..count {
                let pixel = |v: f32x8<S>| v[i] as u16;
                self.rects.push(PixelRect {
                    x: [pixel(left), pixel(right)],
                    y: [pixel(top), pixel(bottom)],
                    near: near[i],
                });
                self.distances.push(distance[i]);
            }
        }
    }

    /// The numbers of the boxes, nearest first.
    pub(super) fn front_to_back(&self, order: &mut Vec<u64>) {
        order.clear();
        // The bits of positive numbers are in their order.
        let key = |(i, d): (usize, &f32)| u64::from(d.to_bits()) << 32 | i as u64;
        order.extend(self.distances.iter().enumerate().map(key));
        order.sort_unstable();
    }
}

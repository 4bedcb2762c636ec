//! Squares of one depth each, drawn into a depth image in constant time for each, whatever their size.
//!
//! The levels are a sparse table (Bender & Farach-Colton 2000, "The LCA Problem Revisited") used
//! backwards. Level `k` has a depth for each square of `2^k` pixels. Any larger square, up to
//! `2^(k+1)`, is the union of four of these, and since the minimum of depths does not mind
//! overlaps, it is written there only. At the end each level is pushed down to the one below.

use super::image::DepthImage;
use crate::numeric::{SUBPIXELS, to_subpixels};
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The largest number of pixels on each side of a point's own that a square covers.
const MOST: f32 = 512.0;

/// Levels for squares of up to `2 MOST + 1` pixels.
const LEVELS: usize = 11;

/// The side of a square beyond the first pixel, halved, in 1/256 of a pixel, by the half side in pixels.
#[inline(always)]
pub(super) fn half_side(pixels: f32) -> i32 {
    // A point always covers its own pixel. NaN is the size of points outside the picture.
    to_subpixels(if pixels > 0.5 { (pixels - 0.5).min(MOST) } else { 0.0 })
}

/// Squares that grow into a depth image. Any thread may draw at any time: the minimum does not
/// depend on the order.
pub(super) struct Squares {
    size: (u32, u32),
    /// Made when a square first needs them.
    levels: [OnceLock<Level<AtomicU32>>; LEVELS],
}

/// The nearest depths of squares of `2^k` pixels by their upper left pixel, from `2^k` pixels
/// before the picture to one beyond it. While squares are drawn they are bits of floats that are
/// not negative, which are in the same order.
struct Level<D> {
    border: usize,
    width: usize,
    depths: Vec<D>,
}

impl Level<AtomicU32> {
    fn new(size: (u32, u32), k: usize) -> Self {
        let border = 1 << k;
        let (width, height) = (size.0 as usize + border + 1, size.1 as usize + border + 1);
        let depths = (0..width * height).map(|_| AtomicU32::new(f32::INFINITY.to_bits())).collect();
        Self { border, width, depths }
    }

    /// The depth of a square by its upper left pixel.
    #[inline(always)]
    fn depth(&self, x: i32, y: i32) -> &AtomicU32 {
        let border = self.border as i32;
        &self.depths[(y + border) as usize * self.width + (x + border) as usize]
    }

    fn complete(self) -> Level<f32> {
        let depths = self.depths.into_iter().map(|depth| f32::from_bits(depth.into_inner())).collect();
        Level { border: self.border, width: self.width, depths }
    }
}

impl Level<f32> {
    /// Lowers these depths to those of the level above, whose squares consist of four of these.
    fn lower_to(&mut self, above: &Self) {
        let (width, step) = (self.width, self.border);
        self.depths.par_chunks_mut(width).enumerate().for_each(|(row, depths)| {
            // The border of the level above is one step wider.
            let upper = &above.depths[row * above.width..];
            let lower = &above.depths[(row + step) * above.width..];
            let corners = [upper, &upper[step..], lower, &lower[step..]].map(|row| &row[..width]);
            for (x, depth) in depths.iter_mut().enumerate() {
                *depth =
                    corners.iter().fold(*depth, |least, row| if row[x] < least { row[x] } else { least });
            }
        });
    }
}

impl Squares {
    pub fn new(size: (u32, u32)) -> Self {
        Self { size, levels: Default::default() }
    }

    /// Draws squares around points in the picture, all lengths in 1/256 of a pixel. Does nothing
    /// for depths of NaN.
    #[inline(always)]
    pub fn draw<const N: usize>(&self, x: &[i32; N], y: &[i32; N], half: &[i32; N], depth: &[f32; N]) {
        // All are read before any is written, so that the processor waits for its caches once; most
        // points are behind others.
        let old: [f32; N] = std::array::from_fn(|i| {
            if half[i] == 0 {
                let [pixel, ..] = self.corners(x[i], y[i], 0);
                return f32::from_bits(pixel.load(Relaxed));
            }
            let old = self.corners(x[i], y[i], half[i]).map(|depth| depth.load(Relaxed));
            f32::from_bits(old[0].max(old[1]).max(old[2].max(old[3])))
        });
        for i in 0..N {
            if depth[i] < old[i] {
                for corner in &self.corners(x[i], y[i], half[i])[..if half[i] == 0 { 1 } else { 4 }] {
                    corner.fetch_min(depth[i].to_bits(), Relaxed);
                }
            }
        }
    }

    /// The four squares of a level, often the same, that make up a square.
    #[inline(always)]
    fn corners(&self, x: i32, y: i32, half: i32) -> [&AtomicU32; 4] {
        let pixel = |v: i32| v.div_euclid(SUBPIXELS as i32);
        let [left, right, top, bottom] = [x - half, x + half, y - half, y + half].map(pixel);
        // Width and height differ by one pixel at most.
        let k = (1 + (right - left).min(bottom - top)).ilog2() as usize;
        let level = self.levels[k].get_or_init(|| Level::new(self.size, k));
        let (right, bottom) = (right + 1 - (1 << k), bottom + 1 - (1 << k));
        [(left, top), (right, top), (left, bottom), (right, bottom)].map(|(x, y)| level.depth(x, y))
    }

    /// The nearest depth of each pixel.
    pub fn into_image(self) -> DepthImage {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let mut above: Option<Level<f32>> = None;
        for (k, level) in self.levels.into_iter().enumerate().rev() {
            let made = level.into_inner();
            // All levels below the first one that was made are needed, and the last one always.
            if made.is_some() || above.is_some() || k == 0 {
                let mut level = made.unwrap_or_else(|| Level::new(self.size, k)).complete();
                above.iter().for_each(|above| level.lower_to(above));
                above = Some(level);
            }
        }
        let rows = above.iter().flat_map(|level| level.depths.chunks(level.width).skip(1).take(height));
        let depths = rows.flat_map(|row| &row[1..][..width]).copied().collect();
        DepthImage { width, depths }
    }
}

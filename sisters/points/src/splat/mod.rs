//! The splat operator: points are drawn as squares into a depth image, and those behind it are hidden.
//!
//! Tavares 2009, "Aproximação Eficiente de Visibilidade para Nuvem de Pontos utilizando a GPU",
//! chapter 5. Here each point is tested; the thesis keeps one for each pixel.

mod image;
mod options;
mod squares;

pub use options::{Bias, Filter, Radius, SplatError, SplatOptions};

use crate::camera::Camera;
use crate::numeric::{SUBPIXELS, to_subpixels};
use bitvec::vec::BitVec;
use glam::Vec3;
use image::DepthImage;
use rayon::prelude::*;
use squares::Squares;

/// Points of a block, whose projections are found together by vector instructions.
const BLOCK: usize = usize::BITS as usize;

/// Points of a task of one thread.
const TASK: usize = 128 * BLOCK;

/// A bit for each point: whether the camera sees it.
///
/// An estimate that errs in both directions. Points outside the picture, nearer than the camera's
/// near depth or beyond the far one are not visible, and hide nothing. Positions in the picture are
/// rounded to 1/256 of a pixel.
///
/// Works on all threads of rayon's pool; the answer does not depend on their number. Takes time in proportion
/// to the points, whatever their radii, and to the pixels times the binary logarithm of the largest square's
/// side. The memory is an image of 4 bytes a pixel for each doubling of that side, and a bit for each point.
///
/// # Errors
/// [`SplatError`] names the point or the parameter at fault.
pub fn visible_points(
    points: &[Vec3],
    camera: &Camera,
    options: &SplatOptions,
) -> Result<BitVec, SplatError> {
    options.check(points.len())?;
    let squares = Squares::new(camera.size());
    // The blocks of each task, with the index of the first point.
    let tasks = || {
        let firsts = |task| (task * TASK..).step_by(BLOCK);
        points.par_chunks(TASK).enumerate().map(move |(i, task)| task.chunks(BLOCK).zip(firsts(i)))
    };
    let draw = |all, (points, first)| all & draw(&squares, points, first, camera, options.radius);
    if !tasks().map(|blocks| blocks.fold(true, draw)).reduce(|| true, |a, b| a & b) {
        let index = points.iter().position(|p| !p.is_finite()).unwrap_or(0);
        return Err(SplatError::PointNotFinite { index });
    }
    let limits = &squares.into_image().filtered(options.filter).limits(options.bias, camera.depths().1);
    let test = |(points, first)| test(limits, points, first, camera, options);
    let mut visible = BitVec::from_vec(tasks().flat_map_iter(|blocks| blocks.map(test)).collect());
    visible.truncate(points.len());
    Ok(visible)
}

/// Where points of a block are in the picture.
struct Block {
    /// In 1/256 of a pixel; 0 for points outside.
    x: [i32; BLOCK],
    y: [i32; BLOCK],
    /// NaN for points outside, which is neither nearer nor farther than any depth.
    depth: [f32; BLOCK],
}

impl Block {
    #[inline(always)]
    fn new(points: &[Vec3], camera: &Camera) -> Self {
        if let Ok(all) = points.try_into() {
            return Self::of_all(all, camera);
        }
        // The eye is not in the picture.
        let some = std::array::from_fn(|i| points.get(i).copied().unwrap_or(camera.eye()));
        Self::of_all(&some, camera)
    }

    /// Without a branch, for vector instructions.
    #[inline(always)]
    fn of_all(points: &[Vec3; BLOCK], camera: &Camera) -> Self {
        let mut block = Self { x: [0; BLOCK], y: [0; BLOCK], depth: [f32::NAN; BLOCK] };
        let (near, far) = camera.depths();
        let (width, height) = camera.size();
        let (width, height) = ((width * SUBPIXELS) as i32, (height * SUBPIXELS) as i32);
        for (i, &p) in points.iter().enumerate() {
            let at = camera.place(p);
            let (x, y) = (to_subpixels(at.x), to_subpixels(at.y));
            let inside = (x >= 0) & (x < width) & (y >= 0) & (y < height);
            let seen = (at.depth >= near) & (at.depth <= far) & inside;
            (block.x[i], block.y[i], block.depth[i]) = if seen { (x, y, at.depth) } else { (0, 0, f32::NAN) };
        }
        block
    }

    /// The half sides of the squares, for a block of which `first` is the first point's index.
    #[inline(always)]
    fn half_sides(&self, first: usize, camera: &Camera, radius: Radius) -> [i32; BLOCK] {
        let scale = camera.pixels_per_tangent();
        match radius {
            Radius::Same(radius) => self.depth.map(|depth| squares::half_side(radius * scale / depth)),
            Radius::Each(all) => {
                let mut radii = [0.0; BLOCK];
                radii.iter_mut().zip(&all[first..]).for_each(|(to, &from)| *to = from);
                std::array::from_fn(|i| squares::half_side(radii[i] * scale / self.depth[i]))
            }
        }
    }
}

/// Draws the squares of a block, of which `first` is the first point's index. Says whether all
/// coordinates are finite.
fn draw(squares: &Squares, points: &[Vec3], first: usize, camera: &Camera, radius: Radius) -> bool {
    let block = Block::new(points, camera);
    let half = block.half_sides(first, camera, radius);
    squares.draw(&block.x, &block.y, &half, &block.depth);
    // Zero times a coordinate is NaN if it is not finite.
    points.iter().fold(true, |all, p| all & (p.x * 0.0 + p.y * 0.0 + p.z * 0.0 == 0.0))
}

/// A bit for each point of a block, of which `first` is the first point's index: whether it is not
/// beyond `most`.
fn test(most: &DepthImage, points: &[Vec3], first: usize, camera: &Camera, options: &SplatOptions) -> usize {
    let block = Block::new(points, camera);
    let width = camera.size().0;
    let pixel: [u32; BLOCK] =
        std::array::from_fn(|i| block.y[i] as u32 / SUBPIXELS * width + block.x[i] as u32 / SUBPIXELS);
    let mut bits = 0;
    for (i, &pixel) in pixel.iter().enumerate() {
        let limit = most.depths.get(pixel as usize).copied().unwrap_or(0.0);
        bits |= usize::from(block.depth[i] <= limit) << i;
    }
    if options.slopes {
        let half = block.half_sides(first, camera, options.radius);
        for (i, &half) in half.iter().enumerate() {
            // Those outside have no depth.
            if bits >> i & 1 == 0 && block.depth[i] > 0.0 {
                let [x, y] = [block.x[i], block.y[i]].map(|v| v / SUBPIXELS as i32);
                bits |= usize::from(1.0 / block.depth[i] >= most.slanted(x, y, half)) << i;
            }
        }
    }
    bits
}

#[cfg(test)]
mod tests;
